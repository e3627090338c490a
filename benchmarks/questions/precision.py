"""Work and precision: which method, and at what tolerance?

One second released from q_e = 0; the errors are those of `simulation.py`, against the tightest run.
"""

import matplotlib.pyplot as plt

import parflex as pf
from benchmarks import robots
from benchmarks.questions.simulation import TIGHTEST, coordinates, error, flown
from benchmarks.report import RESULTS, Section
from benchmarks.timing import alternate

TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
ROUNDS = 5
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
            points = [measured(models[backend], sample, reference, method, rtol) for rtol in TOLERANCES]
            for rtol, (missed, seconds) in zip(TOLERANCES, points, strict=True):
                section.add(modes, way, f"{rtol:.0e}", f"{missed:.1e}", f"{1e3 * seconds:.3g}")
            axis.loglog(*zip(*points, strict=True), "o-", label=way)
        axis.set(title=f"N = {modes}", xlabel="error / 1")
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("time / s")
    axes[0].legend()
    path = RESULTS / "work-precision.png"
    RESULTS.mkdir(exist_ok=True)
    figure.savefig(path, dpi=150)
    section.notes = [
        f"diagram: {path.name}",
        "without the labelled dataset, which is put together at the first look",
    ]
    return section


def measured(model: pf.Model, sample, reference, method: str, rtol: float) -> tuple[float, float]:
    """Error and seconds."""

    run = lambda: flown(model, sample, rtol, method)  # noqa: E731
    missed = error(coordinates(run()), reference)
    return missed, alternate({"run": run}, ROUNDS)["run"].median
