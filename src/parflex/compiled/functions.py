"""The kernels of one mechanism, compiled when they are first asked for, and kept."""

from copy import copy
from dataclasses import replace
from functools import cached_property
from threading import Lock

from parflex.base.array import Array, join
from parflex.compiled.at import At
from parflex.compiled.backend import Backend, Function
from parflex.kernels.by_tips import by_tips
from parflex.kernels.inputs import plainly
from parflex.kernels.kernel import Kernel
from parflex.kernels.moved_base import BASE, moved_base
from parflex.kernels.parametrised import THETA, Build, parametrised
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.redundancy import with_rows
from parflex.robot.parameters import Parameters

GRAVITY = "gravity"


class Functions:
    """The compiled functions of a mechanism at some values of its parameters; shared by threads."""

    def __init__(self, mechanism: Mechanism, backend: Backend, parameters: Parameters) -> None:
        self.mechanism, self.backend = mechanism, backend
        self.parameters, self.theta = parameters, parameters.own
        self.base: Array | None = None  # (…, 19), the motion of the base, where it is on one that moves
        self._first = mechanism
        self._kept: dict[object, Function] = {}
        self._weighed: list[Functions] = []  # those whose parameters have gravity, once they are asked for
        self._lock = Lock()

    def at(self, mechanism: Mechanism, theta: Array) -> "Functions":
        """The same compiled functions at other values θ (P,), which the mechanism has in its tables."""
        other = copy(self)
        other.mechanism, other.theta = mechanism, theta
        return other

    def on(self, mechanism: Mechanism, base: Array) -> "Functions":
        """The same functions on a base that moves so (…, 19), as that of the mechanism does."""
        _ = self._solvable  # found once, for all copies
        other = copy(self)
        other.mechanism, other.base = mechanism, base
        return other

    def weighed(self, mechanism: Mechanism) -> "Functions":
        """Functions at the gravity of a mechanism, which is one of their parameters."""
        names, gravity = self.parameters.names, {GRAVITY: mechanism.gravity}
        if GRAVITY in names:
            return self.at(mechanism, self.parameters.vector(gravity, self.theta))
        with self._lock:
            if not self._weighed:
                every = Parameters(self.parameters.first, (*names, GRAVITY))
                self._weighed.append(Functions(self._first, self.backend, every))
        return self._weighed[0].at(mechanism, join([self.theta, mechanism.gravity]))

    def ready(self, build: Build, *chosen: object) -> bool:
        """True where a function is there without waiting: called before, or kept by the backend."""
        return (build, *chosen) in self._kept or self.backend.keeps(self._kernel(build, *chosen))

    def __call__(self, build: Build, *chosen: object, theta: Array | None = None) -> Function:
        """The function of the kernel that `build` makes of the mechanism and of what else it takes.

        It reads flat float arrays; parameters are at θ (…, P), by default those of this object.
        """
        if self.base is not None and moved_base not in chosen:
            build, chosen = moved_base, (build, *chosen)
        key = (build, *chosen)
        with self._lock:
            if key not in self._kept:
                self._kept[key] = self.backend.compile(self._kernel(build, *chosen))
            found = self._kept[key]
        given = {} if self.base is None else {BASE: self.base}
        if self.parameters.items:
            given[THETA] = self.theta if theta is None else theta
        return At(found, **given) if given else found

    @property
    def way(self) -> Build:
        """The way in which kernels are built: plainly, or with the motion of the base as an input."""
        return plainly if self.base is None else moved_base

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
        rows = {name: getattr(first, name) for name in ("rows", "rows_stiff", "rows_unbent")}
        return replace(self.mechanism, **rows)

    @cached_property
    def _solvable(self) -> Mechanism:
        """The first mechanism, with the rows of its closure that the models solve."""
        return by_tips(with_rows(self._first))
