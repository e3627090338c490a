"""Wrong input ends in one sentence that names the field, the value and the remedy."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import cases
import parflex as pf
from paper_robot import PLATE, corners
from parflex.compiled import ALL_BACKENDS
from rewriting import reframed

NAN = float("nan")
HOME, UPRIGHT = (0.25, 0.433, 1.0), np.eye(3)


def nodes(**changes):
    """A good body of four nodes and one mode, with changes."""
    shape = np.zeros((1, 4, 3))
    shape[0, :, 2] = [0.5, -0.5, 0.5, -0.5]
    given = {
        "positions": np.array([[1.0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]]),
        "masses": np.ones(4),
        "shapes": shape,
        "frequencies": [10.0],
        "damping_ratio": 0.1,
        "attachments": [0, 1],
    }
    return pf.FlexibleBody.from_nodes(**(given | changes))


def leg(**changes):
    """The paper's leg with changes to its second joint."""
    good = pf.robots.gough_stewart(0).legs[0]
    joints = (good.joints[0], replace(good.joints[1], **changes), good.joints[2])
    return pf.Leg(good.rotation, good.origin, joints, good.tips)


def plate_of_one_mode():
    return pf.fe.plate_modes(corners(), n_modes=1, refine=1, **PLATE)


CASES = {
    "position of two": (lambda: pf.State((0, 0), UPRIGHT), r"State.position has shape \(2,\)"),
    "nan position": (lambda: pf.State((0, NAN, 0), UPRIGHT), r"State.position is nan at index \(1,\)"),
    "text for numbers": (lambda: pf.State("here", UPRIGHT), "not an array of numbers"),
    "sheared rotation": (
        lambda: pf.State(HOME, UPRIGHT + 0.01 * np.eye(3, k=1)),
        "State.rotation is not a rotation",
    ),
    "reflection": (lambda: pf.State(HOME, -UPRIGHT), "not a rotation"),
    "rotation in a batch": (
        lambda: pf.State(HOME, np.stack([UPRIGHT, 2 * UPRIGHT])),
        "State.rotation at index 1 is not a rotation",
    ),
    "unbroadcastable batch": (
        lambda: pf.State(np.zeros((3, 3)), np.stack([UPRIGHT] * 2)),
        "must broadcast together",
    ),
    "negative mass of a link": (lambda: leg(M=-1.0), "Joint.M is -1.0; it cannot be negative"),
    "sigma of two": (lambda: leg(sigma=2), "Joint.sigma is 2; it must be 0 or 1"),
    "unsymmetric inertia": (lambda: leg(I=np.eye(3, k=1)), "Joint.I is .*; it must be symmetric"),
    "a loop": (lambda: leg(antecedent=3), "joint 2 has antecedent 3"),
    "no tips": (lambda: pf.Leg(UPRIGHT, (0, 0, 0), leg().joints, ()), "Leg.tips is empty"),
    "tip on no link": (
        lambda: pf.Leg(UPRIGHT, (0, 0, 0), leg().joints, (pf.Tip(4),)),
        "Tip.frame is 4; this leg has links 1 … 3",
    ),
    "tip on a post's joint": (
        lambda: pf.Leg(UPRIGHT, (0, 0, 0), (), (pf.Tip(1),)),
        "Tip.frame is 1; this leg has no links, only its base, frame 0",
    ),
    "fewer attachments than legs": (
        lambda: pf.robots.gough_stewart(
            platform=pf.FlexibleBody.rigid(1.0, (0, 0, 0), np.eye(3), np.eye(5, 3))
        ),
        r"legs\[5\] holds attachment 5, but the platform has 5",
    ),
    "attachment held twice": (
        lambda: pf.Robot((leg(), leg()), nodes()),
        r"both hold attachment 0; list the node twice",
    ),
    "negative nodal mass": (lambda: nodes(masses=[1, 1, -1, 1]), r"masses\[2\] is -1.0"),
    "negative frequency": (lambda: nodes(frequencies=[-3.0]), r"frequencies\[0\] is -3.0"),
    "too many frequencies": (lambda: nodes(frequencies=[1, 2]), r"frequencies has shape \(2,\)"),
    "unnormalised shapes": (lambda: nodes(masses=2 * np.ones(4)), "ΦᵀMΦ differs from 1 by 1.00e[+]00"),
    "negative damping": (lambda: nodes(damping_ratio=-0.1), "damping_ratio is -0.1"),
    "attachment off the body": (lambda: nodes(attachments=[0, 9]), r"attachments\[1\] is node 9"),
    "impossible inertia": (
        lambda: pf.FlexibleBody.rigid(1.0, (0, 0, 0), np.diag([1.0, 1, 3]), np.eye(3)),
        "not the inertia of a body",
    ),
    "weightless body": (
        lambda: pf.FlexibleBody.rigid(0.0, (0, 0, 0), np.eye(3), np.eye(3)),
        "mass is 0.0; it must be positive",
    ),
    "payload of nothing": (lambda: nodes().with_payload(0, 0.0), "mass is 0.0"),
    "payload off the body": (lambda: nodes().with_payload(4, 1.0), "node is 4"),
    "crossing polygon": (
        lambda: pf.fe.plate_modes([(np.cos(a), np.sin(a)) for a in 0.8 * np.pi * np.arange(5)],
                                  n_modes=1, **PLATE),
        "polygon crosses itself",
    ),
    "hollow polygon": (
        lambda: pf.fe.plate_modes([(0, 0), (1, 0), (0.2, 0.2), (0, 1)], n_modes=1, **PLATE),
        r"polygon is not convex at corner 2, \[0.2 0.2\]",
    ),
    "two corners": (lambda: pf.fe.plate_modes([(0, 0), (1, 0)], n_modes=1, **PLATE), "at least 3"),
    "rubber": (
        lambda: pf.fe.plate_modes(corners(), n_modes=1, **(PLATE | {"poisson": 0.6})),
        "poisson is 0.6",
    ),
    "thickness of nothing": (
        lambda: pf.fe.plate_modes(corners(), n_modes=1, **(PLATE | {"thickness": 0})),
        "thickness is 0.0; it must be positive",
    ),
    "eleven published modes": (
        lambda: pf.robots.gough_stewart(11, frequencies="published"),
        'modes is 11, but frequencies="published" has the 10 of Table 2',
    ),
    "unknown frequencies": (lambda: pf.robots.gough_stewart(frequencies="measured"), "'measured'"),
    "unknown backend": (
        lambda: pf.Model(pf.robots.gough_stewart(0), "fortran"),
        """backend is .fortran.; this version has "numpy", "vm", "native" and "auto" """.strip(),
    ),
    "output of seven": (lambda: pf.FrameOutput((0, 6)), "FrameOutput.rows"),
    "frame of nowhere": (lambda: pf.Wrench(0, frame="moon"), "Wrench.frame is 'moon'"),
    "half a mode": (lambda: pf.robots.gough_stewart(2.5), "modes is 2.5; it must be a whole number"),
    "text for a joint number": (lambda: leg(antecedent="1"), "Joint.antecedent is '1'"),
    "a joint, not a list": (
        lambda: pf.Leg(UPRIGHT, (0, 0, 0), leg().joints[0], leg().tips),
        "Leg.joints is Joint",
    ),
    "a leg, not a list": (lambda: pf.Robot(leg(), nodes()), "Robot.legs is Leg; give a list"),
    "a name for a platform": (lambda: pf.Robot((), "plate"), "Robot.platform is str; expected"),
    "complex position": (lambda: pf.State((1j, 0, 0), UPRIGHT), "values of type complex128"),
    "half a node": (lambda: pf.Wrench(0.5), "Wrench.node is 0.5"),
    "no nodes": (lambda: nodes(positions=np.zeros((0, 3))), "positions is empty"),
    "ragged attachments": (
        lambda: pf.FlexibleBody.from_modes(plate_of_one_mode(), attachments=[(0, 0, 0), (1, 0)]),
        "attachments is ragged",
    ),
    "point off the body": (
        lambda: pf.FlexibleBody.from_modes(plate_of_one_mode(), attachments=[(9, 9, 9)]),
        "is on no node; the nearest",
    ),
    "more modes than unknowns": (
        lambda: pf.fe.plate_modes(corners(), n_modes=200, refine=1, **PLATE),
        "n_modes is 200, more than 156 unknowns can carry",
    ),
    "trajectory of one pose": (lambda: pf.Trajectory([HOME], [UPRIGHT], []), "n at least 2"),
    "negative duration": (
        lambda: pf.Trajectory([HOME, HOME], [UPRIGHT] * 2, [-1.0]),
        "must be positive",
    ),
    "text for a limit": (lambda: leg(q_min="low"), "Joint.q_min is not an array of numbers"),
    "no limit": (lambda: leg(q_max=None), "Joint.q_max is not an array of numbers"),
    "limits of two joints": (lambda: leg(q_min=np.zeros(2)), r"Joint.q_min has shape \(2,\)"),
    "no number for a limit": (lambda: leg(q_min=NAN), "Joint.q_min is nan"),
    "limits crossed": (lambda: leg(q_min=1.0, q_max=-np.inf), "q_min must be less"),
    "posture of one": (
        lambda: replace(pf.robots.gough_stewart(0).legs[0], posture=[0.0]),
        r"Leg.posture has shape \(1,\); expected \(3\)",
    ),
    "home of nowhere": (lambda: at_home(None), "Robot.home_pose is NoneType; give a pair"),
    "home without axes": (lambda: at_home((HOME,)), "Robot.home_pose is tuple; give a pair"),
    "home of two numbers": (lambda: at_home(((0, 0), UPRIGHT)), r"Robot.home_pose\[0\] has shape \(2,\)"),
    "mirrored home": (lambda: at_home((HOME, -UPRIGHT)), r"Robot.home_pose\[1\] is not a rotation"),
    "many homes": (lambda: at_home((HOME, [UPRIGHT] * 2)), r"Robot.home_pose\[1\] has shape \(2, 3, 3\)"),
    "nan joints": (
        lambda: pf.State(HOME, UPRIGHT, joints=((0.0, NAN),)),
        r"State.joints\[0\] is nan at index \(1,\)",
    ),
    "joints of no leg": (lambda: pf.State(HOME, UPRIGHT, joints=np.zeros(3)), "State.joints is ndarray"),
    "tool of two numbers": (lambda: pf.PointOutput(0, (0, 1)), r"PointOutput.offset has shape \(2,\)"),
    "point of seven rows": (lambda: pf.PointOutput(0, rows=(7,)), "PointOutput.rows is .7,.; name some"),
    "rows twice": (lambda: pf.PointOutput(0, rows=(1, 1)), "each once"),
    "half a point": (lambda: pf.PointOutput(0.5), "PointOutput.node is 0.5"),
}  # fmt: skip


