"""States on the closure: found, kept in a run, and refused where there are none."""

import signal
import threading
from dataclasses import replace
from functools import cache
from itertools import combinations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import cases
import oracle
import parflex as pf
import zoo
from measures import actuated, random_states, relative
from rewriting import one_tree, reframed
from sample import FIELDS

LIBRARY = 1e-9  # the accuracy the library promises
CLOSED = 1e-10  # m and m/s: the simulator projects onto the closure
POSED = 1e-10  # m, and entries of a rotation: forward after inverse geometry

pytestmark = pytest.mark.filterwarnings("ignore:.*beyond a dynamic singularity")


@cache
def sample_of(name, kind="rigid", rewriting=None, loads=False):
    sample = cases.case(name, kind)
    sample = zoo.with_loads(sample) if loads else sample
    return sample if rewriting is None else rewriting(sample)


@cache
def model_of(name, kind="rigid", rewriting=None, backend="numpy", loads=False):
    return pf.Model(sample_of(name, kind, rewriting, loads).robot, backend)


def off(sample, size, seed=0):
    """A batch of the sample's states with poses and rates moved by about `size`."""
    rng, at = np.random.default_rng(seed), sample.platform
    turn = Rotation.from_rotvec(rng.normal(0, size, (len(at.position), 3))).as_matrix()
    return pf.State(
        at.position + rng.normal(0, size, at.position.shape),
        at.rotation @ turn,
        at.twist + rng.normal(0, size, at.twist.shape),
        at.elastic,
        at.elastic_rate,
        tuple(sample.q),
        tuple(sample.qd),
    )


# --- projection ---


@pytest.mark.parametrize("rewriting", [None, reframed])
@pytest.mark.parametrize("kind", ["rigid", "flex"])
@pytest.mark.parametrize("name", cases.NAMES)
def test_projected_states_are_on_the_closure(name, kind, rewriting):
    """By the oracle's trees; a second time nothing moves; the bend is kept; it comes near, not far."""
    sample, model = sample_of(name, kind, rewriting), model_of(name, kind, rewriting)
    given = off(sample, 1e-2)
    given = given if rewriting else replace(given, joints=None, joint_rates=None)
    found = model.project(given)
    q = model.joints(found).q
    for s in range(len(sample.forces)):
        assert max(sample.open(platform_of(found[s]), [leg[s] for leg in q])) <= CLOSED
    assert np.array_equal(found.elastic, given.elastic)
    assert np.max(np.abs(found.position - given.position)) <= 0.2
    again = model.project(found)
    for field in FIELDS:
        assert np.max(np.abs(getattr(again, field) - getattr(found, field)), initial=0.0) <= 1e-12
    if name == "rus6" and rewriting is None:
        assert np.array_equal(found.position, given.position)


def platform_of(state):
    return pf.State(*(getattr(state, field) for field in FIELDS))


def test_projection_of_a_batch_is_that_of_its_states():
    """(2, 3) states, some of them on the closure already."""
    sample, model = sample_of("delta3"), model_of("delta3")
    given = replace(off(sample, 1e-2)[:6], joints=None, joint_rates=None)
    pose = {field: np.array(getattr(given, field)) for field in FIELDS}
    for field in FIELDS:
        pose[field][:2] = getattr(sample.platform, field)[:2]
    grid = pf.State(*(pose[field].reshape(2, 3, *pose[field].shape[1:]) for field in FIELDS))
    found = model.project(grid)
    assert found.position.shape == (2, 3, 3)
    for i, j in np.ndindex(2, 3):
        one = model.project(grid[i, j])
        for field in FIELDS:
            assert relative(getattr(found, field)[i, j], getattr(one, field)) <= 1e-12
    assert np.max(np.abs(found.position[0, :2] - sample.platform.position[:2])) <= 1e-13


