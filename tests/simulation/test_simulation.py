"""Simulation and results: what is reached is kept, and says what it is."""

import os
import sys
import threading

import h5py
import netCDF4
import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import parflex as pf
from measures import relative
from parflex.analysis.watch import Watch
from parflex.app import paper
from parflex.base.spatial import quaternion_rate
from parflex.kernels import models as kernels
from parflex.model.core import core_of
from parflex.robot.layout import Layout, coordinates, pack
from parflex.simulation.steppers import cyrk

GOAL = np.array([0.055, -0.046, 0.124, -0.298, 0.244, 0.103])  # m, and a rotation vector, from home
TIMES = np.linspace(0, 0.2, 21)


@pytest.fixture(scope="module", params=["vm", "native"])
def model(model_of, request):
    """Integrated step by step from Python by SciPy, and a hundred steps at a time by machine code."""
    return model_of(3, request.param)


@pytest.fixture(scope="module")
def held(model):
    """Held in its equilibrium by the static forces alone, for a moment."""
    state, forces = model.equilibrium(*model.robot.home_pose)
    return pf.simulate(model, forces, state, TIMES)


def test_equilibrium_stays(held):
    """From the static equilibrium, static forces move nothing (an unstable one: 0.2 s only)."""
    assert np.max(np.abs(held.dataset.position - held.dataset.position[0])) <= 1e-9
    assert np.max(np.abs(held.dataset.elastic_rate)) <= 1e-8


def test_controllers_of_all_kinds_agree(model, held):
    """Constant forces as an array, as a function, and as a joint controller without gains."""
    state, forces = model.equilibrium(*model.robot.home_pose)
    push = 1.05 * forces
    by_array = pf.simulate(model, push, state, TIMES)
    by_function = pf.simulate(model, lambda t, s: push, state, TIMES)
    by_controller = pf.simulate(model, pf.JointPD(model, state, 0.0, 0.0, push), state, TIMES)
    bound = 0.0 if model.backend == "vm" else 1e-11  # two integrators, and two machine codes
    for run in (by_function, by_controller):
        assert np.max(np.abs(run.dataset.position - by_array.dataset.position)) <= bound
    assert np.all(by_array.dataset.forces == push)
    assert abs(float(by_array.dataset.position[-1, 2]) - 1.0) > 1e-3


def test_tighter_tolerance_changes_little(model):
    """Two tolerances, and an independent integrator (LSODA on the flat model) agree."""
    _, forces = model.equilibrium(*model.robot.home_pose)
    push, home, c = 1.05 * forces, model.robot.home, model.compiled()
    N, x, out = 3, np.zeros(19), np.zeros(9)

    def rate(t, y):
        x[:] = y
        c.direct(x, push, out)
        v, w = y[7:10], y[10:13]
        R = coordinates(y, Layout(N)).rotation
        turning = np.concatenate([np.cross(w, v), np.zeros(3)])
        return np.concatenate([R @ v, quaternion_rate(y[3:7], w), out[:6] - turning, y[16:19], out[6:9]])

    other = solve_ivp(rate, (0, 0.2), c.pack(home), "LSODA", rtol=1e-11, atol=1e-12).y[:, -1]
    loose = pf.simulate(model, push, home, TIMES, rtol=1e-8).dataset
    tight = pf.simulate(model, push, home, TIMES, rtol=1e-11, atol=1e-13).dataset
    assert np.max(np.abs(tight.position[-1] - other[:3])) <= 1e-9
    assert np.max(np.abs(tight.elastic[-1] - other[13:16])) <= 1e-8
    assert np.max(np.abs(loose.position - tight.position)) <= 1e-7


