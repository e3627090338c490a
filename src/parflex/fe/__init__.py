"""Finite elements: where platforms get their modes."""

from parflex.fe.basis import Basis, FreeFree, FreeFreeWithAttachment
from parflex.fe.free_body import FreeBody
from parflex.fe.nastran import read_nastran
from parflex.fe.nodal import body_of_matrices
from parflex.fe.plate import plate_body, plate_modes

__all__ = [
    "Basis",
    "FreeBody",
    "FreeFree",
    "FreeFreeWithAttachment",
    "body_of_matrices",
    "plate_body",
    "plate_modes",
    "read_nastran",
]
