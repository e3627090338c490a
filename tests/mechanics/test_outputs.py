"""Outputs of the inverse model: points and tools, spare actuators, and what bending makes of their gains."""

import warnings
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.spatial.transform import Rotation

import cases
import oracle
import parflex as pf
import zoo
from measures import relative
from parflex.analysis import gains as singular
from rewriting import reframed

LIBRARY = 1e-9  # the accuracy the library promises

pytestmark = pytest.mark.filterwarnings("ignore:.*beyond a dynamic singularity")


@cache
def model_of(name, kind, backend="numpy"):
    return pf.Model(cases.case(name, kind).robot, backend)


@cache
def turning():
    """A 6-UPS under a body of 3 modes with rotation shapes of its own, and three of its states."""
    sample, rng = zoo.ups(6, 3), np.random.default_rng(5)
    body = replace(sample.body, rotation_shapes=rng.normal(0.0, 0.3, sample.body.shapes.shape))
    return pf.Model(replace(sample.robot, platform=body), "numpy"), sample.platform[:3]


def point_of(body, state, output):
    """World place (3,) of the point: p + R (r + Φ_d q + offset + θ × offset), θ = Φ_r q."""
    q = state.elastic + np.zeros(body.modes)
    turn = np.zeros(3) if body.rotation_shapes is None else q @ body.rotation_shapes[:, output.node]
    offset = np.asarray(output.offset)
    place = body.nodes[output.node] + q @ body.shapes[:, output.node] + offset + np.cross(turn, offset)
    return state.position + state.rotation @ place


# --- points ---

POINTS = {
    "node": pf.PointOutput(7, rows=(0, 1, 2)),
    "two rows": pf.PointOutput(3, rows=(2, 0)),
    "tool": pf.PointOutput(12, (0.05, -0.1, 0.3)),
    "tool that turns": pf.PointOutput(12, (0.05, -0.1, 0.3), range(6)),
}


@pytest.mark.parametrize("name", POINTS)
def test_point_acceleration_is_that_of_a_run(name):
    """The first derivative of its velocity over a run under the forces of the inverse model, by a polynomial
    through five moments of 0.4 ms, good to 1e-4 (modes to 600 rad/s); the velocity is its place's."""
    (model, states), output = turning(), POINTS[name]
    body, rng = model.robot.platform, np.random.default_rng(1)
    state = replace(states[0], elastic=1e-3 * np.ones(3), elastic_rate=np.array([0.3, -0.2, 0.1]))
    target = rng.uniform(-2.0, 2.0, output.size)
    forces = model.inverse(state, target, output).forces
    times = 1e-4 * np.arange(5)
    run = pf.simulate(running(), forces, state, times, rtol=1e-12, atol=1e-14)
    moments = [state, *(run.state(i) for i in range(1, 5))]
    velocities = np.array([velocity_of(body, moment, output) for moment in moments])
    slopes = np.linalg.solve(np.vander(times[1:], 5, increasing=True)[:, 1:], velocities[1:] - velocities[0])
    R = np.asarray(state.rotation)
    measured = np.concatenate([R.T @ slopes[0][:3], R.T @ slopes[0][3:]])[list(output.axes)]
    assert relative(measured, target) <= 1e-4
    places = np.array([point_of(body, moment, output) for moment in moments])
    passed = (places[2] - places[0]) / (times[2] - times[0])
    assert relative(passed, velocities[1][:3]) <= 2e-5


@cache
def running():
    return pf.Model(turning()[0].robot, "vm")


def velocity_of(body, state, output):
    """World velocity and angular velocity of the point: the derivative of its place, written out."""
    R, q = np.asarray(state.rotation), state.elastic + np.zeros(body.modes)
    qd = state.elastic_rate + np.zeros(body.modes)
    v, omega = np.reshape(state.twist, (2, 3))
    turn, turning = (x @ body.rotation_shapes[:, output.node] for x in (q, qd))
    offset = np.asarray(output.offset)
    r = body.nodes[output.node] + q @ body.shapes[:, output.node] + offset + np.cross(turn, offset)
    rd = qd @ body.shapes[:, output.node] + np.cross(turning, offset)
    return np.concatenate([R @ (v + np.cross(omega, r) + rd), R @ (omega + turning)])


