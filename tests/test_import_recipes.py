"""The recipes of docs/importing.md, run on files as the programs write them."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import sparse

import parflex as pf
from imports import small_solid

PAGE = (Path(__file__).parent.parent / "docs" / "importing.md").read_text(encoding="utf-8")


def recipe(heading: str) -> str:
    """The Python of a section."""
    section = PAGE.split(f"## {heading}\n")[1].split("\n## ")[0]
    return "\n".join(re.findall(r"```python\n(.*?)```", section, flags=re.DOTALL))


@pytest.fixture
def body(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return small_solid()[0]


def numbers(body) -> np.ndarray:
    """The programs' node numbers: not from 1, nor in the matrices' order."""
    return 100 + np.random.default_rng(3).permutation(len(body.nodes))


def same(found, body, ids) -> None:
    """The matrices of the body with its nodes in ascending order of ids."""
    order = np.argsort(ids)
    rows = (3 * order[:, None] + np.arange(3)).ravel()
    assert np.allclose(found.nodes, body.nodes[order], rtol=0, atol=1e-14)
    for name in ("stiffness", "mass"):
        expected = getattr(body, name).tocsr()[rows][:, rows]
        assert abs(getattr(found, name) - expected).max() <= 1e-12 * abs(expected).max()


@pytest.mark.parametrize("square", [False, True])
def test_abaqus(body, square, capsys):
    """Matrices in the format of *MATRIX INPUT, of one triangle or of both."""
    ids = numbers(body)
    for name, matrix in (("job_STIF2", body.stiffness), ("job_MASS2", body.mass)):
        X = sparse.coo_array(matrix if square else sparse.tril(matrix))
        lines = [
            f"{ids[i // 3]},{i % 3 + 1}, {ids[j // 3]},{j % 3 + 1}, {value:.15e}"
            for i, j, value in zip(X.row, X.col, X.data, strict=True)
        ]
        Path(f"{name}.mtx").write_text("\n".join(lines) + "\n")
    order = np.argsort(ids)
    rows = [f"{ids[k]}, {', '.join(f'{value:.15e}' for value in body.nodes[k])}" for k in order]
    Path("job.inp").write_text("\n".join(["*NODE", *rows, "999, 0., 0., 9.", "*END"]))
    scope = {"pf": pf}
    exec(recipe("Abaqus"), scope)
    same(scope["body"], body, ids)
    assert "73.07" in capsys.readouterr().out


def test_ansys(body, capsys):
    """The upper triangles of `load_km(sort=True)`, whose nodes ascend."""
    ids = numbers(body)
    order = np.argsort(ids)
    rows = (3 * order[:, None] + np.arange(3)).ravel()
    K, M = (sparse.triu(matrix.tocsr()[rows][:, rows]) for matrix in (body.stiffness, body.mass))
    dof = np.column_stack([np.repeat(ids[order], 3), np.tile([0, 1, 2], len(ids))])
    mesh = SimpleNamespace(nnum=ids[order], nodes=body.nodes[order])
    full = SimpleNamespace(load_km=lambda sort: (dof, K, M))
    scope = {"pf": pf, "full": full, "rst": SimpleNamespace(mesh=mesh)}
    exec(recipe("Ansys"), scope)
    same(scope["body"], body, ids)
    assert "73.07" in capsys.readouterr().out
