"""Equilibria of many poses at once: those that are found one by one, and by other ways than either."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import flexlegs
import parflex as pf
from measures import relative
from parflex.analysis.equilibrium import at_rest
from parflex.kernels.rest import unrest
from parflex.model.core import core_of
from parflex.model.results import Accelerations
from reference.gallery import ENTRIES, robot_of

SAME = 1e-12  # m and rad, and of the forces: both are found to round-off
STILL = 1e-9 * 9.81  # m/s²
COUNT, MODES = 4, 3
FLEXLEGS = "gs_flexlegs"  # links and flexures that bend, joints that are carried and closed
ROBOTS = [*ENTRIES, "nano-hexapod", FLEXLEGS]
LIGHT = {"nano-hexapod": 10.0}  # its legs' grams stand between flexures of 1e8 N/m, which pull at round-off
REACH = {"nano-hexapod": 1e-5, FLEXLEGS: 0.01}  # m; the struts of one give by tenths of a millimetre
WIRES = pf.Strut(
    pf.Bar(mass=1e-3, length=0.22, outer=0.03),
    pf.Bar(outer=2e-3, length=0.2, density=7850, young=205e9, static=True),
)


@cache
def gallery(name: str) -> pf.Model:
    """A robot of the gallery on a platform of three modes."""
    if name == FLEXLEGS:
        return pf.Model(flexlegs.robot(name), "numpy")
    robot = robot_of(name, True) if name in ENTRIES else pf.robots.nano_hexapod(modes=MODES)
    return pf.Model(robot, "numpy")


def poses(robot: pf.Robot, count: int, reach: float = 0.02) -> tuple[np.ndarray, np.ndarray]:
    """Places and attitudes about home."""
    rng = np.random.default_rng(5)
    turn = Rotation.from_rotvec(rng.uniform(-reach, reach, (count, 3))).as_matrix()
    return robot.home.position + rng.uniform(-reach, reach, (count, 3)), turn @ robot.home.rotation


def parts(state: pf.State) -> np.ndarray:
    """All that a batch of states holds, side by side."""
    legs = [values or () for values in (state.joints, state.leg_elastic)]
    carried = [part for values in legs for part in values if part is not None]
    turn = state.rotation.reshape((*state.batch, 9))
    return np.concatenate([state.position, turn, state.elastic, *carried], axis=-1)


def fastest(found: Accelerations) -> float:
    """The largest acceleration, of platform, modes, joints and links."""
    every = [found.platform, found.elastic, *found.leg_joints, *found.leg_elastic]
    return max(float(np.max(np.abs(part), initial=0.0)) for part in every)


@pytest.mark.parametrize("name", ROBOTS)
def test_together_as_one_by_one(name):
    """The general algorithm takes one pose at a time, with motions of all coordinates of the legs; what it
    finds stands still by the direct model, which does not know of either."""
    model = gallery(name)
    position, rotation = poses(model.robot, COUNT, REACH.get(name, 0.02))
    state, forces = model.equilibrium(position, rotation)
    assert state.batch == (COUNT,)
    assert forces.shape == (COUNT, model.robot.n_forces)
    core = core_of(model)
    alone = [
        at_rest(core.functions, "pose", pf.State(*pose)) for pose in zip(position, rotation, strict=True)
    ]
    expected = core.state(np.array([x for x, _ in alone]))
    assert np.max(np.abs(parts(state) - parts(expected))) <= SAME
    assert relative(forces, np.array([u for _, u in alone])) <= SAME
    assert fastest(model.direct(state, forces)) <= STILL * LIGHT.get(name, 1.0)
    one, held = model.equilibrium(position[1], rotation[1])
    assert np.max(np.abs(parts(one) - parts(state)[1])) <= SAME
    assert relative(held, forces[1]) <= SAME


@cache
def on_wires() -> pf.Model:
    """A rigid plate on six struts that bend under little."""
    sizes = {"base_radius": 0.25, "platform_radius": 0.15, "height": 0.3}
    spreads = {"base_spread": np.radians(20), "platform_spread": np.radians(20)}
    return pf.Model(pf.robots.hexapod(**sizes, **spreads, strut=WIRES), "numpy")


def test_the_potential_is_least_there():
    """With the pose held, weight, strain and the work of the forces: no bend of the same size has less, and
    the excess goes with the square of the bend."""
    model = gallery("Gough-Stewart")
    state, forces = model.equilibrium(*model.robot.home_pose)

    def potential(bend: np.ndarray) -> np.ndarray:
        bent = replace(state, elastic=state.elastic + bend)
        found, lengths = model.energies(bent), np.stack([q[..., 2] for q in model.joints(bent).q], axis=-1)
        return found.gravity + found.strain - lengths @ forces

    bends = np.random.default_rng(1).normal(0, 1e-2, (20, MODES))
    least = potential(np.zeros(MODES))
    excess = [potential(part * bends) - least for part in (1.0, 0.5)]
    assert np.all(excess[0] > 0)
    assert excess[0] / excess[1] == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize("name", ["6-RUS", "octapod", "Delta", "nano-hexapod"])
def test_batches_of_forces_lead_back(name):
    """The forces of equilibria, from guesses beside them, lead to their poses."""
    model = gallery(name)
    state, forces = model.equilibrium(*poses(model.robot, COUNT, REACH.get(name, 0.02)))
    guess = pf.State(state.position + (1e-4, -2e-4, 1e-4), state.rotation)
    found, same = model.equilibrium(forces=forces, guess=guess)
    assert np.array_equal(same, forces)
    assert np.max(np.abs(parts(found) - parts(state))) <= SAME


def test_batches_of_wrenches_and_parameters():
    """Two loads beside two gravities: as each of the four alone, and at rest by the direct model."""
    model = pf.Model(gallery("Gough-Stewart").robot, "numpy", parameters=["gravity"])
    loads = [pf.Wrench(3, [[[200.0, -50.0, -400.0]], [[0.0, 10.0, 0.0]]], frame="platform")]
    weights = {"gravity": [[0, 0, -9.81], [0, 0, -1.62]]}
    state, forces = model.equilibrium(*model.robot.home_pose, wrenches=loads, parameters=weights)
    assert state.batch == (2, 2)
    found = model.direct(state, forces, loads, parameters=weights)
    assert np.max(np.abs(found.platform)) <= STILL
    assert np.max(np.abs(found.elastic)) <= STILL
    for i in range(2):
        for j in range(2):
            load = [replace(loads[0], force=loads[0].force[i, 0])]
            moon = {"gravity": weights["gravity"][j]}
            one, held = model.equilibrium(*model.robot.home_pose, wrenches=load, parameters=moon)
            assert np.max(np.abs(parts(one) - parts(state)[i, j])) <= SAME
            assert relative(held, forces[i, j]) <= SAME


def test_a_batch_of_bases_that_accelerate():
    """The platform has its base's acceleration, and what bends has none, for a gravity that is a parameter
    too; two poses on each of two bases."""
    model = pf.Model(gallery("Gough-Stewart").robot, "numpy", parameters=["gravity"])
    turn = Rotation.from_euler("z", [[0.3], [-0.2]]).as_matrix()
    gone = np.array([(1.0, -2.0, 3.0, 0, 0, 0), (0.0, 0.5, 0.0, 0, 0, 0)])
    base = pf.BaseMotion((1.0, 2.0, 0.5), turn, (0.4, 0, 0.1, 0, 0, 0), gone)
    position, rotation = poses(model.robot, 2)
    in_world = base.position + np.einsum("bij,kj->kbi", turn, position)
    moon = {"gravity": (0, 0, -1.62)}
    state, forces = model.equilibrium(in_world, turn @ rotation[:, None], base=base, parameters=moon)
    assert state.batch == (2, 2)
    found = model.direct(state, forces, base=base, parameters=moon)
    expected = np.einsum("kbji,bj->kbi", state.rotation, gone[:, :3])
    assert np.max(np.abs(found.platform[..., :3] - expected)) <= STILL
    assert np.max(np.abs(found.platform[..., 3:])) <= STILL
    assert np.max(np.abs(found.elastic)) <= STILL


@pytest.mark.parametrize("name", ["6-RUS", "Delta"])
def test_what_is_out_of_reach_is_named(name):
    model = gallery(name)
    position, rotation = poses(model.robot, 4)
    position[[1, 3], 2] += 5.0
    with pytest.raises(pf.OutOfReach, match=r"of 4 equilibria 2 fail, the first at index 1: pose: leg 1 "):
        model.equilibrium(position, rotation)
    with pytest.raises(pf.OutOfReach, match=r"2 fail, the first at index \(0, 1\): "):
        model.equilibrium(position.reshape(2, 2, 3), rotation.reshape(2, 2, 3, 3))


def test_what_buckles_is_named():
    """Under its own weight the plate stands on its wires; under more the first that buckles is told, with the
    load that it bears, as of a pose by itself."""
    model = on_wires()
    pushes = pf.Wrench(0, [(0, 0, 0), (0, 0, -1.0), (0, 0, -100.0), (0, 0, -200.0)])
    state, _ = model.equilibrium(*model.robot.home_pose, wrenches=[replace(pushes, force=pushes.force[:2])])
    assert state.batch == (2,)
    with pytest.raises(pf.NotConverged, match="leg 1 is loaded with .* N and buckles from") as alone:
        model.equilibrium(*model.robot.home_pose, wrenches=[replace(pushes, force=pushes.force[2])])
    with pytest.raises(pf.NotConverged) as refused:
        model.equilibrium(*model.robot.home_pose, wrenches=[pushes])
    assert str(refused.value) == f"of 4 equilibria 2 fail, the first at index 2: {alone.value}"


def test_many_are_compiled_and_one_is_not(tmp_path, monkeypatch):
    """A pose by itself does not wait for the compiler; after many it has what they had compiled."""
    monkeypatch.setenv("PARFLEX_CACHE", str(tmp_path))
    model = pf.Model(pf.robots.gough_stewart(1), "vm")
    position, rotation = poses(model.robot, 64)
    one, held = model.equilibrium(position[5], rotation[5])
    kept = core_of(model).functions.ready
    assert not kept(unrest, ())
    state, forces = model.equilibrium(position, rotation)
    assert kept(unrest, ())
    again, same = model.equilibrium(position[5], rotation[5])
    for alike, u in ((again, same), (state[5], forces[5])):
        assert np.max(np.abs(parts(alike) - parts(one))) <= SAME
        assert relative(u, held) <= SAME


def test_none_is_an_empty_batch():
    model = gallery("Gough-Stewart")
    state, forces = model.equilibrium(np.zeros((0, 3)), np.eye(3))
    assert (state.batch, forces.shape) == ((0,), (0, 6))
