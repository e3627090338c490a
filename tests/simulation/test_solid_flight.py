"""The paper's robot with its plate as a solid and as a Kirchhoff plate, 9 + 6 modes each."""

import numpy as np
import pytest

import parflex as pf
from paper_robot import PLATE, corners, held
from parflex.app import paper

pytestmark = pytest.mark.slow

END = 0.9  # s: rest, and a third of the first move


def solid() -> pf.Modes:
    """In-plane directions of the corners left out: they give 0.3 % of what the normal ones do."""
    mesh = pf.fe.outline_mesh(corners(), PLATE["thickness"], size=0.045)
    material = pf.fe.Material(PLATE["young"], PLATE["poisson"], PLATE["density"])
    joints = np.column_stack([corners(), np.zeros(6)])
    return pf.fe.FreeFreeWithAttachment(9, joints, negligible=0.01).modes(pf.fe.solid_body(mesh, material))


def thin() -> pf.Modes:
    return pf.fe.plate_modes(corners(), n_modes=pf.fe.FreeFreeWithAttachment(9), **PLATE)


@pytest.fixture(scope="module")
def runs():
    """Along the paper's trajectory."""
    found = []
    for modes in (thin(), solid()):
        assert len(modes.frequencies) == 15
        model = pf.Model(pf.robots.gough_stewart(platform=held(modes)))
        way = paper.trajectory(model.robot)
        start, _ = model.equilibrium(*model.robot.home_pose)
        times = np.linspace(0.0, END, 91)
        found.append(pf.simulate(model, pf.ComputedTorque(model, way), start, times, rtol=1e-6).dataset)
    return found


@pytest.mark.parametrize(
    ("name", "most"), [("contact_forces", 2e-3), ("forces", 3e-3), ("attachment_deformation", 2e-2)]
)
def test_two_theories_of_one_plate(runs, name, most):
    """Forces hardly differ; the solid bends up to 1 % more at its corners, since it has shear."""
    one, other = (run[name].values for run in runs)
    assert np.max(np.abs(one - other)) <= most * np.max(np.abs(one))
    assert np.max(np.abs(one)) > 1e-3
