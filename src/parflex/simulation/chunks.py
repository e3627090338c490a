"""An integrator that does not return to Python within a hundred steps: CyRK's methods on machine code."""

import ctypes
from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import llvmlite.binding as llvm
import numpy as np

from parflex.analysis.singularities import SINGULAR
from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.compiled.at import At
from parflex.compiled.backend import Function
from parflex.compiled.native.native import NativeFunction, addresses, engine, machine
from parflex.mechanics.legs.base import MARGINS
from parflex.simulation.stepping import Stepper, Stuck

if TYPE_CHECKING:
    from parflex.simulation.laws.bound import BoundLaw

CHUNK = 100  # steps between two returns to Python: where Ctrl-C, progress and singularities are looked at
OUTPUTS = 1000  # rows at most that are read out between two returns
DONE, MORE = 1, -52  # CyRK's status: at the end, and after as many steps as were allowed
NUMBERS = {"RK45": 4, "DOP853": 5, "Radau": 8}  # of its methods
MEMORY = 2000  # MB that a chunk may take

# void rhs(dy, t, y, args, _): the flat state and the works follow from the kernel whose arrays, and what it
# reads of the law, are in a block of words; a state that some leg does not reach gives numbers that are none
DRIVER = f"""
define void @rhs(ptr %dy, double %t, ptr %y, ptr %args, ptr %unused) {{
entry:
  %block = load ptr, ptr %args
  %run = load ptr, ptr %block
  %w1 = getelementptr i64, ptr %block, i64 1
  %pointers = load ptr, ptr %w1
  %w2 = getelementptr i64, ptr %block, i64 2
  %size = load i64, ptr %w2
  %w3 = getelementptr i64, ptr %block, i64 3
  %time = load ptr, ptr %w3
  %w4 = getelementptr i64, ptr %block, i64 4
  %margins = load i64, ptr %w4
  %w5 = getelementptr i64, ptr %block, i64 5
  %health = load ptr, ptr %w5
  %w6 = getelementptr i64, ptr %block, i64 6
  %refused = load ptr, ptr %w6
  %w7 = getelementptr i64, ptr %block, i64 7
  %p_dy = load ptr, ptr %w7
  store double %t, ptr %time
  store ptr %y, ptr %pointers
  store ptr %dy, ptr %p_dy
  %works = getelementptr double, ptr %dy, i64 %size
  %p_works = getelementptr ptr, ptr %p_dy, i64 1
  store ptr %works, ptr %p_works
  call void %run(ptr %pointers, i64 0, i64 1)
  br label %judge
judge:
  %j = phi i64 [0, %entry], [%next, %good]
  %left = icmp slt i64 %j, %margins
  br i1 %left, label %margin, label %done
margin:
  %p_margin = getelementptr double, ptr %health, i64 %j
  %value = load double, ptr %p_margin
  %next = add i64 %j, 1
  %fine = fcmp ogt double %value, {SINGULAR:e}
  br i1 %fine, label %good, label %bad
good:
  br label %judge
bad:
  %total = add i64 %size, 3
  br label %spoil
spoil:
  %i = phi i64 [0, %bad], [%i_next, %spoil]
  %from = getelementptr double, ptr %y, i64 %i
  %kept = load double, ptr %from
  %into = getelementptr double, ptr %refused, i64 %i
  %old = load double, ptr %into
  %number = fcmp ord double %kept, %kept
  %trial = select i1 %number, double %kept, double %old
  store double %trial, ptr %into
  %spoilt = getelementptr double, ptr %dy, i64 %i
  store double 0x7FF8000000000000, ptr %spoilt
  %i_next = add i64 %i, 1
  %spoiling = icmp slt i64 %i_next, %total
  br i1 %spoiling, label %spoil, label %done
done:
  ret void
}}
"""


