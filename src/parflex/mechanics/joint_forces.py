"""The forces at the joints of the legs: springs, friction, couplings, and drives that give."""

import numpy as np

from parflex.base.array import Array, dot, join, mv, stack
from parflex.mechanics.chain import REST_RATE, Chain, Joints, bend_of, joint_position
from parflex.mechanics.couplings import Coupled
from parflex.mechanics.link import strain


def stretch(chain: Chain, joints: Joints) -> Array:
    """θ − q_0 (…, L, n) of the springs: for revolute joints the angle of the link in (−π, π], less what the
    drive gives."""
    q = stack([joint_position(chain, joints, j, chain.q_0[..., j]) for j in range(chain.n)])
    return at_motors(chain, q, joints.bend)


def at_motors(chain: Chain, q: Array, bend: Array) -> Array:
    """θ = q − δ (…, L, n) of the motors, from the joints and all elastic coordinates (…, L, ΣN + d); likewise
    their rates. It is q where no drive gives."""
    if not chain.drives:
        return q
    return stack([at_motor(chain, j, q[..., j], bend) for j in range(chain.n)])


def at_motor(chain: Chain, j: int, q: Array, bend: Array) -> Array:
    """θ_j = q_j − δ_j (…, L) of the motor of a joint, from all elastic coordinates (…, L, ΣN + d)."""
    return q - deflections(chain, bend)[chain.drives.index(j)] if j in chain.drives else q


def deflections(chain: Chain, bend: Array) -> list[Array]:
    """δ (…, L) of each drive, from all elastic coordinates (…, L, ΣN + d)."""
    return [bend[..., sum(chain.modes) + place] for place in range(len(chain.drives))]


def passive(chain: Chain, joints: Joints, zd: Array) -> Array:
    """(…, L, z): friction and springs at the motors, couplings at joints, stiffness and damping of links and
    drives."""
    at_joints = resistance(chain, motor_rates(chain, zd)) + chain.k * stretch(chain, joints)
    strained = [
        strain(link, bend_of(chain, joints.bend, j), bend_of(chain, zd[..., chain.n :], j))
        for j, link in enumerate(chain.links)
        if link is not None
    ]
    given = deflections(chain, joints.bend), deflections(chain, zd[..., chain.n :])
    for j, delta, rate in zip(chain.drives, *given, strict=True):
        pull = chain.drive_stiffness[:, j] * delta + chain.drive_damping[:, j] * rate
        strained.append((pull - at_joints[..., j])[..., None])
    for coupling in chain.couplings:
        at_joints = at_joints + coupling_force(chain, coupling, joints, zd)
    return join([at_joints, *strained]) if strained else at_joints


def coupling_force(chain: Chain, coupling: Coupled, joints: Joints, zd: Array) -> Array:
    """K (q − q_0) + D q̇ (…, L, n) of a coupling, at its joints among all."""
    rates = zd[..., list(coupling.joints)]
    force = mv(coupling.stiffness, stretch_of(chain, coupling, joints)) + mv(coupling.damping, rates)
    return force @ np.eye(chain.n)[list(coupling.joints)]


def stretch_of(chain: Chain, coupling: Coupled, joints: Joints) -> Array:
    """q − q_0 (…, L, n) of the joints of a coupling; angles in (−π, π]."""
    places = enumerate(coupling.joints)
    return stack([joint_position(chain, joints, j, coupling.rest[:, i]) for i, j in places])


def motor_rates(chain: Chain, zd: Array) -> Array:
    """θ̇ (…, L, n) of the motors, q̇ of joints that have none or whose drive does not give."""
    return at_motors(chain, zd[..., : chain.n], zd[..., chain.n :])


def friction(chain: Chain, qd: Array) -> Array:
    """Viscous and smoothed Coulomb friction (…, L, n), against the motion."""
    return chain.Fv * qd + chain.Fs * qd / np.sqrt(qd * qd + chain.v_s * chain.v_s)


def resistance(chain: Chain, qd: Array) -> Array:
    """Friction (…, L, n), its viscous part against the rate at which joints leave the rests of their springs
    where these move."""
    found = friction(chain, qd)
    return found - chain.Fv * chain.rest_rate if REST_RATE in chain.tables else found


def power_lost(chain: Chain, zd: Array) -> Array:
    """The power (…, L) that friction and the damping of drives and couplings take; of viscous
    friction Fv (q̇ − ṙ)² where rests move."""
    qd = motor_rates(chain, zd)
    lost = dot(qd, friction(chain, qd))
    if REST_RATE in chain.tables:
        lost = lost - dot(chain.Fv * chain.rest_rate, 2.0 * qd - chain.rest_rate)
    for j, rate in zip(chain.drives, deflections(chain, zd[..., chain.n :]), strict=True):
        lost = lost + chain.drive_damping[:, j] * rate * rate
    for coupling in chain.couplings:
        rates = zd[..., list(coupling.joints)]
        lost = lost + dot(rates, mv(coupling.damping, rates))
    return lost


def spring_energy(chain: Chain, joints: Joints) -> Array:
    """The energy (…, L) of the joints' springs, of drives and of couplings."""
    stretched = stretch(chain, joints)
    stored = 0.5 * dot(chain.k * stretched, stretched)
    for j, delta in zip(chain.drives, deflections(chain, joints.bend), strict=True):
        stored = stored + 0.5 * chain.drive_stiffness[:, j] * delta * delta
    for coupling in chain.couplings:
        away = stretch_of(chain, coupling, joints)
        stored = stored + 0.5 * dot(away, mv(coupling.stiffness, away))
    return stored
