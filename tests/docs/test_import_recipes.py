"""The recipes of docs/importing.md, run on files as the programs write them."""

import re
from pathlib import Path
from types import SimpleNamespace

import given
import numpy as np
import pytest
from scipy import sparse

import parflex as pf
from places import DOCS

PAGE = (DOCS / "importing.md").read_text(encoding="utf-8")


def recipe(heading: str, language: str = "python") -> str:
    """The code of a section."""
    section = PAGE.split(f"## {heading}\n")[1].split("\n## ")[0]
    return "\n".join(re.findall(rf"```{language}\n(.*?)```", section, flags=re.DOTALL))


@pytest.fixture
def body(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return given.small_plate()


def same(found, body) -> None:
    """The matrices of the body with its nodes in ascending order of their numbers."""
    order = np.argsort(given.numbers(body))
    rows = (3 * order[:, None] + np.arange(3)).ravel()
    assert np.allclose(found.nodes, body.nodes[order], rtol=0, atol=1e-14)
    for name in ("stiffness", "mass"):
        expected = getattr(body, name).tocsr()[rows][:, rows]
        assert abs(getattr(found, name) - expected).max() <= 1e-12 * abs(expected).max()


@pytest.mark.parametrize("square", [False, True])
def test_abaqus(body, square, capsys):
    """Matrices in the format of *MATRIX INPUT, of one triangle or of both."""
    given.abaqus(Path(), square)
    scope = {"pf": pf}
    exec(recipe("Abaqus"), scope)
    same(scope["body"], body)
    assert "73.07" in capsys.readouterr().out


def test_ansys(body, capsys):
    """Both halves: a reader with `load_km(sort=True)` writes the files, which parflex reads."""
    given.ansys(Path())
    K, M = (sparse.load_npz(f"{name}_upper.npz") for name in ("K", "M"))
    with np.load("ansys.npz") as table:
        dof, nnum, nodes = table["dof"], table["nnum"], table["nodes"]
    for path in Path().iterdir():
        path.unlink()
    answers = {
        "file.full": SimpleNamespace(load_km=lambda sort: (dof, K, M)),
        "file.rst": SimpleNamespace(mesh=SimpleNamespace(nnum=nnum, nodes=nodes)),
    }
    scope = {"pf": pf, "np": np, "sparse": sparse, "reader": SimpleNamespace(read_binary=answers.get)}
    exec(recipe("Ansys", "text"), scope)
    exec(recipe("Ansys"), scope)
    same(scope["body"], body)
    assert "73.07" in capsys.readouterr().out
