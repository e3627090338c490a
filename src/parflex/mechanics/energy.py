"""Kinetic, gravitational and strain energy of a robot, and that of its joints' springs."""

import numpy as np

from parflex.base.array import Array, dot, mtv, mv
from parflex.mechanics import chain
from parflex.mechanics.platform import body_energies
from parflex.mechanics.system import System
from parflex.robot.robot import Robot


def energies(robot: Robot, system: System) -> tuple[Array, Array, Array, Array]:
    """Kinetic (rotors included), gravitational (zero at the world's origin), strain energy, and that
    of the joints' springs, J.

    For a state or a batch of them: (…,) each.
    """
    gravity, body, x = np.asarray(robot.gravity), robot.platform, system.x
    kinetic, strain = body_energies(body, x.twist, x.elastic, x.elastic_rate)
    moment = body.tables.MS0 + mv(body.tables.S, x.elastic)
    weight = -dot(gravity, body.tables.m * x.position + mv(x.rotation, moment))
    springs = np.zeros(())
    for leg in system.legs:
        group = leg.group
        kinetic = kinetic + 0.5 * np.sum(dot(leg.qd, mv(leg.A, leg.qd)), axis=-1)
        in_base = mtv(group.rotation, gravity)
        above = chain.potential_energy(group.chain, leg.frames, in_base)
        mass = np.sum(group.chain.M, axis=-1)
        weight = weight + np.sum(above - mass * dot(gravity, group.origin), axis=-1)
        stretch = chain.stretch(group.chain, leg.joints)
        springs = springs + 0.5 * np.sum(group.chain.k * stretch * stretch, axis=(-2, -1))
    return kinetic, weight, strain, springs
