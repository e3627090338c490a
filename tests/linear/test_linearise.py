"""Linear systems against differences of the direct model, and against themselves by other routes."""

from dataclasses import replace

import numpy as np
import pytest

import flexlegs
import parflex as pf
from compliant import compliant
from parflex.analysis.small_motions import slopes
from parflex.base.spatial import cayley
from parflex.linear.response import responses, solved
from parflex.mechanics.closure import displaced
from parflex.model.core import core_of
from published_hexapods import cubic
from soft import softened

GALLERY = [name for name in ("gough_stewart", "rus6", "pus6", "rps3", "prs3", "delta", "octapod")]


def at_rest(robot):
    model = pf.Model(robot, "numpy")
    return model, *model.equilibrium(*robot.home_pose)


def carried():
    """A hexapod one of whose legs carries its joints."""
    return replace(flexlegs.mixed("gs_flexlegs"), gravity=(0.0, 0.0, -9.81))


def robots():
    yield from ((name, getattr(pf.robots, name)(modes=5)) for name in GALLERY)
    yield "flexible legs", flexlegs.robot("gs_flexlegs")
    yield "mixed legs", carried()
    yield "delta with flexible arms", flexlegs.robot("delta_flexarms_foreshortening")
    yield "drives that give", compliant(pf.robots.gough_stewart(3), k=500.0)
    yield "drives on bent legs", compliant(flexlegs.mixed("gs_flexlegs"), (0, 2, 3))
    yield "soft tips", softened(flexlegs.mixed("gs_flexlegs"), ((1, 0), (5, 0)))
    everything = compliant(softened(flexlegs.mixed("gs_flexlegs"), ((1, 0), (5, 0))), (0, 2, 5))
    yield "drives and soft tips", everything
    yield "nano-hexapod", pf.robots.nano_hexapod(modes=4)
    yield (
        "soft and loaded",
        replace(cubic(1e-2, 2e4, 0.4, 10.0, (0.1, 0.1, 0.2), 30.0)[0], gravity=(0, 0, -9.81)),
    )


ROBOTS = dict(robots())

# the systems are compared with other routes to the same numbers, wherever they are, however they grow
pytestmark = [
    pytest.mark.filterwarnings("ignore::parflex.base.errors.BeyondBasis"),
    pytest.mark.filterwarnings("ignore::parflex.base.errors.UnstableEquilibrium"),
]


@pytest.mark.parametrize("name", ROBOTS)
def test_slopes_are_those_of_the_direct_model(name):
    """K and C against central differences of the direct model along motions that the closure allows."""
    model, state, forces = at_rest(ROBOTS[name])
    lin = model.linearise(state, forces, friction="smoothed")
    core = core_of(model)
    law = lambda x: np.broadcast_to(forces, (*x.shape[:-1], len(forces)))  # noqa: E731
    found = slopes(core.readable, lin.point.x, lin.point.T, law)
    for mine, theirs in zip((lin.point.K, lin.point.C), found, strict=True):
        assert np.max(np.abs(mine - theirs)) <= 1e-8 * max(np.max(np.abs(lin.point.K)), 1.0)


@pytest.mark.parametrize("name", ["gough_stewart", "delta", "mixed legs"])
def test_responses_by_modes_and_by_solution_agree(name):
    model, state, forces = at_rest(ROBOTS[name])
    lin = model.linearise(state, forces, outputs=(pf.FramePose(), pf.Accelerometer(0), pf.StrutForce()))
    omega = np.geomspace(3.0, 3e3, 50)
    for eta in (0.0, 0.02):
        A, C = lin.A.astype(complex), lin.C.astype(complex)
        d = len(lin.point.K)
        A[d:, :d] += 1j * eta * lin.point.K
        C[:, :d] += lin.by_acceleration @ (1j * eta * lin.point.K)
        found, wanted = responses(lin, omega, eta), solved(A, lin.B, C, lin.D, omega)
        assert np.max(np.abs(found - wanted)) <= 1e-10 * np.max(np.abs(wanted))


