"""What the tests share: robots, models, random states, and the measure of agreement."""

import signal
import sys
from collections.abc import Callable, Iterator
from functools import lru_cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import parflex as pf
from parflex.app import cli, paper
from parflex.fe.plate import plate

pytest_plugins = ["verification"]

np.set_printoptions(threshold=20, edgeitems=2)  # what an assertion is told of, passed ones too

MODES = (0, 1, 10, 40)  # rigid, one, the paper's, many


def relative(found, expected) -> float:
    """max |Δ| / max(1, max |x|), the measure of every accuracy figure."""
    found, expected = np.asarray(found), np.asarray(expected)
    assert found.shape == expected.shape
    largest = np.max(np.abs(expected), initial=1.0)
    return float(np.max(np.abs(found - expected), initial=0.0) / largest)


def random_states(robot: pf.Robot, count: int, seed: int) -> pf.State:
    """States within ±0.1 m and ±0.1 rad of home, moving and bent, as a batch."""
    rng = np.random.default_rng(seed)
    N = robot.platform.modes
    omega = np.sqrt(robot.platform.stiffness)
    slow = omega[:1] / omega
    return pf.State(
        robot.home.position + rng.uniform(-0.1, 0.1, (count, 3)),
        Rotation.from_rotvec(rng.uniform(-0.1, 0.1, (count, 3))).as_matrix(),
        rng.normal(0, 0.5, (count, 6)),
        0.01 * slow**2 * rng.normal(size=(count, N)),
        0.1 * slow * rng.normal(size=(count, N)),
    )


def random_forces(model: pf.Model, count: int, seed: int) -> np.ndarray:
    """Static forces ± 300 N."""
    _, static = model.static(*model.robot.home_pose)
    return static + np.random.default_rng(seed).uniform(-300, 300, (count, model.robot.n_forces))


def actuated(robot: pf.Robot, q) -> np.ndarray:
    """(…, m) positions of the actuated joints, of joints (…, n_i) by leg."""
    driven = [bool(joint.mu) for leg in robot.legs for joint in leg.joints]
    return np.concatenate(q, axis=-1)[..., driven]


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
