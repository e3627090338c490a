"""Finite elements: where platforms get their modes."""

from parflex.fe.plate import plate_modes

__all__ = ["plate_modes"]
