"""Stresses of solids: closed forms, the full model, and the files for ParaView."""

import numpy as np
import pytest

import parflex as pf
from blocks import STEEL, box
from paper_robot import corners
from parflex.fe.body.response import static_response
from parflex.fe.solid.recovery import nodal_fields, recover, von_mises
from solid_plates import JOINTS, MATERIAL, RADIUS, modes, plate


def test_uniform_strain_and_pure_bending():
    """Linear and quadratic displacements are in the elements: strains and stresses to round-off."""
    mesh = box((1.0, 0.2, 0.1), (4, 1, 1))
    solid = pf.fe.Solid(mesh.elements, mesh.parts, (STEEL,))
    lam, mu = STEEL.lame
    strain = np.array([[1.0, 0.3, -0.2], [0.3, -0.5, 0.4], [-0.2, 0.4, 0.8]]) * 1e-3
    _, found, stress = nodal_fields(mesh.nodes, solid, mesh.nodes @ strain)
    assert np.allclose(found, strain, atol=1e-15)
    assert np.allclose(stress, lam * np.trace(strain) * np.eye(3) + 2 * mu * strain, rtol=1e-10)
    x, y, z = mesh.nodes.T
    k, nu = 0.01, STEEL.poisson  # Timoshenko and Goodier, § 102: σ_xx = −E k z, the others zero
    bent = np.stack([-k * x * z, nu * k * y * z, 0.5 * k * (x**2 - nu * (y**2 - z**2))], axis=1)
    stress = nodal_fields(mesh.nodes, solid, bent)[2]
    scale = STEEL.young * k * 0.05
    expected = np.zeros_like(stress)
    expected[:, 0, 0] = -STEEL.young * k * z
    assert np.max(np.abs(stress - expected)) <= 1e-10 * scale


def test_von_mises_of_textbook_states():
    """Tension σ: σ; shear τ: √3 τ; pressure: nothing."""
    tension, shear, pressure = np.diag([5.0, 0, 0]), np.zeros((3, 3)), -3.0 * np.eye(3)
    shear[0, 1] = shear[1, 0] = 2.0
    assert np.allclose(von_mises(np.stack([tension, shear, pressure])), [5.0, 2.0 * np.sqrt(3.0), 0.0])


def test_anywhere_is_between_the_nodes():
    """In elements, and on their nodes: displacement as a function, stress near the nodal means."""
    found = modes()
    q = 1e-3 / found.frequencies
    rng = np.random.default_rng(0)
    cells = found.solid.elements[rng.integers(len(found.solid.elements), size=40)]
    weights = rng.dirichlet(np.ones(4), 40)
    points = np.einsum("pi,pia->pa", weights, found.nodes[cells[:, :4]])
    at = recover(found, q, points)
    L = weights
    pairs = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
    N = np.concatenate([L * (2 * L - 1), np.stack([4 * L[:, i] * L[:, j] for i, j in pairs], axis=1)], axis=1)
    u = np.einsum("n,nka->ka", q, found.shapes)
    assert np.allclose(at.displacement, np.einsum("pi,pia->pa", N, u[cells]), atol=1e-12 * np.max(np.abs(u)))
    nodal = recover(found, q)
    between = np.einsum("pi,piab->pab", L, nodal.stress[cells[:, :4]])
    assert np.max(np.abs(at.stress - between)) <= 0.25 * np.max(np.abs(nodal.stress))
    assert np.allclose(nodal.displacement, u)


def test_stress_of_a_static_load():
    """Normal forces at the joints, away from their patches: 9 + attachment modes ≤ 2 % of the full model's
    largest stress; free–free modes alone are off by tens of percent."""
    body, found = plate(), modes()
    held = found.reduction.held
    static = static_response(body, held)
    load = np.zeros(static.flexed.shape[1])
    load[2:12:3] = (100.0, -60.0, 80.0, -20.0)
    u = (static.flexed @ load).reshape(-1, 3)
    full = nodal_fields(body.nodes, found.solid, u)[2]
    away = np.min(np.linalg.norm(body.nodes[:, None] - JOINTS, axis=2), axis=1) > 2 * RADIUS
    errors = []
    for basis in (found, pf.fe.FreeFree(9, JOINTS, radius=RADIUS).modes(body)):
        shapes = basis.shapes[:, list(basis.corners)].reshape(len(basis.frequencies), -1)
        q = shapes @ load[:12] / basis.frequencies**2
        stress = recover(basis, q).stress[: len(body.nodes)]
        largest = np.max(np.linalg.norm(full[away], axis=(1, 2)))
        errors.append(np.max(np.linalg.norm((stress - full)[away], axis=(1, 2))) / largest)
    assert errors[0] <= 2e-2
    assert errors[1] >= 0.1


@pytest.fixture(scope="module")
def run() -> tuple[pf.Modes, pf.Result]:
    """A small solid hexagon on the paper's legs, let go for a moment."""
    mesh = pf.fe.outline_mesh(corners(), 0.03, size=0.14)
    body = pf.fe.solid_body(mesh, MATERIAL)
    at = np.column_stack([corners(), np.zeros(6)])
    found = pf.fe.FreeFreeWithAttachment(2, at, radius=0.08, negligible=0.02).modes(body)
    robot = pf.robots.gough_stewart(platform=pf.FlexibleBody.from_modes(found, damping_ratio=0.05))
    model = pf.Model(robot, "numpy")
    state, forces = model.equilibrium(*robot.home_pose)
    return found, pf.simulate(model, lambda t, x: forces, state, np.linspace(0, 0.01, 5), rtol=1e-5)


def test_fields_for_paraview(run, tmp_path):
    """Read again: the nodes, elements and the stresses of the result; the list has the times."""
    meshio = pytest.importorskip("meshio")
    found, result = run
    files = pf.fe.write_fields(found, result, tmp_path / "run.pvd", times=[0.0, 0.01])
    assert [file.name for file in files] == ["run.pvd", "run_0000.vtu", "run_0001.vtu"]
    listed = files[0].read_text()
    assert 'timestep="0.0" part="0" file="run_0000.vtu"' in listed
    assert 'timestep="0.01" part="0" file="run_0001.vtu"' in listed
    mesh = meshio.read(files[2])
    fields = recover(found, result.dataset["elastic"].values[-1])
    assert mesh.cells_dict["tetra10"].shape == found.solid.elements.shape
    assert np.allclose(mesh.point_data["von Mises"], fields.mises[: len(mesh.points)])
    assert np.allclose(mesh.point_data["stress"][:, 3], fields.stress[: len(mesh.points), 0, 1])
    assert np.max(fields.mises) > 1e4


def test_wrong_questions_are_refused(run, tmp_path):
    found, result = run
    thin = pf.fe.plate_modes(corners(), 0.015, 2e10, 0.3, 7500.0, 1)
    for words, ask in (
        ("modes .* have no elements", lambda: recover(thin, [1.0])),
        ("elastic has shape", lambda: recover(found, [1.0])),
        (r"points\[0\] = .* is off the body", lambda: recover(found, 0 * found.frequencies, [(9, 9, 9)])),
        ("must end with .pvd", lambda: pf.fe.write_fields(found, result, tmp_path / "run.vtk")),
        ("times has 5.0 s", lambda: pf.fe.write_fields(found, result, tmp_path / "run.pvd", [5.0])),
        ("modes are 1, the run has", lambda: pf.fe.write_fields(thin, result, tmp_path / "run.pvd")),
    ):
        with pytest.raises(pf.InputError, match=words):
            ask()
    assert not list(tmp_path.iterdir())
