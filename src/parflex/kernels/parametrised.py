"""Kernels that read the robot's parameters θ (P,) as one more input, `theta`."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from parflex.base.array import Array
from parflex.kernels.inputs import with_input
from parflex.kernels.kernel import Kernel, Vectors
from parflex.mechanics.designs import placed
from parflex.mechanics.mechanism import Mechanism
from parflex.robot.parameters import Parameters

Build = Callable[..., Kernel]
THETA = "theta"


@dataclass(frozen=True)
class Parametrised(Kernel):
    """A kernel one of whose inputs is θ (…, P), own those of the robot itself."""

    own: Array = field(default_factory=lambda: np.zeros(0))

    def probe(self, count: int) -> Vectors:
        """Inputs as of any kernel, with parameters near the robot's own."""
        more = np.random.default_rng(1).uniform(0.0, 1e-2, (count, len(self.own)))
        theta = self.own + more * np.where(self.own == 0, 0.1, self.own)
        return super().probe(count) | {THETA: theta}


def parametrised(parameters: Parameters, mechanism: Mechanism, build: Build, *chosen: object) -> Kernel:
    """The kernel that `build` makes of the mechanism and its other arguments, with θ as an input."""

    def at(theta: Array) -> Callable[..., Vectors]:
        return build(placed(parameters, mechanism, theta), *chosen).function

    return for_any(parameters, build(mechanism, *chosen), at)


def for_any(parameters: Parameters, plain: Kernel, at: Callable[[Array], Callable[..., Vectors]]) -> Kernel:
    """The kernel whose function for θ (P,) is `at(θ)`, otherwise like a plain one."""

    def each(theta: Array) -> Callable[..., Vectors]:
        """The function for θ (…, P), of which the mechanism has one at a time."""

        def function(**given: Array) -> Vectors:
            if len(theta) == 1:
                return at(theta[0])(**given)
            designs, which = np.unique(theta, axis=0, return_inverse=True)
            found = {name: np.empty((len(theta), n)) for name, n in plain.outputs.items()}
            for i, design in enumerate(designs):
                rows = which == i
                for name, part in at(design)(**{key: a[rows] for key, a in given.items()}).items():
                    found[name][rows] = part
            return found

        return function

    wider = with_input(plain, THETA, parameters.size, each, parameters.names)
    return Parametrised(**vars(wider), own=parameters.own)
