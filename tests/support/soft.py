"""The reference robots with flexible legs, some of whose tips are soft."""

from dataclasses import replace

import numpy as np

import flexlegs
import parflex as pf

SOFT = {
    "gs_flexlegs": ([(i, 0) for i in range(6)], [(1, 0), (5, 0)]),
    "delta_flexarms_foreshortening": ([(0, 0), (0, 1), (2, 0)], [(1, 1)]),
}
CASES = [(name, tuple(which)) for name, several in SOFT.items() for which in several]


def softened(robot, which):
    """The robot some of whose tips, by leg and tip, are soft."""
    rng, legs = np.random.default_rng(0), list(robot.legs)
    for i, t in which:
        tips = list(legs[i].tips)
        held = tips[t].flexure or pf.Flexure()
        M, D = rng.normal(size=(2, 3, 3))
        flexure = replace(held, translation=2e4 * M @ M.T, translation_damping=50 * D @ D.T)
        tips[t] = replace(
            tips[t], flexure=replace(flexure, rest=np.eye(3) if held.rest is None else held.rest)
        )
        legs[i] = replace(legs[i], tips=tips)
    return replace(robot, legs=legs)


def pulled_off(robot, seed):
    """A moving state whose soft tips are some millimetres off, and leave at some centimetres a second."""
    model, state, rng = pf.Model(robot, "numpy"), flexlegs.moving(robot, seed), np.random.default_rng(seed)
    legs = model.joints(state)
    q = [q + 5e-3 * rng.normal(size=q.shape) for q in legs.q]
    qd = [qd + 0.05 * rng.normal(size=qd.shape) for qd in legs.qd]
    return model.project(replace(state, joints=tuple(q), joint_rates=tuple(qd)))
