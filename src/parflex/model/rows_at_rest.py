"""Equilibria in rows: all at once where that is known to do, one by one where it is not."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from parflex.analysis.closed_equilibria import equilibria_on_closure, has_motions, on_closure
from parflex.analysis.equilibria import Build, Found, Given, equilibria, has_quick, quick
from parflex.analysis.equilibrium import at_rest, check_firm, under_forces
from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.compiled import choose
from parflex.kernels.jacobians import direct_jacobian
from parflex.kernels.rest import closure, unrest
from parflex.mechanics.flat_state import flat_state
from parflex.mechanics.wrench import places_of
from parflex.model.core import Core
from parflex.model.inputs import Wrenches
from parflex.robot.state import State

MANY = 64  # rows from which on compiling is quicker than not
FEW = 4  # rows below which legs that have to be closed are quicker closed one by one, in NumPy


class Asked(NamedTuple):
    """The B equilibria that are asked for: poses that are held, or guesses and the forces there."""

    state: State  # (B,)
    forces: Array  # (B, m)
    pushes: Array  # (B, 6 L), the wrenches (F, N) side by side
    wrenches: Wrenches  # of which only the places are read
    posed: bool

    def part(self, rows: Array) -> "Asked":
        """Some of them, by number."""
        if len(rows) == len(self.forces):
            return self
        return self._replace(state=self.state[rows], forces=self.forces[rows], pushes=self.pushes[rows])

    def loads(self, row: int) -> Wrenches:
        """The wrenches of one row."""
        pairs = self.pushes[row].reshape(-1, 2, 3)
        return [replace(each, force=F, moment=N) for each, (F, N) in zip(self.wrenches, pairs, strict=True)]


class AtRest(NamedTuple):
    """Flat states (B, size) at rest, their forces (B, m), and the errors of rows that have none."""

    x: Array
    forces: Array
    errors: Mapping[int, InputError]


def at_rest_in_rows(core: Core, asked: Asked) -> AtRest:
    """The equilibria of a robot; raises InputError for a mode without stiffness."""
    check_firm(core.mechanism)
    found, errors = all_at_once(core, asked), {}
    for row in map(int, np.flatnonzero(~found.sure)):
        try:
            found.x[row], found.forces[row] = one(core, asked, row)
        except InputError as error:
            errors[row] = error
    return AtRest(found.x, found.forces, errors)


def one(core: Core, asked: Asked, row: int) -> tuple[Array, Array]:
    """The equilibrium of one row, as `analysis.equilibrium` finds it; raises as that does."""
    state, loads = asked.state[row], asked.loads(row)
    if asked.posed:
        return at_rest(core.functions, "position and rotation", state, loads)
    return under_forces(core.functions, asked.forces[row], state, loads)


def all_at_once(core: Core, asked: Asked) -> Found:
    """The equilibria that are found together; none is sure of robots for which that is not known."""
    mechanism, count = core.functions.solvable, len(asked.forces)
    none = Found(np.zeros((count, mechanism.layout.size)), np.array(asked.forces), np.full(count, False))
    opens = not mechanism.closed
    if not count or (opens and not (asked.posed and has_motions(mechanism))):
        return none
    places = places_of(asked.wrenches)
    kernels = [(direct_jacobian, places), (unrest, places), *([(closure,)] if opens else [])]
    build = builder(core, kernels, count)
    if opens and count < FEW and build(closure).readable:
        return none
    start = flat_state(mechanism, asked.state)
    given = Given(start, asked.forces, asked.pushes)
    if opens:
        robot = on_closure(quick(mechanism, build, places, asked.posed), build(closure))
        return equilibria_on_closure(robot, given)
    if not has_quick(mechanism, start[0], asked.posed):
        return none
    return equilibria(quick(mechanism, build, places, asked.posed), given)


def builder(core: Core, kernels: Sequence[tuple[Any, ...]], count: int) -> Build:
    """A maker of functions of kernels: compiled ones for many rows, or where they are there already."""
    functions = core.functions
    if count >= MANY or all(functions.ready(*each) for each in kernels):
        return functions
    return lambda build, *chosen: choose("numpy").compile(build(functions.solvable, *chosen))


def flat_rows(part: Array, batch: tuple[int, ...]) -> Array:
    """Vectors (…, n) as (B, n), one for each of a batch."""
    return np.broadcast_to(part, (*batch, part.shape[-1])).reshape(math.prod(batch), part.shape[-1])


def state_rows(state: State, batch: tuple[int, ...]) -> State:
    """States (…) as (B,), one for each of a batch."""
    count = math.prod(batch)
    if not state.batch:
        return replace(state, position=np.broadcast_to(state.position, (count, 3)))
    numbers = np.arange(math.prod(state.batch)).reshape(state.batch)
    return state[np.unravel_index(np.broadcast_to(numbers, batch).reshape(-1), state.batch)]


def raise_first(errors: Mapping[int, InputError], batch: tuple[int, ...]) -> None:
    """Raise the error of the first row that has one, with its place in a batch and how many there are."""
    if not errors:
        return
    first = min(errors)
    error = errors[first]
    if not batch:
        raise error
    place: Any = tuple(int(i) for i in np.unravel_index(first, batch))
    place = place[0] if len(place) == 1 else place
    fail = "1 fails" if len(errors) == 1 else f"{len(errors)} fail"
    raise type(error)(
        f"of {math.prod(batch)} equilibria {fail}, the first at index {place}: {error}"
    ) from error
