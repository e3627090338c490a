"""Bases: what they span, what they leave out, and how they say so."""

import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scipy.linalg import eigh, null_space

import parflex as pf
from blocks import STEEL, box, two_blocks
from paper_robot import PLATE, corners
from parflex.fe.body.keep import Memory
from parflex.fe.body.response import static_response
from solid_plates import JOINTS, MATERIAL, RADIUS, TOOL, modes, plate


@pytest.fixture(scope="module")
def hexagon() -> pf.fe.FreeBody:
    """The paper's plate."""
    return pf.fe.plate_body(corners(), **PLATE)


def dense(body: pf.fe.FreeBody) -> tuple[np.ndarray, np.ndarray]:
    return body.stiffness.toarray(), body.mass.toarray()


def relieved_flexibility(body: pf.fe.FreeBody, places) -> np.ndarray:
    """Fᵀ K⁺ F by all modes of the dense problem, rigid ones left out: no factorisation, no shift."""
    F = np.hstack([place.displacement.toarray().T for place in places])
    squares, vectors = eigh(*dense(body))
    rigid = int(np.sum(body.can_move))
    modal = F.T @ vectors[:, rigid:]
    return (modal / squares[rigid:]) @ modal.T


def basis_flexibility(found: pf.Modes) -> np.ndarray:
    """From what a simulation uses: shapes at the attachments, frequencies."""
    at = found.shapes[:, list(found.corners)].reshape(len(found.frequencies), -1)
    return (at.T / found.frequencies**2) @ at


def test_plate_of_the_paper_keeps_nine_and_six(hexagon):
    found = pf.fe.FreeFreeWithAttachment(9).modes(hexagon)
    assert len(found.frequencies) == 15
    assert "joint 6 along x" in found.notes[0]
    assert "along z" not in found.notes[0]


def test_flexibility_under_inertia_relief(hexagon):
    """≤ 1e-6 of the full model at the corners, by another route."""
    found = pf.fe.FreeFreeWithAttachment(9).modes(hexagon)
    full = relieved_flexibility(hexagon, found.reduction.held)
    assert np.max(np.abs(basis_flexibility(found) - full)) <= 1e-6 * np.max(np.abs(full))
    free = basis_flexibility(pf.fe.FreeFree(9).modes(hexagon))
    assert np.max(np.abs(free - full)) >= 0.1 * np.max(np.abs(full))  # what ten modes leave out


def test_pinned_corners(hexagon):
    """First five: 9 + 6 ≤ 0.1 %, nine free–free modes alone 5–18 % too high; the full model by the null
    space of the constraints, dense."""
    found = pf.fe.FreeFreeWithAttachment(9).modes(hexagon)
    K, M = dense(hexagon)
    Z = null_space(np.vstack([place.displacement.toarray()[2:] for place in found.reduction.held]))
    exact = np.sqrt(eigh(Z.T @ K @ Z, Z.T @ M @ Z, eigvals_only=True)[:5])
    assert np.allclose(found.error.pinned, exact, rtol=1e-6)
    assert np.all((found.error.pinned_error > -1e-6) & (found.error.pinned_error <= 1e-3))
    free = pf.fe.FreeFree(9).modes(hexagon).error.pinned_error
    assert np.all((free > 0.05) & (free < 0.2))


def test_pinned_frequencies_of_a_simulation(hexagon):
    """The platform of a model, its corners held by force: the same frequencies from what it uses."""
    found = pf.fe.FreeFreeWithAttachment(9).modes(hexagon)
    body = pf.FlexibleBody.from_modes(found)
    x, y, _ = body.attachment_points.T
    rows = np.column_stack([np.ones(6), y, -x, body.attachment_shapes[:, 2]])
    Z = null_space(rows)
    m = body.moments
    inertia = np.diag([m.m, m.P0[1, 1] + m.P0[2, 2], m.P0[0, 0] + m.P0[2, 2]])
    mass = np.block([[inertia, np.zeros((3, 15))], [np.zeros((15, 3)), body.m_ee]])
    stiffness = np.diag(np.concatenate([np.zeros(3), body.stiffness]))
    omega = np.sqrt(eigh(Z.T @ stiffness @ Z, Z.T @ mass @ Z, eigvals_only=True)[:5])
    assert np.allclose(omega, found.error.kept, rtol=1e-8)


