"""Discs and rings: solids of curved elements, thin plates of many corners; against routes without a mesh."""

import numpy as np
import pytest

import parflex as pf
from round_bodies import frequencies, plate_roots

ALUMINIUM = pf.fe.material("aluminium")
LEISSA = {(2, 0): 5.253, (0, 0): 9.084, (3, 0): 12.23, (1, 0): 20.52}  # 1969, Table 2.5, ν = 0.33
RADIUS = 0.17  # m


@pytest.fixture
def netgen():
    pytest.importorskip("netgen.occ")


def solid_frequencies(outline, thickness, holes=(), count=5, size=None):
    body = pf.fe.solid_body(pf.fe.outline_mesh(outline, thickness, holes, size=size), "aluminium")
    return body, np.sqrt(body.free_modes(count)[0][:count])


def thin_frequencies(radius, thickness, count):
    """Kirchhoff's theory of a circle, closed form."""
    E, nu, rho = ALUMINIUM.young, ALUMINIUM.poisson, ALUMINIUM.density
    scale = np.sqrt(E * thickness**2 / (12 * (1 - nu**2) * rho)) / radius**2
    return np.sort(
        [root * scale for n in range(6) for root in plate_roots(n, nu) for _ in range(2 if n else 1)]
    )[:count]


def test_the_closed_form_is_that_of_the_tables():
    """Leissa's four digits, to 0.2 %; the tests below compare with elasticity in three dimensions."""
    for (n, circles), printed in LEISSA.items():
        assert np.isclose(plate_roots(n, 0.33)[circles], printed, rtol=2e-3)


@pytest.mark.parametrize("bore", [0.0, 0.06])
@pytest.mark.parametrize(
    ("size", "above"), [(0.03, 0.03), pytest.param(None, 3.5e-3, marks=pytest.mark.slow)]
)
def test_thick_discs_and_rings(netgen, bore, size, above):
    """340 × 20 mm: nine frequencies lie above those of Ritz, by 0.35 % at most on the default mesh."""
    holes = [(0, 0, bore / 2)] if bore else []
    body, found = solid_frequencies((0, 0, RADIUS), 0.02, holes, 9, size)
    ratio = found / frequencies(RADIUS, bore, 0.02, ALUMINIUM, 9)
    assert np.all(ratio > 1 - 2e-4)
    assert np.all(ratio < 1 + above)
    m = ALUMINIUM.density * 0.02 * np.pi * (RADIUS**2 - (bore / 2) ** 2)
    assert np.isclose(body.mass[::3, ::3].sum(), m, rtol=1e-3 if size else 2e-4)


@pytest.mark.slow
def test_a_thin_disc_as_a_solid(netgen):
    """A hundredth of its diameter thick: within 0.2 % of Kirchhoff's closed form."""
    _, found = solid_frequencies((0, 0, RADIUS), 0.0034, count=7)
    assert np.allclose(found, thin_frequencies(RADIUS, 0.0034, 7), rtol=2e-3)


@pytest.mark.parametrize(("corners", "error"), [(24, 6e-4), (48, 3e-4)])
def test_thin_plates_of_many_corners_are_round(corners, error):
    """Regular polygons of the circle's area, against the closed form; rotary inertia is nothing here."""
    found = pf.fe.plate_modes(pf.fe.circle(RADIUS, corners), 1e-3, n_modes=7, material="aluminium")
    assert np.isclose(found.moments.m, ALUMINIUM.density * 1e-3 * np.pi * RADIUS**2, rtol=1e-12)
    assert np.allclose(found.frequencies, thin_frequencies(RADIUS, 1e-3, 7), rtol=error)


def test_thin_solids_are_doubted(netgen):
    with pytest.warns(pf.ImplausibleValue, match="thickness is 0.001 m on a plate of 0.34 m, too thin"):
        pf.fe.outline_mesh((0, 0, RADIUS), 1e-3, size=0.05)


@pytest.mark.filterwarnings("ignore::parflex.ImplausibleValue")
@pytest.mark.parametrize(("radius", "thickness"), [(170.0, 0.02), (0.17, 2e-5)])
def test_solids_without_a_mesh_are_refused_at_once(netgen, radius, thickness):
    with pytest.raises(
        pf.InputError, match=f"thickness is {thickness:.6g} m on a plate of .* too thin for any"
    ):
        pf.fe.outline_mesh((0, 0, radius), thickness)


def test_what_netgen_cannot_mesh_is_told_in_a_sentence(netgen, monkeypatch):
    class Geometry:
        def __init__(self, shape):
            pass

        def GenerateMesh(self, settings):
            raise RuntimeError("Meshing failed!")

    monkeypatch.setattr("netgen.occ.OCCGeometry", Geometry)
    with pytest.raises(pf.InputError) as told:
        pf.fe.outline_mesh((0, 0, 0.1713), 0.0217, size=0.05)
    assert str(told.value) == (
        "Netgen finds no mesh of the solid with elements of 0.05 m (Meshing failed!); check the units of its "
        "sizes, or give another size of elements"
    )


def test_joints_in_the_middle_of_a_face(netgen):
    """Patches within the top face of a disc: they hold their points, and the basis knows them."""
    mesh = pf.fe.outline_mesh((0, 0, RADIUS), 0.02, size=0.025)
    joints = [(0.09, 0.0, 0.01), (-0.045, 0.078, 0.01), (-0.045, -0.078, 0.01)]
    found = pf.fe.modes(pf.fe.solid_body(mesh, "aluminium"), joints, tool=(0, 0, -0.01), radius=0.02, n=6)
    assert np.allclose(found.nodes[list(found.corners)], joints)
    assert np.allclose(found.nodes[found.tool], (0, 0, -0.01))
    assert np.max(found.error.compliance) < 1e-6


def test_ribs_and_steps_may_be_round(netgen):
    """A boss and a thinner middle: the volume is that of cylinders."""
    rib, step = pf.fe.Rib((0.1, 0, 0.02), 0.01), pf.fe.Step((0, 0, 0.05), 0.01)
    mesh = pf.fe.outline_mesh((0, 0, RADIUS), 0.02, ribs=[rib], steps=[step], size=0.02)
    volume = np.pi * (RADIUS**2 * 0.02 - 0.05**2 * 0.01 + 0.02**2 * 0.01)
    assert np.isclose(pf.fe.solid_body(mesh, "steel").mass[::3, ::3].sum(), 7850 * volume, rtol=2e-3)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: pf.fe.outline_mesh((0, 0, -0.1), 0.02), "outline radius is -0.1"),
        (lambda: pf.fe.outline_mesh((0, 0.1), 0.02), "outline has shape"),
        (lambda: pf.fe.outline_mesh((0, 0, 0.1), 0.02, holes=[(0, 0, 0.2)]), "nothing is left"),
        (lambda: pf.fe.circle(0.0), "radius is 0.0"),
        (lambda: pf.fe.circle(0.1, 2), "corners is 2"),
    ],
)
def test_no_discs(netgen, make, words):
    with pytest.raises(pf.InputError, match=words):
        make()
