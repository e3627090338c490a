"""Stiffness and mass matrices that CalculiX stored."""

from os import PathLike
from pathlib import Path

import numpy as np

from parflex.base.array import Array
from parflex.base.progress import waiting
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.integrals import Sparse
from parflex.fe.body.surface import surface
from parflex.fe.imports.calculix.calculix import UNKNOWN
from parflex.fe.imports.calculix.deck import read_deck
from parflex.fe.imports.foreign import lines_of, refusing, rows_of
from parflex.fe.imports.importer import Importer
from parflex.fe.imports.matrices import free_body, matrix_of_entries
from parflex.fe.imports.unit_systems import check_material, units_named


def calculix_body(matrices: str | PathLike[str], inp: str | PathLike[str], units: str = "") -> FreeBody:
    """The free body of the stiffness and mass matrices that CalculiX wrote.

    matrices names the files of *FREQUENCY, SOLVER=MATRIXSTORAGE: job.sti for job.sti, job.mas and job.dof;
    inp is the deck. A basis makes modes of it: `pf.fe.FreeFreeWithAttachment(9, points).modes(body)`. The
    check report is `body.report`.

    Raises InputError where a file is missing, damaged or of another model, or the model is held.
    """
    system = units_named(units)
    job = Path(matrices)
    with waiting("reading the matrices of CalculiX"):
        deck = read_deck(Path(inp))
        for name, (rho, young) in deck.materials.items():
            check_material(f"material {name} of inp", rho or 0.0, young, system)
        unknowns = degrees(job.with_suffix(".dof"))
        K, M = (triangle(job.with_suffix(suffix), len(unknowns)) for suffix in (".sti", ".mas"))
        ids = np.unique(unknowns[:, 0])
        missing = f"{job.stem}.dof has node {{}}, which inp has not; give the files of one model"
        parts = [(kind, rows_of(ids, nodes, UNKNOWN)) for kind, nodes in deck.elements.items()]
        return free_body(
            ids=ids,
            nodes=deck.nodes[rows_of(deck.ids, ids, missing)],
            stiffness=K,
            mass=M,
            unknowns=np.column_stack([np.searchsorted(ids, unknowns[:, 0]), unknowns[:, 1] - 1]),
            triangles=surface(parts),
            source=f"CalculiX, {job.stem}.sti, .mas, {units}",
            units=system,
        )


def degrees(path: Path) -> Array:
    """The node and direction (n, 2) of each unknown, from lines such as 12.3."""
    lines = lines_of("matrices", path)
    with refusing(f"matrices {path.name} is damaged ({{}}); write it again", ValueError):
        rows = (line.split(".") for line in lines if line.strip())
        return np.array([[int(node), int(direction)] for node, direction in rows]).reshape(-1, 2)


def triangle(path: Path, size: int) -> Sparse:
    """The symmetric matrix (n, n) of lines of row, column, value of one triangle, counted from 1."""
    return matrix_of_entries("matrices", path, lines_of("matrices", path), size, symmetric=True)


IMPORTER = Importer("calculix-matrices", calculix_body, ("matrices", "inp"))
