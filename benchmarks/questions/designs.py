"""How long does a sweep over designs take, compiled once, beside a model for every design?"""

import os
import tempfile
import time
from collections.abc import Callable

import numpy as np

import parflex as pf
from benchmarks.report import Section
from parflex.base.cache import VARIABLE

DESIGNS = 10_000
ALONE = 3  # designs that are given models of their own
NODE = 0


def ask() -> Section:
    """Payloads on the paper's plate, in one pose, from an empty cache."""
    head = ("direct model, N = 10, a payload on a node", "s", f"s for {DESIGNS} designs")
    section = Section("Designs", head)
    robot = pf.robots.gough_stewart(10)
    home, forces, masses = robot.home, np.zeros(robot.n_forces), np.linspace(1.0, 50.0, DESIGNS)
    name = f"platform.payload[{NODE}]"
    kept = os.environ.get(VARIABLE)
    with tempfile.TemporaryDirectory() as folder:
        os.environ[VARIABLE] = folder
        model = pf.Model(robot, "native", parameters=[name])

        def sweep() -> None:
            model.direct(home, forces, parameters={name: masses})

        def alone() -> None:
            for mass in masses[:: DESIGNS // ALONE][:ALONE]:
                platform = robot.platform.with_payload(NODE, mass)
                pf.Model(pf.Robot(robot.legs, platform, home_pose=robot.home_pose), "native").direct(
                    home, forces
                )

        first, again, own = seconds(sweep), min(seconds(sweep) for _ in range(5)), seconds(alone) / ALONE
    if kept is None:
        del os.environ[VARIABLE]
    else:
        os.environ[VARIABLE] = kept
    section.add("parameters, the first call: traced and compiled", f"{first:.3g}", f"{first:.3g}")
    section.add("parameters, from then on", f"{again:.3g}", f"{again:.3g}")
    section.add("one design, a model of its own", f"{own:.3g}", f"{own * DESIGNS:.3g} (from {ALONE})")
    return section


def seconds(call: Callable[[], None]) -> float:
    """That a call takes."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start
