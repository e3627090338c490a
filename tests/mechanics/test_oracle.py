"""The library against the oracle, on the paper's robot. `test_cases.py` holds both against stored cases."""

from typing import NamedTuple

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import oracle
import parflex as pf
from paper_robot import DAMPING_RATIO, PLATE, corners

pytestmark = pytest.mark.filterwarnings("ignore:.*cut a degenerate pair")

# Errors are max|Δ| / max(1, max|x|) of a block of one state.
LIBRARY = 1e-10  # two solutions in 64 bits, near singular poses too: round-off leaves 1e-12
SAME = 1e-12  # the same operations, but sums may be split otherwise
SAME_MODES = 1e-11  # the same eigenvalue problem solved twice; threads may add in another order

STATES = {0: 100, 1: 100, 10: 100, 40: 30}  # by number of modes
BACKENDS = ("numpy", "vm")


def error(found, wanted):
    """The largest error over the states, which are the first axis."""
    found, wanted = (np.reshape(x, (len(wanted), -1)) for x in (found, wanted))
    size = np.max(np.abs(wanted), axis=1, initial=1.0)
    return np.max(np.max(np.abs(found - wanted), axis=1, initial=0.0) / size)


class Problem(NamedTuple):
    """A robot, states of it, what is given, and what the oracle finds."""

    robot: pf.Robot
    cloud: oracle.NodalPlatform
    states: pf.State
    forces: np.ndarray
    target: np.ndarray
    wrenches: list
    direct: oracle.Motion
    inverse: oracle.Motion


def problem(robot, cloud, count, elastic, elastic_rate, static, rng, node=None):
    """Random states within 0.1 m and 0.1 rad of home, random forces about the static ones, random targets;
    a random world force on `node`; the oracle's answers."""
    place, axes = robot.home_pose
    states = pf.State(
        position=np.add(place, rng.uniform(-0.1, 0.1, (count, 3))),
        rotation=axes @ Rotation.from_rotvec(rng.uniform(-0.1, 0.1, (count, 3))).as_matrix(),
        twist=rng.normal(0.0, 0.5, (count, 6)),
        elastic=elastic * rng.standard_normal((count, len(elastic))),
        elastic_rate=elastic_rate * rng.standard_normal((count, len(elastic))),
    )
    forces = static + rng.uniform(-300.0, 300.0, (count, len(static)))
    target = rng.uniform(-1.0, 1.0, (count, 6)) * [2, 2, 2, 4, 4, 4]
    pushes = rng.uniform(-200.0, 200.0, (count, 3))
    wrenches = [] if node is None else [pf.Wrench(node, pushes)]
    direct, inverse = [], []
    for s in range(count):
        state = states[s]
        load = None if node is None else cloud.node_force(state, node, pushes[s])
        system = oracle.system(robot, cloud, state, generalised_wrench=load)
        direct.append(oracle.direct_of(system, forces[s]))
        inverse.append(oracle.inverse_of(system, target[s]))
    return Problem(
        robot, cloud, states, forces, target, wrenches, oracle.stacked(direct), oracle.stacked(inverse)
    )


@pytest.fixture(scope="module", params=list(STATES))
def plate(request):
    """The paper's plate with N modes; higher ones bend and move less, as q ∝ ω⁻² and q̇ ∝ ω⁻¹."""
    robot = pf.robots.gough_stewart(modes=request.param)
    cloud = oracle.plate_cloud(corners(), **PLATE, n_modes=request.param, damping_ratio=DAMPING_RATIO)
    omega = np.sqrt(cloud.stiffness)
    softer = omega[:1] / omega
    static = pf.Model(robot, backend="numpy").equilibrium(*robot.home_pose)[1]
    rng = np.random.default_rng(request.param)
    count = STATES[request.param]
    return problem(robot, cloud, count, 0.01 * softer**2, 0.1 * softer, static, rng)


FREQUENCIES = {"stiff": np.array([200.0, 310.0, 420.0, 560.0, 730.0, 900.0]), "free": np.zeros(6)}


