"""Data that say what a robot is."""
