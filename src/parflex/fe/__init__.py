"""Finite elements: where platforms get their modes."""

from parflex.fe.basis import Basis, FreeFree, FreeFreeWithAttachment
from parflex.fe.free_body import FreeBody
from parflex.fe.material import Material
from parflex.fe.mesh import SolidMesh, solid_mesh
from parflex.fe.mesh_file import read_mesh
from parflex.fe.netgen_mesh import Rib, Step, outline_mesh, step_mesh
from parflex.fe.nodal import body_of_matrices
from parflex.fe.plate import plate_body, plate_modes
from parflex.fe.recovery import Fields, recover
from parflex.fe.solid import solid_body
from parflex.fe.sources import mesh_from, modes
from parflex.fe.vtk_file import write_fields
from parflex.files.body_file import read_modes, write_modes

__all__ = [
    "Basis",
    "Fields",
    "FreeBody",
    "FreeFree",
    "FreeFreeWithAttachment",
    "Material",
    "Rib",
    "SolidMesh",
    "Step",
    "body_of_matrices",
    "mesh_from",
    "modes",
    "outline_mesh",
    "plate_body",
    "plate_modes",
    "read_mesh",
    "read_modes",
    "recover",
    "solid_body",
    "solid_mesh",
    "step_mesh",
    "write_fields",
    "write_modes",
]
