"""What does the first call cost, in time and memory? Every answer is that of a fresh interpreter."""

import json
import os
import subprocess
import sys
import tempfile

import numpy as np

from benchmarks import ROOT
from benchmarks.report import Section
from parflex.base.cache import VARIABLE

RUNS = 5

MEASURE = """
import json, time
def memory():  # its peak, MiB; ru_maxrss would be inherited from the parent
    try:
        lines = open("/proc/self/status").read().splitlines()
        return next(float(line.split()[1]) for line in lines if line.startswith("VmHWM")) / 1024
    except OSError:
        return float("nan")
start = time.perf_counter()
"""

IMPORT = """
import {module}
print(json.dumps([time.perf_counter() - start, float("nan"), memory()]))
"""

FIRST = """
import warnings
warnings.simplefilter("ignore")
import parflex as pf
robot = pf.robots.gough_stewart({modes})
home, forces = robot.home, [0.0] * robot.n_forces
ready = time.perf_counter()
pf.Model(robot, "{backend}").direct(home, forces)
end = time.perf_counter()
print(json.dumps([end - start, end - ready, memory()]))
"""


def ask() -> Section:
    """Imports, then the first direct model: compiled, from the cache, interpreted."""
    head = ("what", "s, from the first line on", "s, of the first model", "peak memory, MiB")
    section = Section("Cold start: medians of fresh interpreters", head)
    for module in ("numpy", "parflex", "pinocchio", "mujoco", "exudyn"):
        section.add(f"import {module}", *measured(IMPORT.format(module=module), None))
    for modes in (0, 10, 40):
        for backend in ("native", "vm", "numpy"):
            script = FIRST.format(modes=modes, backend=backend)
            section.add(f"N = {modes}: {backend}, no cache", *measured(script, ""))
        with tempfile.TemporaryDirectory() as folder:
            script = FIRST.format(modes=modes, backend="native")
            once(script, folder)
            section.add(f"N = {modes}: native, from the cache", *measured(script, folder))
    section.notes = [
        "up to the first model: imports, the plate's modes by finite elements, the robot",
        "parflex imports what it needs when it needs it",
    ]
    return section


def measured(script: str, cache: str | None) -> list[str]:
    """Medians of seconds and MiB."""
    medians = np.median([once(script, cache) for _ in range(RUNS)], axis=0)
    return ["–" if np.isnan(value) else f"{value:.3g}" for value in medians]


def once(script: str, cache: str | None) -> list[float]:
    """What a script prints."""
    environment = os.environ | ({} if cache is None else {VARIABLE: cache})
    given = [sys.executable, "-c", MEASURE + script]
    found = subprocess.run(given, env=environment, cwd=ROOT, check=True, capture_output=True, text=True)
    return json.loads(found.stdout.splitlines()[-1])
