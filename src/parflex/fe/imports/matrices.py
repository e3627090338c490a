"""A free body from stiffness and mass matrices in files, of whatever program."""

from dataclasses import replace
from io import BytesIO
from os import PathLike
from pathlib import Path

import numpy as np
from scipy import sparse

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.progress import waiting
from parflex.fe.body.check_report import MatrixReport
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.integrals import Sparse, rigid_part
from parflex.fe.body.nodal import BELOW, body_of_matrices
from parflex.fe.imports.foreign import lines_of, read, refusing, rows_of
from parflex.fe.imports.free_checks import check_size
from parflex.fe.imports.importer import Importer
from parflex.fe.imports.unit_systems import Units, units_named

BALANCED = 1e-8  # forces in a rigid motion, of those that its parts make, at most


def read_matrices(
    stiffness: str | PathLike[str],
    mass: str | PathLike[str],
    nodes: str | PathLike[str],
    units: str = "",
    unknowns: str | PathLike[str] | None = None,
) -> FreeBody:
    """The free body of matrices (3K, 3K) over the displacements of K nodes.

    stiffness and mass are MatrixMarket files (.mtx) or SciPy's (.npz); nodes is a text table of id, x,
    y, z; unknowns, one of node id and direction (1, 2, 3) for each row of the matrices, by default x, y,
    z of node after node in the table's order. All in `units`, such as "SI" or "mm-tonne-s". A basis
    makes modes of the body: `pf.fe.FreeFreeWithAttachment(9, points).modes(body)`. The check report is
    `body.report`.

    Raises InputError where a file is missing, damaged or does not fit the others, and where the model
    is held.
    """
    system = units_named(units)
    with waiting("reading the matrices"):
        table = table_in("nodes", Path(nodes), 4)
        ids = table[:, 0].astype(int)
        K, M = read_matrix("stiffness", Path(stiffness)), read_matrix("mass", Path(mass))
        rows = None if unknowns is None else node_directions(table_in("unknowns", Path(unknowns), 2), ids)
        source = f"{Path(stiffness).name}, {Path(mass).name}, {units}"
        return free_body(ids, table[:, 1:], K, M, rows, None, source, system)


def free_body(
    ids: Array,
    nodes: Array,
    stiffness: Sparse,
    mass: Sparse,
    unknowns: Array | None,
    triangles: Array | None,
    source: str,
    units: Units,
) -> FreeBody:
    """The body of matrices in a system of units, with its check report.

    Raises InputError where the matrices do not fit the nodes, the model is held, or the units make a
    body that nothing is.
    """
    K, M = units.stiffness * sparse.csr_array(stiffness), units.mass * sparse.csr_array(mass)
    if len(np.unique(ids)) != len(ids):
        raise InputError("nodes has an id twice; give each node once")
    body = body_of_matrices(units.length * nodes, K, M, unknowns, triangles, source=source)
    check_equilibrium(ids, body)
    report = matrix_report(body)
    check_size(body.nodes, report.body.mass, report.first)
    return replace(body, report=report, ids=tuple(int(i) for i in ids))


def check_equilibrium(ids: Array, body: FreeBody) -> None:
    """Raise InputError where a rigid motion makes a force at a node: K R = 0 row by row."""
    largest = abs(body.stiffness) @ np.abs(body.rigid)
    off = np.max(np.abs(body.stiffness @ body.rigid) / np.max(largest, axis=0), axis=1)
    worst = int(np.argmax(off))
    if off[worst] > BALANCED:
        raise InputError(
            f"stiffness makes a force of {off[worst]:.1e} of the largest at node {ids[worst // 3]} in a "
            f"rigid motion; it is held, or at other coordinates in the table of nodes, or a file is damaged"
        )


