"""How long does one static equilibrium take, alone and of many?"""

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.spatial.transform import Rotation

import parflex as pf
from benchmarks import flexible_legs
from benchmarks.report import Section, micro
from benchmarks.robots import GRAVITY
from benchmarks.timing import alternate
from parflex.analysis.equilibrium import at_rest
from parflex.model.core import core_of

MODES, AGREED = 9, 1e-12  # m and rad
GENERAL = 5  # poses that the general algorithm is timed and compared on
ROUNDS = 5
ROBOTS: dict[str, tuple[Callable[[], pf.Robot], int, float]] = {  # how many poses, within m and rad of home
    "the paper's robot": (partial(pf.robots.gough_stewart, MODES), 2048, 0.03),
    "nano-hexapod": (partial(pf.robots.nano_hexapod, MODES), 1024, 3e-5),
    "Delta": (partial(pf.robots.delta, MODES), 64, 0.03),
    "its legs bend, too": (lambda: replace(flexible_legs.robot(), gravity=GRAVITY), 128, 0.03),
}


def ask() -> Section:
    """Machine code, after it was compiled; seconds are those of one processor, all threads together."""
    head = ("robot", "N", "poses", "one, in NumPy: ms", "one: ms", "of many: µs", "a second")
    section = Section("One static equilibrium", head)
    for name, (build, count, reach) in ROBOTS.items():
        model = pf.Model(build(), "native")
        poses = about_home(model.robot, count, reach)
        start = time.perf_counter()
        model.equilibrium(*poses)
        waited = time.perf_counter() - start
        general = compare(name, model, poses)
        found = alternate(
            {
                "one": partial(model.equilibrium, poses[0][0], poses[1][0]),
                "many": partial(model.equilibrium, *poses),
            },
            ROUNDS,
            time.process_time,
        )
        each = found["many"].median / count
        modes = model.robot.platform.modes
        alone = (f"{1e3 * seconds:.3g}" for seconds in (general, found["one"].median))
        section.add(name, modes, count, *alone, micro(each), f"{1 / each:.0f}")
        section.notes.append(f"{name}: the first batch took {waited:.1f} s with what is compiled for it")
    section.notes.append("in NumPy: the general algorithm, to which the others agree to 1e-12 m")
    return section


def about_home(robot: pf.Robot, count: int, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Places and attitudes about home."""
    rng = np.random.default_rng(0)
    turn = Rotation.from_rotvec(rng.uniform(-2 * reach, 2 * reach, (count, 3))).as_matrix()
    return robot.home.position + rng.uniform(-reach, reach, (count, 3)), turn @ robot.home.rotation


def compare(name: str, model: pf.Model, poses: tuple[np.ndarray, np.ndarray]) -> float:
    """Seconds per pose of the general algorithm; raises where its answers are not those of the model."""
    core, seconds = core_of(model), []
    state, _ = model.equilibrium(*(part[:GENERAL] for part in poses))
    for i in range(GENERAL):
        start = time.process_time()
        x, _ = at_rest(core.functions, "pose", pf.State(poses[0][i], poses[1][i]))
        seconds.append(time.process_time() - start)
        alone = core.state(x)
        missed = max(
            float(np.max(np.abs(alone.position - state.position[i]))),
            float(np.max(np.abs(alone.elastic - state.elastic[i]), initial=0.0)),
        )
        if missed > AGREED:
            raise SystemExit(f"{name}: equilibria differ by {missed:.1e}; nothing is timed")
    return float(np.median(seconds))
