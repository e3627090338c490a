"""A result in a browser: the robot moves, bends in colour, and can be turned, slowed and shared."""

from parflex.views.viewer.page import View, view

__all__ = ["View", "view"]
