"""States that are looked for: on the closure, where given joints lead, in equilibrium."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from parflex.analysis import equilibrium as statics
from parflex.analysis import forward as geometry
from parflex.analysis import singularities as singular
from parflex.base.array import Array
from parflex.base.check import exactly, integer, of_type
from parflex.base.errors import InputError, NotConverged
from parflex.mechanics.closure import flat_state, projected
from parflex.mechanics.system import examined
from parflex.robot.layout import unpack
from parflex.robot.robot import Robot
from parflex.robot.state import State

if TYPE_CHECKING:
    from parflex.model.model import Model


def on_closure(robot: Robot, state: State) -> Array:
    """The flat state (…, size) on the closure nearest to a state.

    Raises NotConverged where there is none near, OutOfReach and SingularPose where a leg is why.
    """
    try:
        return projected(robot, state)
    except NotConverged:
        singular.check_legs(robot, examined(robot, flat_state(robot, state))[1])
        raise


def pose(robot: Robot, joints: ArrayLike, guess: State | None, sag: bool) -> Array:
    """The flat state at rest whose actuated joints are as given (m,), from a guess, by default home.

    With sag the platform bends under its own weight. Raises NotConverged where none is found.
    """
    wanted, start = given(robot, joints, guess)
    if not sag:
        return geometry.pose(robot, wanted, start)

    def sagging(q_e: Array) -> Array:
        return geometry.pose(robot, wanted, bent(robot, start, q_e))

    return statics.equilibrium(robot, sagging)[0]


def poses(robot: Robot, joints: ArrayLike, guess: State | None, starts: int, seed: int) -> list[Array]:
    """All flat states found whose actuated joints are as given (m,), the nearest to the guess first."""
    wanted, start = given(robot, joints, guess)
    return geometry.every_pose(robot, wanted, start, integer("starts", starts, 1), seed)


def at_rest(model: "Model", name: str, state: State) -> tuple[Array, Array]:
    """The equilibrium at the pose of a state, as a flat state, and the forces (m,) that hold it.

    Joints that the state names are a start. Raises InputError for a batch, NotConverged where the
    platform is too soft, and as `Model.direct` where the pose is none.
    """
    robot = model.robot
    still = State(state.position, state.rotation, joints=state.joints)
    start = single(name, on_closure(robot, still))
    model.check(start, examined(robot, start)[1])

    def held(q_e: Array) -> Array:
        return projected(robot, unpack(bent(robot, start, q_e), robot.layout))

    return statics.equilibrium(robot, held)


def given(robot: Robot, joints: ArrayLike, guess: State | None) -> tuple[Array, Array]:
    """Actuated joints (m,), and the flat state at rest to start from, with the guess's bend."""
    wanted = exactly("joints", joints, (robot.n_forces,))
    start = robot.home if guess is None else guess
    of_type("guess", start, State)
    still = State(start.position, start.rotation, elastic=start.elastic, joints=start.joints)
    return wanted, single("guess", flat_state(robot, still))


def bent(robot: Robot, x: Array, q_e: Array) -> Array:
    """The flat state with another bend q_e (N,)."""
    return np.concatenate([x[:13], q_e, x[13 + len(q_e) :]])


def single(name: str, x: Array) -> Array:
    """The flat state; raises InputError for a batch."""
    if x.ndim > 1:
        raise InputError(f"{name} is a batch {x.shape[:-1]}; give one state at a time")
    return x