def test_python_control_sees_the_same_system():
    """Poles, zeros and a step response of the StateSpace, against eigenvalues, the rank that defines
    zeros, and the exponential of A."""
    control = pytest.importorskip("control")
    from scipy.linalg import expm

    model, state, forces = at_rest(pf.robots.gough_stewart(modes=3))
    servo = pf.JointPD(model, state, kp=4e6, kd=2.5e4, forces=forces)
    lin = model.linearise(state, forces, outputs=(pf.FramePose(),), controller=servo)
    plant = lin.to_control()
    assert plant.input_labels == list(lin.inputs)
    assert plant.output_labels == list(lin.outputs)
    assert np.allclose(np.sort_complex(plant.poles()), np.sort_complex(lin.poles), rtol=1e-9)
    for zero in plant.zeros():
        system = np.block([[lin.A - zero * np.eye(len(lin.A)), lin.B], [lin.C, lin.D]])
        values = np.linalg.svd(system, compute_uv=False)
        assert values[-1] <= 1e-9 * values[0]
    times = np.linspace(0.0, 0.02, 5)
    step = control.step_response(plant["frame_z", "force[0]"], times).outputs
    at_end = [
        (lin.C @ np.linalg.solve(lin.A, (expm(lin.A * t) - np.eye(len(lin.A))) @ lin.B))[2, 0] for t in times
    ]
    assert np.allclose(step, at_end, atol=1e-9 * np.max(np.abs(at_end)))
    frd = lin.to_control([10.0, 100.0])
    assert np.allclose(frd(1j * np.array([10.0, 100.0])), lin.frf([10.0, 100.0]).values, rtol=1e-12)


def test_an_accelerometer_reads_what_it_would_when_moved():
    """The reading Cᵀ (ρ̈ − Rᵀ g) of displaced states and of other forces, by differences."""
    robot = pf.robots.gough_stewart(modes=4)
    model, state, forces = at_rest(robot)
    node, body, core = 7, robot.platform, core_of(model)
    lin = model.linearise(state, forces, outputs=(pf.Accelerometer(node),))

    def reading(x, u):
        s = core.state(x)
        a = model.direct(s, u)
        own = body.rotation_shapes[:, node].T
        C = cayley(own @ s.elastic, own)[0]
        place = body.nodes[node] + body.shapes[:, node].T @ s.elastic
        W = np.concatenate([np.eye(3), np.cross(np.eye(3), place).T], axis=1)
        moved = W @ a.platform + body.shapes[:, node].T @ a.elastic
        return C.T @ (moved - s.rotation.T @ robot.gravity)

    step = 1e-6
    for k, column in enumerate(lin.point.T.T):
        x = [displaced(core.mechanism, lin.point.x, sign * step * column) for sign in (1, -1)]
        slope = (reading(x[0], forces) - reading(x[1], forces)) / (2 * step)
        assert np.allclose(slope, lin.C[:, k], atol=1e-6 * np.max(np.abs(lin.C)))
    pushed = reading(lin.point.x, forces + np.eye(6)[2]) - reading(lin.point.x, forces)
    assert np.allclose(pushed, lin.D[:, 2], rtol=1e-7, atol=1e-9)


def test_a_reference_moves_its_joint():
    """At rest the joints are where their springs' rests put them, J⁻¹ and stiffness aside (identity)."""
    robot, _ = cubic(1e-2, 1e6, 0.4, 10.0, (0.1, 0.1, 0.2))
    model, state, forces = at_rest(robot)
    lin = model.linearise(state, forces, inputs=(pf.Reference(),), outputs=(pf.JointMotion(),))
    assert np.allclose(lin.frf([0.0]).values[..., 0], np.eye(6), atol=1e-12)