def test_converged_is_the_smallest(hexagon):
    """Nine free–free modes for 1 %: with eight one of the first five is off by more."""
    found = pf.fe.FreeFreeWithAttachment(0).modes(hexagon).converged(0.01)
    assert found.reduction.basis.n == 9
    assert found.error.within(0.01)
    assert not pf.fe.FreeFreeWithAttachment(8).modes(hexagon).error.within(0.01)
    finer = found.converged(1e-3, up_to=1000.0)
    assert finer.reduction.basis.n >= 9
    far = pf.fe.basis_error(finer, up_to=1000.0)
    assert far.within(1e-3)
    assert far.pinned[-1] <= 1000.0 < 1.5 * far.pinned[-1]


@pytest.mark.slow
def test_unreachable_tolerance_is_said(hexagon):
    with pytest.raises(pf.NotConverged, match="96 free–free modes with attachment modes do not meet"):
        pf.fe.FreeFree(1).modes(hexagon).converged(1e-9, up_to=3000.0)


@pytest.mark.parametrize(
    "make", [lambda body: modes(), lambda body: pf.fe.FreeFreeWithAttachment(9, tool=0).modes(body)]
)
def test_contract_of_modes(make, hexagon):
    """m_ee = 1, S = β = 0, K diagonal, frequencies ascending: to 1e-9 of their scale."""
    found = make(hexagon)
    m = found.moments
    about = pf.Moments(*m)
    assert np.max(np.abs(np.trace(m.P2, axis1=2, axis2=3) - np.eye(len(found.frequencies)))) <= 1e-9
    assert np.max(np.abs(m.S)) <= 1e-9 * np.sqrt(m.m)
    beta = about.P1 - np.swapaxes(about.P1, 1, 2)
    assert np.max(np.abs(beta)) <= 1e-9 * np.sqrt(np.trace(m.P0))
    body, _, vectors, _ = found.reduction
    K = vectors.T @ (body.stiffness @ vectors)
    assert np.max(np.abs(K - np.diag(found.frequencies**2))) <= 1e-9 * np.max(K)
    assert np.all(np.diff(found.frequencies) > -1e-6)


def test_static_response_of_a_solid():
    """Equilibrium of each deformation with its load and inertia: K u = f − M R (Rᵀ M R)⁻¹ Rᵀ f."""
    body = plate()
    static = static_response(body, modes().reduction.held)
    f = static.columns
    K, M = body.stiffness, body.mass
    com = np.asarray(M @ np.ones(body.unknowns))[::3] @ body.nodes / (M.sum() / 3)
    r = body.nodes - com
    turns = [np.cross(axis, r).ravel() for axis in np.eye(3)]
    R = np.column_stack([np.tile(axis, len(r)) for axis in np.eye(3)] + turns)
    left = K @ static.flexed - (f - M @ (R @ np.linalg.solve(R.T @ (M @ R), R.T @ f)))
    assert np.max(np.abs(left)) <= 1e-8 * np.max(np.abs(f))
    assert np.max(np.abs(R.T @ (M @ static.flexed))) <= 1e-9


def test_solid_with_tool_is_right():
    """Joints as patches, a tool with moments: compliance and pinned frequencies."""
    error = modes().error
    assert error.places == ("joint 1", "joint 2", "joint 3", "joint 4", "tool", "tool moment")
    assert np.all(error.compliance <= 5e-3)  # directions below 1e-3 of the largest are left out
    assert np.all(error.pinned_error <= 1e-2)
    every = pf.fe.FreeFreeWithAttachment(9, JOINTS, TOOL, RADIUS, negligible=0.0).modes(plate())
    assert np.all(every.error.compliance <= 1e-6)


def test_patch_of_a_joint():
    """A patch moves with the body, whatever its nodes; a force on it is the force at the point."""
    body = plate()
    for place in modes().reduction.held:
        at = place.point - body.nodes.mean(axis=0)
        motion = place.displacement @ body.rigid
        expected = np.hstack([np.eye(3), np.cross(np.eye(3), at).T])
        assert np.allclose(motion, expected, atol=1e-12)
        assert np.allclose(place.rotation @ body.rigid, np.hstack([np.zeros((3, 3)), np.eye(3)]), atol=1e-12)


def test_platform_of_a_solid():
    """Attachments are the patches, the tool a node where moments act; flown by the model."""
    found = modes()
    body = pf.FlexibleBody.from_modes(found, damping_ratio=0.02)
    assert np.allclose(body.attachment_points, JOINTS, atol=1e-12)
    assert np.allclose(found.nodes[found.tool], TOOL)
    assert np.max(np.abs(body.rotation_shapes[:, found.tool])) > 0.1


