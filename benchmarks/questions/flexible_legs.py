"""How long does one direct model take where cylinders and rods bend, too?"""

import os
import time

import numpy as np

from benchmarks import flexible_legs
from benchmarks.flexible_legs import Bending
from benchmarks.report import Section, race
from benchmarks.rivals.exudyn_legs import ExudynLegs
from benchmarks.rivals.parflex_legs import ParflexLegs
from benchmarks.timing import alternate

AGREED = 1e-9
ROUNDS = 201


def ask() -> list[Section]:
    """In motion and at rest; what does not agree is not timed."""
    where = {"in motion": flexible_legs.moving(), "at rest": flexible_legs.at_rest()}
    return [agreement(where), times(where)]


def agreement(where: dict[str, Bending]) -> Section:
    """max |Δ| / max(1, max |x|) over all states, by parts, against parflex's readable reference, which the
    tests hold to an independent program; raises where one is not the same robot."""
    head = "state", "program and way", "platform", "its modes", "modes of the legs"
    section = Section("Legs that bend: agreement", head)
    for place, sample in where.items():
        rivals, states = (ParflexLegs(sample), ExudynLegs(sample)), range(len(sample.forces))
        found = {}
        for s in states:
            for rival in rivals:
                for way, task in rival.direct(s).items():
                    task.call()
                    found.setdefault((f"{rival.name}, {way}", rival.tolerance), []).append(task.answer())
        exudyn = rivals[1]
        found[f"{exudyn.name}, its differentiation at the limit", AGREED] = [exudyn.limit(s) for s in states]
        for (way, tolerance), answers in found.items():
            errors = parts(np.array(answers), sample)
            section.add(place, way, *(f"{e:.1e}" for e in errors), *["–"] * (3 - len(errors)))
            if max(errors) > tolerance:
                raise SystemExit(f"{way}, {place}: differs by {max(errors):.1e}; nothing is timed")
    section.notes = [f"Exudyn {ExudynLegs.remark}", "the limit: four halved steps, extrapolated to none"]
    return section


def parts(answers: np.ndarray, sample: Bending) -> list[float]:
    """The error of each part of the answers (S, ≤ n) that they have."""
    wanted, modes = sample.wanted, sample.body.modes
    errors = []
    for part in (slice(0, 6), slice(6, 6 + modes), slice(6 + modes, None)):
        if answers[:, part].size:
            missed = np.abs(answers[:, part] - wanted[:, part])
            errors.append(float(np.max(missed) / max(1.0, np.max(np.abs(wanted[:, part])))))
    return errors


def times(where: dict[str, Bending]) -> Section:
    """Flat calls in turn: what checks and allocates would empty the processor's caches before the others.

    Seconds are those of the processor, all being of one thread.
    """
    robot = flexible_legs.robot()
    modes = f"{sum(robot.legs[0].modes)} modes per leg, {robot.platform.modes} of the plate"
    title = f"Legs that bend: one direct model, {modes}"
    section = Section(title, ("direct model, program and way", "µs of one processor", "quartiles", "ratio"))
    for place, sample in where.items():
        calls = {
            f"{place}: {rival.name}, {way}": task.call
            for rival in (ParflexLegs(sample, ("native", "vm")), ExudynLegs(sample))
            for way, task in rival.direct(0).items()
            if not way.endswith("call")
        }
        race(section, alternate(calls, ROUNDS, time.thread_time))
        section.notes.append(f"{place}: load {os.getloadavg()[0]:.2f} on {os.cpu_count()} processors")
    return section
