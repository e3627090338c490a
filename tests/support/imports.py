"""Every importer with files of its own: the paper's plate from each, in SI units."""

from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np
import pytest
from scipy import sparse

import parflex as pf
from ccx import plate_mesh
from paper_robot import PLATE, corners
from parflex.fe.imports.nastran.bulk_data import read_bulk
from parflex.fe.imports.nastran.op2 import read_op2
from parflex.fe.imports.unit_systems import SYSTEMS
from places import DATA

CORNERS = np.column_stack([corners(), np.zeros(6)])


class Case(NamedTuple):
    """An importer's name, its files, the files that may be spoilt, and where legs hold."""

    program: str
    files: dict[str, Path]
    spoilt: dict[str, Path]
    radius: float

    def read(self, units: str = "SI", **files: Path) -> pf.Modes:
        """The first nine modes held at the corners."""
        given = self.files | files
        return pf.fe.import_modes(self.program, given, units, 9, None, CORNERS, self.radius)


def nastran(folder: Path) -> Case:
    """MYSTRAN's modes."""
    pytest.importorskip("pyyeti", reason="pyYeti reads Nastran's files")
    files = {"op2": DATA / "hexQ8.OP2", "bulk": DATA / "hexQ8.bdf"}
    return Case("nastran", files, files, 0.07)


def calculix(folder: Path) -> Case:
    """CalculiX's modes on 57 nodes."""
    files = {"frd": DATA / "ccx_plate.frd", "inp": DATA / "ccx_plate.inp"}
    return Case("calculix", files, files, 0.01)


def calculix_matrices(folder: Path) -> Case:
    """Matrices of the same mesh, assembled here and written as CalculiX writes them."""
    body, _ = small_solid()
    rows = np.arange(body.unknowns)
    np.savetxt(folder / "job.dof", np.column_stack([rows // 3 + 1, rows % 3 + 1]), "%d.%d")
    for suffix, matrix in (("sti", body.stiffness), ("mas", body.mass)):
        upper = sparse.triu(matrix).tocoo()
        table = np.column_stack([upper.row + 1, upper.col + 1, upper.data])
        np.savetxt(folder / f"job.{suffix}", table, "%d %d %20.13e")
    own = {suffix: folder / f"job.{suffix}" for suffix in ("sti", "mas", "dof")}
    files = {"matrices": own["sti"], "inp": DATA / "ccx_plate.inp"}
    return Case("calculix-matrices", files, own | {"inp": files["inp"]}, 0.01)


def matrices(folder: Path) -> Case:
    """The same as MatrixMarket, NPZ and a table of nodes."""
    body, _ = small_solid()
    K = sparse.coo_array(body.stiffness)
    lines = ["%%MatrixMarket matrix coordinate real general", f"{K.shape[0]} {K.shape[1]} {K.nnz}"]
    lines += [f"{i + 1} {j + 1} {value:.17g}" for i, j, value in zip(K.row, K.col, K.data, strict=True)]
    (folder / "k.mtx").write_text("\n".join(lines) + "\n")
    sparse.save_npz(folder / "m.npz", sparse.csr_matrix(body.mass))
    np.savetxt(folder / "nodes.txt", np.column_stack([np.arange(len(body.nodes)) + 1, body.nodes]), "%.15g")
    names = {"stiffness": "k.mtx", "mass": "m.npz", "nodes": "nodes.txt"}
    files = {key: folder / name for key, name in names.items()}
    return Case("matrices", files, files, 0.01)


def arrays(folder: Path) -> Case:
    """MYSTRAN's modes, stored as plain arrays."""
    pytest.importorskip("pyyeti", reason="pyYeti reads Nastran's files")
    modes, bulk = read_op2(DATA / "hexQ8.OP2"), read_bulk(DATA / "hexQ8.bdf", SYSTEMS["SI"])
    with h5py.File(folder / "modes.h5", "w") as file:
        file["nodes"], file["masses"] = bulk.nodes, bulk.masses["lumped"].diagonal()
        file["shapes"], file["rotations"] = modes.shapes, modes.rotations
        file["omega"] = np.sign(modes.squares) * np.sqrt(np.abs(modes.squares))
        file["ids"], file["triangles"] = bulk.ids, bulk.triangles
    files = {"path": folder / "modes.h5"}
    return Case("arrays", files, files, 0.07)


ALL_CASES = {
    "nastran": nastran,
    "calculix": calculix,
    "calculix-matrices": calculix_matrices,
    "matrices": matrices,
    "arrays": arrays,
}


def small_solid() -> tuple[pf.fe.FreeBody, np.ndarray]:
    """The plate on the 57 nodes of ccx_plate.inp, in their order, and its elements."""
    nodes, elements = plate_mesh(0)
    body = pf.fe.solid_body(
        pf.fe.solid_mesh(nodes, elements), pf.fe.Material(PLATE["young"], PLATE["poisson"], PLATE["density"])
    )
    assert np.allclose(body.nodes, nodes, rtol=0, atol=1e-15)
    return body, elements
