"""How long does one simulated second take, at the same accuracy?

Errors are the largest of position, attitude and bend at the output times, each over its largest change in the
reference, parflex at its tightest. That Exudyn converges to it is the check of the reference.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

import parflex as pf
from benchmarks import robots
from benchmarks.report import Section
from benchmarks.rivals.exudyn import Exudyn
from benchmarks.timing import alternate
from parflex.app import paper
from sample import Sample

WANTED = 1e-6
TIMES = np.linspace(0.0, 1.0, 51)
ROUNDS = 3
TOLERANCES = 10.0 ** -np.arange(3.0, 12.0, 0.5)
TIGHTEST = 1e-13
SCHEMES = {"generalised α, ρ = 0.8, modified Newton": 0.8, "index 2 trapezoidal, modified Newton": None}
STEPS = 1000  # of the first try
MARGIN = 1.1


class Contender(NamedTuple):
    """A program with the setting that reaches the accuracy, and its run."""

    program: str
    setting: str
    error: float
    run: Callable[[], object]


def ask() -> list[Section]:
    """The same motion by all programs, and the paper's."""
    return [matched(), paper_flown()]


def paper_flown() -> Section:
    """The trajectory of Section 6 under computed torque, at the settings of `parflex paper`."""
    head = ("modes", "s of motion", "s", "times as quick as real time")
    section = Section("The paper's trajectory: inverse and direct model, integrated", head)
    for modes in (0, 10):
        model = pf.Model(pf.robots.gough_stewart(modes))
        way = paper.trajectory(model.robot)
        start = model.equilibrium(*model.robot.home_pose)[0]
        times = np.linspace(0.0, way.duration, round(way.duration / paper.SAMPLE_TIME) + 1)
        given = pf.ComputedTorque(model, way), start, times
        run = partial(pf.simulate, model, *given, rtol=paper.RTOL, atol=paper.ATOL)
        seconds = alternate({"run": run}, 11)["run"].median
        section.add(modes, f"{way.duration:.3g}", f"{seconds:.3g}", f"{way.duration / seconds:.3g}")
    return section


def matched() -> Section:
    """One row per start and program, with what it took to reach the accuracy."""
    head = ("start", "program", "setting", "error", "s", "ratio")
    section = Section(f"One second of motion at error {WANTED:g}, N = {robots.MODES}", head)
    released = robots.at_rest(robots.MODES)
    for name, sample in {
        "released from q_e = 0": released,
        "from equilibrium, forces × 1.01": pushed(released),
    }.items():
        model = pf.Model(sample.robot)
        reference = coordinates(flown(model, sample, TIGHTEST))
        others = [exudyn_at(sample, reference, rho, label) for label, rho in SCHEMES.items()]
        contenders = [parflex_at(model, sample, reference), *others]
        times = alternate({c.setting: c.run for c in contenders}, ROUNDS)
        first = times[contenders[0].setting].median
        for program, setting, missed, _ in contenders:
            seconds = times[setting].median
            section.add(name, program, setting, f"{missed:.1e}", f"{seconds:.3g}", f"{seconds / first:.3g}")
    section.notes = [
        "each over the largest change of position, attitude and bend, at 51 output times",
        "parflex's time includes its energy ledger, but not its labelled dataset, made at the first look",
    ]
    return section


def pushed(released: Sample) -> Sample:
    """From the bent equilibrium, under one per cent more force."""
    model = pf.Model(released.robot, "numpy")
    state, forces = model.equilibrium(*released.home_pose)
    still = np.zeros((1, 6)), np.zeros((1, released.body.modes))
    place = state.position[None], state.rotation[None]
    batch = pf.State(*place, still[0], state.elastic[None], still[1])
    q = [leg[None] for leg in model.joints(state).q]
    return replace(released, platform=batch, q=q, forces=1.01 * forces[None])


def flown(model: pf.Model, sample: Sample, rtol: float, method: str = "DOP853") -> pf.Result:
    """parflex's run."""
    given = sample.forces[0], sample.platform[0], TIMES
    return pf.simulate(model, *given, rtol=rtol, atol=1e-2 * rtol, method=method)


def coordinates(run: pf.Result) -> np.ndarray:
    """(T, 6 + N): position, attitude as a rotation vector, bend."""
    data = run.dataset
    turns = Rotation.from_matrix(data["rotation"].values).as_rotvec()
    return np.hstack([data["position"].values, turns, data["elastic"].values])


def error(found: np.ndarray, reference: np.ndarray) -> float:
    """The largest error of each quantity over its largest change, the worst of them."""
    missed, change = np.abs(found - reference), np.abs(reference - reference[0])
    parts = [slice(0, 3), slice(3, 6), slice(6, None)]
    return max(float(np.max(missed[:, p]) / np.max(change[:, p])) for p in parts)


def parflex_at(model: pf.Model, sample: Sample, reference: np.ndarray) -> Contender:
    """At the loosest tolerance that reaches the accuracy."""
    for rtol in TOLERANCES:
        missed = error(coordinates(flown(model, sample, rtol)), reference)
        if missed <= WANTED:
            break
    return Contender("parflex", f"rtol = {rtol:.1e}", missed, lambda: flown(model, sample, rtol))


def exudyn_at(sample: Sample, reference: np.ndarray, rho: float | None, label: str) -> Contender:
    """With as few steps as reach the accuracy: both schemes are of second order, which tells how many."""
    rival, steps, outputs = Exudyn(sample), STEPS, len(TIMES) - 1
    while True:
        missed = error(rival.simulate(TIMES, steps, rho), reference)
        if missed <= WANTED:
            break
        steps = outputs * int(np.ceil(MARGIN * steps * np.sqrt(missed / WANTED) / outputs))
    run = lambda: rival.simulate(TIMES, steps, rho)  # noqa: E731
    return Contender("Exudyn", f"{label}, {steps} steps", missed, run)
