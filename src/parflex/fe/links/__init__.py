"""Flexible links from finite elements: bodies clamped at the frame of a joint."""
