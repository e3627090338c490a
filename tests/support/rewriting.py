"""The same robot written otherwise: other link frames, other base frames, other trees.

A modified-DH table leaves a choice: every link frame may be moved along and turned about its own joint axis,
and, where nothing drives the joint, turned over, which reverses the sign of its variable. With such a change
of frame G_j, Z_j(q) G_j = G_j Z_j(±q), so that the constant part T_aj of a row (q = 0) becomes G_a⁻¹ T_aj G_j
and the joint moves the robot as before. Legs may also share one tree, on a base of its own.

The robot moves as before to round-off; none of its legs has a table that a closed form would know.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate

import numpy as np
from scipy.spatial.transform import Rotation

import parflex as pf
from oracle import screw
from sample import Sample

TURNED_OVER = np.diag([1.0, -1.0, -1.0, 1.0])


def reframed(sample: Sample, seed: int = 0) -> Sample:
    """Every leg with new link frames and a new base frame; passive joints turned over at random."""
    rng = np.random.default_rng(seed)
    written = [rewritten([leg], random_pose(rng), rng) for leg in sample.legs]
    return with_legs(sample, written, [[i] for i in range(len(written))])


def one_tree(sample: Sample, seed: int = 0) -> Sample:
    """All legs as the branches of one tree: one 'leg' with all joints and all tips."""
    return grouped(sample, [range(len(sample.legs))], seed)


def grouped(sample: Sample, groups: Sequence[Sequence[int]], seed: int = 0) -> Sample:
    """Groups of consecutive legs, each group as one tree."""
    rng = np.random.default_rng(seed)
    written = [rewritten([sample.legs[i] for i in group], random_pose(rng), rng) for group in groups]
    return with_legs(sample, written, groups)


REWRITINGS = (reframed, one_tree)


def with_legs(sample: Sample, written: list, groups: Sequence[Sequence[int]]) -> Sample:
    """The sample with new legs; its joint values in their order, with their signs."""
    legs, signs = zip(*written, strict=True)
    q, qd = (
        [
            sign * np.concatenate([values[i] for i in group], axis=-1)
            for group, sign in zip(groups, signs, strict=True)
        ]
        for values in (sample.q, sample.qd)
    )
    return replace(sample, legs=legs, q=q, qd=qd)


def rewritten(
    legs: Sequence[pf.Leg], base: np.ndarray, rng: np.random.Generator
) -> tuple[pf.Leg, np.ndarray]:
    """One leg that stands on `base` (4, 4) and moves as all of these together; the signs of its joints."""
    old = [joint for leg in legs for joint in leg.joints]
    signs = np.array([-1.0 if not joint.mu and rng.random() < 0.5 else 1.0 for joint in old])
    change = [new_frame(sign, rng) for sign in signs]
    shift = [0, *accumulate(len(leg.joints) for leg in legs)]
    joints, tips = [], []
    for leg, first in zip(legs, shift, strict=False):
        stands = pose(leg.rotation, leg.origin)
        for joint in leg.joints:
            number = len(joints)
            antecedent = joint.antecedent + first if joint.antecedent else 0
            G_a = change[antecedent - 1] if antecedent else np.linalg.solve(stands, base)
            joints.append(in_new_frame(joint, antecedent, G_a, change[number], signs[number]))
        for tip in leg.tips:
            offset = np.linalg.solve(change[tip.frame + first - 1], [*tip.offset, 1.0])[:3]
            tips.append(pf.Tip(tip.frame + first, offset, tip.attachment))
    posture = None
    if all(leg.posture is not None for leg in legs):
        posture = signs * np.concatenate([leg.posture for leg in legs])
    return pf.Leg(base[:3, :3], base[:3, 3], tuple(joints), tuple(tips), posture=posture), signs


def in_new_frame(joint: pf.Joint, antecedent: int, G_a: np.ndarray, G: np.ndarray, sign) -> pf.Joint:
    """The row and inertia of a joint whose frame is moved by G and whose antecedent's by G_a."""
    row = screw(2, joint.gamma, joint.b) @ screw(0, joint.alpha, joint.d) @ screw(2, joint.theta, joint.r)
    R, p, MS = G[:3, :3], G[:3, 3], np.asarray(joint.MS)
    both = np.outer(p, MS) + np.outer(MS, p) - joint.M * np.outer(p, p)
    inertia = R.T @ (joint.I - np.trace(both) * np.eye(3) + both) @ R  # about the new origin
    return replace(
        joint,
        antecedent=antecedent,
        **mdh_row(np.linalg.solve(G_a, row @ G)),
        MS=R.T @ (MS - joint.M * p),
        I=0.5 * (inertia + inertia.T),
        q_0=sign * joint.q_0,
    )


def mdh_row(T: np.ndarray) -> dict[str, float]:
    """γ, b, α, d, θ, r of any placement: the common normal of both z axes runs along x after γ."""
    R, p = T[:3, :3], T[:3, 3]
    gamma = np.arctan2(R[0, 2], -R[1, 2])
    if np.hypot(R[0, 2], R[1, 2]) < 1e-9:  # parallel axes: every common normal will do, r = 0
        gamma = np.arctan2(p[1], p[0])
    x = np.array([np.cos(gamma), np.sin(gamma), 0.0])
    y = np.array([-x[1], x[0], 0.0])
    alpha = np.arctan2(-y @ R[:, 2], R[2, 2])
    theta = np.arctan2(-x @ R[:, 1], x @ R[:, 0])
    axes = np.column_stack([[0.0, 0.0, 1.0], x, R[:, 2]])
    b, d, r = np.linalg.lstsq(axes, p, rcond=1e-9)[0]
    return dict(gamma=gamma, b=b, alpha=alpha, d=d, theta=theta, r=r)


def new_frame(sign: float, rng: np.random.Generator) -> np.ndarray:
    """A frame (4, 4) somewhere on the joint's axis, turned over for the sign −1."""
    G = screw(2, rng.uniform(-3.0, 3.0), rng.uniform(-0.3, 0.3))
    return G @ TURNED_OVER if sign < 0 else G


def random_pose(rng: np.random.Generator) -> np.ndarray:
    """A pose (4, 4) within 1 m of the origin."""
    return pose(Rotation.random(random_state=rng).as_matrix(), rng.uniform(-0.5, 0.5, 3))


def pose(rotation, origin) -> np.ndarray:
    """(4, 4) of axes and origin."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation, origin
    return T