def test_solid_and_thin_plate_are_alike():
    """Two theories of the same plate: the first four frequencies within 1 %."""
    thin = pf.fe.plate_modes(JOINTS[:, :2], 0.02, 7e10, 0.3, 2700.0, n_modes=4)
    assert np.max(np.abs(modes().frequencies[:4] / thin.frequencies - 1)) <= 1e-2


def mechanism():
    """Two blocks that share an edge: a hinge."""
    r, cells = two_blocks(0.0)
    r = r.copy()
    r[len(r) // 2 :, 2] += 0.1
    return pf.fe.FreeFree(2).modes(pf.fe.solid_body(pf.fe.solid_mesh(r, cells), MATERIAL))


def attached(**changes):
    given = {"points": JOINTS, "radius": RADIUS}
    return lambda: pf.fe.FreeFreeWithAttachment(2, **(given | changes)).modes(plate())


WRONG = {
    "off the body": (
        attached(points=JOINTS + [0, 0, 0.5]),
        "joint 1 at .* is off the body: the nearest node",
    ),
    "two on one node": (attached(points=JOINTS[[0, 1, 2, 0]]), "joint 1 and joint 4 both hold node"),
    "tool on a joint": (attached(tool=JOINTS[1]), "joint 2 and tool both hold node"),
    "few nodes": (
        attached(radius=0.009),
        "joint 1 at .* has 1 of the surface's nodes within 0.009 m, too few",
    ),
    "unknown node": (attached(points=[0, 99999]), r"points\[1\] is node 99999"),
    "ragged": (attached(points=[(0, 0, 0), (1, 0)]), "points is ragged"),
    "negative": (lambda: pf.fe.FreeFree(-1), "n is -1"),
    "negligible": (lambda: pf.fe.FreeFree(1, negligible=1.5), "negligible is 1.5"),
    "mechanism": (mechanism, "the body is not free and in one piece: 6 rigid modes were expected"),
    "no joints": (lambda: pf.fe.FreeFree(2).modes(plate()).error, "points is empty"),
}


@pytest.mark.parametrize("case", WRONG)
def test_refused_in_one_sentence(case):
    make, words = WRONG[case]
    with pytest.raises(pf.InputError, match=words):
        make()


def test_more_modes_than_the_mesh_can_carry():
    small = pf.fe.solid_body(box((0.1,) * 3, (1, 1, 1)), STEEL)
    with pytest.raises(pf.InputError, match="n is 200, more modes than the 81 unknowns of this mesh"):
        pf.fe.FreeFree(200).modes(small)


def test_same_node_of_a_plate_twice(hexagon):
    with pytest.raises(pf.InputError, match="joint 1 and joint 3 both hold node 1"):
        pf.fe.FreeFreeWithAttachment(3, points=[1, 2, 1]).modes(hexagon)


def test_cache_gives_the_same(tmp_path, monkeypatch):
    """From an empty cache, then from a full one, where nothing is factorised."""
    monkeypatch.setenv("PARFLEX_CACHE", str(tmp_path))
    found = []
    for _ in range(2):
        body = pf.fe.solid_body(box((0.3, 0.2, 0.1), (9, 6, 3)), STEEL)  # a small one is not kept
        ends = [(-0.15, -0.1, 0.0), (0.15, 0.1, 0.0)]
        found.append(pf.fe.FreeFreeWithAttachment(3, ends, radius=0.06).modes(body))
    assert any(tmp_path.iterdir())
    assert np.array_equal(found[0].shapes, found[1].shapes)
    assert "factor" not in found[1].reduction.body.__dict__
    assert len(list(tmp_path.glob("*.bin"))) == 2


def test_threads_wait_for_one_answer():
    """Eight threads ask at once: one computes, all have the same; a larger answer replaces a smaller one."""
    memory, computed = Memory(), []

    def compute():
        time.sleep(0.05)
        computed.append(1)
        return [len(computed)]

    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda _: memory.recall("key", compute), range(8)))
    assert found == [[1]] * 8
    assert memory.recall("key", lambda: [1, 2], enough=lambda known: len(known) >= 2) == [1, 2]
    assert memory.recall("key", compute) == [1, 2]


def test_a_memory_keeps_the_newest():
    memory = Memory()
    for number in range(20):
        memory.recall(str(number), lambda number=number: number)
    assert memory.recall("19", lambda: "forgotten") == 19
    assert memory.recall("0", lambda: "forgotten") == "forgotten"
