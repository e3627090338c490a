"""The paper's plate as a solid, against converged values of other elements."""

import numpy as np
import pytest

import parflex as pf
from paper_robot import PLATE, corners

pytestmark = pytest.mark.slow

# ν = 0.3, elastic modes 1, 3, 4, 5, 6, 8, 10 (rad/s): the values that solid elements of other kinds and
# 30,000 to 400,000 unknowns tend to; a thin plate (test_plate.py) has up to 1.1 % more, having no shear.
HEXAGON = {1: 188.562, 3: 315.926, 4: 399.913, 5: 475.607, 6: 701.754, 8: 753.460, 10: 1182.02}


def errors(size: float | None, most: int) -> np.ndarray:
    """Relative differences of the seven frequencies."""
    mesh = pf.fe.outline_mesh(corners(), PLATE["thickness"], size=size)
    body = pf.fe.solid_body(mesh, pf.fe.Material(PLATE["young"], PLATE["poisson"], PLATE["density"]))
    assert body.unknowns <= most
    found = np.sqrt(body.free_modes(10)[0])
    return np.array([found[mode - 1] / omega - 1 for mode, omega in HEXAGON.items()])


def test_default_mesh():
    """≤ 35,000 unknowns, ≤ 0.6 %, from above (Ritz)."""
    found = errors(None, 35_000)
    assert np.all((found > 0) & (found <= 6e-3))


def test_extrapolated_from_two_meshes():
    """≤ 0.15 %, to first order in the elements' size: the error is that of a layer along the free edges, as
    wide as the plate is thick and narrower than the elements."""
    coarse, fine = errors(0.03, 35_000), errors(0.02, 70_000)
    assert np.max(np.abs(fine - (coarse - fine) * 0.02 / 0.01)) <= 1.5e-3
