"""The cases of the exported self-test: inputs near home, and the answers of the NumPy reference."""

from collections.abc import Mapping
from typing import NamedTuple

import casadi
import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.compiled.reference import NumpyFunction
from parflex.export.interface import Routine
from parflex.mechanics import closure
from parflex.mechanics.flat_state import projected, state_of
from parflex.mechanics.mechanism import Mechanism
from parflex.robot.body import FlexibleBody

COUNT = 4
MOVED = 0.02  # of the platform's size, and rad
GRAVITY = 9.81  # m/s²: what accelerations, forces and the sag are measured by
MOVING = 0.1  # m/s, rad/s, modal rates
OFF = 1e-5  # m, m/s, rad: what states to be projected are off the closure
SAME = 1e-12  # of an array's largest entry, or of 1: where C agrees with the reference
ROUNDINGS = 10.0  # times what two orders of the same operations differ by, where stiff tips make more of it
WRONG = 1e-9  # of the same: no round-off


class Cases(NamedTuple):
    """The cases of a function, side by side, and how far each output of C may be from them."""

    inputs: Array  # (COUNT, Σ n_i)
    outputs: Array  # (COUNT, Σ m_i)
    tolerances: tuple[float, ...]  # of each output's largest entry, or of 1


def cases(mechanism: Mechanism, routine: Routine, graph: casadi.Function) -> Cases:
    """The cases of a function, of which the graph is what C is written of."""
    rng, kernel, scales = np.random.default_rng(1), routine.kernel, magnitudes(mechanism)
    x = states(mechanism)
    if not routine.closure:
        place, at = np.arange(x.shape[1]), mechanism.layout.at
        off = (place >= at.twist.start) & (place < at.branches.start)
        x = x + OFF * off * rng.normal(size=x.shape)
    sizes = {name: size for name, size in kernel.inputs.items() if name != "x"}
    inputs = {"x": x} | {name: scales[name] * rng.normal(size=(COUNT, n)) for name, n in sizes.items()}
    outputs = NumpyFunction(kernel)(**inputs)
    given, expected = (np.hstack(list(each.values())) for each in (inputs, outputs))
    return Cases(given, expected, tolerances(graph, inputs, outputs))


def tolerances(
    graph: casadi.Function, inputs: Mapping[str, Array], outputs: Mapping[str, Array]
) -> tuple[float, ...]:
    """The differences that each output may have: SAME, or more where the order of operations makes it,
    as of the force of a stiff soft tip, which is a small difference of places.

    Raises InputError where the graph differs from the reference by more than round-off.
    """
    rows = [graph.call([casadi.DM(x[k]) for x in inputs.values()]) for k in range(COUNT)]
    found = []
    for expected, *results in zip(outputs.values(), *rows, strict=True):
        largest = np.max(np.abs(expected), axis=-1, keepdims=True, initial=1.0)
        got = np.reshape([np.array(result) for result in results], expected.shape)
        off = float(np.max(np.abs(got - expected) / largest, initial=0.0))
        if not off <= WRONG:
            raise InputError(
                f"the code of {graph.name()} differs from the reference by {off:.1e} near home, where the "
                f"robot is too ill-conditioned for doubles; move its home, or soften its stiffest parts"
            )
        found.append(max(SAME, ROUNDINGS * off))
    return tuple(found)


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
    legs, moving = leg_sag(mechanism), MOVING * (leg_sag(mechanism) > 0)
    found[at.joints] += legs * rng.normal(size=len(legs))
    found[at.joint_rates] += moving * rng.normal(size=len(legs))
    try:
        return projected(mechanism, state_of(mechanism, found))
    except InputError:
        return x


def sag(mechanism: Mechanism) -> Array:
    """Modal coordinates (N,) of the order of the bend under the platform's weight, and never large."""
    return sag_of(mechanism.robot.platform, MOVED * mechanism.size)


def leg_sag(mechanism: Mechanism) -> Array:
    """(n,) of the coordinates that the legs carry: of elastic ones their sag, of joints zero."""
    found = np.zeros(mechanism.layout.carried)
    for leg, place in zip(mechanism.robot.legs, mechanism.layout.by_leg[1], strict=True):
        bodies = [joint.body for joint in leg.joints if joint.body is not None]
        parts = [sag_of(body, MOVED * mechanism.size) for body in bodies]
        drives = [leg.joints[j] for j in leg.drives]
        given = [GRAVITY * joint.IA / (joint.drive_stiffness or 1.0) for joint in drives]
        found[place] = np.concatenate([*parts, np.minimum(given, MOVED * mechanism.size)])
    return found


def sag_of(body: FlexibleBody, most: float) -> Array:
    """Modal coordinates (N,) of the order of a body's bend under its weight, of at most so many metres."""
    period = np.diagonal(body.m_ee) / np.maximum(body.stiffness, 1e-300)
    return np.asarray(np.sqrt(body.moments.m) * np.minimum(GRAVITY * period, most))
