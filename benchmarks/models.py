"""Time of one direct and one inverse model, and what they consist of.

    python benchmarks/models.py

Each figure is the median of many calls, the variants alternating in one run: machines differ and are
noisy, so read the ratios. `flat` is `model.compiled()`, `call` the comfortable `model.direct`.
"""

import time
import warnings
from collections.abc import Callable

import numpy as np
from rich.console import Console
from rich.table import Table

import parflex as pf
from parflex import cartesian
from parflex.compiled import kernels
from parflex.compiled.vm import trace
from parflex.state import coordinates

ROUNDS, CALLS, BATCH = 30, 100, 1000
warnings.filterwarnings("ignore", message=".*cut a degenerate pair.*")


def alternate(variants: dict[str, tuple[Callable[[], object], int]]) -> dict[str, float]:
    """Median time of one call (µs) per variant, the variants taking turns; (call, calls a turn)."""
    times: dict[str, list[float]] = {name: [] for name in variants}
    for call, _ in variants.values():
        call()
    for _ in range(ROUNDS):
        for name, (call, repeat) in variants.items():
            start = time.perf_counter()
            for _ in range(repeat):
                call()
            times[name].append((time.perf_counter() - start) / repeat)
    return {name: 1e6 * float(np.median(found)) for name, found in times.items()}


def measure(modes: int) -> dict[str, float]:
    """All variants for the paper's robot with this number of modes."""
    robot = pf.robots.gough_stewart(modes)
    vm, reference = pf.Model(robot, "vm"), pf.Model(robot, "numpy")
    state, forces = reference.static(*robot.home_pose)
    x, u, c = vm.flat(state), forces.copy(), vm.compiled()
    out, target, back = np.zeros(6 + modes), np.zeros(6), np.zeros(6 + modes)
    many = pf.State(np.tile(state.position, (BATCH, 1)), state.rotation, elastic=state.elastic)
    variants = {
        "direct, vm, flat": (lambda: c.direct(x, u, out), CALLS),
        "inverse, vm, flat": (lambda: c.inverse(x, target, back), CALLS),
        "direct, vm, call": (lambda: vm.direct(state, u), 10),
        "direct, numpy, call": (lambda: reference.direct(state, u), 1),
        "direct, paper's Eqs. 44-49, numpy": (
            lambda: cartesian.direct(robot, coordinates(x, robot.layout), u),
            1,
        ),
    }
    found = alternate(variants)
    start = time.perf_counter()
    reference.direct(many, u)
    found["direct, numpy, per state of a batch"] = 1e6 * (time.perf_counter() - start) / BATCH
    start = time.perf_counter()
    graph = trace(kernels.direct(robot))
    found["trace of the direct model (ms)"] = 1e3 * (time.perf_counter() - start)
    found["scalar operations of the direct model"] = graph.n_instructions()
    return found


def main() -> None:
    """The table over N."""
    columns = {modes: measure(modes) for modes in (0, 10, 40)}
    table = Table("µs", *(f"N = {modes}" for modes in columns), title="The paper's robot")
    for name in columns[0]:
        table.add_row(name, *(f"{columns[modes][name]:.1f}" for modes in columns))
    Console().print(table)


if __name__ == "__main__":
    main()
