"""pyYeti's readers of Nastran's files; the package is an extra."""

from typing import Any

import numpy as np

from parflex.base.extra import extra


def nastran(module: str) -> Any:
    """A module of `pyyeti.nastran`, which sets NumPy's print options for the whole process: put back here.

    Raises InputError where pyYeti is not installed.
    """
    words = 'Nastran\'s files need pyYeti; install it with: pip install "parflex[nastran]"'
    with np.printoptions():
        return extra(f"pyyeti.nastran.{module}", words)
