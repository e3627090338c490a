"""A controller bound to a model and to the loads on its platform, for one simulation."""

from bisect import bisect_right
from collections.abc import Callable
from functools import cached_property, partial

import numpy as np

from parflex.analysis.health import check_legs
from parflex.base.array import Array
from parflex.compiled.backend import Trigger
from parflex.model.core import core_of
from parflex.model.model import Model
from parflex.simulation.laws.law import Inputs, Law, Outputs, Replay
from parflex.simulation.loads import Loads
from parflex.simulation.surroundings.at_times import at_times


class BoundLaw:
    """A law and the motion it causes, on flat vectors; for one thread."""

    def __init__(self, law: Law, model: Model, loads: Loads) -> None:
        core = core_of(model)
        self.law, self.loads, self.mechanism = law, loads, core.mechanism
        self.rows, self._starts = np.atleast_2d(law.rows), law.starts.tolist()
        self.function = core.functions(*loads.reading(law.kernel, *law.outputs, loads.places))
        self._derivative = partial(core.functions, *loads.reading(law.derivative, *law.outputs, loads.places))
        kernel = self.function.kernel
        self.imposed = {name: np.zeros(each.size) for name, each in loads.imposed.items()}
        own = {name: np.zeros(n) for name, n in kernel.inputs.items() if name not in self.imposed}
        self.inputs = Inputs(**own)
        self.results = Outputs(**{name: np.zeros(n) for name, n in kernel.outputs.items()})
        self.inputs.pushes[:] = loads.pushes
        self._run = self.function.bind(self._given, self.results._asdict())

    @property
    def known(self) -> bool:
        """True where the law's forces are known without calling anybody."""
        return True

    @property
    def alone(self) -> bool:
        """True where forces, loads and surroundings are known without calling anybody."""
        return self.known and self.loads.steady and not self.imposed

    @property
    def works(self) -> int:
        """The number of works that are integrated behind the state and the law's memory."""
        found: int = self.function.kernel.outputs["powers"]
        return found

    def row(self, t: float, x: Array) -> Array:
        """The numbers that the kernel reads of the law at a time and flat state."""
        found: Array = self.rows[self.stretch(t)[0]]
        return found

    def stretch(self, t: float) -> tuple[int, float]:
        """The row of the law that holds at a time, and until when; steps do not go beyond."""
        row = bisect_right(self._starts, t)
        return row, self._starts[row] if row < len(self._starts) else np.inf

    def rate(self, t: float, x: Array) -> tuple[Array, Array]:
        """ẋ and the powers, as `Outputs` has them, under the law's forces and the loads.

        Raises as `Model.direct` where a leg's inverse geometry fails.
        """
        self._read(t, x)
        self._run()
        check_legs(self.mechanism, self.results.health)
        return self.results.rate, self.results.powers

    def forces(self, t: float, x: Array) -> Array:
        """Γ (m,) at a time and flat state, with nothing in the law's memory."""
        self.rate(t, x)
        return self.results.forces.copy()

    @property
    def differentiable(self) -> bool:
        """True where its derivative is compiled: nobody is called, and the law remembers nothing."""
        return self.law.differentiable and self.known and self.loads.steady and self.law.memory == 0

    def jacobian(self, t: float, x: Array) -> Array:
        """∂ẋ/∂x (size, size): exact where the law is differentiable, else by differences."""
        if not self.differentiable:
            return differences(lambda x: self.rate(t, x)[0].copy(), x)
        run, found = self._slopes
        self._read(t, x)
        run()
        return found.reshape(len(x), len(x))

    def replay(self, t: Array, x: Array) -> Replay:
        """Forces and motion at times (T,) and flat states (T, size); not numbers where they fail."""
        rows, raised = at_times(self.row, t, x, self.rows.shape[1])
        load, raised_too = self.loads.at(t, x)
        imposed = {name: at_times(each.at, t, x, each.size) for name, each in self.loads.imposed.items()}
        raised = raised or raised_too or next((error for _, error in imposed.values() if error), None)
        moved = {name: rows for name, (rows, _) in imposed.items()}
        given = Inputs(x, t[:, None], rows, load, self.loads.pushes)._asdict()
        found = Outputs(**self.function.each(**given, **moved))
        load = load + self.loads.constant(x)
        return Replay(found.forces, found.rate, found.contact, load, moved, raised)

    @cached_property
    def _slopes(self) -> tuple[Trigger, Array]:
        """The compiled derivative, and where it leaves its answer."""
        function = self._derivative()
        found = np.zeros(function.kernel.outputs["slopes"])
        return function.bind(self._given, {"slopes": found}), found

    @property
    def _given(self) -> dict[str, Array]:
        """The kernel's inputs by name."""
        return {**self.inputs._asdict(), **self.imposed}

    def _read(self, t: float, x: Array) -> None:
        """Fill the kernel's inputs."""
        own = self.inputs
        own.row[:] = self.row(t, x)
        own.x[: len(x)], own.time[0], own.load[:] = x, t, self.loads(t, x)
        for name, vector in self.imposed.items():
            vector[:] = self.loads.imposed[name](t)


def differences(function: Callable[[Array], Array], x: Array) -> Array:
    """∂function/∂x by steps of 1.5e-8 ahead."""
    from scipy.optimize import approx_fprime

    found: Array = approx_fprime(x, function)
    return found
