"""Identities that hold at any state: two routes through the mechanics, one answer."""

from dataclasses import replace

import numpy as np
import pytest

import parflex as pf
from measures import MODES, random_forces, random_states, relative
from parflex.base.array import join, mtv, mv, transpose
from parflex.kernels import models as kernels
from parflex.mechanics import cartesian, dynamics, kinematics, recursion
from parflex.mechanics import system as assembly
from parflex.mechanics.redundancy import solvable
from parflex.mechanics.wrench import generalised_force
from parflex.model.core import core_of
from parflex.robot.layout import coordinates

SAME = 1e-12  # the same quantity by another order of operations
SOLVED = 1e-10  # forces recovered through a solve of condition some 1e4
STATES = 100


@pytest.fixture(params=MODES, scope="module")
def case(request, model_of):
    """A model, 100 states and forces, and the states for the mechanics itself."""
    model = model_of(request.param)
    state = random_states(model.robot, STATES, seed=request.param)
    forces = random_forces(model, STATES, seed=100 + request.param)
    return model, state, forces, coordinates(core_of(model).flat(state), core_of(model).mechanism.layout)


def test_contact_form_is_the_cartesian_form(case):
    """Eqs. 44–49 against the contact form, direct model."""
    model, state, forces, x = case
    found = model.direct(state, forces)
    Vd, qdd_e = cartesian.direct(core_of(model).mechanism, x, forces)
    assert relative(found.platform, Vd) <= SAME
    assert relative(found.elastic, qdd_e) <= SAME


def test_inverse_forces_satisfy_the_cartesian_form(case):
    """A V̇_p + c = J_sys⁻ᵀ Γ with Γ from the contact form, against the largest of its terms."""
    model, state, forces, x = case
    target = model.direct(state, forces).platform
    gamma = model.inverse(state, target).forces
    form = model.cartesian(state)
    terms = [mv(form.A, target), form.c, mv(form.Jsys_invT, gamma)]
    largest = max(np.max(np.abs(term)) for term in terms)
    assert np.max(np.abs(terms[0] + terms[1] - terms[2])) <= SAME * largest
    assert relative(cartesian.inverse(core_of(model).mechanism, x, target)[0], forces) <= SOLVED


def test_inverse_after_direct_gives_the_forces_back(case):
    model, state, forces, _ = case
    accelerations = model.direct(state, forces)
    back = model.inverse(state, accelerations.platform)
    assert relative(back.forces, forces) <= SOLVED
    assert relative(back.elastic, accelerations.elastic) <= SOLVED
    assert relative(back.contact_forces, accelerations.contact_forces) <= SOLVED
    assert relative(back.platform, accelerations.platform) <= SAME


def test_partial_output_is_reached_with_the_shortest_forces(case):
    """Three rows of V̇_p with six actuators: the target is met, and the forces are orthogonal to
    what leaves it unchanged."""
    model, state, forces, _ = case
    rows = (0, 2, 4)
    target = model.direct(state, forces).platform[:, rows]
    found = model.inverse(state, target, pf.FrameOutput(rows))
    assert relative(model.direct(state, found.forces).platform[:, rows], target) <= SOLVED
    core = core_of(model)
    gain = core.functions(kernels.gains, pf.FrameOutput(rows))(x=core.flat(state))["flexible"]
    gain = gain.reshape(STATES, 3, 6)
    null = np.linalg.svd(gain)[2][:, 3:]
    assert relative(mv(null, found.forces), np.zeros((STATES, 3))) <= SOLVED * np.max(np.abs(found.forces))


def test_virtual_machine_agrees_with_numpy(case, model_of):
    model, state, forces, _ = case
    traced = model_of(model.robot.platform.modes, "vm")
    for found, expected in zip(traced.direct(state, forces), model.direct(state, forces), strict=True):
        assert relative(found, expected) <= SAME
    target = model.direct(state, forces).platform
    for found, expected in zip(traced.inverse(state, target), model.inverse(state, target), strict=True):
        assert relative(found, expected) <= SAME


@pytest.mark.parametrize("backend", ["numpy", "vm"])
def test_batch_is_the_loop(case, model_of, backend):
    model = model_of(case[0].robot.platform.modes, backend)
    _, state, forces, _ = case
    batch = model.direct(state, forces)
    for i in (0, 7, STATES - 1):
        for whole, one in zip(batch, model.direct(state[i], forces[i]), strict=True):
            assert relative(whole[i], one) <= SAME
    folded = pf.State(*(np.reshape(a, (4, 25, *np.shape(a)[1:])) for a, _ in state._arrays()))
    again = model.direct(folded, forces.reshape(4, 25, -1))
    assert relative(again.platform.reshape(STATES, -1), batch.platform) <= SAME


