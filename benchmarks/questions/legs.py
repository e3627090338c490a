"""How long do lengths, rates and accelerations of the legs take along a trajectory?"""

import os
from functools import partial

import numpy as np

import parflex as pf
from benchmarks.report import Section, race
from benchmarks.timing import Time, alternate

INSTANTS = 100_000
ROUNDS = 15
MOVE = (0.0, 0.0, 0.02)  # m


def ask() -> Section:
    """`pf.leg_motion`, per instant, with its checks; beside it the joints of one state."""
    title = f"Legs along a trajectory, {INSTANTS} instants, {os.cpu_count()} threads: per instant"
    section = Section(title, ("positions, rates and accelerations", "µs", "quartiles", "ratio"))
    entries = [entry for entry in pf.robots.ALL_ROBOTS if entry.output]
    models = {entry.name: pf.Model(entry.build(modes=0), "native") for entry in entries}
    calls = {}
    for name, model in models.items():
        home = model.robot.home
        way = pf.Trajectory.of(home, [pf.Hold(0.1), pf.MoveTo(home.position + MOVE, duration=0.05)])
        times = np.linspace(0.0, way.duration, INSTANTS)
        calls[name] = partial(pf.leg_motion, model, way, times)
    found = alternate(calls, ROUNDS)
    race(section, {name: Time(*(seconds / INSTANTS for seconds in time)) for name, time in found.items()})
    name, model = next(iter(models.items()))
    [one] = alternate({name: partial(model.joints, model.robot.home)}).values()
    section.notes.append(f"model.joints of one state, {name}: {1e6 * one.median:.3g} µs")
    return section
