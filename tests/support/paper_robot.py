"""The numbers of the paper's robot, which the library keeps beside the function that builds it."""

from parflex.robots.gough_stewart import (
    DAMPING_RATIO,
    HOME,
    PLATE,
    TABLE_2,
    TABLE_4,
    base_frames,
    corners,
    held,
    links,
)

__all__ = ["DAMPING_RATIO", "HOME", "PLATE", "TABLE_2", "TABLE_4", "base_frames", "corners", "held", "links"]
