"""Functions of callers at many times: what they give, and what they raise."""

from collections.abc import Callable

import numpy as np

from parflex.base.array import Array


def at_times(
    function: Callable[[float, Array], Array], t: Array, x: Array, size: int
) -> tuple[Array, BaseException | None]:
    """Rows (T, size) of a function of times (T,) and flat states (T, n), and the first thing that it raised.

    Rows where it raises something are not numbers; after Ctrl-C it is not called any more.
    """
    rows, raised = np.full((len(t), size), np.nan), None
    for i, time in enumerate(t):
        try:
            rows[i] = function(time, x[i])
        except KeyboardInterrupt as interrupt:
            return rows, interrupt
        except Exception as error:  # a caller's function may raise anything; the other rows are worth keeping
            raised = raised or error
    return rows, raised
