"""Robots in which everything gives at once: drives, couplings, soft tips, links and the platform."""

from dataclasses import replace
from functools import cache

import numpy as np

import flexlegs
import parflex as pf
from floors import moving_base
from soft import CASES, pulled_off, softened

SOFT_TIPS = dict(CASES[1:3])  # some tips of each robot; others hold their points


@cache
def everything(name):
    """A robot of `flexlegs.mixed` on soft and hard tips; every other leg has a drive that gives, every leg a
    coupling of its first two joints, and every joint friction."""
    robot, rng, legs = softened(flexlegs.mixed(name), SOFT_TIPS[name]), np.random.default_rng(4), []
    for i, leg in enumerate(robot.legs):
        joints = [replace(joint, Fv=3.0, Fs=2.0, v_s=0.1) for joint in leg.joints]
        if i % 2 == 0:
            joints = [driven(joint) if joint.mu else joint for joint in joints]
        K, D = rng.normal(size=(2, 2, 2))
        coupling = pf.Coupling((1, 2), 200 * K @ K.T, 3 * D @ D.T, 0.2 * rng.normal(size=2))
        legs.append(replace(leg, joints=tuple(joints), couplings=(coupling,)))
    return replace(robot, legs=tuple(legs))


def driven(joint):
    """The joint behind a drive that gives, with a spring on its motor."""
    drive = {"drive_stiffness": 3e4, "drive_damping": 20.0, "k": 500.0, "q_0": 0.1}
    return replace(joint, IA=max(joint.IA, 2.0), **drive)


def at(name, seed):
    """The robot, a state in the world that names the joints, the base under it, and forces."""
    robot, base = everything(name), moving_base(seed)
    state = base.carried(pulled_off(robot, seed))
    legs = pf.Model(robot, "numpy").joints(state, base=base)
    forces = 100.0 * np.random.default_rng(seed).normal(size=robot.n_forces)
    return robot, replace(state, joints=legs.q, joint_rates=legs.qd), base, forces