def at_home(pose):
    """A body that no leg holds, at this home pose."""
    return pf.Robot((), nodes(), home_pose=pose)


def test_home_pose_is_kept_as_arrays():
    """What came as lists and whole numbers; the caller's arrays stay his own."""
    mine = np.eye(3)
    robot = at_home(([0, 0, 1], mine))
    mine[:] = 0
    assert robot.home_pose[0].dtype == float
    assert np.array_equal(robot.home_pose[1], UPRIGHT)


@pytest.mark.parametrize("name", CASES)
def test_refused_in_one_sentence(name):
    call, message = CASES[name]
    with pytest.raises(pf.InputError, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 400


@pytest.fixture(scope="module", params=["numpy", "vm"])
def model(request, model_of):
    return model_of(1, request.param)


def test_wrong_sizes_are_named(model):
    home = model.robot.home
    with pytest.raises(pf.InputError, match=r"forces has shape \(5,\); expected \(6\)"):
        model.direct(home, np.zeros(5))
    with pytest.raises(pf.InputError, match="forces is inf"):
        model.direct(home, [0, 0, np.inf, 0, 0, 0])
    with pytest.raises(pf.InputError, match=r"State.elastic has shape \(3,\); this platform has 1 modes"):
        model.direct(replace(home, elastic=np.zeros(3)), np.zeros(6))
    with pytest.raises(pf.InputError, match="target has shape"):
        model.inverse(home, np.zeros(3))
    with pytest.raises(pf.InputError, match="must broadcast together"):
        model.direct(pf.State(np.tile(HOME, (3, 1)), UPRIGHT), np.zeros((4, 6)))
    with pytest.raises(pf.InputError, match=r"wrenches\[0\].node is 99"):
        model.direct(home, np.zeros(6), [pf.Wrench(99, (1, 0, 0))])
    with pytest.raises(pf.InputError, match="wrenches is Wrench; give a list"):
        model.direct(home, np.zeros(6), pf.Wrench(0))
    with pytest.raises(pf.InputError, match="axes of the wrenches' forces and moments"):
        model.direct(home, np.zeros(6), [pf.Wrench(0, np.zeros((4, 3))), pf.Wrench(0, np.zeros((5, 3)))])
    with pytest.raises(pf.InputError, match="state is tuple; expected a State"):
        model.direct((0, 0, 1), np.zeros(6))


def test_batches_of_every_part_broadcast(model):
    """States, forces and wrenches each bring leading axes; a batch may be empty."""
    home, forces = model.robot.home, np.linspace(0, 1, 18).reshape(3, 1, 6)
    push = pf.Wrench(0, np.arange(12.0).reshape(4, 3))
    found = model.direct(home, forces, [push])
    assert found.platform.shape == (3, 4, 6)
    one = model.direct(home, forces[2, 0], [pf.Wrench(0, push.force[3])])
    assert np.allclose(found.platform[2, 3], one.platform, atol=1e-12)
    empty = model.direct(pf.State(np.zeros((0, 3)), UPRIGHT), np.zeros(6))
    assert empty.platform.shape == (0, 6)
    assert empty.contact_forces.shape == (0, 6, 3)
    states = pf.State(np.tile(HOME, (3, 1)), UPRIGHT)
    assert states[1].elastic.shape == ()
    assert model.direct(states[:2], np.zeros(6)).platform.shape == (2, 6)


def test_moment_needs_rotation_shapes():
    model = pf.Model(pf.Robot((), nodes()), "numpy")
    with pytest.raises(pf.InputError, match="no rotation shapes"):
        model.direct(model.robot.home, np.zeros(0), [pf.Wrench(0, moment=(1, 0, 0))])


def test_fewer_actuators_than_outputs():
    robot = pf.robots.gough_stewart(0)
    three = pf.Model(pf.Robot(robot.legs[:3], robot.platform), "numpy")
    with pytest.raises(pf.InputError, match="asks for 6 accelerations, but the robot has 3 actuators"):
        three.inverse(robot.home, np.zeros(6))


def lowered(robot, point):
    """Home, but with the first attachment at the first leg's base point plus `point`."""
    shift = robot.legs[0].origin + point - robot.platform.attachment_points[0]
    return pf.State(shift, UPRIGHT)


def test_pose_out_of_reach(model):
    """The tip at the base point: no leg is that short."""
    batch = pf.State(np.stack([HOME, lowered(model.robot, np.zeros(3)).position]), UPRIGHT)
    for call in (model.direct, model.inverse):
        with pytest.raises(pf.OutOfReach, match="pose at index 1: leg 1 cannot reach"):
            call(batch, np.zeros(6))
    with pytest.raises(pf.OutOfReach, match="pose: leg 1 cannot reach"):
        model.joints(batch[1])


def test_singular_leg(model):
    """The tip on the first joint's axis: gimbal lock of the universal joint (sin q2 = 0)."""
    axis = model.robot.legs[0].rotation @ np.array([0, 1.0, 0])
    with pytest.raises(pf.SingularPose, match="leg 1 is singular"):
        model.direct(lowered(model.robot, axis), np.zeros(6))


def test_parallel_singularity_names_the_free_twist(model):
    """All legs in planes through the platform's z axis: turning about it meets no resistance. The
    twist that the message names changes no leg's length: a_i·(v + ω × r_i) = 0."""
    spokes = [
        pf.Leg(UPRIGHT, 2 * np.append(c, 0), leg().joints, (pf.Tip(3, attachment=i),))
        for i, c in enumerate(corners())
    ]
    robot = pf.Robot(tuple(spokes), model.robot.platform, home_pose=((0, 0, 1.0), UPRIGHT))
    singular = pf.Model(robot, model.backend)
    singular.direct(robot.home, np.zeros(6))  # the contact form needs no J_p
    with pytest.raises(pf.SingularPose, match="pose is a parallel singularity") as caught:
        singular.inverse(robot.home, np.zeros(6))
    twist = np.array(re.search(r"= \[(.*)\]", str(caught.value))[1].split(), dtype=float)
    r = robot.platform.attachment_points
    along = r + (0, 0, 1.0) - 2 * r
    stretching = np.sum(along * (twist[:3] + np.cross(twist[3:], r)), axis=1)
    assert np.max(np.abs(twist)) == 1
    assert np.max(np.abs(stretching)) <= 2e-3  # the twist is printed with three digits


def soft_model(model_of, factor):
    """The paper's robot with its plate's frequencies scaled, one mode that the legs see well."""
    body = model_of(5).robot.platform
    softened = replace(body, stiffness=factor**2 * body.stiffness)
    return pf.Model(pf.robots.gough_stewart(platform=softened))


@pytest.mark.parametrize("backend", ["numpy", "vm"])
def test_dynamic_singularity_is_said(model_of, backend):
    """Where det J_sys and det J_p (Eqs. 21, 48) differ in sign, the platform bends so much that it
    accelerates against its actuators: the inverse model warns, the direct model does not."""
    model = model_of(9, backend)
    robot, rng = model.robot, np.random.default_rng(2)
    turn = Rotation.from_rotvec(rng.uniform(-0.3, 0.3, (200, 3))).as_matrix()
    states = pf.State(robot.home.position + rng.uniform(-0.2, 0.2, (200, 3)), turn)
    legs = model.joints(states)
    ratio = np.linalg.det(model.cartesian(states).Jsys_invT) / np.linalg.det(printed_Jp(robot, states, legs))
    wrong = np.flatnonzero(ratio < 0)
    assert 5 <= len(wrong) <= 50
    for i in wrong[:5]:
        with pytest.warns(pf.DynamicSingularity, match="pose lies beyond a dynamic.*against its actuators"):
            model.inverse(states[i], np.zeros(6))
        assert np.all(np.isfinite(model.direct(states[i], np.zeros(6)).platform))
    for i in np.flatnonzero(ratio > 0)[:20]:
        model.inverse(states[i], np.zeros(6))
    with pytest.warns(pf.DynamicSingularity, match=f"pose at index {wrong[0]} lies beyond a dynamic"):
        model.inverse(states, np.zeros(6))


def printed_Jp(robot, states, legs):
    """Eq. 21 from positions alone: rows a_iᵀ, (r_i × a_i)ᵀ with a_i from base point to corner."""
    r = robot.platform.attachment_points
    origins = np.array([leg.origin for leg in robot.legs])
    R = np.asarray(states.rotation)
    along = np.asarray(states.position)[:, None] + r @ np.swapaxes(R, 1, 2) - origins
    lengths = np.stack([q[:, 2] for q in legs.q], axis=1)
    a = (along @ R) / lengths[..., None]
    assert np.allclose(np.linalg.norm(a, axis=-1), 1)
    return np.concatenate([a, np.cross(r, a)], axis=-1)


def test_flat_arrays_are_checked_when_bound(model):
    c, N = model.compiled(), model.robot.platform.modes
    x, u, out = c.pack(model.robot.home), np.zeros(6), np.zeros(6 + N)
    c.direct(x, u, out)
    for bad, words in (
        ((x[:-1], u, out), "x has shape"),
        ((x, u.astype(np.float32), out), "u is of float32"),
        ((x, [0] * 6, out), "u is of list"),
        ((x, np.zeros(12)[::2], out), "strides"),
        ((x, u, np.zeros(5)), "out has shape"),
    ):
        with pytest.raises(pf.InputError, match=words):
            c.direct(*bad)
    sealed = np.zeros(6 + N)
    sealed.flags.writeable = False
    with pytest.raises(pf.InputError, match="read-only"):
        c.direct(x, u, sealed)
    with pytest.raises(pf.InputError, match="target has shape"):
        c.inverse(x, np.zeros(5), out)


def test_simulation_refuses_before_it_starts(model):
    home, t = model.robot.home, [0.0, 0.1]
    for bad, words in (
        ((np.zeros(4), home, t), "forces_or_controller has shape"),
        ((np.zeros(6), home, [0.0]), "at least two times"),
        ((np.zeros(6), home, [0.1, 0.0]), "each later than the one before"),
        ((np.zeros(6), pf.State(np.tile(HOME, (2, 1)), UPRIGHT), t), "simulate one state at a time"),
        ((lambda t, s: np.zeros(3), home, t), r"gave shape \(3,\); expected \(6,\)"),
        ((np.zeros(6), lowered(model.robot, np.zeros(3)), t), "leg 1 cannot reach"),
    ):
        with pytest.raises(pf.InputError, match=words):
            pf.simulate(model, *bad)
    with pytest.raises(pf.InputError, match="rtol is 0.0"):
        pf.simulate(model, np.zeros(6), home, t, rtol=0)
    way = pf.Trajectory.through(home, [((0.1, 0, 0), (0, 0, 0))], 1.0)
    with pytest.raises(pf.InputError, match="ComputedTorque.kp is -1.0"):
        pf.ComputedTorque(model, way, kp=-1)
    with pytest.raises(pf.InputError, match=r"JointPD.kd has shape \(3,\)"):
        pf.JointPD(model, home, 1.0, np.ones(3))


def test_too_soft_for_its_weight(model_of):
    """A plate of a tenth of the frequencies has no equilibrium with small deflections."""
    with pytest.raises(pf.NotConverged, match="too soft for its weight"):
        soft_model(model_of, 0.02).equilibrium(*model_of(5).robot.home_pose)


@pytest.mark.parametrize("backend", ALL_BACKENDS)
@pytest.mark.parametrize("good", [pf.robots.gough_stewart(0), pf.robots.rps3()], ids=["6-UPS", "3-RPS"])
def test_legs_without_inertia_are_refused(good, backend):
    """A is singular: no acceleration is finite, no simulation starts; weights have a balance."""
    light = [
        replace(
            one, joints=tuple(replace(j, M=0, MS=(0, 0, 0), I=np.zeros((3, 3)), IA=0) for j in one.joints)
        )
        for one in good.legs
    ]
    model, m = pf.Model(replace(good, legs=tuple(light)), backend), good.n_forces
    state, forces = model.equilibrium(*good.home_pose)
    assert np.all(np.isfinite(forces))
    driven = pf.FrameOutput(range(6) if m == 6 else (2, 3, 4))
    for call, *output in (
        (model.direct,),
        (model.direct_jacobian,),
        (model.joint_accelerations,),
        (model.reactions,),
        (model.inverse, driven),
        (model.inverse_jacobian, driven),
    ):
        with pytest.raises(pf.SingularPose, match="no inertia against one of its motions"):
            call(state, np.zeros(m), *output)
    with pytest.raises(pf.SingularPose, match="no inertia"):
        model.output_report(state, driven)
    with pytest.raises(pf.SingularPose, match="no inertia"):
        pf.simulate(model, np.zeros(m), state, [0, 0.1])


def test_computed_torque_needs_six_actuators():
    robot = pf.robots.gough_stewart(0)
    three = pf.Model(pf.Robot(robot.legs[:3], robot.platform))
    way = pf.Trajectory.through(robot.home, [((0.1, 0, 0), (0, 0, 0))], 1.0)
    with pytest.raises(pf.InputError, match="follows 6 freedoms, but the robot has 3 actuators"):
        pf.ComputedTorque(three, way)


# --- robots of fewer freedoms, and legs whose joints are carried in the state ---


@cache
def case_model(name, backend, rewriting=None):
    """A rigid reference case, as it is or written otherwise."""
    sample = cases.case(name, "rigid")
    return pf.Model((sample if rewriting is None else rewriting(sample)).robot, backend)


@pytest.mark.parametrize("backend", ["numpy", "vm"])
@pytest.mark.parametrize("name", ["rps3", "delta3"])
def test_empty_batches_of_fewer_freedoms(name, backend):
    """Of states, of forces, of targets; (0,) and (2, 0, 3)."""
    model, rows = case_model(name, backend), cases.case(name, "rigid").output
    home = model.robot.home
    for batch in ((0,), (2, 0, 3)):
        none = pf.State(np.zeros((*batch, 3)), UPRIGHT)
        assert model.direct(none, np.zeros(3)).platform.shape == (*batch, 6)
        assert model.direct(home, np.zeros((*batch, 3))).contact_forces.shape[: len(batch)] == batch
        assert model.inverse(home, np.zeros((*batch, 3)), rows).forces.shape == (*batch, 3)
        assert model.joints(none).q[1].shape == (*batch, len(model.robot.legs[1].joints))
        assert model.reactions(none, np.zeros(3)).force[0].shape[:-2] == batch
        assert model.project(none).position.shape == (*batch, 3)


@pytest.mark.parametrize("name", cases.NAMES)
def test_empty_batches_of_carried_legs(name):
    model = case_model(name, "numpy", reframed)
    none = pf.State(np.zeros((0, 3)), UPRIGHT)
    assert model.direct(none, np.zeros(model.robot.n_forces)).platform.shape == (0, 6)
    assert model.joints(none).qd[0].shape == (0, len(model.robot.legs[0].joints))


@pytest.mark.parametrize("rewriting", [None, reframed])
@pytest.mark.parametrize("name", cases.NAMES)
def test_joints_of_another_robot_are_refused(name, rewriting):
    """As many legs, and as many joints of each, as the robot has: for legs of every kind."""
    model = case_model(name, "numpy", rewriting)
    home, m = model.robot.home, model.robot.n_forces
    q = model.joints(home).q
    model.direct(replace(home, joints=q), np.zeros(m))
    for field in ("joints", "joint_rates"):
        for wrong in (q[:-1], (*q, q[0])):
            with pytest.raises(pf.InputError, match=f"State.{field} has {len(wrong)} entries; this robot"):
                model.direct(replace(home, **{field: wrong}), np.zeros(m))
        for wrong in (q[1][:-1], np.append(q[1], 0.0)):
            with pytest.raises(pf.InputError, match=rf"State.{field}\[1\] has shape \({len(wrong)},\)"):
                model.direct(replace(home, **{field: (q[0], wrong, *q[2:])}), np.zeros(m))


@pytest.mark.parametrize("backend", ["numpy", "vm"])
def test_outputs_and_preloads_of_wrong_shape(backend):
    model = case_model("delta3", backend)
    home, three = model.robot.home, pf.FrameOutput((0, 1, 2))
    with pytest.raises(pf.InputError, match="PointOutput.node is 6; the platform has nodes 0 … 5"):
        model.inverse(home, np.zeros(3), pf.PointOutput(6))
    with pytest.raises(pf.InputError, match="output is tuple; expected an Output"):
        model.inverse(home, np.zeros(3), (0, 1, 2))
    with pytest.raises(pf.InputError, match="asks for 6 accelerations, but the robot has 3 actuators"):
        model.inverse(home, np.zeros(6), pf.PointOutput(0, rows=range(6)))
    with pytest.raises(pf.InputError, match=r"preload has shape \(4,\); expected \(3\)"):
        model.inverse(home, np.zeros(3), three, preload=np.zeros(4))
    with pytest.raises(pf.InputError, match=r"\(3,\) of target.* \(4,\) of preload; they must broadcast"):
        model.inverse(home, np.zeros((3, 3)), three, preload=np.zeros((4, 3)))
    with pytest.raises(pf.InputError, match="preload is nan"):
        model.inverse(home, np.zeros(3), three, preload=[0, NAN, 0])


@pytest.mark.parametrize("rewriting", [None, reframed])
@pytest.mark.parametrize("name", cases.NAMES)
def test_poses_far_away_are_refused_everywhere(name, rewriting):
    """Five metres off: every door says so in a sentence, without a warning from the arithmetic."""
    model = case_model(name, "numpy", rewriting)
    m, far = model.robot.n_forces, pf.State((5.0, 5.0, 5.0), UPRIGHT)
    doors = {
        "direct": lambda: model.direct(far, np.zeros(m)),
        "joints": lambda: model.joints(far),
        "mobility": lambda: model.mobility(far),
        "joint controller": lambda: pf.JointPD(model, far, 1.0, 1.0),
        "simulate": lambda: pf.simulate(model, np.zeros(m), far, [0.0, 0.1]),
    }
    if rewriting is None and name != "rps3":  # whose legs are as long as one likes
        doors["project"] = lambda: model.project(far)
        doors["equilibrium"] = lambda: model.equilibrium(far.position, far.rotation)
        doors["report"] = lambda: model.output_report(far, cases.case(name, "rigid").output)
    if rewriting:
        doors["pack"] = lambda: model.compiled().pack(far)
    words = "cannot reach|off the closure|no state on the closure|no joints of leg 1 were found"
    for door in doors.values():
        with pytest.raises(pf.InputError, match=words) as caught:
            door()
        assert "inf" not in str(caught.value)


def test_start_off_the_closure_is_refused():
    """In place and in velocity; the sentence names the leg, the gap and the remedy."""
    model = case_model("rps3", "numpy")
    home = model.robot.home
    moved = replace(home, position=home.position + [0, 1e-3, 0])
    with pytest.raises(pf.InputError, match=r"a gap of 0.001 m between leg 1 .*model.project\(state\)"):
        pf.simulate(model, np.zeros(3), moved, [0.0, 0.1])
    sliding = replace(home, twist=(0, 0.02, 0, 0, 0, 0))
    with pytest.raises(pf.InputError, match="a gap velocity of 0.02 m/s between leg 1"):
        pf.simulate(model, np.zeros(3), sliding, [0.0, 0.1])
    batch = pf.State(np.stack([home.position, moved.position]), UPRIGHT)
    with pytest.raises(pf.InputError, match="state at index 1 is off the closure"):
        model.direct(batch, np.zeros(3))


def test_forward_geometry_takes_one_set_of_joints():
    model = case_model("rps3", "numpy")
    for call in (model.forward, model.forward_all):
        with pytest.raises(pf.InputError, match=r"joints has shape \(2,\); expected \(3\)"):
            call([0.7, 0.7])
        with pytest.raises(pf.InputError, match=r"joints has shape \(2, 3\); expected \(3\)"):
            call(np.full((2, 3), 0.7))
        with pytest.raises(pf.InputError, match="joints is nan"):
            call([0.7, NAN, 0.7])
        with pytest.raises(pf.InputError, match="guess is tuple; expected a State"):
            call([0.7, 0.7, 0.7], (HOME, UPRIGHT))
        with pytest.raises(pf.InputError, match=r"guess is a batch \(2,\)"):
            call([0.7, 0.7, 0.7], pf.State(np.zeros((2, 3)), UPRIGHT))
    with pytest.raises(pf.InputError, match="starts is 2.5; it must be a whole number"):
        model.forward_all([0.7, 0.7, 0.7], starts=2.5)
    with pytest.raises(pf.InputError, match="starts is 0; it must be a whole number, 1 or more"):
        model.forward_all([0.7, 0.7, 0.7], starts=0)
