"""The elements of imported models: volumes, inertia and surfaces that are known by formula."""

import numpy as np
import pytest

from parflex.fe.body.elements import ELEMENTS, Elements, mass_matrix
from parflex.fe.body.surface import surface

SIZE = {"line2": 1, "tri3": 1 / 2, "tri6": 1 / 2, "quad4": 1, "quad8": 1, "tet4": 1 / 6, "tet10": 1 / 6,
        "wedge6": 1 / 2, "wedge15": 1 / 2, "hex8": 1, "hex20": 1}  # fmt: skip
SKEW = np.array([[1.0, 0.3, 0.1], [-0.2, 0.8, 0.0], [0.1, 0.2, 1.2]])


def places(kind: str) -> np.ndarray:
    """The reference element, (n, 3)."""
    points = ELEMENTS[kind].points
    return np.pad(points, ((0, 0), (0, 3 - points.shape[1])))


@pytest.mark.parametrize("kind", ELEMENTS)
def test_mass_and_second_moment_of_a_skew_element(kind):
    """∫ r rᵀ of x → A x is A ∫ x xᵀ Aᵀ times the stretch; that of the reference element by many points."""
    nodes = places(kind) @ SKEW.T
    m = mass_matrix(nodes, [Elements(kind, np.arange(len(nodes))[None], np.array([2.0]))]).toarray()
    d = ELEMENTS[kind].points.shape[1]
    stretch = np.sqrt(np.linalg.det(SKEW[:, :d].T @ SKEW[:, :d]))
    assert m.sum() == pytest.approx(2.0 * SIZE[kind] * stretch, rel=1e-12)
    assert np.allclose(nodes.T @ m @ nodes, 2.0 * stretch * SKEW @ second_moment(kind) @ SKEW.T, atol=1e-12)


def second_moment(kind: str) -> np.ndarray:
    """∫ x xᵀ over [0, 1]^d, the simplex, or a simplex times a span, by formula."""
    d = ELEMENTS[kind].points.shape[1]
    out = np.zeros((3, 3))
    if kind.startswith(("tri", "tet")):  # ∫ x_i x_j = d! V (1 + δ_ij) / (d + 2)! of unit simplices
        out[:d, :d] = (np.ones((d, d)) + np.eye(d)) / {2: 24, 3: 120}[d]
    elif kind.startswith("wedge"):
        out[:2, :2] = (np.ones((2, 2)) + np.eye(2)) / 24
        out[2, 2], out[:2, 2], out[2, :2] = 1 / 6, 1 / 12, 1 / 12
    else:
        out[:d, :d] = np.full((d, d), 1 / 4) + np.eye(d) / 12
    return out


@pytest.mark.parametrize("kind", [kind for kind in ELEMENTS if kind != "line2"])
def test_surface_of_one_element(kind):
    """Of known area; that of a solid is closed: its area vectors sum to zero."""
    nodes = places(kind)
    corners = nodes[surface([Elements(kind, np.arange(len(nodes))[None], np.ones(1))])]
    vectors = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = {"tri": 0.5, "qua": 1.0, "tet": 1.5 + np.sqrt(3) / 2, "wed": 3.0 + np.sqrt(2), "hex": 6.0}[
        kind[:3]
    ]
    assert np.sum(np.linalg.norm(vectors, axis=1)) == pytest.approx(area, rel=1e-12)
    if ELEMENTS[kind].points.shape[1] == 3:
        assert np.allclose(vectors.sum(axis=0), 0, atol=1e-12)


def test_two_bricks_share_no_surface():
    """Twelve nodes, two bricks side by side: ten faces outside."""
    second = [1, 8, 9, 2, 5, 10, 11, 6]
    found = surface([Elements("hex8", np.array([np.arange(8), second]), np.ones(2))])
    assert len(found) == 2 * 10
    assert not any(set(triangle) <= {1, 2, 5, 6} for triangle in found)
