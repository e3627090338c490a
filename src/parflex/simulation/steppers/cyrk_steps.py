"""An integrator that does not return to Python within a hundred steps: CyRK's methods on machine code."""

from collections.abc import Sequence

import numpy as np

from parflex.analysis.health import SINGULAR
from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.compiled.at import At
from parflex.compiled.backend import Function
from parflex.compiled.native.driver import right_hand_side, words_of
from parflex.compiled.native.native import NativeFunction, addresses
from parflex.simulation.laws.bound import BoundLaw
from parflex.simulation.laws.law import Inputs, Outputs
from parflex.simulation.steppers.cyrk import DONE, MORE, NUMBERS, available, solver
from parflex.simulation.steppers.stepper import Stepper, Stuck

CHUNK = 100  # steps between two returns to Python, where Ctrl-C, progress and singularities are looked at
OUTPUTS = 1000  # rows at most that are read out between two returns
MEMORY = 2000  # MB that a chunk may take
ROW = Inputs._fields.index("row")
RATE = Outputs._fields.index("rate")


class CyrkSteps(Stepper):
    """A law that needs nobody's advice, integrated a hundred steps at a time."""

    def __init__(
        self,
        law: BoundLaw,
        function: NativeFunction,
        more: Sequence[Array],
        method: str,
        t: float,
        y: Array,
        tolerances: dict[str, float],
    ) -> None:
        self.t, self.y, self.steps = t, y.copy(), 0
        self._law, self._method, self._stuck = law, NUMBERS[method], False
        self._inputs = [*law.inputs, *more]
        self._rtol, self._atol = (np.array([tolerances[name]]) for name in ("rtol", "atol"))
        self._longest = tolerances["max_step"]
        self._rows = np.ascontiguousarray(law.rows, dtype=float)
        self._refused = np.full(len(y), np.nan)
        self._pointers = addresses([*self._inputs, *law.results])
        self._block = words_of(
            run=function.address,
            pointers=self._pointers.ctypes.data,
            rates=self._pointers[len(self._inputs) + RATE :].ctypes.data,
            time=law.inputs.time.ctypes.data,
            health=law.results.health.ctypes.data,
            refused=self._refused.ctypes.data,
            margins=law.mechanism.health.margins.stop,
            size=law.inputs.x.size,
            total=len(y),
        )
        self._args = addresses([self._block])

    def advance(self, times: Array) -> Array:
        if self._stuck:
            raise Stuck
        row, until = self._law.stretch(self.t)
        self._pointers[ROW] = self._rows[row].ctypes.data
        inside = np.ascontiguousarray(times[times <= until][:OUTPUTS])
        end = until if len(inside) < min(len(times), OUTPUTS) else inside[-1]
        size, self._refused[:], api = len(self.y), np.nan, solver()
        found = api.solve(
            rhs=right_hand_side(SINGULAR)[1], args=self._args.ctypes.data, args_bytes=self._args.nbytes,
            start=self.t, end=end, y=self.y.ctypes.data, y_size=size,
            times=inside.ctypes.data, times_size=len(inside),
            rtol=self._rtol.ctypes.data, rtol_size=1, atol=self._atol.ctypes.data, atol_size=1,
            method=self._method, max_step=self._longest, max_steps=CHUNK, max_megabytes=MEMORY,
        )  # fmt: skip
        try:
            status, taken = api.status(found), api.steps_taken(found)
            rows = api.rows(found, size)[: len(inside)]
            if taken:
                self.t, self.y = api.t_now(found), api.y_now(found, size)
        finally:
            api.free(found)
        self.steps += taken
        self._stuck = status not in (DONE, MORE)  # said when it is asked to go on: these rows are good
        return rows

    @property
    def refused(self) -> InputError | None:
        if not np.isfinite(self._refused).all():
            return None
        try:
            self._law.rate(self.t, self._refused[: self._law.inputs.x.size])
        except InputError as error:
            return error
        return None

    def moved(self) -> None:
        return


def cyrk_steps(
    law: BoundLaw, method: str, t: float, y: Array, tolerances: dict[str, float]
) -> CyrkSteps | None:
    """The integrator for a law, where law, backend and machine allow it."""
    function: Function = law.function
    more: list[Array] = []
    if isinstance(function, At):
        more, function = list(function.given.values()), function.function
    if not law.alone or not isinstance(function, NativeFunction):
        return None
    if not available():
        return None
    return CyrkSteps(law, function, more, method, t, y, tolerances)