@pytest.mark.parametrize("kind", ["rigid", "flex", "nostiff"])
@pytest.mark.parametrize("name", cases.NAMES)
def test_node_acceleration_by_the_oracle(name, kind):
    """The world acceleration J u̇ + γ of a node, from the oracle's answer to the forces of the inverse model.
    A tip of the 3-RPS keeps to a plane: one row of it, for which three actuators are more than enough."""
    sample, model = cases.case(name, kind), model_of(name, kind)
    node = sample.body.attachments[1]
    output = pf.PointOutput(node, rows=(2,) if name == "rps3" else (0, 1, 2))
    cloud, rng = sample.cloud, np.random.default_rng(3)
    r, Phi = cloud.attachments[[1]], cloud.attachment_shapes[[1]]
    for s in (0, 4):
        target = rng.uniform(-1.0, 1.0, output.size)
        found = model.inverse(sample.states[s], target, output)
        motion = oracle.direct_of(sample.systems[s], found.forces)
        R, state = np.asarray(sample.platform.rotation[s]), sample.platform[s]
        world = np.concatenate([R @ motion.platform[:3], R @ motion.platform[3:], motion.elastic])
        _, _, J, drift = cloud.point_motion(state, r, Phi)
        measured = (R.T @ (J[0] @ world + drift[0]))[list(output.rows)]
        assert relative(measured, target) <= LIBRARY


@pytest.mark.parametrize("backend", ["numpy", "vm"])
def test_inverse_after_direct_at_a_point(backend):
    """The acceleration of a tool under known forces, wanted again, asks for the same forces; as a batch."""
    numpy_model, states = turning()
    model = pf.Model(numpy_model.robot, backend)
    output, rng = pf.PointOutput(12, (0.05, -0.1, 0.3), range(6)), np.random.default_rng(2)
    x = states[1]
    body = model.robot.platform
    forces = rng.uniform(-200, 200, (2, 3, 6))
    there = model.direct(x, forces)
    # a = v̇ + ω̇ × r + ω × (ω × r) + 2 ω × ṙ + r̈, α = ω̇ + θ̈ + ω × θ̇, in Σp
    q, qd = x.elastic, x.elastic_rate
    Phi, Psi, o = body.shapes[:, 12], body.rotation_shapes[:, 12], np.array([0.05, -0.1, 0.3])
    place = Phi + np.cross(Psi, o)
    r, rd, rdd = body.nodes[12] + o + q @ place, qd @ place, there.elastic @ place
    omega, omegad = x.twist[3:], there.platform[..., 3:]
    linear = there.platform[..., :3] + np.cross(omegad, r) + np.cross(omega, np.cross(omega, r))
    linear = linear + 2 * np.cross(omega, rd) + rdd
    angular = omegad + there.elastic @ Psi + np.cross(omega, qd @ Psi)
    back = model.inverse(x, np.concatenate([linear, angular], axis=-1), output)
    assert relative(back.forces, forces) <= LIBRARY
    assert relative(back.platform, there.platform) <= LIBRARY
    assert relative(back.elastic, there.elastic) <= LIBRARY


def test_a_tool_on_a_rigid_platform_needs_no_rotation_shapes():
    """On one that bends without them it is refused."""
    rigid, flexible = model_of("rus6", "rigid"), model_of("rus6", "flex")
    output = pf.PointOutput(0, (0, 0, 0.1), range(6))
    assert rigid.inverse(rigid.robot.home, np.zeros(6), output).forces.shape == (6,)
    for wrong in (output, pf.PointOutput(0, rows=(3,))):
        with pytest.raises(pf.InputError, match="no rotation shapes"):
            flexible.inverse(flexible.robot.home, np.zeros(wrong.size), wrong)


# --- spare actuators ---


@pytest.mark.parametrize("modes", [0, 3])
def test_spare_actuators_stay_near_their_preload(modes):
    """Γ − Γ_0 has no part in the null space of the map from Γ to the output, by differences of the direct
    model; along that null space forces change nothing."""
    sample = zoo.ups(8, modes)
    model, rng = pf.Model(sample.robot, "numpy"), np.random.default_rng(0)
    state, target = sample.platform[0], sample.target[0]
    gain = model.direct(state, 100 * np.eye(8)).platform - model.direct(state, np.zeros(8)).platform
    spare = null_space(gain.T, rcond=1e-10)
    assert spare.shape == (8, 2)
    preload = rng.uniform(-500, 500, 8)
    for wanted, bias in ((0.0, None), (preload, preload)):
        forces = model.inverse(state, target, preload=bias).forces
        assert np.max(np.abs(spare.T @ (forces - wanted))) <= 1e-8
        assert relative(model.direct(state, forces).platform, target) <= LIBRARY
        other = model.direct(state, forces + spare @ [300.0, -200.0])
        assert relative(other.platform, target) <= LIBRARY


