"""Links of finite elements: against beams, their own model condensed on its ends, and closed forms;
misuse."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve
from scipy.spatial.transform import Rotation

import parflex as pf
from blocks import STEEL as BLOCK_STEEL
from blocks import box
from parflex.fe.body.integrals import nodal_moments
from parflex.robot.modal import modal_mass
from parts import INNER, LENGTH, OUTER, STEEL, drawn, notch, step_tube, tube, tube_shape

SIDES, CELLS = (0.3, 0.02, 0.03), (12, 1, 2)
ENDS = {"frame": (-0.15, 0, 0), "interfaces": [(0.15, 0, 0)]}


def compliance(body: pf.FlexibleBody) -> np.ndarray:
    """(6, 6) of forces and moments at the first interface, by the modes."""
    Phi = np.vstack([body.attachment_shapes[0], body.attachment_turns[0]])
    return Phi / body.stiffness @ Phi.T


def block() -> pf.fe.FreeBody:
    return pf.fe.solid_body(box(SIDES, CELLS), BLOCK_STEEL)


def matrices() -> pf.fe.FreeBody:
    """The same without its elements, as if another program had made them."""
    whole = block()
    return pf.fe.body_of_matrices(whole.nodes, whole.stiffness, whole.mass, triangles=whole.triangles)


def test_a_tube_from_step_is_a_beam():
    """First bending frequency, compliances of a pull, a push aside, a moment and a twist."""
    found = step_tube()
    beam = pf.beam((0, 0, LENGTH), OUTER, INNER, **STEEL, bending=3, static=True, axial=1, torsion=1)
    assert found.frequencies[:2] == pytest.approx(beam.frequencies[:2], rel=5e-3)
    mine, closed = compliance(found), compliance(beam)
    assert np.diagonal(mine) == pytest.approx(np.diagonal(closed), rel=5e-3)
    assert mine[0, 4] == pytest.approx(closed[0, 4], rel=5e-3)


def test_what_a_tube_bends_more_than_a_beam_is_shear():
    """ℓ/(κGA) of a thin tube, κ = 2 (1 + ν)/(4 + 3 ν) (Cowper 1966): 0.33 % without Poisson's ratio, where
    the clamped end does not hold the section round."""
    cork = pf.fe.Material(STEEL["young"], 0.0, STEEL["density"])
    solid = tube().solid
    body = pf.fe.solid_body(pf.fe.SolidMesh(tube().nodes, solid.elements, solid.parts), cork)
    mine = compliance(pf.fe.link(body, (0, 0, 0), [(0, 0, LENGTH)], n_modes=0))
    area, second = np.pi / 4 * (OUTER**2 - INNER**2), np.pi / 64 * (OUTER**4 - INNER**4)
    expected = LENGTH**3 / (3 * cork.young * second) + 4 * LENGTH / (cork.young * area)
    assert np.diagonal(mine)[:2] == pytest.approx([expected] * 2, rel=2e-4)


def test_a_tube_weighs_what_it_does():
    """Mass, centre and inertia of a tube, by the textbook."""
    m = step_tube().moments
    mass = STEEL["density"] * np.pi / 4 * (OUTER**2 - INNER**2) * LENGTH
    across = (OUTER**2 + INNER**2) / 16
    assert m.m == pytest.approx(mass, rel=1e-4)
    assert pytest.approx([0, 0, mass * LENGTH / 2], abs=1e-4 * mass * LENGTH) == m.MS0
    expected = mass * np.diag([across, across, LENGTH**2 / 3])
    assert np.max(np.abs(m.P0 - expected)) < 1e-4 * expected[2, 2]
    assert np.max(np.abs((m.P0 - expected)[:2, :2])) < 1e-3 * expected[0, 0]


def test_a_tube_comes_nearer_as_a_beam_does():
    """Second-order displacement of the end under a force and a moment across it."""
    mine, beam = step_tube(), pf.beam((0, 0, LENGTH), OUTER, INNER, **STEEL, bending=0, static=True)
    drawn_in = []
    for body in (mine, beam):
        loads = np.vstack([body.attachment_shapes[0][:1], body.attachment_turns[0][1:2]])
        e = loads / body.stiffness
        drawn_in.append(np.einsum("km,aml,nl->akn", e, body.foreshortening[0], e))
    assert drawn_in[0][2] == pytest.approx(drawn_in[1][2], rel=5e-3)
    assert np.max(np.abs(drawn_in[0][:2])) < 1e-12 * np.max(np.abs(drawn_in[0][2]))


def condensed(body: pf.fe.FreeBody, fixed: np.ndarray, held: np.ndarray, point: np.ndarray) -> np.ndarray:
    """The compliance (6, 6) of the nodes `held` in the mean, the nodes `fixed` still, by the whole matrix: a
    force is spread alike over the nodes, a moment as forces that grow with the distance from their centre."""
    s = body.nodes[held] - body.nodes[held].mean(axis=0)
    J = np.sum(s**2) * np.eye(3) - s.T @ s
    loads = np.zeros((6, len(body.nodes), 3))
    for k, axis in enumerate(np.eye(3)):
        turned = np.cross(
            body.nodes[held].mean(axis=0) - point, axis
        )  # the moment of the force about the point
        loads[k, held] = axis / len(held) - np.cross(np.linalg.solve(J, turned), s)
        loads[3 + k, held] = np.cross(np.linalg.solve(J, axis), s)
    free = np.setdiff1d(np.arange(3 * len(body.nodes)), (3 * fixed[:, None] + np.arange(3)).ravel())
    F = loads.reshape(6, -1).T[free]
    return F.T @ spsolve(body.stiffness.tocsc()[free][:, free], F)


def test_a_notch_is_as_stiff_as_its_finite_elements():
    """All six stiffnesses and their coupling, of the neck of 1 mm, to 1e-6."""
    body = notch()
    link = pf.fe.link(body, (0, 0, 0), [(0, 0, 0.04)])
    fixed, held = (np.flatnonzero(np.abs(body.nodes[:, 2] - z) < 1e-9) for z in (0.0, 0.04))
    expected = np.linalg.inv(condensed(body, fixed, held, np.array([0, 0, 0.04])))
    found = np.linalg.inv(compliance(link))
    scale = np.sqrt(np.outer(np.diagonal(expected), np.diagonal(expected)))
    assert np.max(np.abs(found - expected) / scale) <= 1e-6
    assert np.diagonal(found) == pytest.approx(np.diagonal(expected), rel=1e-6)


def test_directions_that_are_negligible_are_rigid():
    """A pull along a slender bar gives little: 10 modes less one."""
    assert pf.fe.link(block(), **ENDS).modes == 10
    fewer = pf.fe.link(block(), **ENDS, negligible=1e-2)
    assert fewer.modes == 9
    assert compliance(fewer)[0, 0] < 1e-3 * compliance(pf.fe.link(block(), **ENDS))[0, 0]


def test_shapes_vanish_at_the_frame_and_are_orthonormal():
    link = pf.fe.link(block(), **ENDS, n_modes=3, damping_ratio=0.01)
    assert link.origin_node == 0
    at_frame = np.abs(link.nodes[:, 0]) < 1e-12
    assert np.all(link.shapes[:, at_frame] == 0)
    assert np.all(link.rotation_shapes[:, at_frame] == 0)
    assert np.max(np.abs(link.m_ee - np.eye(9))) < 1e-12
    assert link.damping_ratios == pytest.approx(np.full(9, 0.01))
    assert link.attachment_points == pytest.approx(np.array([[0.3, 0, 0]]))


def test_a_frame_anywhere_is_the_part_moved_there():
    """Axes and origin by arguments, against the mesh turned and shifted before its matrices are made."""
    R, origin = Rotation.from_rotvec([0.4, -0.3, 0.9]).as_matrix(), np.array([-0.15, 0.002, 0.004])
    mesh = box(SIDES, CELLS)
    moved = pf.fe.SolidMesh((mesh.nodes - origin) @ R, mesh.elements, mesh.parts)
    end = (np.array([0.15, 0, 0]) - origin) @ R
    found = pf.fe.link(pf.fe.solid_body(mesh, BLOCK_STEEL), origin, ENDS["interfaces"], rotation=R)
    expected = pf.fe.link(pf.fe.solid_body(moved, BLOCK_STEEL), (0, 0, 0), [end])
    assert found.frequencies == pytest.approx(expected.frequencies, rel=1e-8)
    for name in ("m", "MS0", "P0"):
        mine, theirs = (np.asarray(getattr(body.moments, name)) for body in (found, expected))
        assert np.max(np.abs(mine - theirs)) < 1e-12 * np.max(np.abs(theirs))
    sign = np.sign(np.sum(found.shapes * expected.shapes, axis=(1, 2)))  # coordinates choose the signs
    both = np.multiply.outer(sign, sign)
    for name in ("S", "P1", "P2"):
        mine, theirs = (getattr(body.moments, name) for body in (found, expected))
        theirs = theirs * {"S": sign, "P1": sign[:, None, None]}.get(name, both[..., None, None])
        assert np.max(np.abs(mine - theirs)) < 1e-7 * np.max(np.abs(theirs))
    H = expected.foreshortening * both
    assert np.max(np.abs(found.foreshortening - H)) < 1e-7 * np.max(np.abs(H))


def test_three_interfaces_hold_each_for_itself():
    """The middle of a bar is an interface too; its compliance is that of a bar of half the length."""
    body = pf.fe.solid_body(box((0.3, 0.02, 0.02), (12, 1, 1)), BLOCK_STEEL)
    link = pf.fe.link(body, (-0.15, 0, 0), [(0.15, 0, 0), (0, 0, 0.01)], radius=0.0145)
    assert len(link.attachments) == 2
    assert link.foreshortening.shape == (2, 3, 16, 16)
    slender = 0.15**3 / (3 * 2.1e11 * 0.02**4 / 12)
    across = np.sum(link.attachment_shapes[1, 1] ** 2 / link.stiffness)
    assert across == pytest.approx(slender, rel=0.05)


def test_matrices_are_the_same_link_without_foreshortening():
    """P_cr of the warning is Euler's, of the bar's weaker bending; shear and the clamp make it 5 % less."""
    euler = np.pi**2 * 2.1e11 * 0.03 * 0.02**3 / 12 / 0.3**2
    with pytest.warns(pf.NoForeshortening, match="P_cr about") as told:
        link = pf.fe.link(matrices(), **ENDS)
    [load] = re.findall(r"P_cr about (\S+) N", str(told[0].message))
    assert float(load) == pytest.approx(euler, rel=0.05)
    own = pf.fe.link(block(), **ENDS)
    assert link.stiffness == pytest.approx(own.stiffness, rel=1e-9)
    assert link.foreshortening is None
    given = pf.fe.link(matrices(), **ENDS, foreshortening=own.foreshortening)
    assert np.array_equal(given.foreshortening, own.foreshortening)


def test_nodes_by_their_numbers_are_patches():
    """Of matrices without a surface: the same nodes as the faces have."""
    whole = block()
    bare = pf.fe.body_of_matrices(whole.nodes, whole.stiffness, whole.mass)
    H = pf.fe.link(whole, **ENDS).foreshortening
    mine = pf.fe.link(bare, ids=FACES, foreshortening=H)
    assert mine.stiffness == pytest.approx(pf.fe.link(whole, **ENDS).stiffness, rel=1e-9)
    numbered = replace(bare, ids=tuple(range(100, 100 + len(bare.nodes))))
    ids = [[100 + node for node in group] for group in FACES]
    assert pf.fe.link(numbered, ids=ids, foreshortening=H).stiffness == pytest.approx(mine.stiffness)


def test_modes_of_a_free_body_are_held_at_the_frame():
    """Their integrals by the masses of the finite elements and the shapes found; their lowest frequencies
    nearly, and their compliance at most, those of the clamped body."""
    body = block()
    with pytest.warns(pf.NoForeshortening):
        link = pf.fe.link(pf.fe.FreeFree(30).modes(body), **ENDS)
    nodes = slice(1, 1 + len(body.nodes))  # the frame's comes first
    expected = nodal_moments(link.nodes[nodes], body.mass[::3, ::3], link.shapes[:, nodes])
    for name, mine, theirs in zip(expected._fields, link.moments, expected, strict=True):
        assert np.max(np.abs(mine - theirs)) <= 1e-9 * np.max(np.abs(theirs)), name
    assert np.max(np.abs(modal_mass(link.moments) - np.eye(link.modes))) < 1e-10
    assert np.max(np.abs(link.shapes[:, link.origin_node])) < 1e-9 * np.max(np.abs(link.shapes))
    right = pf.fe.link(body, **ENDS, n_modes=6)
    assert link.frequencies[:2] == pytest.approx(right.frequencies[:2], rel=0.1)
    with pytest.warns(pf.NoForeshortening):
        fewer = pf.fe.link(pf.fe.FreeFree(30).modes(body), **ENDS, n_modes=10)
    assert fewer.modes == 10
    few, many, all_of_them = (np.diagonal(compliance(each))[1:3] for each in (fewer, link, right))
    assert np.all((few < many) & (many < all_of_them))  # the fewer, the stiffer
    assert np.all(many > 0.85 * all_of_them)


def spoilt(field, change):
    """The matrices of a bar with one entry changed."""
    body = matrices()
    matrix = getattr(body, field).tolil()
    change(matrix)
    return replace(body, **{field: matrix.tocsr()})


def negative(matrix):
    matrix[30, 30] = -matrix[30, 30]


BODY = block()
FACES = [np.flatnonzero(np.abs(BODY.nodes[:, 0] - x) < 1e-9).tolist() for x in (-0.15, 0.15)]
EDGE = np.all(np.abs(BODY.nodes - [0.15, 0.01, 0.0]) < [1e-9, 1e-9, 1.0], axis=1)
IN_A_ROW = np.flatnonzero(EDGE)[:3].tolist()
BAD = {
    "no frame": (lambda: pf.fe.link(BODY, interfaces=[(0.15, 0, 0)]), "frame is missing; give the point"),
    "no interface": (lambda: pf.fe.link(BODY, (-0.15, 0, 0)), "interfaces is missing; give the points"),
    "an interface in the air": (
        lambda: pf.fe.link(BODY, (-0.15, 0, 0), [(0.25, 0, 0)]),
        r"interfaces\[0\] at \[0.25 0.   0.  \] m is nowhere on the part: the nearest face, .* 0.1 m away",
    ),
    "away from any radius": (
        lambda: pf.fe.link(BODY, (-0.15, 0, 0), [(0.25, 0, 0)], radius=0.02),
        r"interfaces\[0\] at .* is off the body",
    ),
    "one face twice": (
        lambda: pf.fe.link(BODY, (-0.15, 0, 0), [(-0.15, 0.001, 0)]),
        r"frame and interfaces\[0\] both hold node",
    ),
    "an interface at the frame": (
        lambda: pf.fe.link(BODY, (0, 0, 0), [(0, 0, 0)], ids=FACES),
        r"interfaces\[0\] is at .* the origin of the frame",
    ),
    "one node": (
        lambda: pf.fe.link(matrices(), ids=[FACES[0], FACES[1][:1]]),
        r"interfaces\[0\] is a patch of 1 nodes, which do not",
    ),
    "a row of nodes": (
        lambda: pf.fe.link(matrices(), ids=[FACES[0], IN_A_ROW]),
        r"interfaces\[0\] is a patch of 3 nodes, .* in one line",
    ),
    "an unknown node": (
        lambda: pf.fe.link(matrices(), ids=[FACES[0], [99999, 3, 4]]),
        r"ids\[1\] has node 99999, which the model has not",
    ),
    "no lists of nodes": (lambda: pf.fe.link(BODY, ids=[[0, 1, 2]]), "ids has 1 lists of nodes; give the"),
    "ids and a radius": (lambda: pf.fe.link(BODY, ids=[[0], [1]], radius=0.1), "radius is 0.1 beside ids"),
    "no surface": (
        lambda: pf.fe.link(replace(BODY, triangles=BODY.triangles[:0]), **ENDS),
        "frame names a face, but the body has no surface",
    ),
    "a stiffness that gives way": (
        lambda: pf.fe.link(spoilt("stiffness", negative), **ENDS),
        "stiffness is not positive definite with the frame held: .* of its pivots",
    ),
    "a mass that is negative": (
        lambda: pf.fe.link(spoilt("mass", negative), **ENDS),
        "mass is not positive definite: .* of its pivots",
    ),
    "an uneven stiffness": (
        lambda: pf.fe.body_of_matrices(BODY.nodes, BODY.stiffness.tolil().T.tocsr() * 1.0 + one(), BODY.mass),
        "stiffness is not symmetric",
    ),
    "too many modes": (lambda: pf.fe.link(BODY, **ENDS, n_modes=5000), "n_modes is 5000, more than the"),
    "a plate": (
        lambda: pf.fe.link(pf.fe.plate_body([(0, 0), (1, 0), (0, 1)], 0.01, material="steel"), **ENDS),
        "body is a plate, of which no link is made",
    ),
    "a number": (lambda: pf.fe.link(3.0, **ENDS), "body is float; expected a FreeBody"),
}


def one():
    """A matrix of one large entry off its diagonal."""
    matrix = BODY.stiffness.tolil() * 0.0
    matrix[0, 5] = 1e12
    return matrix.tocsr()


@pytest.mark.parametrize("name", BAD)
def test_what_is_wrong_is_said_in_one_sentence(name):
    wrong, words = BAD[name]
    with pytest.raises(pf.InputError, match=words) as caught:
        wrong()
    assert "\n" not in str(caught.value)


def test_step_files_that_are_no_link(tmp_path):
    """Two bodies apart, and a file that was cut off."""
    occ = pytest.importorskip("netgen.occ")
    two = occ.Compound([occ.Box((0, 0, 0), (10, 10, 10)), occ.Box((20, 0, 0), (30, 10, 10))])
    with pytest.raises(pf.InputError, match="2 parts that do not touch, .* a body is one piece"):
        drawn(occ, two, size=0.01)
    tube_shape(occ).WriteStep(str(tmp_path / "tube.step"))
    text = (tmp_path / "tube.step").read_text()
    for part in (0.3, 0.6, 0.95):
        (tmp_path / "cut.step").write_text(text[: int(part * len(text))])
        with pytest.raises(pf.InputError, match=r"cut.step (is damaged|names no unit|holds no solid)"):
            pf.fe.step_mesh(tmp_path / "cut.step", size=0.007)
