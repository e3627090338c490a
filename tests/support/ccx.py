"""CalculiX in the tests: decks of solids on the paper's plate, and the program's own answers to them."""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from paper_robot import PLATE, corners
from parflex.fe.body.elements import TETRA_EDGES
from parflex.fe.plate.mesh import fan_mesh

CCX = shutil.which("ccx")
needs_ccx = pytest.mark.skipif(CCX is None, reason="CalculiX (ccx) is not installed")


def plate_mesh(refine: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (K, 3) m and tetrahedra (E, 10) of the paper's plate, one layer, mid-plane at z = 0."""
    flat = fan_mesh(corners(), refine)
    points, triangles, h = flat.p.T, flat.t.T, PLATE["thickness"]
    count = len(points)
    nodes = np.vstack([np.column_stack([points, np.full(count, z)]) for z in (-h / 2, h / 2)])
    a, b, c = np.sort(triangles, axis=1).T
    A, B, C = a + count, b + count, c + count
    tets = np.concatenate([np.stack(t, axis=1) for t in ((a, b, c, C), (a, b, B, C), (a, A, B, C))])
    first, *others = np.moveaxis(nodes[tets], 1, 0)
    volume = np.linalg.det(np.stack([other - first for other in others], axis=1))
    tets[volume < 0] = tets[volume < 0][:, [1, 0, 2, 3]]
    edges = np.sort(np.stack([tets[:, list(edge)] for edge in TETRA_EDGES], axis=1), axis=2)
    unique, middle = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
    everywhere = np.vstack([nodes, nodes[unique].mean(axis=1)])
    return everywhere, np.hstack([tets, len(nodes) + middle.reshape(len(tets), 6)])


def deck(nodes: np.ndarray, elements: np.ndarray, step: str, kind: str = "C3D10", extra: str = "") -> str:
    """An input deck of the paper's material; elements in Abaqus' order, numbered from 0."""
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{k + 1}," + ",".join(f"{value:.12e}" for value in xyz) for k, xyz in enumerate(nodes)]
    lines.append(f"*ELEMENT, TYPE={kind}, ELSET=BODY")
    for k, row in enumerate(elements):
        numbers = [str(k + 1), *(str(node + 1) for node in row)]
        lines.append(",".join(numbers[:11]) + ("," if len(numbers) > 11 else ""))
        lines += [",".join(numbers[11:])] * (len(numbers) > 11)
    lines += ["*MATERIAL, NAME=Plate", "*ELASTIC", f"{PLATE['young']:g},{PLATE['poisson']}"]
    lines += ["*DENSITY", f"{PLATE['density']:g}", "*SOLID SECTION, ELSET=BODY, MATERIAL=Plate", extra]
    return "\n".join([*lines, "*STEP", step, "*NODE FILE", "U", "*END STEP", ""])


def run(folder: Path, name: str, text: str) -> Path:
    """Solve a deck; the path of its input file."""
    (folder / f"{name}.inp").write_text(text)
    assert CCX is not None
    done = subprocess.run([CCX, name], cwd=folder, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout[-2000:]
    return folder / f"{name}.inp"
