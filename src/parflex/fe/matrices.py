"""A free body from stiffness and mass matrices in files, of whatever program."""

from collections.abc import Callable
from os import PathLike
from pathlib import Path

import numpy as np
from scipy import io, sparse

from parflex.array import Array
from parflex.errors import InputError
from parflex.fe.acceptance import check_size
from parflex.fe.check_report import BodyReport
from parflex.fe.free_body import FreeBody, Sparse
from parflex.fe.imported import rigid_body
from parflex.fe.nodal import BELOW, body_of_matrices
from parflex.fe.unit_systems import Units, units_named
from parflex.progress import waiting


def read_matrices(
    stiffness: str | PathLike[str],
    mass: str | PathLike[str],
    nodes: str | PathLike[str],
    units: str = "",
    unknowns: str | PathLike[str] | None = None,
    say: Callable[[str], None] = print,
) -> FreeBody:
    """The free body of matrices (3K, 3K) over the displacements of K nodes.

    stiffness and mass are MatrixMarket files (.mtx) or SciPy's (.npz); nodes is a text table of id, x,
    y, z; unknowns, one of node id and direction (1, 2, 3) for each row of the matrices, by default x, y,
    z of node after node in the table's order. All in `units`, such as "SI" or "mm-tonne-s". A basis
    makes modes of the body: `pf.fe.FreeFreeWithAttachment(9, points).modes(body)`.

    Raises InputError where a file is missing, damaged or does not fit the others, and where the model
    is held.
    """
    system = units_named(units)
    with waiting("reading the matrices"):
        table = read_table("nodes", Path(nodes), 4)
        ids = table[:, 0].astype(int)
        K, M = read_matrix("stiffness", Path(stiffness)), read_matrix("mass", Path(mass))
        rows = None if unknowns is None else numbered(read_table("unknowns", Path(unknowns), 2), ids)
        names = f"{Path(stiffness).name}, {Path(mass).name}"
        return free_body(ids, table[:, 1:], K, M, rows, None, f"{names}, {units}", system, say)


def free_body(
    ids: Array,
    nodes: Array,
    stiffness: Sparse,
    mass: Sparse,
    unknowns: Array | None,
    triangles: Array | None,
    source: str,
    units: Units,
    say: Callable[[str], None],
) -> FreeBody:
    """The body of matrices in a system of units, with what is to be said of it."""
    K, M = units.stiffness * sparse.csr_array(stiffness), units.mass * sparse.csr_array(mass)
    if len(np.unique(ids)) != len(ids):
        raise InputError("nodes has an id twice; give each node once")
    body = body_of_matrices(units.length * nodes, K, M, unknowns, triangles, source=source)
    report = report_of(body)
    check_size(float(np.max(np.ptp(body.nodes, axis=0))), report.body.mass, report.first)
    say(str(report))
    return body


def report_of(body: FreeBody) -> BodyReport:
    """What the matrices say of the rigid body, and how soft its rigid motions are."""
    none = body.moments(np.zeros((body.unknowns, 0)))
    inertia = np.block(
        [[none.m * np.eye(3), -hat(none.MS0)], [hat(none.MS0), np.trace(none.P0) * np.eye(3) - none.P0]]
    )
    first = float(np.sqrt(body.shift / BELOW))
    R = body.rigid
    energy = np.sum(R * (body.stiffness @ R), axis=0) / np.sum(R * (body.mass @ R), axis=0)
    return BodyReport(
        source=body.source,
        body=rigid_body(inertia),
        unknowns=body.unknowns,
        residual_stiffness=float(np.max(np.abs(energy)) / first**2),
        first=first,
    )


def hat(v: Array) -> Array:
    """The matrix of v ×."""
    return np.cross(np.eye(3), v).T


def read_matrix(name: str, path: Path) -> Sparse:
    """A sparse matrix of a file."""
    try:
        return sparse.csr_array(sparse.load_npz(path) if path.suffix == ".npz" else io.mmread(path))
    except OSError as error:
        raise InputError(f"{name} {path} cannot be read: {error.strerror or error}") from None
    except Exception as error:  # the readers raise many kinds for a damaged file
        raise InputError(
            f"{name} {path.name} is no sparse matrix of MatrixMarket or SciPy ({error}); write it again"
        ) from None


def read_table(name: str, path: Path, columns: int) -> Array:
    """Numbers (n, columns) of a text table, with commas or without."""
    try:
        text = path.read_text(encoding="latin-1").replace(",", " ")
        table = np.loadtxt(text.splitlines(), ndmin=2)
    except OSError as error:
        raise InputError(f"{name} {path} cannot be read: {error.strerror or error}") from None
    except ValueError as error:
        raise InputError(f"{name} {path.name} is no table of numbers ({error}); correct it") from None
    if table.shape[1:] != (columns,) or not np.all(np.isfinite(table)):
        raise InputError(f"{name} {path.name} has not {columns} finite numbers in each line; correct it")
    return table


def numbered(table: Array, ids: Array) -> Array:
    """(n, 2) node and direction from 0, of ids and directions from 1."""
    order = np.argsort(ids)
    at = np.searchsorted(ids, table[:, 0], sorter=order)
    node = order[np.minimum(at, len(ids) - 1)]
    wrong = np.flatnonzero(ids[node] != table[:, 0])
    if len(wrong):
        raise InputError(f"unknowns has node {table[wrong[0], 0]:.0f}, which the table of nodes has not")
    return np.column_stack([node, table[:, 1].astype(int) - 1])
