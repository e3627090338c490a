"""CyRK's integrators by their interface for other languages: plain C functions, found by their addresses."""

import warnings
from ctypes import CFUNCTYPE, POINTER, c_bool, c_double, c_int32, c_size_t, c_void_p
from functools import cache
from typing import Any

import numpy as np

from parflex.base.array import Array

NUMBERS = {"RK45": 4, "DOP853": 5, "Radau": 8}  # CyRK's numbers
DONE, MORE = 1, -52  # CyRK's status: at the end, and after as many steps as were allowed

SOLVE = {  # the arguments of `numba_cysolve_ivp`, in its order
    "rhs": c_void_p,
    "start": c_double,
    "end": c_double,
    "y": c_void_p,
    "y_size": c_size_t,
    "method": c_int32,
    "expected": c_size_t,
    "extra": c_size_t,
    "args": c_void_p,
    "args_bytes": c_size_t,
    "max_steps": c_size_t,
    "max_megabytes": c_size_t,
    "dense": c_bool,
    "times": c_void_p,
    "times_size": c_size_t,
    "before": c_void_p,
    "events": c_void_p,
    "events_size": c_size_t,
    "rtol": c_void_p,
    "rtol_size": c_size_t,
    "atol": c_void_p,
    "atol_size": c_size_t,
    "max_step": c_double,
    "first_step": c_double,
    "keep": c_bool,
}


class Solver:
    """The C functions: `solve`, which gives an address, and those that read there."""

    def __init__(self, api: Any) -> None:
        doubles = POINTER(c_double)
        self._solve = CFUNCTYPE(c_void_p, *SOLVE.values())(api.get_solve_func_ptr())
        self.status = CFUNCTYPE(c_int32, c_void_p)(api.get_status_func_ptr())
        self.free = CFUNCTYPE(None, c_void_p)(api.get_free_func_ptr())
        self._size = CFUNCTYPE(c_size_t, c_void_p)(api.get_size_func_ptr())
        self.steps_taken = CFUNCTYPE(c_size_t, c_void_p)(api.get_steps_taken_func_ptr())
        self.t_now = CFUNCTYPE(c_double, c_void_p)(api.get_t_now_func_ptr())
        self._y = CFUNCTYPE(doubles, c_void_p)(api.get_y_func_ptr())
        self._y_now = CFUNCTYPE(doubles, c_void_p)(api.get_y_now_ptr_func_ptr())

    def solve(self, **arguments: Any) -> int:
        """An integration, to be freed; all of SOLVE but first_step, dense, extra and events are needed."""
        rest = {"expected": arguments["times_size"], "extra": 0, "dense": False, "first_step": 0.0}
        none = {"before": None, "events": None, "events_size": 0, "keep": True}
        given = {**rest, **none, **arguments}
        found: int = self._solve(*(given[name] for name in SOLVE))
        return found

    def rows(self, found: int, size: int) -> Array:
        """y (k, size) at the times that were passed; at all steps where no times were given."""
        return np.array(self._y(found)[: self._size(found) * size]).reshape(-1, size)

    def y_now(self, found: int, size: int) -> Array:
        """y (size,) where the integration ended."""
        return np.array(self._y_now(found)[:size])


@cache
def solver() -> Solver:
    """The interface; raises ImportError or OSError where there is none for this processor."""
    import CyRK.nb.numba_c_api as api

    return Solver(api)


@cache
def available() -> bool:
    """True where the interface is there; where it is not, that is said once."""
    try:
        solver()
    except (ImportError, OSError):  # not installed, or not for this processor
        words = "CyRK is not installed, or not for this machine: SciPy takes the steps of simulations"
        warnings.warn(f"{words}, with the same results but slower", stacklevel=2)
        return False
    return True
