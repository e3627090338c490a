"""The models on flat arrays, for control loops: no allocation, no checks after the first call."""

from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.compiled.backend import Trigger
from parflex.kernels import models as kernels
from parflex.kernels.kernel import lengths
from parflex.kernels.moved_base import moved_base
from parflex.mechanics.output import Output
from parflex.model.core import Core
from parflex.robot.base_motion import BASE
from parflex.robot.state import State

REMEMBERED = 64  # sets of arrays, per function


Key = tuple[int, ...]  # identities of the arrays


class Bound(NamedTuple):
    """A bound call and the very objects that were passed: while they live, their id is theirs."""

    trigger: Trigger
    arrays: tuple[Array | None, ...]


class Compiled:
    """Direct and inverse models on flat float64 arrays; one per thread.

    The state x is (p 3, quaternion w x y z 4, v_p 3, ω_p 3, q_e N, q̇_e N[, q, q̇][, ±1]), of
    length `state_size`: q are the joints of legs without closed-form inverse geometry, ±1 is the assembly
    branch of each leg that has two and no posture; the quaternion is normalised inside.

    Arrays are bound at first sight, kept alive, and recognised by identity: pass the same arrays again and
    only their contents are read.
    """

    def __init__(self, core: Core, output: Output) -> None:
        self._core, self.output = core, output
        sizes = lengths(core.mechanism)
        self.state_size, self.modes, self.force_size = sizes["x"], sizes["elastic"], sizes["forces"]
        self.contact_size = sizes["contact"]
        self._direct: dict[Key, Bound] = {}
        self._inverse: dict[Key, Bound] = {}

    def pack(self, state: State) -> Array:
        """The flat state (state_size,) of one state.

        Raises OutOfReach where no joints are found for a leg whose joints it carries.
        """
        x = self._core.flat(state)
        if x.ndim != 1:
            raise InputError(f"state is a batch {x.shape[:-1]}; compiled models take one at a time")
        if any(self._core.mechanism.layout.joints):
            self._core.system(state)
        return x

    def unpack(self, x: Array) -> State:
        """The state of a flat vector."""
        return self._core.state(x)

    def direct(self, x: Array, u: Array, out: Array, base: Array | None = None) -> None:
        """out = (V̇_p 6, q̈_e N[, contact forces 3 per attachment held]) for forces u (m,).

        base (19,) is the motion of a floor that moves, as `BaseMotion.flat`.
        """
        key = (id(x), id(u), id(out), id(base))
        bound = self._direct.get(key)
        if bound is None:
            bound = Bound(self._bind_direct(x, u, out, base), (x, u, out, base))
            remember(self._direct, key, bound)
        bound.trigger()

    def inverse(self, x: Array, target: Array, out: Array, base: Array | None = None) -> None:
        """out = (Γ m, q̈_e N[, contact forces 3 per attachment held]) for an output's target (o,), on a base
        as of `direct`.

        Nothing is checked here: near a singular pose the forces grow without bound.
        """
        key = (id(x), id(target), id(out), id(base))
        bound = self._inverse.get(key)
        if bound is None:
            bound = Bound(self._bind_inverse(x, target, out, base), (x, target, out, base))
            remember(self._inverse, key, bound)
        bound.trigger()

    def _bind_direct(self, x: Array, u: Array, out: Array, base: Array | None) -> Trigger:
        check("x", x, self.state_size)
        check("u", u, self.force_size)
        outputs = self._split(out, "platform", 6)
        return self._bound(base, {"x": x, "forces": u}, outputs, kernels.direct)

    def _bind_inverse(self, x: Array, target: Array, out: Array, base: Array | None) -> Trigger:
        check("x", x, self.state_size)
        size = self.output.size
        check("target", target, size)
        if self.force_size < size:
            raise InputError(
                f"the flat inverse model prescribes {size} accelerations, but the robot has "
                f"{self.force_size} actuators; use model.compiled(FrameOutput(rows=…))"
            )
        outputs = self._split(out, "forces", self.force_size)
        return self._bound(base, {"x": x, "target": target}, outputs, kernels.inverse, self.output)

    def _bound(
        self, base: Array | None, given: dict[str, Array], outputs: dict[str, Array], *kernel: Any
    ) -> Trigger:
        """A call of a kernel, on a base that moves where there is one."""
        if base is None:
            return self._core.functions(*kernel).bind(given, outputs)
        check("base", base, BASE)
        return self._core.functions(moved_base, *kernel).bind({**given, "base": base}, outputs)

    def _split(self, out: Array, name: str, first: int) -> dict[str, Array]:
        """Views of the output's parts by name; the contact forces where there is room for them."""
        short = first + self.modes
        check("out", out, short, short + self.contact_size)
        if not out.flags.writeable:
            raise InputError("out is read-only; pass an array that can be written")
        parts = {name: out[:first], "elastic": out[first:short]}
        return parts | {"contact": out[short:]} if len(out) > short else parts


def check(name: str, array: Array, *lengths: int) -> None:
    """A contiguous float64 vector of one of these lengths, as it is: nothing is copied."""
    if not isinstance(array, np.ndarray) or array.dtype != np.float64:
        kind = getattr(array, "dtype", type(array).__name__)
        raise InputError(f"{name} is of {kind}; pass a NumPy array of float64")
    if array.ndim != 1 or len(array) not in lengths or not array.flags.c_contiguous:
        wanted = " or ".join(f"({n},)" for n in sorted(set(lengths)))
        raise InputError(
            f"{name} has shape {array.shape} and strides {array.strides}; pass a contiguous {wanted}"
        )


def remember(known: dict[Key, Bound], key: Key, bound: Bound) -> None:
    """Keep a bound call; the oldest is dropped where a caller keeps passing new arrays."""
    if len(known) >= REMEMBERED:
        known.pop(next(iter(known)))
    known[key] = bound
