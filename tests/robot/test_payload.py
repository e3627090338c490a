"""Payloads on rigid and flexible platforms, against masses at points that are fixed to the body."""

from dataclasses import replace

import numpy as np
import pytest

import parflex as pf
from measures import relative
from parflex.robot.moments import lumped_moments, with_point
from parflex.robot.payload import fitted_turn

CORNERS = np.array([(0.0, 0.0), (0.5, 0.0), (0.6, 0.4), (0.0, 0.3)])
COM = np.array([0.2, 0.1, 0.15])


def plate(modes: int = 4, refine: int | None = None) -> pf.FlexibleBody:
    return pf.FlexibleBody.from_modes(pf.fe.plate_modes(CORNERS, 0.01, 7e10, 0.3, 2700.0, modes, refine))


def six_points(rng: np.random.Generator) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
    """Equal masses at ± three vectors from a centre: mass, places from it, and I = ∫ |s|² 1 − s sᵀ."""
    half = rng.normal(size=(3, 3)) * 0.05
    s = np.concatenate([half, -half])
    m = 0.5
    second = m * s.T @ s
    return m, s, np.trace(second) * np.eye(3) - second, second


@pytest.mark.parametrize("modes", [0, 4])
def test_a_payload_is_the_points_that_it_consists_of(modes):
    """Each point moves with the node under the payload, u = Φ_d + Φ_r × arm, and adds m u uᵀ."""
    body, rng = plate(modes), np.random.default_rng(modes)
    m, s, inertia, _ = six_points(rng)
    found = pf.Payload(6 * m, COM, inertia).on(body).moments
    node = int(np.argmin(np.linalg.norm(body.nodes - COM, axis=1)))
    expected = body.moments
    for point in COM + s:
        Phi, _ = body.shapes_at(node, point - body.nodes[node])
        expected = with_point(expected, m, point, Phi.T)
    for name, value in expected._asdict().items():
        assert relative(getattr(found, name), value) < 1e-13, name


def test_a_node_of_ones_choice():
    body = plate()
    node = 3
    point = pf.Payload(2.0, body.nodes[node], node=node).on(body)
    expected = body.with_payload(node, 2.0)
    assert all(relative(a, b) < 1e-15 for a, b in zip(point.moments, expected.moments, strict=True))
    assert np.array_equal(point.stiffness, body.stiffness)


def test_rigid_motion_is_that_of_one_body():
    """N = 0: mass, centre and inertia of both together, by the parallel axes."""
    disc = pf.FlexibleBody.rigid(2.0, (0, 0, 0), np.diag([0.1, 0.1, 0.2]), np.zeros((0, 3)))
    found = pf.Payload(3.0, COM, np.diag([0.01, 0.02, 0.025])).on(disc).moments
    inertia = np.trace(found.P0) * np.eye(3) - found.P0
    steiner = 3.0 * (COM @ COM * np.eye(3) - np.outer(COM, COM))
    assert relative(found.m, 5.0) == 0
    assert relative(found.MS0, 3.0 * COM) < 1e-15
    assert relative(inertia, np.diag([0.11, 0.12, 0.225]) + steiner) < 1e-15


def test_turning_without_rotations_is_that_of_the_neighbours():
    """A body that moves rigidly turns everywhere alike; one that bends, nearly as its node."""
    rng = np.random.default_rng(5)
    nodes, turns = rng.normal(size=(40, 3)), rng.normal(size=(2, 3))
    shapes = np.cross(turns[:, None], nodes) + rng.normal(size=(2, 1, 3))
    rigid = pf.FlexibleBody(lumped_moments(nodes, np.ones(40), shapes), nodes, shapes, None, np.ones(2),
                            np.zeros(2), (0,))  # fmt: skip
    assert relative(fitted_turn(rigid, 7), turns) < 1e-13
    body = plate(refine=3)
    inner = int(np.argmin(np.linalg.norm(body.nodes, axis=1)))
    exact = body.rotation_shapes[:, inner]
    bare = replace(body, rotation_shapes=None)
    assert np.max(np.abs(fitted_turn(bare, inner) - exact)) < 0.02 * np.max(np.abs(body.rotation_shapes))


MISUSE = {
    "no mass": (lambda: pf.Payload(0.0), "Payload.mass is 0.0; it must be positive"),
    "no body": (lambda: pf.Payload(1.0, inertia=np.diag([1, 1, 5.0])), "which no body has"),
    "not symmetric": (lambda: pf.Payload(1.0, inertia=np.triu(np.ones((3, 3)))), "must be symmetric"),
    "a place in words": (lambda: pf.Payload(1.0, com="middle"), "Payload.com is not an array of numbers"),
    "half a node": (lambda: pf.Payload(1.0, node=1.5), "Payload.node is 1.5; it must be a whole number"),
}


@pytest.mark.parametrize("name", MISUSE)
def test_misuse_is_told_in_a_sentence(name):
    make, words = MISUSE[name]
    with pytest.raises(pf.InputError, match=words):
        make()
