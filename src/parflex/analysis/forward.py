"""Forward geometry: the poses to which given actuated joints lead."""

import numpy as np
from numpy.typing import ArrayLike

from parflex.analysis.equilibrium import equilibrium, held_joints
from parflex.analysis.health import single
from parflex.analysis.statics import held_load
from parflex.base.array import Array
from parflex.base.check import exactly, integer, of_type
from parflex.base.errors import NotConverged
from parflex.base.progress import Progress
from parflex.base.spatial import within_half_a_turn
from parflex.mechanics.closure import CLOSED, POSE, displaced, posed, units
from parflex.mechanics.flat_state import flat_state
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.redundancy import with_rows
from parflex.robot.layout import Layout, coordinates
from parflex.robot.state import State

CLOSE_ENOUGH = 1e3 * CLOSED  # of the platform's size
SAME = 1e-6  # of the platform's size and a radian: poses that are one
SPREAD = (3.0, np.pi)  # random starts: of the platform's size, rad


def forward(mechanism: Mechanism, joints: ArrayLike, guess: State | None, sag: bool) -> Array:
    """The flat state at rest whose actuated joints are as given (m,), from a guess, by default home.

    With sag the platform bends under its own weight. Raises NotConverged where none is found.
    """
    wanted, start = given(mechanism, joints, guess)
    return standing(mechanism, wanted, start)[0] if sag else pose(mechanism, wanted, start)


def standing(mechanism: Mechanism, wanted: Array, start: Array) -> tuple[Array, Array]:
    """The flat state at rest under gravity whose actuated joints are as wanted (m,), from one near it, and
    the forces (m,) that hold it."""

    def moved(x: Array, motion: Array) -> Array:
        return pose(mechanism, wanted, displaced(mechanism, x, motion))

    mechanism = with_rows(mechanism)
    there, none = pose(mechanism, wanted, start), np.zeros(len(wanted))
    return equilibrium(mechanism, there, moved, held_joints, held_load(mechanism, ()), none)


def forward_all(
    mechanism: Mechanism, joints: ArrayLike, guess: State | None, starts: int, seed: int
) -> list[Array]:
    """All flat states found whose actuated joints are as given (m,), the nearest to the guess first."""
    wanted, start = given(mechanism, joints, guess)
    return every_pose(mechanism, wanted, start, integer("starts", starts, 1), integer("seed", seed))


def given(mechanism: Mechanism, joints: ArrayLike, guess: State | None) -> tuple[Array, Array]:
    """Actuated joints (m,), and the flat state at rest to start from, with the guess's bend."""
    wanted = exactly("joints", joints, (mechanism.n_forces,))
    start = mechanism.robot.home if guess is None else guess
    of_type("guess", start, State)
    return wanted, single("guess", flat_state(mechanism, start.still))


def pose(mechanism: Mechanism, wanted: Array, start: Array) -> Array:
    """The flat state whose actuated joints are as wanted (m,), from a flat state near it."""
    found, gap = posed(mechanism, start, wanted)
    if not gap <= CLOSE_ENOUGH * max(1.0, mechanism.size):
        raise NotConverged(
            f"no pose with these actuated joints was found from the guess, a gap of {gap:.2g} m or rad "
            f"remains; give a guess nearer to it, or look for all poses with model.forward_all"
        )
    return found


def every_pose(mechanism: Mechanism, wanted: Array, start: Array, starts: int, seed: int) -> list[Array]:
    """All poses found from random starts about a flat state, the nearest to it first."""
    rng, found = np.random.default_rng(seed), [np.empty((0, len(start)))]
    size = mechanism.size
    spread = units(mechanism, POSE) * np.concatenate(
        [np.full(3, SPREAD[0] * size), np.full(len(units(mechanism, POSE)) - 3, SPREAD[1] * size)]
    )
    with Progress("poses", starts) as bar:
        for done in range(starts):
            step = spread * rng.uniform(-1, 1, len(spread)) * (done > 0)
            x, gap = posed(mechanism, displaced(mechanism, start, step), wanted)
            if gap <= CLOSE_ENOUGH * max(1.0, size) and not any(same(mechanism, x, y) for y in found[1:]):
                found.append(x)
            bar.to(done + 1)
    return sorted(found[1:], key=lambda x: distance(mechanism.layout, x, start, size))


def same(mechanism: Mechanism, a: Array, b: Array) -> bool:
    """True where two flat states are one pose, with the same joints but for full turns."""
    layout = mechanism.layout
    straight = (mechanism.slides | mechanism.bends)[mechanism.kept]
    apart = coordinates(a, layout).s - coordinates(b, layout).s
    apart = np.where(straight, apart, within_half_a_turn(apart))
    size = mechanism.size
    return max(distance(layout, a, b, size), np.max(np.abs(apart), initial=0.0)) < SAME * max(1.0, size)


def distance(layout: Layout, a: Array, b: Array, size: float) -> float:
    """The distance between two poses, m, with the angle on the platform's size."""
    at = layout.at
    angle = 2 * np.arccos(np.minimum(1.0, np.abs(np.dot(a[at.quaternion], b[at.quaternion]))))
    return float(np.linalg.norm(a[at.position] - b[at.position]) + size * angle)
