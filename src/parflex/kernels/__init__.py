"""The functions that are compiled."""