def matrix_report(body: FreeBody) -> MatrixReport:
    """The rigid body of the matrices, and how soft its rigid motions are."""
    first = float(np.sqrt(body.shift / BELOW))
    return MatrixReport(
        source=body.source,
        notes=(),
        body=rigid_part(body.moments(np.zeros((body.unknowns, 0)))),
        unknowns=body.unknowns,
        residual_stiffness=float(np.max(np.abs(body.rigid_squares)) / first**2),
        first=first,
    )


def read_matrix(name: str, path: Path) -> Sparse:
    """A sparse matrix of a file."""
    if path.suffix != ".npz":
        return matrix_market(name, path)
    data = BytesIO(read(name, path))
    with refusing(f"{name} {path.name} is damaged, or of no matrix ({{}}); write it again", Exception):
        matrix = sparse.csr_array(sparse.load_npz(data))
        matrix.check_format(full_check=True)
    return matrix


def matrix_market(name: str, path: Path) -> Sparse:
    """A real matrix in coordinate format, general or symmetric.

    Read here, since SciPy's reader may crash on a damaged file (1.17).
    """
    lines = lines_of(name, path)
    head = lines[0].lower().split()
    real = head[:3] == ["%%matrixmarket", "matrix", "coordinate"] and head[3:4] in (["real"], ["integer"])
    if not real or head[4:] not in (["general"], ["symmetric"]):
        raise InputError(
            f"{name} {path.name} begins with {lines[0][:60]!r}; expected %%MatrixMarket matrix coordinate "
            f"real, general or symmetric"
        )
    body = [line for line in lines[1:] if line and not line.startswith("%")]
    size, *entries = body or [""]
    shape = [int(word) if word.isdigit() else -1 for word in size.split()]
    if len(shape) != 3 or min(shape) < 0 or shape[0] != shape[1] or len(entries) != shape[2]:
        raise InputError(f"{name} {path.name} says {size!r} and has {len(entries)} entries; it is damaged")
    return matrix_of_entries(name, path, entries, shape[0], head[4] == "symmetric")


def matrix_of_entries(name: str, path: Path, entries: list[str], size: int, symmetric: bool) -> Sparse:
    """The matrix (n, n) of lines of row, column, value, counted from 1; of one triangle if symmetric."""
    table = table_of_lines(name, path, entries, 3)
    whole = np.all(table[:, :2] == np.floor(table[:, :2]))
    if not whole or np.any(table[:, :2] < 1) or np.any(table[:, :2] > size):
        raise InputError(f"{name} {path.name} does not fit {size} unknowns; write it again")
    i, j = table[:, :2].astype(int).T - 1
    matrix = sparse.coo_array((table[:, 2], (i, j)), shape=(size, size)).tocsr()
    return matrix + matrix.T - sparse.diags_array(matrix.diagonal()) if symmetric else matrix


def table_in(name: str, path: Path, columns: int) -> Array:
    """The finite numbers (n, columns) of a text file."""
    return table_of_lines(name, path, lines_of(name, path), columns)


def table_of_lines(name: str, path: Path, lines: list[str], columns: int) -> Array:
    """Finite numbers (n, columns) of lines, with commas or without."""
    rows = [line.replace(",", " ") for line in lines if line.strip() and not line.startswith("#")]
    if not rows:
        raise InputError(f"{name} {path.name} is empty; write it again")
    with refusing(f"{name} {path.name} is no table of numbers ({{}}); correct it", ValueError):
        table = np.loadtxt(rows, ndmin=2)
    if table.shape[1:] != (columns,) or not np.all(np.isfinite(table)):
        raise InputError(f"{name} {path.name} has not {columns} finite numbers in each line; correct it")
    return table


def node_directions(table: Array, ids: Array) -> Array:
    """Node and direction (n, 2) from 0, of ids and directions from 1."""
    rows = rows_of(ids, table[:, 0], "unknowns has node {}, which the table of nodes has not")
    return np.column_stack([rows, table[:, 1].astype(int) - 1])


IMPORTER = Importer("matrices", read_matrices, ("stiffness", "mass", "nodes"), ("unknowns",))
