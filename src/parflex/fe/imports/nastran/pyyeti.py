"""pyYeti's readers of Nastran's files; the package is an extra."""

from importlib import import_module
from typing import Any

import numpy as np

from parflex.base.errors import InputError


def nastran(module: str) -> Any:
    """A module of `pyyeti.nastran`, which sets NumPy's print options for the whole process: put back here.

    Raises InputError where pyYeti is not installed.
    """
    try:
        with np.printoptions():
            return import_module(f"pyyeti.nastran.{module}")
    except ImportError:
        raise InputError(
            'Nastran\'s files need pyYeti; install it with: pip install "parflex[nastran]"'
        ) from None
