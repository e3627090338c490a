"""Finite elements: where platforms get their modes."""

from parflex.fe.accuracy import BasisError, with_mesh_error
from parflex.fe.attach import attached
from parflex.fe.basis import Basis, FreeFree, FreeFreeWithAttachment
from parflex.fe.calculix import calculix_body, read_calculix
from parflex.fe.free_body import FreeBody
from parflex.fe.importers import IMPORTERS, import_modes
from parflex.fe.material import Material
from parflex.fe.matrices import read_matrices
from parflex.fe.mesh import SolidMesh, solid_mesh
from parflex.fe.mesh_file import read_mesh
from parflex.fe.modal_arrays import read_arrays
from parflex.fe.nastran import read_nastran
from parflex.fe.netgen_mesh import Rib, Step, outline_mesh, step_mesh
from parflex.fe.nodal import body_of_matrices
from parflex.fe.plate import plate_body, plate_modes
from parflex.fe.recovery import Fields, recover
from parflex.fe.solid import solid_body
from parflex.fe.sources import mesh_from, modes
from parflex.fe.vtk_file import write_fields
from parflex.files.body_file import read_modes, write_modes

__all__ = [
    "IMPORTERS",
    "Basis",
    "BasisError",
    "Fields",
    "FreeBody",
    "FreeFree",
    "FreeFreeWithAttachment",
    "Material",
    "Rib",
    "SolidMesh",
    "Step",
    "attached",
    "body_of_matrices",
    "calculix_body",
    "import_modes",
    "mesh_from",
    "modes",
    "outline_mesh",
    "plate_body",
    "plate_modes",
    "read_arrays",
    "read_calculix",
    "read_matrices",
    "read_mesh",
    "read_modes",
    "read_nastran",
    "recover",
    "solid_body",
    "solid_mesh",
    "step_mesh",
    "with_mesh_error",
    "write_fields",
    "write_modes",
]
