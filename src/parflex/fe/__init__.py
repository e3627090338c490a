"""Finite elements: where platforms get their modes."""

from parflex.fe.body.accuracy import BasisError
from parflex.fe.body.attach import attached
from parflex.fe.body.basis import (
    Basis,
    ComputedModes,
    FreeFree,
    FreeFreeWithAttachment,
    basis_error,
    converged,
    with_mesh_error,
)
from parflex.fe.body.basis_report import check_rows
from parflex.fe.body.check_report import CheckReport, MatrixReport, Report
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.nodal import body_of_matrices
from parflex.fe.body.solid import Solid
from parflex.fe.imports.calculix.calculix import read_calculix
from parflex.fe.imports.calculix.storage import calculix_body
from parflex.fe.imports.importer import Importer
from parflex.fe.imports.importers import IMPORTERS, import_modes, read_files
from parflex.fe.imports.matrices import read_matrices
from parflex.fe.imports.modal_arrays import read_arrays
from parflex.fe.imports.nastran.nastran import read_nastran
from parflex.fe.links.link import link
from parflex.fe.modal_file import read_modes, write_modes
from parflex.fe.plate.plate import plate_body, plate_modes
from parflex.fe.plate.polygon import circle
from parflex.fe.solid.mesh import SolidMesh, solid_mesh
from parflex.fe.solid.mesh_file import read_mesh
from parflex.fe.solid.netgen_mesh import Rib, Step, outline_mesh, step_mesh
from parflex.fe.solid.recovery import Fields, recover
from parflex.fe.solid.solid import solid_body
from parflex.fe.solid.vtk_file import write_fields
from parflex.fe.sources import mesh_from, modes
from parflex.robot.material import Material
from parflex.robot.materials import MATERIALS
from parflex.robot.materials import named as material

__all__ = [
    "IMPORTERS",
    "MATERIALS",
    "Basis",
    "BasisError",
    "CheckReport",
    "ComputedModes",
    "Fields",
    "FreeBody",
    "FreeFree",
    "FreeFreeWithAttachment",
    "Importer",
    "Material",
    "MatrixReport",
    "Report",
    "Rib",
    "Solid",
    "SolidMesh",
    "Step",
    "attached",
    "basis_error",
    "body_of_matrices",
    "calculix_body",
    "check_rows",
    "circle",
    "converged",
    "import_modes",
    "link",
    "material",
    "mesh_from",
    "modes",
    "outline_mesh",
    "plate_body",
    "plate_modes",
    "read_arrays",
    "read_calculix",
    "read_files",
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
