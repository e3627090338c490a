"""Kinetic, gravitational and strain energy of a robot, and that of its joints' springs."""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, dot, mtv, mv
from parflex.mechanics import chain
from parflex.mechanics.platform import body_energies
from parflex.mechanics.system import System


class Energies(NamedTuple):
    """Energies of a robot, J, (…,) each.

    kinetic counts the rotors in, gravity is zero at the world's origin, strain is that of the platform
    and springs that of the joints' springs.
    """

    kinetic: Array
    gravity: Array
    strain: Array
    springs: Array


def energies(system: System) -> Energies:
    """The energies of a robot at a state or a batch of them."""
    gravity, platform, x = system.mechanism.gravity, system.mechanism.platform, system.x
    kinetic, strain = body_energies(platform, x.twist, x.elastic, x.elastic_rate)
    moment = platform.moments.MS0 + mv(platform.moments.S, x.elastic)
    weight = -dot(gravity, platform.moments.m * x.position + mv(x.rotation, moment))
    springs = np.zeros(x.position.shape[:-1])
    for leg in system.legs:
        group = leg.group
        kinetic = kinetic + 0.5 * np.sum(dot(leg.qd, mv(leg.A, leg.qd)), axis=-1)
        in_base = mtv(group.rotation, gravity)
        above = chain.potential_energy(group.chain, leg.frames, in_base)
        mass = np.sum(group.chain.M, axis=-1)
        weight = weight + np.sum(above - mass * dot(gravity, group.origin), axis=-1)
        stretch = chain.stretch(group.chain, leg.joints)
        springs = springs + 0.5 * np.sum(group.chain.k * stretch * stretch, axis=(-2, -1))
    return Energies(kinetic, weight, strain, springs)
