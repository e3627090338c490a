"""Gravity sag: where a point of the platform goes as the base is tilted, as a telescope's is by elevation."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.analysis.forward import standing
from parflex.base.array import Array
from parflex.base.check import exactly, finite, scalar
from parflex.base.errors import InputError, NotConverged
from parflex.base.spatial import cayley, rotation_from_vector, vector_from_rotation
from parflex.linear.outputs import NodeMotion
from parflex.mechanics.system import actuated_positions
from parflex.model.core import Core, HasCore, core_of
from parflex.model.rest import equilibrium_of
from parflex.robot.state import State

MOTORS = ("auto", "locked", "springs")
Offset = tuple[float, float, float]


def sag(
    model: HasCore,
    elevations: ArrayLike,
    node: int,
    offset: Offset = (0.0, 0.0, 0.0),
    *,
    axis: ArrayLike = (1.0, 0.0, 0.0),
    home: float = 0.0,
    motors: str = "auto",
) -> Any:
    """The sag of a node, or of a point fixed to it at `offset` (3,) m in Σp, over elevation, a Dataset.

    The base turns by elevations (e,) rad about an axis (3,) of Σ0; at 0 gravity is the robot's own. At the
    elevation `home` the motors bring the platform to its home pose, and from there they hold what they have:
    "locked" their positions, as brakes and servos that integrate do, so that links, drives, tips and the
    platform give; "springs" their forces, so that the springs beside them give, too. "auto" takes springs
    where all motors have one.

    displacement (elevation, axis) m and rotation (elevation, axis) rad, a rotation vector, are those of the
    point from where it is at `home`, in the axes of Σ0; forces (elevation, actuator) N or N m are the
    motors', and gravity (elevation, axis) m/s² is as Σ0 sees it. All are equilibria of the nonlinear model.

    Raises InputError for a node that there is not, an axis without length and unknown motors; NotConverged as
    `Model.equilibrium`, with the elevation.
    """
    core = core_of(model)
    at, about, begin = finite("elevations", elevations), exactly("axis", axis, (3,)), scalar("home", home)
    if at.ndim != 1 or not at.size:
        raise InputError(f"elevations have shape {at.shape}; give a list of angles (e,) in rad")
    if not np.linalg.norm(about) > 0:
        raise InputError(f"axis is {about.tolist()}; give the direction of the axis of elevation")
    place = NodeMotion(node, offset)
    place.check(core.robot)
    locked = are_locked(core, motors)
    turned = [rotation_from_vector(angle * about / np.linalg.norm(about)) for angle in at]
    there = tilted(core, rotation_from_vector(begin * about / np.linalg.norm(about)))
    first, held = equilibrium_of(there, *core.robot.home_pose, None, None, (), None)
    joints = actuated_positions(core.system(first))
    states: dict[int, State] = {}
    forces = np.zeros((len(at), len(held)))
    for side in (np.flatnonzero(at >= begin), np.flatnonzero(at < begin)):
        guess = first
        for k in side[np.argsort(np.abs(at[side] - begin))]:
            try:
                guess, forces[k] = holding(tilted(core, turned[k]), guess, held, joints, locked)
            except NotConverged as error:
                raise NotConverged(f"elevation {np.degrees(at[k]):.4g} deg: {error}") from None
            states[int(k)] = guess
    poses = [pose_of(place, core, states[k]) for k in range(len(at))]
    return dataset(core, at, begin, pose_of(place, core, first), poses, forces, turned, locked)


def are_locked(core: Core, motors: Any) -> bool:
    """True for motors that hold their positions, False for those that hold their forces.

    Raises InputError for an unknown word, and forces that no springs are beside.
    """
    if not isinstance(motors, str) or motors not in MOTORS:
        raise InputError(f"motors is {motors!r}; choose one of {', '.join(MOTORS)}")
    sprung = [joint.k > 0 for joint in core.robot.actuated]
    if motors == "springs" and not all(sprung):
        raise InputError(
            'motors is "springs", but not all actuated joints have one, and forces alone hold nothing that '
            'tilts; give them a stiffness k, or take "locked"'
        )
    return motors == "locked" or (motors == "auto" and not all(sprung))


def tilted(core: Core, rotation: Array) -> Core:
    """The core on a base of such axes (3, 3), seen from it."""
    return core.weighed(np.zeros(3), rotation)


def holding(core: Core, guess: State, forces: Array, joints: Array, locked: bool) -> tuple[State, Array]:
    """The equilibrium near a guess of motors that hold their positions, or their forces, and the forces."""
    if not locked:
        return equilibrium_of(core, None, None, forces, guess, (), None)
    x, found = standing(core.readable.solvable, joints, core.flat(guess))
    return core.state(x), found


def pose_of(place: NodeMotion, core: Core, state: State) -> tuple[Array, Array]:
    """Where a point is in Σ0, (3,) m, and its axes (3, 3), which turn as the platform bends."""
    body, x = core.robot.platform, core.system(state).x
    shapes, turns = body.shapes_at(place.node, place.offset)
    own = body.nodes[place.node] + place.offset + shapes @ x.elastic
    return x.position + x.rotation @ own, x.rotation @ cayley(turns @ x.elastic, turns)[0]


def dataset(
    core: Core,
    at: Array,
    begin: float,
    first: tuple[Array, Array],
    poses: list[tuple[Array, Array]],
    forces: Array,
    turned: list[Array],
    locked: bool,
) -> Any:
    """The Dataset of `sag`."""
    import xarray as xr

    moved = np.array([place - first[0] for place, _ in poses])
    turns = np.array([vector_from_rotation(axes @ first[1].T) for _, axes in poses])
    gravity = np.array([rotation.T @ np.asarray(core.mechanism.gravity) for rotation in turned])
    words = {
        "displacement": (("elevation", "axis"), moved, "m", "displacement from where it is at home, in Σ0"),
        "rotation": (("elevation", "axis"), turns, "rad", "turn from how it stands at home, in Σ0"),
        "gravity": (("elevation", "axis"), gravity, "m/s^2", "gravity, as the base sees it"),
        "forces": (("elevation", "actuator"), forces, "N, N m", "forces of the motors"),
    }
    data = {
        name: (dims, values, {"units": unit, "long_name": text})
        for name, (dims, values, unit, text) in words.items()
    }
    coords = {
        "elevation": ("elevation", at, {"units": "rad", "long_name": "turn of the base"}),
        "axis": list("xyz"),
        "actuator": np.arange(forces.shape[1]),
    }
    return xr.Dataset(data, coords, {"motors": "locked" if locked else "springs", "home": begin})
