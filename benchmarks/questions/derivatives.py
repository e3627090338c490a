"""What does a Jacobian of the direct or inverse model cost, in models?"""

from collections.abc import Callable

import numpy as np

import parflex as pf
from benchmarks.report import Section, micro
from benchmarks.timing import alternate
from parflex.compiled.backend import Function
from parflex.compiled.native.loops import program
from parflex.kernels import jacobians
from parflex.kernels import models as kernels
from parflex.mechanics.output import FrameOutput
from parflex.model.core import core_of

MODES = (0, 10, 40)


def ask() -> Section:
    """All motions of the state, all forces and the load, beside one model, flat calls."""
    head = ("model", "N", "operations", "µs", "of its Jacobian", "µs", "ratio of operations", "ratio of time")
    section = Section("Derivatives: the Jacobian beside its model, one state", head)
    for modes in MODES:
        robot, out = pf.robots.gough_stewart(modes), FrameOutput()
        model = pf.Model(robot)
        for name, plain, derivative in (
            ("direct", (kernels.direct,), (jacobians.direct_jacobian, ())),
            ("inverse", (kernels.inverse, out), (jacobians.inverse_jacobian, out, ())),
        ):
            functions = [core_of(model).functions(build, *chosen) for build, *chosen in (plain, derivative)]
            counts = [program(function.kernel).operations for function in functions]
            times = alternate({"model": bound(functions[0]), "jacobian": bound(functions[1])})
            one, all_of_it = times["model"].median, times["jacobian"].median
            section.add(
                name, modes, counts[0], micro(one), counts[1], micro(all_of_it),
                f"{counts[1] / counts[0]:.1f}", f"{all_of_it / one:.1f}",
            )  # fmt: skip
    section.notes = ["by implicit differentiation: the contact system is solved for changes as for forces"]
    return section


def bound(function: Function) -> Callable[[], None]:
    """A call on arrays that stay."""
    inputs = {name: np.ascontiguousarray(a[0]) for name, a in function.kernel.probe(1).items()}
    return function.bind(inputs, {name: np.zeros(n) for name, n in function.kernel.outputs.items()})