@pytest.mark.parametrize("backend", ["numpy", "vm"])
def test_flat_models_agree_with_the_comfortable_ones(case, model_of, backend):
    model = model_of(case[0].robot.platform.modes, backend)
    _, state, forces, _ = case
    N, c = model.robot.platform.modes, model.compiled()
    u, target, short, long, back = (
        np.zeros(6),
        np.zeros(6),
        np.zeros(6 + N),
        np.zeros(24 + N),
        np.zeros(6 + N),
    )
    x = c.pack(state[0])
    for i in (0, 1, 2):
        x[:], u[:] = c.pack(state[i]), forces[i]
        x[3:7] *= 1.7  # the quaternion's length is of no account
        expected = model.direct(state[i], forces[i])
        c.direct(x, u, short)
        c.direct(x, u, long)
        assert relative(short, np.concatenate([expected.platform, expected.elastic])) <= SAME
        assert relative(long[6 + N :], expected.contact_forces.ravel()) <= SAME
        target[:] = expected.platform
        c.inverse(x, target, back)
        assert relative(back[:6], forces[i]) <= SOLVED
        assert relative(back[6:], expected.elastic) <= SOLVED


def test_closure_and_leg_equations_hold(case):
    """J q̈ + J̇q̇ = Wᵀ(V̇_p, q̈_e) + h, with q̈ from the legs' own dynamics; Eqs. 6, 7 and 10."""
    model, _, forces, x = case
    system = assembly.assemble(solvable(model.robot), x)
    found = dynamics.direct_of(system, forces, np.zeros(6 + model.robot.platform.modes))
    (leg,) = system.legs
    f = found.contact.reshape(STATES, 6, 3)
    (qdd,) = assembly.leg_accelerations(system, forces, found.contact)
    W = np.concatenate([system.W_p, np.broadcast_to(system.W_e, (STATES, *system.W_e.shape))], axis=-2)
    tips = kinematics.point_acceleration(
        W, kinematics.stacked(system.points.h), found.platform, found.elastic
    ).reshape(STATES, 6, 3)
    assert relative(mv(leg.J, qdd) + leg.Jdqd, tips) <= SOLVED
    assert relative(cartesian.tip_to_joints(leg, tips), qdd) <= SOLVED
    axes = transpose(cartesian.inverse_jacobian(leg)) @ leg.group.S
    assert relative(cartesian.tip_force(leg, axes, forces[:, :, None], qdd), f) <= SOLVED


def test_power_of_the_actuators(case):
    """q̇_a = J_p⁻¹ V_p + J_e⁻¹ q̇_e (Eqs. 19–21) are the rates of the legs (Eq. 2)."""
    model, _, _, x = case
    system = assembly.assemble(core_of(model).mechanism, x)
    Jp, Je = kinematics.actuator_jacobian(system.W_p, system.W_e, assembly.actuated_axes(system))
    rates = mtv(Jp, x.twist) + mtv(Je, x.elastic_rate)
    assert relative(rates, assembly.joint_rates(system)) <= SAME


def test_leg_jacobian_is_that_of_the_paper(case):
    """Eqs. 3 and 4, typed from the paper, in Σ0i; and J q̇ is the tip's velocity (Eq. 1)."""
    model, state, _, x = case
    (leg,) = assembly.assemble(core_of(model).mechanism, x).legs
    legs = model.joints(state)
    for i in range(6):
        q1, q2, q3 = np.moveaxis(legs.q[i], -1, 0)
        s1, c1, s2, c2 = np.sin(q1), np.cos(q1), np.sin(q2), np.cos(q2)
        printed = np.array(
            [
                [-q3 * s1 * s2, q3 * c1 * c2, c1 * s2],
                [0 * q1, q3 * s2, -c2],
                [-q3 * c1 * s2, -q3 * c2 * s1, -s1 * s2],
            ]
        )
        in_base = transpose(leg.group.rotation[i]) @ x.rotation @ leg.J[:, i]
        assert relative(in_base, np.moveaxis(printed, -1, 0)) <= SAME
    system = assembly.assemble(core_of(model).mechanism, x)
    assert relative(mv(leg.J, leg.qd), system.points.v) <= SAME