class Chunks(Stepper):
    """A law that needs nobody's advice, integrated a hundred steps at a time."""

    def __init__(
        self,
        law: "BoundLaw",
        function: NativeFunction,
        more: Sequence[Array],
        method: int,
        t: float,
        y: Array,
        tolerances: dict[str, float],
    ) -> None:
        self.t, self.y, self.steps = t, y.copy(), 0
        self._method, self._stuck = method, False
        self._law, self._inputs = law, [*law.inputs, *more]
        self._rtol, self._atol = (np.array([tolerances[name]]) for name in ("rtol", "atol"))
        self._longest = tolerances["max_step"]
        self._rows = np.ascontiguousarray(law.rows, dtype=float)
        self._refused = np.full(len(y), np.nan)
        self._pointers = addresses([*self._inputs, *law.results])
        time, health = law.inputs.t, law.results.health
        self._block = np.array(
            [
                function.address,
                self._pointers.ctypes.data,
                law.inputs[0].size,
                time.ctypes.data,
                MARGINS * len(law.robot.legs),
                health.ctypes.data,
                self._refused.ctypes.data,
                self._pointers[len(self._inputs) + 1 :].ctypes.data,
            ],
            dtype=np.uint64,
        )
        self._args = addresses([self._block])

    def advance(self, times: Array) -> Array:
        if self._stuck:
            raise Stuck
        row, until = self._law.stretch(self.t)
        self._pointers[2] = self._rows[row].ctypes.data
        inside = np.ascontiguousarray(times[times <= until][:OUTPUTS])
        end = until if len(inside) < min(len(times), OUTPUTS) else inside[-1]
        size, self._refused[:] = len(self.y), np.nan
        solver = cyrk()
        found = solver.solve(
            driver()[1], self.t, end, self.y.ctypes.data, size, self._method, len(inside), 0,
            self._args.ctypes.data, self._args.nbytes, CHUNK, MEMORY, False, inside.ctypes.data, len(inside),
            None, None, 0, self._rtol.ctypes.data, 1, self._atol.ctypes.data, 1, self._longest, 0.0, True,
        )  # fmt: skip
        try:
            status, taken = solver.status(found), solver.steps_taken(found)
            rows = np.array(solver.y(found)[: solver.size(found) * size]).reshape(-1, size)
            rows = rows[: len(inside)]  # without output times it gives all steps
            if taken:
                self.t, self.y = solver.t_now(found), np.array(solver.y_now(found)[:size])
        finally:
            solver.free(found)
        self.steps += taken
        self._stuck = status not in (DONE, MORE)  # said when it is asked to go on: these rows are good
        return rows

    @property
    def refused(self) -> InputError | None:
        if not np.isfinite(self._refused).all():
            return None
        try:
            self._law.rate(self.t, self._refused[: self._law.inputs[0].size])
        except InputError as error:
            return error
        return None

    def moved(self) -> None:
        return


def chunks(law: "BoundLaw", method: str, t: float, y: Array, tolerances: dict[str, float]) -> Chunks | None:
    """The integrator for a law, where law, backend and machine allow it."""
    function: Function = law.function
    more: list[Array] = []
    if isinstance(function, At):
        more, function = [function.theta], function.function
    if not law.alone or not isinstance(function, NativeFunction):
        return None
    try:
        cyrk()
    except (ImportError, OSError):  # not installed, or not for this processor
        return None
    return Chunks(law, function, more, NUMBERS[method], t, y, tolerances)


@cache
def driver() -> tuple[Any, int]:
    """The right-hand side: what keeps it alive, and its address."""
    kept = engine(machine().emit_object(llvm.parse_assembly(DRIVER)))
    return kept, kept.get_function_address("rhs")


class Solver:
    """CyRK's interface for other languages: plain C functions, found by their addresses."""

    def __init__(self, api: Any) -> None:
        P, Z, D, B, N = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_double, ctypes.c_bool, ctypes.c_int32
        solve = (P, P, D, D, P, Z, N, Z, Z, P, Z, Z, Z, B, P, Z, P, P, Z, P, Z, P, Z, D, D, B)
        doubles = ctypes.POINTER(D)
        self.solve = ctypes.CFUNCTYPE(*solve)(api.get_solve_func_ptr())
        for name, kind, address in (
            ("status", N, api.get_status_func_ptr),
            ("size", Z, api.get_size_func_ptr),
            ("steps_taken", Z, api.get_steps_taken_func_ptr),
            ("t_now", D, api.get_t_now_func_ptr),
            ("y", doubles, api.get_y_func_ptr),
            ("y_now", doubles, api.get_y_now_ptr_func_ptr),
            ("free", None, api.get_free_func_ptr),
        ):
            setattr(self, name, ctypes.CFUNCTYPE(kind, P)(address()))


@cache
def cyrk() -> Any:
    """The interface; raises ImportError where there is none."""
    import CyRK.nb.numba_c_api as api

    return Solver(api)
