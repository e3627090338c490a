"""The cases of the exported self-test: inputs near home, and the answers of the NumPy reference."""

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.compiled.reference import NumpyFunction
from parflex.export.interface import Routine
from parflex.mechanics import closure
from parflex.mechanics.flat_state import projected, state_of
from parflex.mechanics.mechanism import Mechanism

COUNT = 4
MOVED = 0.02  # of the platform's size, and rad
GRAVITY = 9.81  # m/s²: what accelerations, forces and the sag are measured by
MOVING = 0.1  # m/s, rad/s, modal rates
OFF = 1e-5  # m, m/s, rad: what states to be projected are off the closure


def cases(mechanism: Mechanism, routine: Routine) -> tuple[Array, Array]:
    """Inputs (COUNT, Σ n_i) and outputs (COUNT, Σ m_i) of a function, side by side."""
    rng, kernel, scales = np.random.default_rng(1), routine.kernel, magnitudes(mechanism)
    x = states(mechanism)
    if not routine.closure:
        place, at = np.arange(x.shape[1]), mechanism.layout.at
        off = (place >= at.twist.start) & (place < at.branches.start)
        x = x + OFF * off * rng.normal(size=x.shape)
    sizes = {name: size for name, size in kernel.inputs.items() if name != "x"}
    inputs = {"x": x} | {name: scales[name] * rng.normal(size=(COUNT, n)) for name, n in sizes.items()}
    return np.hstack(list(inputs.values())), np.hstack(list(NumpyFunction(kernel)(**inputs).values()))


def magnitudes(mechanism: Mechanism) -> dict[str, Array]:
    """The usual size of each input: forces of the order of the platform's weight, so that the
    accelerations are no small differences of large ones."""
    robot, size = mechanism.robot, mechanism.size
    mass = robot.platform.moments.m
    weight = mass * GRAVITY
    modal = np.full(robot.platform.modes, weight / np.sqrt(mass))
    arm = np.array([1.0 if joint.sigma else size for leg in robot.legs for joint in leg.joints if joint.mu])
    loads = np.concatenate([np.repeat([0.1 * weight, 0.1 * weight * size], 3), 0.1 * modal])
    return {"forces": weight * arm, "preload": weight * arm, "load": loads, "target": np.full(1, GRAVITY)}


def states(mechanism: Mechanism) -> Array:
    """Flat states (COUNT, size) on the closure: home, and others near it, bent and in motion."""
    rng, start = np.random.default_rng(0), home(mechanism)
    return np.array([start] + [near(mechanism, start, rng) for _ in range(COUNT - 1)])


def home(mechanism: Mechanism) -> Array:
    """The flat state at rest on the closure nearest to home."""
    return projected(mechanism, mechanism.robot.home)


def near(mechanism: Mechanism, x: Array, rng: np.random.Generator) -> Array:
    """A state on the closure near x, in motion; x itself where the legs reach none."""
    at, pose = mechanism.layout.at, closure.units(mechanism, closure.POSE)
    step = MOVED * mechanism.size * pose * rng.uniform(-1, 1, len(pose))
    bend = sag(mechanism)
    step[mechanism.layout.displacements.elastic] = bend * rng.normal(size=len(bend))
    found = closure.displaced(mechanism, x, step)
    found[at.twist] = MOVING * rng.normal(size=6)
    found[at.elastic_rate] = MOVING * rng.normal(size=len(bend))
    try:
        return projected(mechanism, state_of(mechanism, found))
    except InputError:
        return x


def sag(mechanism: Mechanism) -> Array:
    """Modal coordinates (N,) of the order of the bend under the platform's weight, and never large."""
    body = mechanism.robot.platform
    root, most = np.sqrt(body.moments.m), MOVED * mechanism.size
    period = np.diagonal(body.m_ee) / np.maximum(body.stiffness, 1e-300)
    return root * np.minimum(GRAVITY * period, most)