def test_projection_is_the_nearest():
    """A 3-RPS: with small shifts the change of pose, angles times the platform's size, is normal to its
    motions (of the oracle's closure), to first order."""
    sample, model = sample_of("rps3"), model_of("rps3")
    state, q = sample.platform[2], [leg[2] for leg in sample.q]
    r = sample.body.attachment_points
    size = np.sqrt(np.mean(np.sum((r - r.mean(axis=0)) ** 2, axis=1)))
    R = np.asarray(state.rotation)
    rows = [oracle.tip_rows(leg, oracle.tree(leg, q_i)[2]) for leg, q_i in zip(sample.legs, q, strict=True)]
    W = sample.cloud.point_motion(state, sample.cloud.attachments, sample.cloud.attachment_shapes)[2]
    constraints = np.array([across(J) @ W_i for J, W_i in zip(rows, W, strict=True)]) @ np.kron(np.eye(2), R)
    allowed = np.linalg.svd(constraints / np.repeat([1.0, size], 3))[2][3:]
    worst = []
    for step in (1e-3, 1e-4):
        shift = step * np.random.default_rng(1).normal(size=3)
        found = model.project(pf.State(state.position + R @ shift, R))
        moved = R.T @ (found.position - state.position) - shift
        turned = Rotation.from_matrix(R.T @ found.rotation).as_rotvec()
        worst.append(np.max(np.abs(allowed @ np.append(moved, size * turned))) / step)
    assert max(worst) <= 1e-5


def across(J):
    """The direction (3,) in which no joint moves the tip."""
    return np.linalg.svd(J.T)[2][-1]


def test_rates_are_corrected_with_the_pose():
    """Where the pose is on the closure and the twist is not, only the rates move, by what the legs forbid."""
    sample, model = sample_of("rps3"), model_of("rps3")
    state = sample.platform[0]
    pushed = replace(state, twist=np.asarray(state.twist) + [0.1, 0, 0, 0, 0, 0])
    found = model.project(pushed)
    assert np.max(np.abs(found.position - state.position)) <= 1e-14
    assert sample.open(found, [leg[0] for leg in sample.q])[1] <= 1e-13
    assert np.max(np.abs(found.twist - pushed.twist)) <= 0.1 + 1e-12


# --- what is refused ---


def test_states_off_the_closure_are_refused():
    """In place and velocity, in a (2, 3) batch; leg, gap, index and remedy are named."""
    model = model_of("rps3")
    sample = sample_of("rps3")
    places, turns = np.array(sample.platform.position[:6]), np.array(sample.platform.rotation[:6])
    twists = np.array(sample.platform.twist[:6])
    hinge = np.asarray(sample.legs[1].rotation) @ [0, 1, 0]
    places[4] += 2e-5 * hinge / np.linalg.norm(hinge)
    batch = pf.State(places.reshape(2, 3, 3), turns.reshape(2, 3, 3, 3), twists.reshape(2, 3, 6))
    for call in (model.direct, lambda state, forces: model.joints(state)):
        with pytest.raises(
            pf.InputError, match=r"state at index \(1, 1\) is off the closure: a gap of .*-05 m"
        ):
            call(batch, np.zeros(3))
    assert model.direct(model.project(batch), np.zeros(3)).platform.shape == (2, 3, 6)
    twists[5] += [0, 0, 0, 0, 0, 1e-3]
    places[4] = sample.platform.position[4]
    batch = pf.State(places, turns, twists)
    with pytest.raises(pf.InputError, match=r"state at index 5 is off the closure: a gap velocity of"):
        model.direct(batch, np.zeros(3))


@pytest.mark.parametrize("name", cases.NAMES)
def test_wrong_branch_is_refused(name):
    """A joint half a turn from where the closed form has it; a full turn away it is the same joint."""
    model = model_of(name)
    home = model.robot.home
    q = [np.array(q_i) for q_i in model.joints(home).q]
    q[1][0] += 2 * np.pi
    model.joints(replace(home, joints=tuple(q)))
    q[1][0] -= np.pi
    with pytest.raises(pf.InputError, match=r"State.joints\[1\] is on another .* than leg 2: joint 1"):
        model.joints(replace(home, joints=tuple(q)))


