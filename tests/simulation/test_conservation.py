"""Conservation laws: what no force changes stays, and energy is accounted for."""

import numpy as np
import pytest

import parflex as pf
from parflex.base.array import mv
from parflex.mechanics.platform import platform_terms
from parflex.robot.layout import Layout, coordinates, pack

MOMENTUM = 1e-11  # over 2 s at rtol 1e-12
BALANCE = 1e-10  # of the largest term, at rtol 1e-10


def lumped_body(rng, modes=6, count=30):
    """A body with ∫ Φ dm ≠ 0, ∫ r × Φ dm ≠ 0 and its centre of mass off the origin."""
    masses = rng.uniform(0.5, 2.0, count)
    raw = rng.normal(size=(modes, count * 3))
    gram = (raw * np.repeat(masses, 3)) @ raw.T
    shapes = (np.linalg.inv(np.linalg.cholesky(gram)) @ raw).reshape(modes, count, 3)
    return pf.FlexibleBody.from_nodes(
        rng.normal(size=(count, 3)), masses, shapes, rng.uniform(40, 90, modes), 0.0
    )


@pytest.mark.parametrize("kind", ["plate", "lumped"])
def test_free_platform_keeps_its_momentum(kind):
    """No legs, no gravity, no damping: linear and angular momentum about Σ0, by sums of M_p (V, q̇)."""
    rng = np.random.default_rng(3)
    body = pf.robots.gough_stewart(9, damping_ratio=0.0).platform if kind == "plate" else lumped_body(rng)
    model = pf.Model(pf.Robot((), body, gravity=(0, 0, 0)))
    N, omega = body.modes, np.sqrt(body.stiffness)
    start = pf.State(
        (0.1, 0.2, 0.3),
        np.eye(3),
        rng.normal(0, 0.5, 6),
        0.01 * (omega[0] / omega) ** 2 * rng.normal(size=N),
        0.1 * (omega[0] / omega) * rng.normal(size=N),
    )
    run = pf.simulate(model, np.zeros(0), start, np.linspace(0, 2, 21), rtol=1e-12, atol=1e-14)
    assert not run.partial
    data = run.dataset
    x = coordinates(pack(pf.State(*(data[n].values for n in (
        "position", "rotation", "twist", "elastic", "elastic_rate"))), Layout(N)), Layout(N))  # fmt: skip
    terms = platform_terms(body, x.twist[:, 3:], x.elastic, x.elastic_rate, np.zeros(3))
    h = mv(terms.A_rr, x.twist) + mv(terms.A_re, x.elastic_rate)
    linear = mv(x.rotation, h[:, :3])
    angular = np.cross(x.position, linear) + mv(x.rotation, h[:, 3:])
    for momentum in (linear, angular):
        assert np.max(np.abs(momentum - momentum[0])) <= MOMENTUM * max(1, np.max(np.abs(momentum)))
    assert np.max(np.abs(data.energy_residual)) <= BALANCE * float(data.energy_kinetic.max())
    R = data.rotation.values
    assert np.max(np.abs(np.swapaxes(R, -1, -2) @ R - np.eye(3))) <= 1e-12


def test_lumped_momentum_is_that_of_the_nodes():
    """M_p (V, q̇_e) of the moment tensors against Σ m v and Σ m ρ × v over the nodes."""
    rng = np.random.default_rng(4)
    body = lumped_body(rng)
    masses = rng_masses(4)
    V, q, qd = rng.normal(size=6), rng.normal(size=6), rng.normal(size=6)
    terms = platform_terms(body, V[3:], q, qd, np.zeros(3))
    rho = body.nodes + np.einsum("k,kna->na", q, body.shapes)
    v = V[:3] + np.cross(V[3:], rho) + np.einsum("k,kna->na", qd, body.shapes)
    expected = np.concatenate([masses @ v, masses @ np.cross(rho, v)])
    found = terms.A_rr @ V + terms.A_re @ qd
    assert np.max(np.abs(found - expected)) <= 1e-12 * np.max(np.abs(expected))


def rng_masses(seed):
    """The masses that `lumped_body` draws first."""
    return np.random.default_rng(seed).uniform(0.5, 2.0, 30)


def test_energy_balances_under_constant_forces(model_of):
    """Undamped, forces 2 % above the static ones, half a second (then it falls over)."""
    model = model_of(10, "vm", damping_ratio=0.0)
    _, forces = model.equilibrium(*model.robot.home_pose)
    check_balance(pf.simulate(model, 1.02 * forces, model.robot.home, np.linspace(0, 0.5, 51), rtol=1e-10))


