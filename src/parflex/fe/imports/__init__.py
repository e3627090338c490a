"""Bodies from other programs."""