def test_carried_legs_that_are_not_found_are_named():
    """Alone, and within a batch of which the rest is fine."""
    model, sample = model_of("rus6", rewriting=reframed), sample_of("rus6", rewriting=reframed)
    places = np.array(sample.platform.position[:4])
    places[2] += [0, 0, 3.0]
    batch = pf.State(places, sample.platform.rotation[:4], joints=tuple(q[:4] for q in sample.q))
    with pytest.raises(pf.OutOfReach, match="state at index 2: no joints of leg 1 were found"):
        model.direct(batch, np.zeros(6))
    with pytest.raises(pf.OutOfReach, match="state: no joints of leg 1 were found that reach"):
        model.joints(batch[2])
    fine = batch[np.array([0, 1, 3])]
    assert relative(model.joints(fine).q[3][2], sample.q[3][3]) <= LIBRARY


# --- flat states with carried joints ---


@pytest.mark.parametrize("rewriting", [reframed, one_tree])
@pytest.mark.parametrize("name", cases.NAMES)
def test_flat_states_hold_the_joints(name, rewriting):
    """pack, unpack, pack; and the flat direct model is the comfortable one."""
    sample, model = sample_of(name, rewriting=rewriting), model_of(name, rewriting=rewriting, backend="numpy")
    c, state = model.compiled(), sample.states[3]
    x = c.pack(state)
    back = c.unpack(x)
    for i in range(len(sample.legs)):
        assert relative(back.joints[i], sample.q[i][3]) <= LIBRARY
        assert relative(back.joint_rates[i], sample.qd[i][3]) <= LIBRARY
    assert relative(c.pack(back), x) <= 1e-12
    out = np.zeros(6 + c.modes + c.contact_size)
    c.direct(x, sample.forces[3].copy(), out)
    wanted = model.direct(state, sample.forces[3])
    assert relative(out[:6], wanted.platform) <= LIBRARY
    held = [tip.attachment for leg in model.robot.legs for tip in leg.tips]
    assert relative(out[6 + c.modes :].reshape(-1, 3), wanted.contact_forces[held]) <= LIBRARY