def test_energy_balances_under_a_joint_controller(model_of):
    """Undamped, held by springs and dampers at the joints, 2 s, from the flat plate."""
    model = model_of(10, "vm", damping_ratio=0.0)
    _, forces = model.equilibrium(*model.robot.home_pose)
    hold = pf.JointPD(model, model.robot.home, kp=2e5, kd=2e3, forces=forces)
    check_balance(pf.simulate(model, hold, model.robot.home, np.linspace(0, 2, 101), rtol=1e-10))


def test_energy_balances_with_wrenches_and_damping(model_of):
    """A force on the plate's centre that swings, damped modes: every term of the ledger is at work."""
    model = model_of(10, "vm")
    start, forces = model.equilibrium(*model.robot.home_pose)
    hold = pf.JointPD(model, start, kp=2e5, kd=2e3, forces=forces)
    run = pf.simulate(
        model,
        hold,
        start,
        np.linspace(0, 1, 51),
        rtol=1e-10,
        wrenches=lambda t: [pf.Wrench(0, (0, 0, 200 * np.sin(40 * t)), (5, 0, 0))],
    )
    check_balance(run)
    for name in ("energy_wrenches", "energy_dissipated", "energy_actuators"):
        assert np.max(np.abs(run.dataset[name])) > 1e-3


def check_balance(run):
    """The residual against the largest term that changes."""
    assert not run.partial, run.stopped
    names = [n for n in run.dataset if n.startswith("energy_") and n != "energy_residual"]
    largest = max(float(np.max(np.abs(run.dataset[n] - run.dataset[n][0]))) for n in names)
    assert float(np.max(np.abs(run.dataset.energy_residual))) <= BALANCE * largest


def test_rigid_plate_is_the_hexagon_of_the_textbook():
    """N = 0 against mass and inertia of a hexagonal plate: I = m (5 s²/24 + h²/12), 5 m s²/12."""
    side, h = 0.5, 15e-3
    moments = pf.robots.gough_stewart(0).platform.moments
    m = 7.5e3 * h * 1.5 * np.sqrt(3) * side**2
    assert abs(moments.m - m) <= 1e-12 * m
    inertia = np.trace(moments.P0) * np.eye(3) - moments.P0
    expected = m * np.diag([5 * side**2 / 24 + h**2 / 12] * 2 + [5 * side**2 / 12])
    assert np.max(np.abs(inertia - expected)) <= 1e-12 * m


def test_rigid_body_equals_flexible_body_without_modes(model_of):
    """`FlexibleBody.rigid` with that inertia moves the robot as the plate with N = 0 does."""
    plate = model_of(0)
    moments = plate.robot.platform.moments
    inertia = np.trace(moments.P0) * np.eye(3) - moments.P0
    body = pf.FlexibleBody.rigid(moments.m, (0, 0, 0), inertia, plate.robot.platform.attachment_points)
    other = pf.Model(pf.robots.gough_stewart(platform=body), "numpy")
    state, forces = plate.equilibrium(*plate.robot.home_pose)
    found, expected = other.direct(state, forces + 100), plate.direct(state, forces + 100)
    assert np.max(np.abs(found.platform - expected.platform)) <= 1e-12
    assert np.max(np.abs(found.contact_forces - expected.contact_forces)) <= 1e-9


def test_payload_is_a_point_mass():
    """A body with a payload against the same body with one more node, by `from_nodes`."""
    rng = np.random.default_rng(5)
    bare = lumped_body(rng)
    loaded = bare.with_payload(7, 3.5)
    masses = rng_masses(5)
    masses[7] += 3.5
    q, qd, V = rng.normal(size=6), rng.normal(size=6), rng.normal(size=6)
    terms = platform_terms(loaded, V[3:], q, qd, np.zeros(3))
    rho = bare.nodes + np.einsum("k,kna->na", q, bare.shapes)
    v = V[:3] + np.cross(V[3:], rho) + np.einsum("k,kna->na", qd, bare.shapes)
    momentum = terms.A_rr @ V + terms.A_re @ qd
    expected = np.concatenate([masses @ v, masses @ np.cross(rho, v)])
    assert np.max(np.abs(momentum - expected)) <= 1e-12 * np.max(np.abs(expected))
    kinetic = 0.5 * (V @ momentum + qd @ terms.A_re.T @ V + qd @ loaded.m_ee @ qd)
    assert abs(kinetic - 0.5 * masses @ np.sum(v * v, axis=1)) <= 1e-12 * kinetic
    assert np.all(loaded.stiffness == bare.stiffness)
