"""Kinetic, gravitational and strain energy of a robot, and that of its joints' springs."""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, dot, mtv, mv
from parflex.mechanics import chain, flexures, joint_forces, recursion
from parflex.mechanics.floor import ground, twist_of_legs
from parflex.mechanics.leg_terms import LegTerms
from parflex.mechanics.platform import body_energies
from parflex.mechanics.system import System
from parflex.robot.carrying import Base


class Energies(NamedTuple):
    """Energies of a robot, J, (…,) each.

    kinetic counts the rotors in, gravity is zero at the world's origin, strain is that of the platform and
    of flexible links, and springs that of the springs at joints, of drives that give, and of the flexures at
    tips.
    """

    kinetic: Array
    gravity: Array
    strain: Array
    springs: Array


def dissipation(system: System) -> Array:
    """The power (…,) W that damping and friction take: of platform, joints, drives, links and flexures."""
    x = system.x
    lost = dot(x.elastic_rate, system.mechanism.platform.damping * x.elastic_rate)
    for leg in system.legs:
        group, c = leg.group, leg.group.chain
        lost = lost + np.sum(joint_forces.power_lost(c, leg.zd), axis=-1)
        for j, link in enumerate(c.links):
            if link is not None:
                ed = chain.bend_of(c, leg.zd[..., c.n :], j)
                lost = lost + np.sum(link.damping * ed * ed, axis=(-2, -1))
        if group.flexures is not None:
            spin, rate = leg.flexed.spin, leg.flexed.stretch_rate
            lost = lost + np.sum(dot(spin, flexures.resistance(group.flexures, spin)), axis=(-2, -1))
            if any(group.soft):
                against = mv(group.flexures.translation_damping, rate)
                lost = lost + np.sum(dot(rate, against), axis=(-2, -1))
    return lost


def rests_power(system: System) -> Array:
    """The power (…,) W that rests of springs which move give to the robot: −(k (q − r) + Fv (q̇ − ṙ)) ṙ."""
    given = np.zeros(system.x.position.shape[:-1])
    for leg in system.legs:
        c = leg.group.chain
        if chain.REST_RATE in c.tables:
            rate = joint_forces.motor_rates(c, leg.zd) - c.rest_rate
            pull = c.k * joint_forces.stretch(c, leg.joints) + c.Fv * rate
            given = given - np.sum(pull * c.rest_rate, axis=(-2, -1))
    return given


def energies(system: System) -> Energies:
    """The energies of a robot at a state or a batch of them."""
    gravity, platform, x = system.mechanism.gravity, system.mechanism.platform, system.x
    base, (down, *_) = system.mechanism.base, ground(system.mechanism.base, gravity)
    kinetic, strain = body_energies(platform, x.twist, x.elastic, x.elastic_rate)
    moment = platform.moments.MS0 + mv(platform.moments.S, x.elastic)
    weight = -dot(gravity, platform.moments.m * x.position + mv(x.rotation, moment))
    springs = np.zeros(x.position.shape[:-1])
    for leg in system.legs:
        group = leg.group
        kinetic = kinetic + 0.5 * np.sum(dot(leg.zd, mv(leg.A, leg.zd)), axis=-1)
        in_base = mtv(group.rotation, down[..., None, :])
        above = chain.potential_energy(group.chain, leg.bent, in_base)
        mass = sum((chain.mass(group.chain, j) for j in range(group.chain.n)), np.zeros(len(group.legs)))
        weight = weight + np.sum(above - mass * dot(down[..., None, :], group.origin), axis=-1)
        if base is not None:
            kinetic = kinetic + carried_energy(base, leg)
            weight = weight - np.sum(mass) * dot(gravity, base.position)
        springs = springs + np.sum(joint_forces.spring_energy(group.chain, leg.joints), axis=-1)
        for j, link in enumerate(group.chain.links):
            if link is not None:
                e = chain.bend_of(group.chain, leg.joints.bend, j)
                strain = strain + 0.5 * np.sum(link.stiffness * e * e, axis=(-2, -1))
        if group.flexures is not None:
            springs = springs + np.sum(flexures.energy(group.flexures, leg.flexed.bending), axis=-1)
            if any(group.soft):
                stretched = flexures.stretch_energy(group.flexures, leg.flexed.stretch)
                springs = springs + np.sum(stretched, axis=-1)
    return Energies(kinetic, weight, strain, springs)


def carried_energy(base: Base, leg: LegTerms) -> Array:
    """The part of the kinetic energy (…,) of legs that a base which moves adds to ½ żᵀ A ż: it is
    żᵀ p + ½ (v, ω)·h, of the momenta p of the legs' coordinates, and h of their bases, that the base's twist
    alone gives.

    The recursion turns accelerations into forces as velocities into momenta.
    """
    c, frames, still = leg.group.chain, leg.bent, np.zeros(leg.group.chain.size)
    v, omega = twist_of_legs(base, leg.group)
    motions = recursion.link_motions(c, frames, still, still, recursion.Motion(np.zeros(3), omega, v))
    momenta = recursion.inverse_dynamics(c, frames, motions, still, still)
    h = recursion.reactions(c, frames, motions, still, still, recursion.unloaded(c))
    own = dot(h.force[-1], v) + dot(h.moment[-1], omega)
    return np.sum(dot(leg.zd, momenta) + 0.5 * own, axis=-1)