def test_preload_of_a_robot_without_spare_actuators_changes_nothing():
    sample, model = cases.case("delta3", "flex"), model_of("delta3", "flex")
    free = model.inverse(sample.states, sample.target, sample.output)
    pressed = model.inverse(sample.states, sample.target, sample.output, preload=[50.0, -20.0, 10.0])
    assert relative(pressed.forces, free.forces) <= LIBRARY


def test_preloads_bring_leading_axes():
    """(2, 1, 8) against a batch of three targets."""
    sample = zoo.ups(8, 0)
    model, preload = pf.Model(sample.robot, "numpy"), np.random.default_rng(4).uniform(-99, 99, (2, 1, 8))
    found = model.inverse(sample.platform[0], sample.target[:3], preload=preload).forces
    assert found.shape == (2, 3, 8)
    one = model.inverse(sample.platform[0], sample.target[2], preload=preload[1, 0]).forces
    assert relative(found[1, 2], one) <= LIBRARY


def driven_hinges():
    """The 3-RPS with motors on its hinges too: six actuators, of N and N m, for three freedoms."""
    sample = cases.case("rps3", "rigid")
    legs = [replace(leg, joints=tuple(replace(j, mu=1) for j in leg.joints)) for leg in sample.legs]
    return pf.Model(pf.Robot(tuple(legs), sample.body, sample.gravity, sample.home_pose), "numpy")


@pytest.mark.parametrize("model", [driven_hinges, lambda: pf.Model(zoo.ups(8, 0).robot, "numpy")])
def test_static_forces_are_the_shortest(model):
    """The inverse model at rest, with Γ of least norm, is another route to them."""
    model = model()
    state, forces = model.equilibrium(*model.robot.home_pose)
    rows = (2, 3, 4) if model.robot.n_forces == 6 else range(6)
    shortest = model.inverse(state, np.zeros(len(rows)), pf.FrameOutput(tuple(rows))).forces
    assert relative(forces, shortest) <= LIBRARY
    assert np.max(np.abs(model.direct(state, forces).platform)) <= 1e-9


# --- gains ---


def test_gain_ratio_of_a_rigid_platform_is_one():
    for name in cases.NAMES:
        model = model_of(name, "rigid")
        report = model.output_report(model.robot.home, cases.case(name, "rigid").output)
        assert np.allclose(report.gain_ratio, 1.0, rtol=0, atol=1e-12)
        assert (report.sign, report.stable, len(report.poles)) == (1, True, 0)


def test_delta_accelerates_against_its_actuators():
    """The hub of the disc, soft on its rim, answers upwards with −1.8 % of the acceleration of a rigid one:
    by the oracle's answers to unit forces with and without modes, at the same pose."""
    model, sample = model_of("delta3", "flex"), cases.case("delta3", "flex")
    report = model.output_report(model.robot.home, sample.output)
    assert np.min(report.gain_ratio.real) == pytest.approx(-0.018, abs=5e-4)
    assert report.sign == -1
    assert not report.stable
    assert "opposite sign" in str(report)
    gains = []
    for kind in ("flex", "rigid"):
        body = replace(sample.cloud, **stiff(sample.cloud)) if kind == "rigid" else sample.cloud
        at = report.state
        still = pf.State(at.position, at.rotation, elastic=at.elastic if kind == "flex" else 0.0)
        q = list(model.joints(at).q)
        if kind == "rigid":  # held as it is bent: the points where the bent platform has them
            moved = sample.cloud.attachments + sample.cloud.attachment_shapes @ at.elastic
            bent = sample.cloud.positions + np.einsum("n,nka->ka", at.elastic, sample.cloud.shapes)
            body = replace(body, attachments=moved, positions=bent)
        system = oracle.system(sample, body, still, start=q)
        base = oracle.direct_of(system, np.zeros(3)).platform[:3]
        gains.append(np.stack([oracle.direct_of(system, u).platform[:3] - base for u in np.eye(3)], axis=1))
    ratios = np.linalg.eigvals(gains[0] @ np.linalg.inv(gains[1]))
    assert relative(np.sort(ratios.real), np.sort(report.gain_ratio.real)) <= 1e-8


