"""Robots with a source, one file each."""

from parflex.robots.gough_stewart import gough_stewart

__all__ = ["gough_stewart"]
