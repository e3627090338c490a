"""The version of parflex."""

__version__ = "0.1.0"