def test_computed_torque_gains_pull_the_platform_back(model):
    """Critically damped error: released 5 mm and 0.02 rad off, it is back after a second."""
    home = model.robot.home
    way = pf.Trajectory.through(home, [((0.02, 0, 0.01), (0, 0.02, 0))], 0.5, rest=(0.1, 0.1))
    state, _ = model.equilibrium(*model.robot.home_pose)
    off = pf.State(
        np.asarray(home.position) + [0.005, 0, 0],
        Rotation.from_rotvec([0, 0.02, 0]).as_matrix(),
        elastic=state.elastic,
    )
    kp = 20.0**2
    control = pf.ComputedTorque(model, way, kp=kp, kd=2 * np.sqrt(kp))
    run = pf.simulate(model, control, off, np.linspace(0, 1.2, 61))
    error = np.abs(run.dataset.pose_error.values)
    assert error[0].max() > 0.019
    assert error[-1].max() <= 1e-6
    expected = 0.005 * (1 + 20 * run.dataset.time.values) * np.exp(-20 * run.dataset.time.values)
    world = run.dataset.desired_position - run.dataset.position
    assert np.max(np.abs(np.abs(world[:, 0]) - expected)) <= 2e-5  # but for the turning of Σp
    assert np.allclose(control(0.0, off), run.dataset.forces[0])


def test_dataset_is_labelled(held):
    data = held.dataset
    for name in ("position", "rotation", "twist", "acceleration", "elastic", "elastic_rate", "forces",
                 "contact_forces", "joint", "energy_kinetic", "energy_residual"):  # fmt: skip
        assert data[name].attrs["units"]
        assert data[name].attrs["long_name"]
    assert data.contact_forces.dims == ("time", "attachment", "axis")
    assert data.joint.dims[:2] == ("time", "leg")
    assert list(data.mode) == [1, 2, 3]
    assert list(data.axis.values) == ["x", "y", "z"]
    assert float(data.forces.sel(actuator=3)[0]) == pytest.approx(1924, rel=0.2)
    assert not held.partial


def test_saved_result_comes_back(held, tmp_path):
    """By parflex, by xarray, and by the netCDF-4 library that MATLAB and others use."""
    path = held.save(tmp_path / "sub" / "run.nc")
    back = pf.load_result(path)
    xr.testing.assert_identical(back.dataset.drop_attrs(deep=False), held.dataset.drop_attrs(deep=False))
    assert back.stopped == ""
    assert back.dataset.attrs["integrator"] == "DOP853"
    with netCDF4.Dataset(path) as file:
        assert file.data_model == "NETCDF4"
        assert file["forces"].units == "N"
        assert np.array_equal(file["position"][:], held.dataset.position)
    with xr.open_dataset(path) as plain:
        assert plain.sizes["time"] == len(TIMES)
    with h5py.File(path) as raw:
        assert raw["twist"].dtype == np.float64
    assert os.listdir(path.parent) == ["run.nc"]
    assert np.allclose(back.state(5).twist, held.dataset.twist[5])


def test_states_of_a_result_replay_the_models(model, held):
    """Stored forces, accelerations and contact forces belong to the stored states."""
    for i in (0, 10, 20):
        found = model.direct(held.state(i), held.dataset.forces.values[i])
        assert np.allclose(found.platform, held.dataset.acceleration[i], atol=1e-9)
        assert np.allclose(found.contact_forces, held.dataset.contact_forces[i], atol=1e-8)
    q = model.joints(held.state(3)).q
    assert np.allclose(held.dataset.joint[3], np.stack(q))


def test_controllers_are_functions_of_time_and_state(model_of):
    """What a joint controller gives at the rows of a run is what the run recorded."""
    model = model_of(3, "vm")
    start, forces = model.equilibrium(*model.robot.home_pose)
    hold = pf.JointPD(model, start, 1e5, 1e3, forces)
    run = pf.simulate(model, hold, model.robot.home, np.linspace(0, 0.02, 5))
    found = [hold(t, run.state(i)) for i, t in enumerate(run.dataset.time.values)]
    assert relative(found, run.dataset.forces) <= 1e-12


@pytest.mark.parametrize("method", ["RK45", "Radau"])
def test_methods_agree(model, method):
    """With the eighth-order one, within what their tolerances promise."""
    _, forces = model.equilibrium(*model.robot.home_pose)
    runs = [
        pf.simulate(model, 1.02 * forces, model.robot.home, TIMES, rtol=1e-9, atol=1e-11, method=name).dataset
        for name in ("DOP853", method)
    ]
    assert runs[1].attrs["integrator"] == method
    assert np.max(np.abs(runs[1].position - runs[0].position)) <= 1e-7
    with pytest.raises(pf.InputError, match="method is 'Euler'"):
        pf.simulate(model, forces, model.robot.home, TIMES, method="Euler")