def stiff(cloud):
    """A cloud without modes."""
    K, k = len(cloud.masses), len(cloud.attachments)
    return {
        "shapes": np.zeros((0, K, 3)),
        "stiffness": np.zeros(0),
        "damping": np.zeros(0),
        "attachment_shapes": np.zeros((k, 3, 0)),
    }


def test_computed_torque_beyond_a_dynamic_singularity_warns():
    """At the start of a run, once; the inverse model warns as well, and names the line that called it."""
    model, sample = model_of("delta3", "flex", "vm"), cases.case("delta3", "flex")
    start, _ = model.equilibrium(*model.robot.home_pose)
    way = pf.Trajectory.through(start, [((0, 0, 0.01), (0, 0, 0))], 0.1)
    control = pf.ComputedTorque(model, way, 100.0, 20.0, sample.output)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        pf.simulate(model, control, start, [0.0, 1e-4, 2e-4])
    assert [(w.category, w.filename) for w in caught] == [(pf.DynamicSingularity, __file__)]
    with pytest.warns(pf.DynamicSingularity, match="see model.output_report") as told:
        model.inverse(start, np.zeros(3), sample.output)
    assert [w.filename for w in told] == [__file__]


# --- zero dynamics ---


@pytest.mark.parametrize(("name", "kind"), [("rus6", "flex"), ("rps3", "flex"), ("delta3", "flex")])
def test_poles_by_the_oracle(name, kind):
    """From the oracle alone: with the output held, q̈_e = f(q_e, q̇_e) is its inverse model; the platform's
    other coordinates follow the bend so that closure and output hold. Central differences in q_e, q̇_e."""
    sample, model = cases.case(name, kind), model_of(name, kind)
    report = model.output_report(model.robot.home, sample.output)
    rows, N, eps = sample.rows, sample.body.modes, 1e-6
    at, q = report.state, list(model.joints(report.state).q)
    axes = np.array([i for i in range(6) if i not in rows], dtype=int)

    def elastic(bend, rate):
        state, joints, rates = held(sample, at, q, axes, bend, rate)
        system = oracle.system(sample, sample.cloud, state, start=joints, rates=rates)
        return oracle.inverse_of(system, np.zeros(len(rows)), rows).elastic

    still, one = np.zeros(N), np.eye(N)
    A = [elastic(eps * e, still) - elastic(-eps * e, still) for e in one]
    B = [elastic(still, eps * e) - elastic(still, -eps * e) for e in one]
    system = np.block([[np.zeros((N, N)), one], [np.transpose(A) / (2 * eps), np.transpose(B) / (2 * eps)]])
    expected = np.linalg.eigvals(system)
    for pole in report.poles:
        nearest = np.min(np.abs(expected - pole))
        assert nearest <= 1e-4 * np.max(np.abs(expected)), (pole, np.sort_complex(expected))
    assert len(report.poles) == 2 * N
    assert report.stable == bool(np.all(expected.real < 0))


def held(sample, at, q, axes, bend, rate):
    """The state with bend and rate added, on the closure again by `axes` of the pose and the joints."""
    state = replace(at, elastic=at.elastic + bend, elastic_rate=rate, joints=None, joint_rates=None)
    points = [tip.attachment for leg in sample.legs for tip in leg.tips]
    r, Phi = sample.cloud.attachments[points], sample.cloud.attachment_shapes[points]
    turn = np.kron(np.eye(2), state.rotation)

    def closure():
        trees = [oracle.tree(leg, q_i) for leg, q_i in zip(sample.legs, q, strict=True)]
        places, velocities, W, _ = sample.cloud.point_motion(state, r, Phi)
        J = [oracle.tip_rows(leg, J) for leg, (_, _, J) in zip(sample.legs, trees, strict=True)]
        rows = -W.reshape(-1, W.shape[-1])
        free = np.hstack([rows[:, :6] @ turn[:, axes], oracle.block_diag(*J)])
        gap = np.concatenate([tips for _, tips, _ in trees]) - places
        return gap.ravel(), velocities.ravel(), free

    for _ in range(8):
        gap, _, free = closure()
        step = np.linalg.lstsq(free, -gap, rcond=1e-12)[0]
        moved = np.zeros(6)
        moved[axes], joints = step[: len(axes)], step[len(axes) :]
        R = np.asarray(state.rotation)
        state = replace(
            state,
            position=state.position + R @ moved[:3],
            rotation=R @ Rotation.from_rotvec(moved[3:]).as_matrix(),
        )
        q = [a + b for a, b in zip(q, np.split(joints, np.cumsum([len(x) for x in q])[:-1]), strict=True)]
    _, velocities, free = closure()
    rates = np.linalg.lstsq(free, velocities, rcond=1e-12)[0]
    twist = np.zeros(6)
    twist[axes] = rates[: len(axes)]
    qd = np.split(rates[len(axes) :], np.cumsum([len(x) for x in q])[:-1])
    return replace(state, twist=twist), q, qd


