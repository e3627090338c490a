"""Work and precision: which method, and at what tolerance?

One second released from q_e = 0; the errors are those of `simulation.py`, against the tightest run.
"""

import time
from functools import partial

import matplotlib.pyplot as plt

import parflex as pf
from benchmarks import robots
from benchmarks.questions.simulation import TIGHTEST, coordinates, error, flown
from benchmarks.report import RESULTS, Section
from benchmarks.timing import alternate

TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
ROUNDS = 5
PATIENCE = 1.0  # s; where a run takes longer, a way is not asked for more precision
WAYS = {
    "DOP853, machine code": ("DOP853", "native"),
    "RK45, machine code": ("RK45", "native"),
    "Radau, machine code": ("Radau", "native"),
    "DOP853, virtual machine": ("DOP853", "vm"),
}


def ask() -> Section:
    """A table, and a diagram beside it."""
    section = Section(
        "Work and precision: one second released from q_e = 0", ("N", "way", "rtol", "error", "ms")
    )
    figure, axes = plt.subplots(1, 2, figsize=(10, 4), sharey=True, layout="constrained")
    for axis, modes in zip(axes, (11, 40), strict=True):
        sample = robots.at_rest(modes)
        models = {backend: pf.Model(sample.robot, backend) for backend in ("native", "vm")}
        reference = coordinates(flown(models["native"], sample, TIGHTEST))
        for way, (method, backend) in WAYS.items():
            points = line(models[backend], sample, reference, method)
            for rtol, (missed, seconds) in zip(TOLERANCES, points, strict=False):
                section.add(modes, way, f"{rtol:.0e}", f"{missed:.1e}", f"{1e3 * seconds:.3g}")
            axis.loglog(*zip(*points, strict=True), "o-", label=way)
        axis.set(title=f"N = {modes}", xlabel="largest error over the largest change")
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("time / s")
    axes[0].legend()
    path = RESULTS / "work-precision.png"
    RESULTS.mkdir(exist_ok=True)
    figure.savefig(path, dpi=150)
    section.notes = [
        f"diagram: {path.name}",
        "without the labelled dataset, which is put together at the first look",
        f"a line ends where a run has taken more than {PATIENCE:g} s",
    ]
    return section


def line(model: pf.Model, sample, reference, method: str) -> list[tuple[float, float]]:
    """Error and seconds at one tolerance after the other, as far as patience lasts."""
    points: list[tuple[float, float]] = []
    for rtol in TOLERANCES:
        start = time.perf_counter()
        missed = error(coordinates(flown(model, sample, rtol, method)), reference)
        seconds = time.perf_counter() - start
        if seconds > PATIENCE:
            return [*points, (missed, seconds)]
        run = partial(flown, model, sample, rtol, method)
        points.append((missed, alternate({"run": run}, ROUNDS)["run"].median))
    return points
