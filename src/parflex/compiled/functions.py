"""The kernels of one mechanism, compiled when they are first asked for, and kept."""

from copy import copy
from dataclasses import replace
from functools import cached_property
from threading import Lock

from parflex.base.array import Array
from parflex.compiled.at import At
from parflex.compiled.backend import Backend, Function
from parflex.kernels.by_tips import by_tips
from parflex.kernels.kernel import Kernel
from parflex.kernels.parametrised import THETA, Build, parametrised
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.redundancy import with_rows
from parflex.robot.parameters import Parameters


class Functions:
    """The compiled functions of a mechanism at some values of its parameters; shared by threads."""

    def __init__(self, mechanism: Mechanism, backend: Backend, parameters: Parameters) -> None:
        self.mechanism, self.backend = mechanism, backend
        self.parameters, self.theta = parameters, parameters.own
        self._first = mechanism
        self._kept: dict[object, Function] = {}
        self._lock = Lock()

    def at(self, mechanism: Mechanism, theta: Array) -> "Functions":
        """The same compiled functions at other values θ (P,), which the mechanism has in its tables."""
        other = copy(self)
        other.mechanism, other.theta = mechanism, theta
        return other

    def __call__(self, build: Build, *chosen: object, theta: Array | None = None) -> Function:
        """The function of the kernel that `build` makes of the mechanism and of what else it takes.

        It reads flat float arrays; parameters are at θ (…, P), by default those of this object.
        """
        key = (build, *chosen)
        with self._lock:
            if key not in self._kept:
                self._kept[key] = self.backend.compile(self._kernel(build, *chosen))
            found = self._kept[key]
        if not self.parameters.items:
            return found
        return At(found, theta=self.theta if theta is None else theta)

    def _kernel(self, build: Build, *chosen: object) -> Kernel:
        """The kernel, which takes θ where there are parameters."""
        kernel = build(self._solvable, *chosen)
        if not self.parameters.items or THETA in kernel.inputs:
            return kernel
        return parametrised(self.parameters, self._solvable, build, *chosen)

    @property
    def solvable(self) -> Mechanism:
        """The mechanism at these values, with the rows of its closure that the models solve."""
        first = self._solvable
        return replace(self.mechanism, rows=first.rows, rows_unbent=first.rows_unbent)

    @cached_property
    def _solvable(self) -> Mechanism:
        """The first mechanism, with the rows of its closure that the models solve."""
        return by_tips(with_rows(self._first))
