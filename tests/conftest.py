"""What the tests share: models and runs that are made once, the command, Ctrl-C."""

import os

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # before NumPy: a test's matrices are small, its processes many

import signal
import sys
from collections.abc import Callable, Iterator

import numpy as np
import pytest

import parflex as pf
from parflex.app import cli, paper

pytest_plugins = ["verification"]

np.set_printoptions(threshold=20, edgeitems=2)  # what an assertion is told of, passed ones too


@pytest.fixture(scope="session")
def model_of() -> Callable[..., pf.Model]:
    """Models of the paper's robot, built once per session."""
    known: dict[tuple, pf.Model] = {}

    def get(modes: int, backend: str = "numpy", **options) -> pf.Model:
        key = (modes, backend, *sorted(options.items()))
        if key not in known:
            known[key] = pf.Model(pf.robots.gough_stewart(modes, **options), backend)
        return known[key]

    return get


@pytest.fixture(scope="session")
def flown() -> paper.PaperRun:
    """The paper's run at ten modes, from its static equilibrium."""
    return paper.run(10)


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Ctrl-C is heard, as it is not in what a shell runs in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def parflex(monkeypatch, capsys, tmp_path):
    """Runs the command in an empty folder; gives exit code, output and errors."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")

    def run(*words: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["parflex", *words])
        code = 0
        try:
            cli.run()
        except SystemExit as stop:
            code = int(stop.code or 0)
        out, err = capsys.readouterr()
        return code, out, err

    return run
