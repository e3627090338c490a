"""A plate on six struts against its whole finite-element model on six springs, and where a basis warns."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import block_diag, eigh

import parflex as pf
from parflex.fe.body.joints import places
from parflex.robots.gough_stewart import corners

PLATE = pf.fe.plate_body(corners(), thickness=0.015, material="steel")
POINTS, CENTRE = np.pad(corners(), ((0, 0), (0, 1))), (0.0, 0.0, 0.0)
ETA = 0.02


def on_struts(modes: pf.Modes, k: float) -> pf.Robot:
    """The paper's robot without weight under another plate, on springs of k N/m whose legs weigh 1e-7 kg."""
    robot = pf.robots.gough_stewart(platform=pf.FlexibleBody.from_modes(modes, POINTS))
    q = pf.Model(robot, "numpy").joints(robot.home).q
    legs = []
    for leg, joints in zip(robot.legs, q, strict=True):
        light = {"M": 1e-7, "MS": np.zeros(3), "I": 1e-9 * np.eye(3), "Fv": 0.0, "Fs": 0.0, "IA": 0.0}
        first, second, slide = (replace(joint, **light) for joint in leg.joints)
        legs.append(replace(leg, joints=(first, second, replace(slide, k=k, q_0=joints[2]))))
    return replace(robot, legs=tuple(legs), gravity=(0.0, 0.0, 0.0))


def whole(robot: pf.Robot, k: float, w: np.ndarray) -> np.ndarray:
    """z over a force along z at the centre by all modes of the finite-element model, whose plane is rigid, on
    springs at the joints: (K (1 + iη) − ω² M)⁻¹."""
    m = robot.platform.moments
    M = block_diag(PLATE.mass.toarray(), np.diag([m.m, m.m, m.P0[0, 0] + m.P0[1, 1]]))
    K = block_diag(PLATE.stiffness.toarray(), np.zeros((3, 3)))
    moves = []
    for held in places(PLATE, POINTS, CENTRE):
        x, y, _ = held.point
        moves.append(np.hstack([held.displacement.toarray(), [[1, 0, -y], [0, 1, x], [0, 0, 0]]]))
    home = robot.home
    for leg in robot.legs:
        number = leg.tips[0].attachment
        strut = home.position + home.rotation @ robot.platform.attachment_points[number] - leg.origin
        along = moves[number].T @ home.rotation.T @ strut / np.linalg.norm(strut)
        K = K + k * np.outer(along, along)
    squares, shapes = eigh(K, M)
    seen = shapes.T @ moves[-1][2]
    return np.array([np.sum(seen**2 / (squares * (1 + 1j * ETA) - each**2)) for each in w])


def responses(basis: pf.fe.Basis, k: float) -> tuple[np.ndarray, np.ndarray]:
    """The compliance of the library at the centre and that of the whole model, up to half the highest
    free–free frequency."""
    modes = basis.modes(PLATE)
    robot = on_struts(modes, k)
    model = pf.Model(robot, "numpy")
    lin = model.linearise(*model.equilibrium(*robot.home_pose))
    w = np.linspace(20.0, modes.band / 2, 4000)
    node = int(np.argmin(np.linalg.norm(robot.platform.nodes, axis=1)))
    return pf.compliance(lin, node)(w, structural=ETA).values[2, 2], whole(robot, k, w)


@pytest.mark.parametrize("k", [1e6, 2e7])
def test_a_tool_in_the_basis_answers_as_the_whole_model(k):
    """No more than 1e-3 of the peak, and 0.1 dB in the median; and no warning."""
    with warnings.catch_warnings(action="error", category=pf.BeyondBasis):
        found, expected = responses(pf.fe.FreeFreeWithAttachment(18, POINTS, tool=CENTRE), k)
    assert np.max(np.abs(found - expected)) <= 1e-3 * np.max(np.abs(expected))
    assert np.median(np.abs(20 * np.log10(np.abs(found / expected)))) <= 0.1


@pytest.mark.parametrize(
    ("basis", "words"),
    [
        (pf.fe.FreeFreeWithAttachment(9, POINTS), "its modes lack 1[0-9.]* %"),
        (pf.fe.FreeFree(10, POINTS), "its modes lack 1[0-9.]* %"),
    ],
)
def test_a_tool_that_is_not_in_the_basis_is_warned_of(basis, words):
    """With what its static compliance lacks, by the whole model (the share is checked below)."""
    with pytest.warns(pf.BeyondBasis, match=words):
        found, expected = responses(basis, 1e6)
    assert np.median(np.abs(20 * np.log10(np.abs(found / expected)))) > 0.1


def test_what_is_lacking_at_the_nodes():
    """Against static solutions of the whole model: the response of the free plate to forces at its centre,
    under inertia relief, and that of the modes."""
    from parflex.fe.body.response import static_response

    modes = pf.fe.FreeFree(10, POINTS).modes(PLATE)
    held = places(PLATE, POINTS)
    whole = np.diagonal(static_response(PLATE, held).compliance)[2::3]
    nodes = list(modes.corners)
    kept = np.sum((modes.shapes[:, nodes, 2] / modes.frequencies[:, None]) ** 2, axis=0)
    assert np.allclose(modes.missed[nodes], 1 - kept / whole, rtol=1e-6)
    exact = pf.fe.FreeFreeWithAttachment(10, POINTS).modes(PLATE)
    assert np.max(np.abs(exact.missed[list(exact.corners)])) <= 1e-6


def test_frequencies_beyond_the_basis_are_warned_of():
    """Half the highest free–free mode, which the attachment modes do not raise."""
    modes = pf.fe.FreeFreeWithAttachment(9, POINTS).modes(PLATE)
    assert modes.band == pytest.approx(pf.fe.FreeFree(9, POINTS).modes(PLATE).frequencies[-1], rel=1e-9)
    robot = on_struts(modes, 1e6)
    model = pf.Model(robot, "numpy")
    lin = model.linearise(*model.equilibrium(*robot.home_pose))
    with pytest.warns(pf.BeyondBasis, match=r"omega reaches .* Hz, but the platform's modes are right up to"):
        lin.frf([1.0, 0.6 * modes.band])
    with warnings.catch_warnings(action="error", category=pf.BeyondBasis):
        lin.frf([1.0, 0.4 * modes.band])


def test_files_keep_it(tmp_path):
    """Band and what is missed at nodes, in modal files."""
    modes = pf.fe.FreeFreeWithAttachment(5, POINTS).modes(PLATE)
    again = pf.fe.read_modes(pf.fe.write_modes(modes, tmp_path / "plate.nc"))
    assert again.band == modes.band
    assert np.array_equal(again.missed, modes.missed, equal_nan=True)


def test_an_unstable_equilibrium_is_told_with_its_growth():
    """The paper's robot under constant forces falls over; its largest real part is that of the poles."""
    model = pf.Model(pf.robots.gough_stewart(2), "numpy")
    lin = model.linearise(*model.equilibrium(*model.robot.home_pose))
    growth = np.max(lin.poles.real)
    with pytest.warns(pf.UnstableEquilibrium, match=f"a motion grows e-fold in {1 / growth:.3g} s"):
        lin.frf([10.0])