@pytest.mark.parametrize("kind", ["forces", "joint controller", "computed torque"])
def test_integrators_agree(model_of, kind):
    """CyRK on machine code and SciPy on the virtual machine, under constant loads in both frames; and
    the same loads as a function of time, which SciPy alone can integrate."""
    found = []
    for backend, called in (("vm", False), ("native", False), ("native", True)):
        model = model_of(3, backend)
        start, forces = model.equilibrium(*model.robot.home_pose)
        way = pf.Trajectory.through(
            model.robot.home, [((0.02, 0, 0.01), (0, 0.02, 0))], 0.1, rest=(0.02, 0.02)
        )
        law = {
            "forces": 1.02 * forces,
            "joint controller": pf.JointPD(model, start, 1e5, 1e3, forces),
            "computed torque": pf.ComputedTorque(model, way, kp=400.0, kd=40.0),
        }[kind]
        loads = [pf.Wrench(3, (10.0, 0, -30), (0, 1.0, 2)), pf.Wrench(7, (0, 5.0, 0), frame="platform")]
        given = (lambda t, loads=loads: loads) if called else loads
        found.append(pf.simulate(model, law, start, TIMES, wrenches=given).dataset)
    first = found[0]
    for other in found[1:]:
        for name, bound in (
            ("position", 1e-9),
            ("elastic", 1e-9),
            ("forces", 1e-3),
            ("energy_wrenches", 1e-8),
        ):
            assert np.max(np.abs(other[name] - first[name])) <= bound, name
    assert abs(float(first.energy_wrenches[-1])) > 1e-3
    assert np.max(np.abs(first.energy_residual)) <= 1e-7 * np.max(np.abs(first.energy_actuators))


@pytest.mark.parametrize("backend", ["vm", "native"])
def test_steps_end_where_segments_do(model_of, backend):
    """The wanted motion is a polynomial between poses, which the method integrates exactly: at any
    tolerance the platform is on it, as long as no step goes across a jump of its third derivative."""
    model = model_of(0, backend)
    moves = [([0.03, -0.02, 0.05], np.zeros(3)), ([-0.04, 0.03, 0.02], np.zeros(3))]
    way = pf.Trajectory.through(model.robot.home, moves, 0.37, (0.11, 0.07))
    times = np.linspace(0, way.duration, 50)
    run = pf.simulate(model, pf.ComputedTorque(model, way), model.robot.home, times, rtol=1e-4, atol=1e-4)
    assert np.max(np.abs(run.dataset.pose_error)) <= 1e-12


@pytest.mark.parametrize("backend", ["vm", "native"])
def test_what_lies_beyond_a_crossing_is_not_kept(model_of, backend):
    """States on a line through a dynamic singularity; the signs of the determinants by NumPy alone."""
    model, reference = model_of(9, backend), model_of(9)
    home = model.robot.home
    line = [
        pf.State(home.position + s * GOAL[:3], Rotation.from_rotvec(s * GOAL[3:]).as_matrix())
        for s in np.linspace(0, 1.5, 40)
    ]
    x = np.array([core_of(model).flat(state) for state in line])
    flexible, rigid = core_of(reference).functions(kernels.gains, pf.FrameOutput())(x=x).values()
    signs = np.sign(np.linalg.det(flexible.reshape(-1, 6, 6)) * np.linalg.det(rigid.reshape(-1, 6, 6)))
    first = int(np.argmax(signs != signs[0]))
    assert 0 < first < len(x) - 1
    watch = Watch(core_of(model).functions, pf.FrameOutput())
    assert watch.look(x[:1]) == (1, "")
    before, words = watch.look(x)
    assert before == first
    assert "crossed a dynamic singularity" in words
    assert watch.look(x[:first]) == (first, "")


