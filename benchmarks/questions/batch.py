"""How long does one state of many take?"""

import os
from functools import partial

import numpy as np

import parflex as pf
from benchmarks.report import Section, race
from benchmarks.rows import direct_rows
from benchmarks.timing import Time, alternate
from parflex.compiled.native.native import widest

STATES = 4096


def ask() -> Section:
    """The direct model of the paper's robot, per state."""
    section = Section(f"{STATES} states at once: per state", ("direct model", "µs", "quartiles", "ratio"))
    wide, threads = f"{widest()} per instruction", f"{os.cpu_count()} threads"
    for modes in (0, 10, 40):
        robot = pf.robots.gough_stewart(modes)
        many, one = direct_rows(robot, widest(), STATES), direct_rows(robot, 1, STATES)
        model = pf.Model(robot, "native")
        state = pf.State(np.tile(robot.home.position, (STATES, 1)), robot.home.rotation)
        forces = np.zeros((STATES, robot.n_forces))
        found = alternate(
            {
                f"N = {modes}: {wide}, one thread": many.one_thread(),
                f"N = {modes}: {wide}, {threads}": many.all_threads(),
                f"N = {modes}: one per instruction, one thread": one.one_thread(),
                f"N = {modes}: model.direct, {threads}, with its checks": partial(
                    model.direct, state, forces
                ),
            }
        )
        race(section, {name: Time(*(seconds / STATES for seconds in time)) for name, time in found.items()})
    return section