def test_a_servo_closes_the_loop():
    """Poles under kp, kd and ki against `small_motions`, which forms them from S and B."""
    model, state, forces = at_rest(pf.robots.gough_stewart(modes=5))
    motions = core_of(model).at_home
    kp, kd, ki = (np.full(6, value) for value in (4e6, 2.5e4, 1e7))

    class Gains:
        pass

    gains = Gains()
    gains.kp, gains.kd, gains.ki = kp, kd, ki
    lin = model.linearise(state, forces, controller=gains)
    found, wanted = (np.sort_complex(poles) for poles in (lin.poles, motions.servo_poles(kp, kd, ki)))
    assert np.allclose(found, wanted, rtol=1e-7, atol=1e-6)


def test_locked_motors():
    """The poles against those of `small_motions`, which locks with forces instead of leaving motions out."""
    model, state, forces = at_rest(pf.robots.delta(modes=4))
    lin = model.linearise(state, forces, controller="locked")
    wanted = core_of(model).at_home.locked_poles()
    assert np.allclose(np.sort_complex(lin.poles), wanted, rtol=1e-7, atol=1e-6)


def rubbing():
    robot, _ = cubic(1e-2, 1e6, 0.4, 10.0, (0.1, 0.1, 0.2))
    first = robot.legs[0]
    joints = (*first.joints[:2], replace(first.joints[2], Fs=5.0, v_s=1e-3))
    return replace(robot, legs=(replace(first, joints=joints), *robot.legs[1:]))


def test_coulomb_friction_at_rest_is_left_out_smoothed_or_sticks():
    """Left out it is the robot without, smoothed it damps with F_s / v_s = 5,000 N s/m; stuck it takes a
    freedom, as a spring of 1e13 N/m does."""
    robot = rubbing()
    model, state, forces = at_rest(robot)
    plain, smoothed, stuck = (
        model.linearise(state, forces, friction=f) for f in ("viscous", "smoothed", "stuck")
    )
    bare = cubic(1e-2, 1e6, 0.4, 10.0, (0.1, 0.1, 0.2))[0]
    other = pf.Model(bare, "numpy").linearise(state, forces)
    assert np.allclose(plain.modes().frequency, other.modes().frequency, rtol=1e-10)
    assert np.max(smoothed.modes().damping) > 0.01
    assert len(stuck.A) == len(plain.A) - 2
    stiff = replace(robot.legs[0].joints[2], Fs=0.0, k=1e13)
    first = replace(robot.legs[0], joints=(*robot.legs[0].joints[:2], stiff))
    locked = pf.Model(replace(bare, legs=(first, *bare.legs[1:])), "numpy").linearise(state, forces)
    assert np.allclose(stuck.modes().frequency, locked.modes().frequency[:5], rtol=1e-6)


NODE = len(pf.robots.gough_stewart(modes=2).platform.nodes)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (dict(inputs=(pf.NodeWrench(NODE),)), "the platform has nodes 0"),
        (dict(outputs=(pf.FramePose(), pf.FramePose())), "frame_x twice"),
        (dict(inputs=(pf.Reference(),)), "no actuated joint has one"),
        (dict(friction="dry"), "friction is 'dry'; choose one of viscous, smoothed, stuck"),
        (dict(friction="stuck"), "no joint has Coulomb friction"),
        (dict(controller=object()), "controller is object, which has no gains"),
        (dict(inputs=("force",)), "inputs"),
    ],
)
def test_what_cannot_be_linearised_is_said(given, words):
    model, state, forces = at_rest(pf.robots.gough_stewart(modes=2))
    with pytest.raises(pf.InputError, match=words):
        model.linearise(state, forces, **given)


def test_no_equilibrium_no_linear_system():
    model, state, forces = at_rest(pf.robots.gough_stewart(modes=2))
    with pytest.raises(pf.InputError, match="no equilibrium under these forces: .* N are left"):
        model.linearise(state, 1.1 * forces)
    with pytest.raises(pf.InputError, match="state moves, with rates up to 0.1"):
        model.linearise(replace(state, twist=(0.1, 0, 0, 0, 0, 0)), forces)
    with pytest.raises(pf.InputError, match="of\" is|NodeMotion.of is 'jerk'"):
        pf.NodeMotion(0, of="jerk")