def test_wrench_does_the_work_it_should(case):
    """W_a: the power of a wrench is F·v + N·ω of the node's total twist (Eq. 14); and it enters the
    direct model as the inverse model asks."""
    model, state, forces, x = case
    node = 20
    force, moment = np.array([30.0, -20.0, 50.0]), np.array([2.0, 3.0, -1.0])
    wrench = pf.Wrench(node, force, moment, frame="platform")
    w = generalised_force(model.robot.platform, state, [wrench])
    speeds = join([x.twist, x.elastic_rate])
    V_t = kinematics.node_twist(model.robot.platform, node, x)
    assert relative(np.sum(w * speeds, -1), V_t @ np.concatenate([force, moment])) <= SAME
    turned = pf.Wrench(node, mv(x.rotation, force), mv(x.rotation, moment))
    pushed = model.direct(state, forces, [wrench])
    assert relative(model.direct(state, forces, [turned]).platform, pushed.platform) <= SAME
    back = model.inverse(state, pushed.platform, wrenches=[wrench])
    assert relative(back.forces, forces) <= SOLVED


def test_force_at_an_attachment_is_carried_like_a_contact_force(case):
    """A force on the node of an attachment acts as W_i f_i does (Eqs. 26–28)."""
    model, state, _, x = case
    body, f = model.robot.platform, np.array([5.0, -7.0, 11.0])
    system = assembly.assemble(core_of(model).mechanism, x)
    stacked = np.zeros((STATES, 18))
    stacked[:, 6:9] = f
    F_p, Q_p = kinematics.generalised_force(system.W_p, system.W_e, stacked)
    w = generalised_force(body, state, [pf.Wrench(body.attachments[2], f, frame="platform")])
    assert relative(join([F_p, Q_p]), w) <= SAME


def test_inertia_matrix_is_that_of_the_inverse_dynamics(case):
    """Column k of A is τ(q̈ = e_k) − τ(q̈ = 0)."""
    model, _, _, x = case
    (leg,) = assembly.assemble(core_of(model).mechanism, x).legs
    table, frames = leg.group.chain, leg.bent
    rest = recursion.Motion(*np.zeros((3, 3)))
    for k in range(3):
        unit = np.zeros(3)
        unit[k] = 1.0
        still = 0 * leg.zd
        motions = recursion.link_motions(table, frames, still, unit, rest)
        assert (
            relative(recursion.inverse_dynamics(table, frames, motions, still, unit), leg.A[..., k]) <= SAME
        )


def test_static_equilibrium_is_at_rest(model_of):
    """V̇_p = q̈_e = 0 there; what remains is K times the tolerance of q_e."""
    for modes in MODES:
        model = model_of(modes)
        state, forces = model.equilibrium(*model.robot.home_pose)
        found = model.direct(state, forces)
        assert np.max(np.abs(found.platform)) <= 1e-9
        assert np.max(np.abs(found.elastic), initial=0.0) <= 1e-9


def test_slider_measured_from_elsewhere_is_the_same_leg(model_of):
    """The joint variable is added to r: with r = 1.05 m, q_3 is shorter by that and nothing else."""
    model = model_of(1)
    legs = [
        replace(leg, joints=(*leg.joints[:2], replace(leg.joints[2], r=1.05))) for leg in model.robot.legs
    ]
    other = pf.Model(replace(model.robot, legs=tuple(legs)), "numpy")
    state, forces = random_states(model.robot, 5, 1), random_forces(model, 5, 2)
    assert relative(other.direct(state, forces).platform, model.direct(state, forces).platform) <= SAME
    assert relative(other.joints(state).q[2][:, 2] + 1.05, model.joints(state).q[2][:, 2]) <= SAME


def test_leg_without_an_actuator(model_of):
    """Seven legs, one a passive strut: six forces, and the inverse model gives them back."""
    robot = model_of(1).robot
    strut = replace(
        robot.legs[0],
        joints=(*robot.legs[0].joints[:2], replace(robot.legs[0].joints[2], mu=0)),
        origin=robot.legs[0].origin + [0.1, 0.4, 0.0],
        tips=(pf.Tip(3, attachment=6),),
    )
    body = replace(robot.platform, attachments=(*robot.platform.attachments, 0))
    model = pf.Model(replace(robot, legs=(*robot.legs, strut), platform=body), "numpy")
    state, forces = random_states(robot, 5, 3), 100.0 + np.arange(30.0).reshape(5, 6)
    found = model.direct(state, forces)
    assert found.contact_forces.shape == (5, 7, 3)
    assert relative(model.inverse(state, found.platform).forces, forces) <= SOLVED
    assert (
        relative(
            cartesian.direct(
                core_of(model).mechanism,
                coordinates(core_of(model).flat(state), core_of(model).mechanism.layout),
                forces,
            )[0],
            found.platform,
        )
        <= SAME
    )
