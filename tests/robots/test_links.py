"""Links from dimensions, against masses at Gauss points, which have the same integrals up to the second."""

from itertools import product

import numpy as np

import parflex as pf
from measures import relative
from parflex.robots.links import box, together, tube


def of_masses(m, points):
    """M, MS, I of equal masses m at points (n, 3)."""
    second = m * points.T @ points
    return m * len(points), m * points.sum(axis=0), np.trace(second) * np.eye(3) - second


def check(found, m, points):
    for a, b in zip(found.values(), of_masses(m, points), strict=True):
        assert relative(a, b) < 1e-14


def test_box():
    size, centre = np.array([0.3, 0.1, 0.05]), np.array([0.2, -0.1, 0.4])
    points = centre + size * np.array(list(product((-1, 1), repeat=3))) / np.sqrt(12)
    check(box(2700.0, size, centre), 2700.0 * 0.3 * 0.1 * 0.05 / 8, points)


def test_tube():
    """On the ring of mean square radius, at ± ℓ/√12 from the middle."""
    start, end = np.array([0.1, 0.2, -0.1]), np.array([0.4, -0.1, 0.3])
    along, middle = end - start, (start + end) / 2
    across = np.linalg.svd(along[None])[2][1:]
    ring = np.sqrt((0.02**2 + 0.015**2) / 2) * np.concatenate([across, -across])
    points = np.concatenate([middle + side * along / np.sqrt(12) + ring for side in (-1, 1)])
    mass = 7850.0 * np.pi * (0.02**2 - 0.015**2) * np.linalg.norm(along)
    check(tube(7850.0, 0.02, start, end, bore=0.015), mass / 8, points)


def test_together():
    """A bar is what its halves are together."""
    halves = tube(1.0, 0.1, (0, 0, 0), (1, 0, 0)), tube(1.0, 0.1, (1, 0, 0), (2, 0, 0))
    whole = tube(1.0, 0.1, (0, 0, 0), (2, 0, 0))
    for name, value in together(*halves).items():
        assert relative(value, whole[name]) < 1e-14


def test_links_of_the_gallery_can_be_built():
    """Mass density is nowhere negative: ∫ (r, 1)(r, 1)ᵀ dm has no negative eigenvalue. The paper's tensors
    are grouped parameters, which no body need have."""
    for entry in pf.robots.ALL_ROBOTS[1:]:
        for joint in (joint for leg in entry.build(modes=0).legs for joint in leg.joints):
            MS = np.asarray(joint.MS)[:, None]
            second = np.trace(joint.I) / 2 * np.eye(3) - joint.I
            pseudo = np.block([[second, MS], [MS.T, np.array([[joint.M]])]])
            assert np.linalg.eigvalsh(pseudo)[0] >= -1e-15