@pytest.fixture(scope="module", params=list(FREQUENCIES))
def blob(request):
    """An asymmetrical cloud with random shapes: ∫Φ dm and ∫ r × Φ dm are not zero, nor is the centre of mass
    the origin. 'free' has no stiffness and more deflection, so that inertia is not hidden."""
    omega, held, nodes = FREQUENCIES[request.param], [34, 3, 11, 20, 58, 47], 60
    rng = np.random.default_rng(7)
    positions = rng.uniform(-1.0, 1.0, (nodes, 3)) * [0.5, 0.5, 0.15]
    positions[held] = np.pad(corners(), ((0, 0), (0, 1))) + rng.uniform(-0.05, 0.05, (6, 3))
    positions += [0.06, -0.08, 0.05]
    masses = rng.uniform(0.2, 2.5, nodes)
    orthogonal = np.linalg.qr(rng.standard_normal((3 * nodes, len(omega))))[0]
    shapes = orthogonal.T.reshape(-1, nodes, 3) / np.sqrt(masses)[:, None]  # ΦᵀMΦ = 1
    rotations, zeta = rng.standard_normal(shapes.shape), rng.uniform(0.01, 0.3, len(omega))
    rigid = pf.FlexibleBody.from_nodes(positions, masses, shapes[:0], omega[:0], 0.0, held)
    stiff_robot = pf.robots.gough_stewart(platform=rigid)
    static = pf.Model(stiff_robot, backend="numpy").equilibrium(*stiff_robot.home_pose)[1]
    body = pf.FlexibleBody.from_nodes(positions, masses, shapes, omega, zeta, held, rotations)
    robot = pf.robots.gough_stewart(platform=body)
    cloud = oracle.nodal_platform(positions, masses, shapes, omega, zeta, held)
    softer = omega[0] / omega if np.all(omega) else np.full(6, np.sqrt(10.0))
    return problem(robot, cloud, 100, 0.01 * softer**2, 0.1 * softer, static, rng, node=17)


def errors_of(problem, backend):
    """Direct and inverse model of the library against the oracle, by block."""
    model = pf.Model(problem.robot, backend=backend)
    direct = model.direct(problem.states, problem.forces, problem.wrenches)
    inverse = model.inverse(problem.states, problem.target, wrenches=problem.wrenches)
    pairs = {"direct": (direct, problem.direct), "inverse": (inverse, problem.inverse)}
    return {
        f"{name}.{field}": error(getattr(found, field), getattr(wanted, field))
        for name, (found, wanted) in pairs.items()
        for field in found._fields
    }


@pytest.mark.parametrize("backend", BACKENDS)
def test_plate_on_six_legs(plate, backend):
    """The paper's robot, rigid and with the modes of its plate."""
    errors = errors_of(plate, backend)
    assert max(errors.values()) <= LIBRARY, errors


@pytest.mark.parametrize("backend", BACKENDS)
def test_nodal_body_with_external_force(blob, backend):
    """Every inertia integral of a body without symmetry, and a world force on one of its nodes."""
    errors = errors_of(blob, backend)
    assert max(errors.values()) <= LIBRARY, errors


def test_direct_and_inverse_by_name(blob):
    """The short calls answer as the ones on an assembled system, which the comparisons above use."""
    force = blob.wrenches[0].force[0]
    state, robot, cloud = blob.states[0], blob.robot, blob.cloud
    load = cloud.node_force(state, blob.wrenches[0].node, force)
    direct = oracle.direct(robot, cloud, state, blob.forces[0], generalised_wrench=load)
    inverse = oracle.inverse(robot, cloud, state, blob.target[0], generalised_wrench=load)
    found = (*direct[:3], *direct[3], *inverse)
    wanted = (*blob.direct[:3], *blob.direct[3], blob.inverse.forces, blob.inverse.elastic)
    assert all(error([x], y[:1]) <= SAME for x, y in zip(found, wanted, strict=True))


def test_external_force_matters(blob):
    """Without the force the answers differ: the comparison above does see it."""
    model = pf.Model(blob.robot, backend="numpy")
    free = model.direct(blob.states, blob.forces)
    assert error(free.platform, blob.direct.platform) > 1e-3


@pytest.mark.parametrize("modes", [10, 40])  # 10 cuts a degenerate pair
def test_plate_cloud_has_the_modes_of_the_plate(modes):
    """Number, order and signs of the modes at the corners, frequencies, mass, and unit modal mass."""
    cloud = oracle.plate_cloud(corners(), **PLATE, n_modes=modes)
    computed = pf.fe.plate_modes(corners(), **PLATE, n_modes=modes)
    at_corners = np.moveaxis(computed.shapes[:, list(computed.corners)], 0, -1)
    flat = cloud.shapes.reshape(modes, 3 * len(cloud.masses))
    modal_mass = (flat * np.repeat(cloud.masses, 3)) @ flat.T
    assert error([cloud.attachment_shapes], [at_corners]) <= SAME_MODES
    assert error([cloud.stiffness], [computed.frequencies**2]) <= SAME_MODES
    assert error([np.sum(cloud.masses)], [computed.moments.m]) <= SAME_MODES
    assert error([modal_mass], [np.eye(modes)]) <= SAME_MODES
