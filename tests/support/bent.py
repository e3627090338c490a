"""Robots of the gallery whose links bend in arbitrary shapes."""

from dataclasses import replace

import numpy as np

import parflex as pf
from parflex.robot.leg import placed

MODES = 3


def body(rng: np.random.Generator, points: list[np.ndarray], mass: float) -> pf.FlexibleBody:
    """A link with random shapes, rotations and foreshortening, clamped at the origin; it holds the points."""
    spread = max(max(float(np.linalg.norm(p)) for p in points), 0.1)
    nodes = np.vstack([np.zeros(3), points, spread * rng.uniform(-1, 1, (6, 3))])
    masses = mass * np.concatenate([[0.0], rng.uniform(0.5, 1.5, len(nodes) - 1)]) / len(nodes)
    shapes = rng.normal(size=(MODES, len(nodes), 3))
    shapes[:, 0] = 0.0
    gram = np.einsum("k,nka,mka->nm", masses, shapes, shapes)
    shapes = np.einsum("nm,mka->nka", np.linalg.inv(np.linalg.cholesky(gram)), shapes)
    turns = rng.normal(size=shapes.shape) / spread * np.max(np.abs(shapes))
    turns[:, 0] = 0.0
    H = rng.normal(size=(len(points), 3, MODES, MODES)) / spread
    return pf.FlexibleBody.from_nodes(
        nodes,
        masses,
        shapes,
        rng.uniform(200, 2000, MODES),
        0.01,
        list(range(1, len(points) + 1)),
        turns,
        foreshortening=H + np.swapaxes(H, -1, -2),
    )


def bent_leg(leg: pf.Leg, rng: np.random.Generator, links: list[int], flexures: bool = False) -> pf.Leg:
    """The leg with flexible links (from 1) instead of rigid ones, and with flexures at its tips."""
    joints, tips = list(leg.joints), list(leg.tips)
    for j in links:
        held = [placed(joint)[0] for joint in leg.joints if joint.antecedent == j]
        held += [np.asarray(tip.offset) for tip in leg.tips if tip.frame == j]
        mass = float(joints[j - 1].M) or 1.0
        given = {"M": 0.0, "MS": np.zeros(3), "I": np.zeros((3, 3)), "body": body(rng, held, mass)}
        joints[j - 1] = replace(joints[j - 1], **given)
    if flexures:
        M, D = rng.normal(size=(2, 3, 3))
        spring = pf.Flexure(20 * M @ M.T, D @ D.T, 0.5, 0.1, rest=np.eye(3))
        tips = [replace(tip, flexure=spring) for tip in tips]
    return replace(leg, joints=tuple(joints), tips=tuple(tips))
