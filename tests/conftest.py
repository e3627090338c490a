"""What the tests share: models and runs that are made once, the command, Ctrl-C."""

import signal
import sys
from collections.abc import Callable, Iterator
from functools import lru_cache

import numpy as np
import pytest

import parflex as pf
from parflex.app import cli, paper
from parflex.fe.plate import plate

pytest_plugins = ["verification"]

np.set_printoptions(threshold=20, edgeitems=2)  # what an assertion is told of, passed ones too


@pytest.fixture(scope="session", autouse=True)
def elements() -> Iterator[None]:
    """The elements of a plate, most of the work at its modes, are made once for all robots that have it."""
    make = plate.argyris

    @lru_cache(maxsize=16)
    def made(corners: tuple, refine: int):
        return make(np.array(corners), refine)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plate, "argyris", lambda corners, refine: made(tuple(map(tuple, corners)), refine))
        yield


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
