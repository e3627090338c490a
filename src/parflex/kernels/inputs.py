"""Kernels with one more input, of which their mechanism is made anew: parameters, the rests of springs, the
motion of the base."""

from collections.abc import Callable
from dataclasses import replace

from parflex.base.array import Array
from parflex.kernels.kernel import Kernel, Vectors
from parflex.mechanics.mechanism import Mechanism


def plainly(mechanism: Mechanism, build: Callable[..., Kernel], *chosen: object) -> Kernel:
    """The kernel that `build` makes of the mechanism and its other arguments, without another input."""
    return build(mechanism, *chosen)


def with_input(
    plain: Kernel, name: str, size: int, at: Callable[[Array], Callable[..., Vectors]], *chosen: object
) -> Kernel:
    """The kernel whose function is `at(v)` for one more input v (…, size), otherwise like a plain one."""

    def function(**given: Array) -> Vectors:
        return at(given.pop(name))(**given)

    inputs = {**plain.inputs, name: size}
    return replace(plain, function=function, inputs=inputs, chosen=(*plain.chosen, *chosen))


def remade(
    mechanism: Mechanism,
    name: str,
    own: Array,
    changed: Callable[[Mechanism, Array], Mechanism],
    build: Callable[..., Kernel],
    *chosen: object,
) -> Kernel:
    """The kernel that `build` makes of the mechanism and its other arguments, whose mechanism is
    `changed(mechanism, v)` for one more input v (…, n), which is `own` (n,) where nothing has changed."""

    def at(value: Array) -> Callable[..., Vectors]:
        return build(changed(mechanism, value), *chosen).function

    found = with_input(build(changed(mechanism, own), *chosen), name, len(own), at, name)
    return replace(found, mechanism=mechanism, near={**found.near, name: own})