def test_report_is_of_the_branch_that_the_joints_name():
    """Legs that carry their joints may stand otherwise than their postures: a crank folded the other way."""
    sample = cases.case("rus6", "rigid")
    model, folded = pf.Model(reframed(sample).robot, "numpy"), other_branch(sample)
    report = model.output_report(folded, pf.FrameOutput())
    assert np.allclose(report.state.joints[0], folded.joints[0], atol=1e-9)
    shortest = model.inverse(folded, np.zeros(6)).forces
    assert relative(report.forces, shortest) <= LIBRARY


def other_branch(sample):
    """The home pose with every leg's joints on the other side, found from postures reflected at the tip."""
    model = pf.Model(reframed(sample).robot, "numpy")
    home = model.robot.home
    q = model.joints(home).q
    rng = np.random.default_rng(0)
    for _ in range(50):
        guess = tuple(q_i + rng.uniform(-3, 3, 3) for q_i in q)
        try:
            found = model.joints(replace(home, joints=guess)).q
        except pf.InputError:
            continue
        if all(np.max(np.abs(np.sin((a - b) / 2))) > 0.1 for a, b in zip(found, q, strict=True)):
            return replace(home, joints=found)
    raise AssertionError("no other branch was found")


def test_report_of_a_singular_pose_says_so():
    """At Fichter's pose there is nothing to report."""
    model = zoo.six_ups(0.9, 0.5, 0.8, 0.2, 0.7, 90.0)
    with pytest.raises((pf.SingularPose, pf.NotConverged), match="singularity"):
        model.output_report(model.robot.home)


def test_flat_inverse_of_a_robot_with_three_freedoms():
    """`model.compiled(output)` gives what `model.inverse` gives."""
    sample = cases.case("rps3", "flex")
    model = pf.Model(sample.robot, "vm")
    flat = model.compiled(sample.output)
    x, target, out = flat.pack(sample.states[0]), sample.target[0].copy(), np.zeros(3 + 8)
    flat.inverse(x, target, out)
    expected = model.inverse(sample.states[0], target, sample.output)
    assert relative(out, np.concatenate([expected.forces, expected.elastic])) <= 1e-12
    with pytest.raises(pf.InputError, match=r"prescribes 6 accelerations, but the robot has 3"):
        model.compiled().inverse(x, np.zeros(6), np.zeros(11))


def test_an_output_that_no_actuator_moves():
    """A Delta does not turn: its angular rows have gains of round-off, however well they compare."""
    model = pf.Model(pf.robots.delta(0), "numpy")
    with pytest.raises(pf.SingularPose, match="no actuator moves the output at all"):
        model.inverse(model.robot.home, np.zeros(3), pf.FrameOutput((3, 4, 5)))


@pytest.mark.parametrize("n", [1, 2, 3, 6])
def test_determinants_bound_the_ratio_of_singular_values(n):
    """From below, and closely where all of them are alike; of matrices that are nearly singular, too."""
    rng = np.random.default_rng(n)
    A = rng.normal(size=(200, n, n))
    A[:100, 0] *= 10.0 ** rng.uniform(-12, 0, (100, 1))
    size = np.linalg.norm(A, axis=(-2, -1))
    bound = singular.smallest_ratio(np.linalg.det(A), size, n)
    assert np.all(bound <= singular.ratio(A) * (1 + 1e-9) + 1e-15)  # of round-off
    Q = np.linalg.qr(A[150])[0]
    assert singular.smallest_ratio(np.linalg.det(Q), np.linalg.norm(Q), n) > 0.25