def test_threads_share_a_constrained_model():
    """Projection, joints and both models at once, of a robot whose joints are carried."""
    sample, model = sample_of("rps3", rewriting=reframed), model_of("rps3", rewriting=reframed, backend="vm")
    expected, worst = model.direct(sample.states, sample.forces).platform, []

    def work(s):
        for _ in range(5):
            state = model.project(sample.states[s])
            worst.append(np.max(np.abs(model.direct(state, sample.forces[s]).platform - expected[s])))
            model.inverse(state, sample.target[s], sample.output)

    threads = [threading.Thread(target=work, args=(s,)) for s in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(worst) == 20
    assert max(worst) <= 1e-8


# --- runs ---

RUNS = {
    **{
        f"{name}-{kind}": (name, kind, None, False)
        for name in ("rps3", "delta3")
        for kind in ("rigid", "flex")
    },
    **{f"{name} with loads": (name, "rigid", None, True) for name in cases.NAMES},
    "rps3 otherwise": ("rps3", "rigid", reframed, False),
    "delta3 otherwise": ("delta3", "rigid", reframed, False),
}


@cache
def run(which):
    """Two seconds from rest, off the equilibrium, under springs and dampers on the actuated joints."""
    name, kind, rewriting, loads = RUNS[which]
    model = model_of(name, kind, rewriting, "vm", loads)
    start = model.project(model.robot.home)
    control = pf.JointPD(model, start, *((3e3, 30.0) if name == "rps3" else (6.0, 0.3)))
    return pf.simulate(model, control, start, np.linspace(0, 2, 41), rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("which", RUNS)
def test_runs_stay_on_the_closure(which):
    """By the oracle: nothing drifts in two seconds, for any leg."""
    result, sample = run(which), sample_of(*RUNS[which])
    assert not result.partial, result.stopped
    for i in (1, 10, 25, 40):
        state = result.state(i)
        q = [row[np.isfinite(row)] for row in result.dataset.joint.values[i]]
        assert max(sample.open(platform_of(state), q)) <= CLOSED


@pytest.mark.parametrize("which", RUNS)
def test_energy_is_accounted_for(which):
    """To 1e-9 of the largest change of any term: springs, friction and rotors are in the ledger."""
    data = run(which).dataset
    terms = [str(n) for n in data if str(n).startswith("energy_") and n != "energy_residual"]
    changes = {name: float(np.ptp(data[name].values)) for name in terms}
    assert float(np.max(np.abs(data.energy_residual))) <= 1e-9 * max(changes.values())
    if "loads" in which:
        assert changes["energy_springs"] > 1e-3 * max(changes.values())
        assert changes["energy_dissipated"] > 1e-3 * max(changes.values())


@pytest.mark.parametrize("which", ["rps3-flex", "delta3 otherwise"])
def test_states_of_a_run_replay_the_models(which):
    """With their joints, where these are carried: no posture is needed near them."""
    result, model = run(which), model_of(*RUNS[which][:3], backend="numpy", loads=RUNS[which][3])
    data = result.dataset
    for i in (3, 40):
        found = model.direct(result.state(i), data.forces.values[i])
        assert np.allclose(found.platform, data.acceleration[i], atol=1e-8)
        legs = model.joints(result.state(i))
        for leg in range(len(legs.q)):
            n = legs.q[leg].shape[-1]
            assert np.allclose(legs.qd[leg], data.joint_rate.values[i, leg, :n], atol=1e-9)


@pytest.mark.parametrize(("name", "rewriting"), [("rps3", None), ("rps3", reframed)])
def test_projection_keeps_the_order_of_the_integrator(name, rewriting):
    """Fixed steps of an eighth-order method, halved: the error against a tight run falls by 2⁷ at least."""
    sample, model = sample_of(name, rewriting=rewriting), model_of(name, rewriting=rewriting, backend="vm")
    start, forces = sample.states[1], sample.forces[1]
    end = 0.32
    tight = pf.simulate(model, forces, start, [0.0, end], rtol=1e-13, atol=1e-14, max_step=0.005)
    errors = []
    for step in (0.04, 0.02):
        coarse = pf.simulate(model, forces, start, [0.0, end], rtol=1e3, atol=1e3, max_step=step)
        assert not coarse.partial
        errors.append(
            max(float(np.max(np.abs(coarse.dataset[f][-1] - tight.dataset[f][-1]))) for f in FIELDS[:3])
        )
    assert errors[0] > 1e-10
    assert errors[1] <= errors[0] / 2**7, errors


@pytest.mark.usefixtures("interruptible")
@pytest.mark.parametrize("rewriting", [None, reframed])
def test_ctrl_c_keeps_what_a_constrained_robot_reached(rewriting):
    """On the closure up to its last row, and with joints."""
    model, sample = (
        model_of("rps3", rewriting=rewriting, backend="vm"),
        sample_of("rps3", rewriting=rewriting),
    )
    start, pressed = model.robot.home, []

    def controller(t, state):
        if t > 0.05 and not pressed:
            pressed.append(t)
            signal.raise_signal(signal.SIGINT)
        return np.full(3, 40.0)

    with pytest.warns(pf.PartialRun, match="interrupted"):
        result = pf.simulate(model, controller, start, np.linspace(0, 0.2, 41))
    assert result.partial
    assert "interrupted" in result.stopped
    assert 1 < result.dataset.sizes["time"] < 41
    last = result.state(-1)
    assert max(sample.open(platform_of(last), last.joints)) <= CLOSED
    assert np.all(np.isfinite(model.direct(last, np.zeros(3)).platform))


# --- forward geometry ---


def lengths_of(model, state):
    """(m,) positions of the actuated joints."""
    return actuated(model.robot, model.joints(state).q)


def apart(a, b):
    """The largest difference of two poses."""
    return max(np.max(np.abs(a.position - b.position)), np.max(np.abs(a.rotation - b.rotation)))


@pytest.mark.parametrize("rewriting", [None, reframed])
@pytest.mark.parametrize("name", cases.NAMES)
def test_forward_after_inverse_geometry(name, rewriting):
    """From home to every state of the case, bent as it is."""
    for kind in ("rigid", "flex"):
        sample, model = sample_of(name, kind, rewriting), model_of(name, kind, rewriting)
        for s in range(len(sample.forces)):
            state = sample.states[s]
            guess = replace(model.robot.home, elastic=state.elastic)
            found = model.forward(lengths_of(model, state), guess)
            assert apart(found, state) <= POSED
            assert np.all(found.twist == 0)


def test_forward_geometry_of_the_papers_robot():
    """At fifty poses within ± 0.1 m and ± 0.1 rad."""
    model = pf.Model(pf.robots.gough_stewart(0), "numpy")
    states = random_states(model.robot, 50, 0)
    for s in range(50):
        assert apart(model.forward(lengths_of(model, states[s])), states[s]) <= POSED


@pytest.mark.parametrize("name", cases.NAMES)
def test_forward_geometry_with_sag(name):
    """The joints of the static equilibrium lead back to it, its bend included, from the undeformed home."""
    model = model_of(name, "flex")
    state, _ = model.equilibrium(*model.robot.home_pose)
    found = model.forward(lengths_of(model, state), sag=True)
    assert apart(found, state) <= 1e-9
    size = np.max(np.abs(state.elastic))
    assert relative(found.elastic / size, state.elastic / size) <= 1e-8


@pytest.mark.parametrize("rewriting", [None, reframed])
def test_all_poses_of_a_3rps(rewriting):
    """Every pose reproduces the lengths and closes the legs; they are distinct; with equal lengths a third of
    a turn leads from one to another. Legs that carry their joints know more poses than 80 starts can find."""
    sample, model = sample_of("rps3", rewriting=rewriting), model_of("rps3", rewriting=rewriting)
    home = model.robot.home
    lengths = lengths_of(model, home)
    found = model.forward_all(lengths, starts=80)
    assert apart(found[0], home) <= POSED
    assert len(found) >= 5
    joints = [model.joints(state).q for state in found]
    for state, q in zip(found, joints, strict=True):
        assert np.max(np.abs(actuated(model.robot, q) - lengths)) <= POSED
        assert sample.open(platform_of(state), q)[0] <= CLOSED
    for (a, q_a), (b, q_b) in combinations(zip(found, joints, strict=True), 2):
        turns = [np.max(np.abs(np.sin((x - y) / 2))) for x, y in zip(q_a, q_b, strict=True)]
        assert apart(a, b) > 1e-6 or max(turns) >= 1e-6
    if rewriting:
        return
    third = Rotation.from_euler("z", 120, degrees=True).as_matrix()
    heights = [state for state in found if state.position[2] > 0]
    for state in heights:
        turned = pf.State(third @ state.position, third @ state.rotation @ third.T)
        assert min(apart(turned, other) for other in heights) <= 1e-7


def test_no_pose_is_an_empty_list():
    """Two metres and two times two millimetres: no triangle has such sides."""
    model = model_of("rps3")
    assert model.forward_all([2.0, 0.002, 0.002], starts=3) == []
    with pytest.raises(pf.NotConverged, match="no pose with these actuated joints was found"):
        model.forward([2.0, 0.002, 0.002])
