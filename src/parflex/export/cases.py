"""What the exported self-test compares with: inputs near home, and the answers of the NumPy reference."""

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.compiled.reference import NumpyFunction
from parflex.export.interface import Routine
from parflex.mechanics import closure
from parflex.robot.layout import unpack
from parflex.robot.robot import Robot

COUNT = 4
MOVED = 0.02  # of the platform's size, and rad
GRAVITY = 9.81  # m/s²: what accelerations, forces and the sag are measured by
MOVING = 0.1  # m/s, rad/s, modal rates
OFF = 1e-5  # m, m/s, rad: what states to be projected are off the closure


def cases(robot: Robot, routine: Routine) -> tuple[Array, Array]:
    """Inputs (COUNT, Σ n_i) and outputs (COUNT, Σ m_i) of a function, side by side."""
    rng, kernel, scales = np.random.default_rng(1), routine.kernel, magnitudes(robot)
    x = states(robot)
    if not routine.closure:
        x = x + OFF * (np.arange(x.shape[1]) > 6) * rng.normal(size=x.shape)
    pairs = zip(routine.inputs[1:], kernel.inputs[1:], strict=True)
    inputs = [x, *(scales[name] * rng.normal(size=(COUNT, size)) for name, size in pairs)]
    return np.hstack(inputs), np.hstack(NumpyFunction(kernel)(*inputs))


def magnitudes(robot: Robot) -> dict[str, Array]:
    """What is usual for each input: forces of the order of the platform's weight, so that the
    accelerations are no small differences of large ones."""
    mass, size = robot.platform.moments.m, closure.size_of(robot)
    weight = mass * GRAVITY
    modal = np.full(robot.platform.modes, weight / np.sqrt(mass))
    arm = np.array([1.0 if joint.sigma else size for leg in robot.legs for joint in leg.joints if joint.mu])
    loads = np.concatenate([np.repeat([0.1 * weight, 0.1 * weight * size], 3), 0.1 * modal])
    return {"u": weight * arm, "preload": weight * arm, "w": loads, "target": np.full(1, GRAVITY)}


def states(robot: Robot) -> Array:
    """Flat states (COUNT, size) on the closure: home, and others near it, bent and in motion."""
    rng, start = np.random.default_rng(0), home(robot)
    return np.array([start] + [near(robot, start, rng) for _ in range(COUNT - 1)])


def home(robot: Robot) -> Array:
    """The flat state at rest on the closure nearest to home."""
    return closure.projected(robot, robot.home)


def near(robot: Robot, x: Array, rng: np.random.Generator) -> Array:
    """A state on the closure near x, in motion; x itself where the legs reach none."""
    N, pose = robot.platform.modes, closure.units(robot, closure.POSE)
    step = MOVED * closure.size_of(robot) * pose * rng.uniform(-1, 1, len(pose))
    step[6 : 6 + N] = sag(robot) * rng.normal(size=N)
    found = closure.displaced(robot, x, step)
    found[7:13] = MOVING * rng.normal(size=6)
    found[13 + N : 13 + 2 * N] = MOVING * rng.normal(size=N)
    try:
        return closure.projected(robot, unpack(found, robot.layout))
    except InputError:
        return x


def sag(robot: Robot) -> Array:
    """Modal coordinates (N,) of the order of the bend under the platform's weight, and never large."""
    body = robot.platform
    root, most = np.sqrt(body.moments.m), MOVED * closure.size_of(robot)
    period = np.diagonal(body.m_ee) / np.maximum(body.stiffness, 1e-300)
    return root * np.minimum(GRAVITY * period, most)
