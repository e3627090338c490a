"""Linear systems in the hands of other programs: python-control and MATLAB."""

from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.extra import extra
from parflex.base.writing import replacing
from parflex.linear.matrices import Matrices
from parflex.linear.response import frequencies, responses


def to_control(lin: Matrices, omega: ArrayLike | None) -> Any:
    """The StateSpace or FRD of `LinearModel.to_control`."""
    control = extra("control", "to_control needs python-control: pip install parflex[control]")
    labels = {"inputs": list(lin.inputs), "outputs": list(lin.outputs)}
    if omega is None:
        return control.ss(lin.A, lin.B, lin.C, lin.D, **labels)
    w = frequencies(omega)
    return control.frd(responses(lin, w), w, **labels)


def to_matlab(lin: Matrices, path: str | PathLike[str]) -> Path:
    """Write the file of `LinearModel.to_matlab`."""
    from scipy.io import savemat

    target = Path(path)
    words = {name: np.array(getattr(lin, name), dtype=object) for name in ("inputs", "outputs")}
    words |= {name: np.array(getattr(lin, name), dtype=object) for name in ("input_units", "output_units")}
    with replacing(target) as file:
        savemat(file, {"A": lin.A, "B": lin.B, "C": lin.C, "D": lin.D, **words})
    return target
