"""The files that readers bring to a page: written before its snippets run, as other programs write them."""

import shutil
from pathlib import Path

import numpy as np
from netgen import occ
from scipy import sparse

import parflex as pf
from parflex.fe.imports.calculix.deck import read_deck
from parflex.fe.imports.nastran.bulk_data import read_bulk
from parflex.fe.imports.nastran.op2 import read_op2
from parflex.fe.imports.unit_systems import SYSTEMS
from parflex.robots.gough_stewart import PLATE

DATA = Path(__file__).parent.parent / "tests" / "support" / "data"
SHELLS = {"op2": DATA / "hexQ8.OP2", "bulk": DATA / "hexQ8.bdf"}  # the paper's plate
SOLID = DATA / "ccx_plate.inp"  # the same in 57 nodes


def small_plate() -> pf.fe.FreeBody:
    """The paper's plate in 18 tetrahedra; its matrices keep the order of the deck's nodes."""
    deck = read_deck(SOLID)
    material = pf.fe.Material(PLATE["young"], PLATE["poisson"], PLATE["density"])
    return pf.fe.solid_body(pf.fe.solid_mesh(deck.nodes, deck.elements["tet10"] - 1), material)


def numbers(body: pf.fe.FreeBody) -> np.ndarray:
    """Node numbers as programs have them: not from 1, nor in the matrices' order."""
    return 100 + np.random.default_rng(3).permutation(len(body.nodes))


def nastran(folder: Path) -> None:
    """A result and its bulk data."""
    shutil.copy(SHELLS["op2"], folder / "plate.op2")
    shutil.copy(SHELLS["bulk"], folder / "plate.dat")


def abaqus(folder: Path, square: bool = False) -> None:
    """Matrices in the format of *MATRIX INPUT, of one triangle or of both, and the deck."""
    body = small_plate()
    ids = numbers(body)
    for name, matrix in (("job_STIF2", body.stiffness), ("job_MASS2", body.mass)):
        X = sparse.coo_array(matrix if square else sparse.tril(matrix))
        lines = [
            f"{ids[i // 3]},{i % 3 + 1}, {ids[j // 3]},{j % 3 + 1}, {value:.15e}"
            for i, j, value in zip(X.row, X.col, X.data, strict=True)
        ]
        (folder / f"{name}.mtx").write_text("\n".join(lines) + "\n")
    rows = [f"{ids[k]}, {', '.join(f'{value:.15e}' for value in body.nodes[k])}" for k in np.argsort(ids)]
    (folder / "job.inp").write_text("\n".join(["*NODE", *rows, "999, 0., 0., 9.", "*END"]))


def ansys(folder: Path) -> None:
    """What ansys-mapdl-reader hands on: upper triangles whose nodes ascend, unknowns, nodes."""
    body = small_plate()
    ids = numbers(body)
    order = np.argsort(ids)
    rows = (3 * order[:, None] + np.arange(3)).ravel()
    for name, matrix in (("K", body.stiffness), ("M", body.mass)):
        sparse.save_npz(folder / f"{name}_upper.npz", sparse.triu(matrix.tocsr()[rows][:, rows]).tocsc())
    dof = np.column_stack([np.repeat(ids[order], 3), np.tile([0, 1, 2], len(ids))])
    np.savez(folder / "ansys.npz", dof=dof, nnum=ids[order], nodes=body.nodes[order])


def tables(folder: Path) -> None:
    """Modes as text, in mm, tonne, s: a node a row, of each mode a row after the other."""
    bulk, modes = read_bulk(SHELLS["bulk"], SYSTEMS["SI"]), read_op2(SHELLS["op2"])
    np.savetxt(folder / "nodes.csv", 1e3 * bulk.nodes, delimiter=",")
    np.savetxt(folder / "masses.csv", 1e-3 * bulk.masses["lumped"].diagonal())
    np.savetxt(folder / "shapes.csv", np.sqrt(1e3) * modes.shapes.reshape(-1, 3), delimiter=",")
    np.savetxt(folder / "hertz.csv", np.sqrt(np.abs(modes.squares)) / (2 * np.pi))


def step(folder: Path) -> None:
    """A disc with a boss, in millimetres."""
    disc = occ.Cylinder((0, 0, 0), occ.Z, r=240, h=8)
    (disc + occ.Cylinder((0, 0, 0), occ.Z, r=50, h=40)).WriteStep(str(folder / "platform.step"))


GIVEN = {"importing.md": (nastran, abaqus, ansys, tables), "own-platform.md": (step,)}
