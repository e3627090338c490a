"""A direct model's machine code on many rows, without what surrounds it in the library."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from parflex.compiled.native import native
from parflex.kernels import models as kernels
from parflex.kernels.by_tips import by_tips
from parflex.kernels.kernel import Kernel
from parflex.mechanics.redundancy import solvable
from parflex.robot.robot import Robot


class Rows(NamedTuple):
    """A kernel's code and arrays of `count` rows to run it on."""

    code: native.Code
    arrays: list[np.ndarray]
    count: int

    def one_thread(self) -> Callable[[], object]:
        """A call that computes all rows."""
        places = native.addresses(self.arrays)
        blocks = self.count // self.code.lanes
        return lambda: self.code.run(places.ctypes.data, 0, blocks)

    def all_threads(self) -> Callable[[], object]:
        """The same, shared by the processors as the library does."""
        return lambda: native.run_rows(self.code, self.arrays, self.count)


def direct_rows(robot: Robot, lanes: int, count: int) -> Rows:
    """The direct model, `lanes` states per instruction, at states near home."""
    kernel: Kernel = kernels.direct(by_tips(solvable(robot)))
    arrays = [*kernel.probe(count).values(), *(np.zeros((count, n)) for n in kernel.outputs.values())]
    return Rows(native.code(kernel, lanes), arrays, count)