def test_without_cyrk_scipy_takes_the_steps_and_it_is_said_once(monkeypatch):
    """On machines for which CyRK has no package: the paper's run, with the same numbers."""
    expected = paper.run(3).result.dataset
    with monkeypatch.context() as hiding:
        hiding.setitem(sys.modules, "CyRK.nb.numba_c_api", None)
        for each in (cyrk.solver, cyrk.available):
            each.cache_clear()
        with pytest.warns(UserWarning, match="SciPy takes the steps of simulations") as said:
            found, _ = (paper.run(modes).result for modes in (3, 0))
    for each in (cyrk.solver, cyrk.available):
        each.cache_clear()
    assert len([each for each in said if "CyRK" in str(each.message)]) == 1
    assert not found.partial
    # both integrate to a relative 1e-7 a step
    assert np.max(np.abs(found.dataset["position"] - expected["position"])) <= 1e-7
    assert np.max(np.abs(found.dataset["elastic"] - expected["elastic"])) <= 1e-6


def test_unwritable_folder_is_said(held, tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(pf.InputError, match="was not written"):
        held.save(tmp_path / "file" / "run.nc")


def test_damaged_files_are_refused(held, tmp_path):
    path = held.save(tmp_path / "run.nc")
    whole = path.read_bytes()
    for name, content in (
        ("short.nc", whole[: len(whole) // 2]),
        ("empty.nc", b""),
        ("text.nc", b"time,x\n0,1\n"),
    ):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(pf.InputError, match="is damaged or no NetCDF-4 file"):
            pf.load_result(tmp_path / name)
    with pytest.raises(pf.InputError, match="there is no such file"):
        pf.load_result(tmp_path / "none.nc")
    xr.Dataset({"a": ("x", [1.0])}).to_netcdf(tmp_path / "other.nc", engine="h5netcdf")
    with pytest.raises(pf.InputError, match="is no result of this version of parflex"):
        pf.load_result(tmp_path / "other.nc")


def test_threads_share_a_model_but_not_a_workspace(model):
    """Two threads, each with `compiled()`, and the comfortable calls beside them."""
    rng = np.random.default_rng(0)
    state, forces = model.equilibrium(*model.robot.home_pose)
    pushes = forces + rng.uniform(-300, 300, (2, 200, 6))
    expected = [model.direct(state, p).platform for p in pushes]
    worst = []

    def work(k):
        c = model.compiled()
        x, u, out = c.pack(state), np.zeros(6), np.zeros(9)
        for i in range(200):
            u[:] = pushes[k][i]
            c.direct(x, u, out)
            worst.append(np.max(np.abs(out[:6] - expected[k][i])))

    threads = [threading.Thread(target=work, args=(k,)) for k in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(worst) == 400
    assert max(worst) <= 1e-10


def test_state_of_a_trajectory_packs(model):
    """`Sample.state` gives states of the batch, undeformed by default."""
    way = pf.Trajectory.through(model.robot.home, [((0.02, 0, 0), (0, 0, 0))], 0.5)
    states = way.sample(np.linspace(0, 1, 5)).state()
    assert pack(states, Layout(3)).shape == (5, 19)


def test_flat_calls_write_where_they_are_told(model):
    """Rows of a matrix are new views at every call, whose identities are soon reused."""
    _, forces = model.equilibrium(*model.robot.home_pose)
    pushes = forces + np.arange(8.0)[:, None] * 50
    for backend in ("numpy", "vm"):
        c = pf.Model(model.robot, backend).compiled()
        x, u, rows = c.pack(model.robot.home), np.zeros(6), np.full((8, 9), np.nan)
        for i in range(8):
            u[:] = pushes[i]
            c.direct(x, u, rows[i])
        found = model.direct(model.robot.home, pushes)
        assert np.allclose(rows, np.concatenate([found.platform, found.elastic], axis=1), atol=1e-9)


def test_controller_of_another_model_is_refused(model, model_of):
    home = model.robot.home
    way = pf.Trajectory.through(home, [((0.01, 0, 0), (0, 0, 0))], 0.5)
    for other in (pf.ComputedTorque(model_of(0), way), pf.JointPD(model_of(0), model_of(0).robot.home, 1, 1)):
        with pytest.raises(pf.InputError, match="made for another model"):
            pf.simulate(model, other, home, TIMES)
