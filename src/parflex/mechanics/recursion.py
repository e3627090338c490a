"""The recursive Newton–Euler algorithm of the legs (Sec. 3): motions of the links, and what they take."""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, cross, join, mtv, mv, stack
from parflex.mechanics.chain import Chain, Frames, Point, bend_of
from parflex.mechanics.joint_forces import at_motors
from parflex.mechanics.link import Seat, body_wrench, drift_of, pushed

E_Z = np.array([0.0, 0.0, 1.0])


class Motion(NamedTuple):
    """Angular velocity, angular acceleration and acceleration of a frame, in its own axes."""

    omega: Array
    omegad: Array
    vd: Array


class Reaction(NamedTuple):
    """Force and moment (about the frame's origin) that each link receives through its joint, last what the
    base receives from below, and the modal forces of flexible links."""

    force: list[Array]
    moment: list[Array]
    modal: list[Array]


def link_motions(chain: Chain, frame: Frames, zd: Array, zdd: Array, base: Motion) -> list[Motion]:
    """Forward recursion from the base, which comes last, and accelerates with −g besides what it does:
    gravity needs no further word."""
    motions = [base]
    for j, a in enumerate(chain.antecedent):
        R_aj, p_aj, seat = frame.R_aj[j], frame.p_aj[j], frame.seats[j]
        omega_a, omegad_a, vd_a = motions[a]
        if seat is not None:
            omega_a, omegad_a, vd_a = motion_at(chain, motions[a], a, seat, zd, zdd)
            p_aj = p_aj - seat.place
        slide, turn = chain.sigma[j], 1 - chain.sigma[j]
        rate, acceleration = zd[..., j, None] * E_Z, zdd[..., j, None] * E_Z
        omega_ja = mtv(R_aj, omega_a)
        omega = omega_ja + turn * rate
        omegad = mtv(R_aj, omegad_a) + turn * (acceleration + cross(omega_ja, rate))
        vd = mtv(R_aj, vd_a + point_acceleration(omega_a, omegad_a, p_aj))
        vd = vd + slide * (acceleration + 2.0 * cross(omega_ja, rate))
        motions.insert(j, Motion(omega, omegad, vd))
    return motions


def motion_at(chain: Chain, motion: Motion, link: int, seat: Seat, zd: Array, zdd: Array) -> Motion:
    """The motion of the section at a seat of a link, in the axes of the link's frame."""
    omega, omegad, vd = motion
    ed, edd = (bend_of(chain, part[..., chain.n :], link) for part in (zd, zdd))
    drift = drift_of(seat, ed)
    vd = vd + point_acceleration(omega, omegad, seat.place) + 2.0 * cross(omega, drift.velocity)
    return Motion(
        omega + drift.spin,
        omegad + cross(omega, drift.spin) + mv(seat.tilt, edd) + drift.spinning,
        vd + mv(seat.shift, edd) + drift.acceleration,
    )


def tip_acceleration(chain: Chain, motions: list[Motion], point: Point, zd: Array, zdd: Array) -> Array:
    """The acceleration (…, L, 3) of a point of a link, in the axes of the link's frame."""
    if point.seat is not None:
        return motion_at(chain, motions[point.link], point.link, point.seat, zd, zdd).vd
    omega, omegad, vd = motions[point.link]
    return vd + point_acceleration(omega, omegad, point.place)


def point_acceleration(omega: Array, omegad: Array, p: Array) -> Array:
    """Acceleration of a fixed point p of a frame relative to the frame's origin."""
    return cross(omegad, p) + cross(omega, cross(omega, p))


def unloaded(chain: Chain) -> Reaction:
    """No wrenches, of the links and of the base."""
    none = [np.zeros(3)] * (chain.n + 1)
    return Reaction(none, list(none), [np.zeros(modes) for modes in chain.modes])


def with_push(loads: Reaction, point: Point, push: Array, moment: Array | None = None) -> None:
    """Add a force (…, L, 3) that a link gives at one of its points, and a moment, in the link's axes."""
    j, twist = point.link, cross(point.place, push)
    turn = twist if moment is None else twist + moment
    loads.force[j], loads.moment[j] = loads.force[j] + push, loads.moment[j] + turn
    if point.seat is not None:
        about = np.zeros(3) if moment is None else moment
        loads.modal[j] = loads.modal[j] + pushed(point.seat, push, about)


def reactions(
    chain: Chain, frame: Frames, motions: list[Motion], zd: Array, zdd: Array, tips: Reaction
) -> Reaction:
    """The backward recursion; `tips` are the wrenches that the links give to the platform."""
    force, moment, modal = list(tips.force), list(tips.moment), list(tips.modal)
    for j in range(chain.n):
        omega, omegad, vd = motions[j]
        link, body = chain.links[j], frame.bodies[j]
        if link is None or body is None:
            MS, inertia = chain.MS[:, j], chain.I[:, j]
            force[j] = force[j] + chain.M[:, j, None] * vd + point_acceleration(omega, omegad, MS)
            moment[j] = moment[j] + mv(inertia, omegad) + cross(omega, mv(inertia, omega)) + cross(MS, vd)
            continue
        ed, edd = (bend_of(chain, part[..., chain.n :], j) for part in (zd, zdd))
        own = body_wrench(link, body, omega, omegad, vd, ed, edd)
        force[j], moment[j], modal[j] = force[j] + own[0], moment[j] + own[1], modal[j] + own[2]
    for j in reversed(range(chain.n)):
        a, passed, seat = chain.antecedent[j], mv(frame.R_aj[j], force[j]), frame.seats[j]
        turned = mv(frame.R_aj[j], moment[j])
        force[a] = force[a] + passed
        moment[a] = moment[a] + turned + cross(frame.p_aj[j], passed)
        if seat is not None:
            about = turned + cross(frame.p_aj[j] - seat.place, passed)
            modal[a] = modal[a] + pushed(seat, passed, about)
    return Reaction(force, moment, modal)


def inverse_dynamics(
    chain: Chain, frame: Frames, motions: list[Motion], zd: Array, zdd: Array, tips: Reaction | None = None
) -> Array:
    """Generalised forces (…, L, z) = A z̈ + c (+ Jᵀ f) of the trees, without what is
    `joint_forces.passive`."""
    found = reactions(chain, frame, motions, zd, zdd, unloaded(chain) if tips is None else tips)
    torque, rotors = [], chain.IA * at_motors(chain, zdd[..., : chain.n], zdd[..., chain.n :])
    for j, slides in enumerate(chain.sigma):
        axial = slides * found.force[j][..., 2] + (1 - slides) * found.moment[j][..., 2]
        torque.append(axial + rotors[..., j])
    modal = [found.modal[j] for j, modes in enumerate(chain.modes) if modes]
    return join([stack(torque), *modal, *(-rotors[..., j, None] for j in chain.drives)])
