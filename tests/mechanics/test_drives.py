"""Drives that give: motor, spring, link in series, against Lagrange's equations and closed forms."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.linalg import eigvals

import flexlegs
import parflex as pf
from compliant import compliant
from lagrange import Lagrange, errors
from measures import relative
from parflex.analysis.small_motions import SmallMotions, slopes
from parflex.kernels.motion import derivative

AGREED = 1e-10  # two solutions in 64 bits; 2e-11 is reached
SAME = 1e-12
NAMES = ("gough", "delta", "some", *flexlegs.NAMES)


@cache
def named(name):
    """All legs alike, a robot of fewer freedoms, some legs only, and beside links that bend and flexures."""
    if name in flexlegs.NAMES:
        return compliant(flexlegs.mixed(name), (0, 2, 3))
    robots = {"gough": pf.robots.gough_stewart(2), "delta": pf.robots.delta(0)}
    return compliant(robots[name]) if name in robots else compliant(pf.robots.gough_stewart(0), (1, 3))


def moving(robot, seed, freedoms=6):
    """A state near home in motion, its drives too, that names the joints."""
    rng, model = np.random.default_rng(seed), pf.Model(robot, "numpy")
    if any(any(leg.modes) for leg in robot.legs):
        state = flexlegs.moving(robot, seed)
    else:
        N = robot.platform.modes
        state = replace(
            robot.home,
            twist=0.3 * np.append(rng.normal(size=freedoms), np.zeros(6 - freedoms)),
            elastic=1e-3 * rng.normal(size=N),
            elastic_rate=0.1 * rng.normal(size=N),
            leg_elastic=[1e-2 * rng.normal(size=leg.bends) for leg in robot.legs],
            leg_elastic_rate=[0.1 * rng.normal(size=leg.bends) for leg in robot.legs],
        )
    legs = model.joints(state)
    return replace(state, joints=legs.q, joint_rates=legs.qd)


def of(name, seed):
    robot = named(name)
    state = moving(robot, seed, 3 if name == "delta" else 6)
    return robot, state, 100.0 * np.random.default_rng(seed).normal(size=robot.n_forces)


CASES = [(name, "numpy") for name in NAMES] + [
    ("gough", "vm"),
    ("gough", "native"),
    ("gs_flexlegs", "native"),
]


@pytest.mark.parametrize(("name", "backend"), CASES)
def test_they_obey_lagranges_equations(name, backend):
    robot, state, forces = of(name, 1)
    model, answer = pf.Model(robot, backend), Lagrange(robot)(state, forces)
    found = errors(answer, model, state, forces)
    assert max(found.values()) <= AGREED, found
    assert sum(model.energies(state)) == pytest.approx(answer.energy, rel=SAME)


@pytest.mark.parametrize("name", ["gough", "delta", "some", "gs_flexlegs"])
def test_the_derivatives_are_the_slopes_of_the_direct_model(name):
    """By rates of the drives, by deflections, and by the forces: central differences of the direct model."""
    robot, state, forces = of(name, 2)
    model = pf.Model(robot, "numpy")
    jacobian, layout = model.direct_jacobian(state, forces), model._core.mechanism.layout
    x = model._core.flat(state)
    run = model._core.readable
    h, at, motions = 1e-6, layout.at, layout.motions

    def rates(x, u=forces):
        found = run(derivative)(x=x, forces=u, load=np.zeros(6 + robot.platform.modes))["rate"]
        return np.concatenate([found[at.elastic_rate], found[at.joint_rates]])

    rows = np.concatenate([jacobian.state[6:], jacobian.carried])
    for part, of_motion in ((at.joints, motions.joints), (at.joint_rates, motions.joint_rates)):
        for place in range(layout.carried):
            step = np.zeros(len(x))
            step[part.start + place] = h
            slope = (rates(x + step) - rates(x - step)) / (2 * h)
            assert relative(rows[:, of_motion.start + place], slope) <= 2e-6
    by_forces = np.concatenate([jacobian.forces[6:], jacobian.carried_forces])
    for n, unit in enumerate(np.eye(len(forces))):
        assert relative(by_forces[:, n], rates(x, forces + unit) - rates(x, forces)) <= 1e-8


@pytest.mark.parametrize("name", ["gough", "some", "gs_flexlegs"])
def test_the_powers_balance(name):
    """Γ θ̇ − lost is the slope of the energy along the motion."""
    robot, state, forces = of(name, 3)
    model = pf.Model(robot, "numpy")
    x = model._core.flat(state)
    found = model._core.readable(derivative)(x=x, forces=forces, load=np.zeros(6 + robot.platform.modes))
    h = 1e-5

    def stored(t):
        return sum(model.energies(model._core.state(x + t * found["rate"])))

    slope = (8 * (stored(h) - stored(-h)) - (stored(2 * h) - stored(-2 * h))) / (12 * h)
    motors, _, lost = found["powers"]
    assert abs(slope - (motors - lost)) <= 1e-7 * (abs(motors) + abs(lost))


@pytest.mark.parametrize("stiff", [1e2, 1e4])
def test_a_stiff_drive_tends_to_a_rigid_one(stiff):
    """Legs that bend statically: what is left to the rigid drive's forces falls with 1/k."""
    state = replace(pf.robots.gough_stewart(0).home, twist=[0.1, -0.2, 0.1, 0.2, 0.1, -0.1])
    target = np.array([0.3, 0.1, -0.4, 0.2, 0.1, 0.3])
    rigid = compliant(pf.robots.gough_stewart(0), drive_stiffness=None, drive_damping=0.0)
    expected = pf.Model(rigid, "numpy").inverse(state, target).forces
    left = []
    for k in (3e4 * stiff, 3e6 * stiff):
        soft = pf.Model(compliant(pf.robots.gough_stewart(0), drive_stiffness=k), "numpy")
        left.append(relative(soft.inverse(state, target, legs="static").forces, expected))
    assert left[0] <= 1e-1 / stiff
    assert left[1] / left[0] == pytest.approx(1e-2, rel=0.02)


def test_the_bend_that_is_found_gives_the_target():
    robot = named("gough")
    model = pf.Model(robot, "numpy")
    state = replace(robot.home, twist=[0.1, -0.2, 0.1, 0.2, 0.1, -0.1])
    target = np.array([0.3, 0.1, -0.4, 0.2, 0.1, 0.3])
    found = model.inverse(state, target, legs="static")
    there = replace(state, leg_elastic=found.leg_elastic)
    assert relative(model.direct(there, found.forces).platform, target) <= 1e-10


@pytest.mark.parametrize("backend", ["numpy", "native"])
@pytest.mark.parametrize("name", ["gough", "some"])
def test_the_platform_does_not_accelerate_at_once(name, backend):
    """∂V̇_p/∂Γ is zero: refused with advice that works, also where only some motors drive through springs."""
    robot = named(name)
    model = pf.Model(robot, backend)
    state = moving(robot, 4)
    forces = np.arange(6.0) * [bool(leg.drives) for leg in robot.legs]
    assert relative(model.direct(state, forces).platform, model.direct(state, 0 * forces).platform) <= 1e-9
    for allowed in (False, True):
        with pytest.raises(pf.InputError, match=r"JointOutput\(\)"):
            model.inverse(state, np.zeros(6), allow_ill_posed=allowed)
    for asked in (lambda: model.inverse_jacobian(state, np.zeros(6)), lambda: model.output_report(state)):
        with pytest.raises(pf.InputError, match="a compliance lies between motors and platform"):
            asked()
    target = np.linspace(-1, 1, 6)
    found = model.inverse(state, target, pf.JointOutput())
    there = model.direct(state, found.forces)
    motors = [q[2] - sum(e) for q, e in zip(there.leg_joints, there.leg_elastic, strict=True)]
    assert relative(np.array(motors), target) <= 1e-10


LEG_MASS, IA, K_SERVO, K_DRIVE = 1e-5, 4.0, 2e5, 8e4


@cache
def series(leg_mass=LEG_MASS):
    """A hexapod of series-elastic struts: rotor and servo spring, drive, light legs, rigid platform."""
    bar = pf.Bar(mass=leg_mass / 2, length=0.3, outer=0.002)
    strut = pf.Strut(bar, bar, stiffness=K_SERVO, rotor_inertia=IA, drive_stiffness=K_DRIVE)
    return pf.robots.hexapod(
        base_radius=0.4,
        platform_radius=0.25,
        height=0.5,
        base_spread=0.35,
        platform_spread=0.3,
        strut=strut,
        payload=pf.Payload(20.0, (0.02, 0.01, 0.05), np.diag([0.4, 0.5, 0.6])),
    )


def closed_form(robot, state, forces):
    """ω² of the platform's six motions and the six motors: M ẍ = −J_lᵀ k_d (J_l x − θ), IA θ̈ = …, with
    rows J_l = (a, ρ × a) of the struts' unit vectors; the preload's own stiffness of the struts aside, which
    is (f/ℓ) (1 − a aᵀ) at the joints, and of their forces at the platform that turns."""
    body, moments = robot.platform, robot.platform.moments
    p, R = np.asarray(state.position), np.asarray(state.rotation)
    inertia = np.trace(moments.P0) * np.eye(3) - moments.P0
    hat = hats(moments.MS0)
    M = np.block([[moments.m * np.eye(3), -hat], [hat, inertia]])
    model = pf.Model(robot, "numpy")
    joints, contact = model.joints(state).q, model.direct(state, forces).contact_forces
    K, J = np.zeros((12, 12)), []
    for leg, q in zip(robot.legs, joints, strict=True):
        rho = body.attachment_points[leg.tips[0].attachment]
        way = R.T @ (p + R @ rho - leg.origin)
        a, length = way / np.linalg.norm(way), np.linalg.norm(way)
        f = contact[leg.tips[0].attachment]
        push = f @ a  # along the strut, on the platform
        moved = np.hstack([np.eye(3), -hats(rho)])
        across = np.eye(3) - np.outer(a, a)
        K[:6, :6] -= push / length * moved.T @ across @ moved
        K[3:6, 3:6] -= hats(rho) @ hats(f)  # δ(ρ × f) of a force that stays in space
        J.append(a @ moved)
        assert q[2] > 0
    J = np.array(J)
    gravity = R.T @ np.asarray(robot.gravity)
    K[3:6, 3:6] -= hats(moments.MS0) @ hats(gravity)
    K[:6, :6] += K_DRIVE * J.T @ J
    K[:6, 6:], K[6:, :6] = -K_DRIVE * J.T, -K_DRIVE * J
    K[6:, 6:] = (K_DRIVE + K_SERVO) * np.eye(6)
    mass = np.block([[M, np.zeros((6, 6))], [np.zeros((6, 6)), IA * np.eye(6)]])
    return np.sqrt(np.sort(eigvals(K, mass).real))


def hats(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def test_series_elastic_struts_have_twelve_frequencies():
    """By differences of the direct model, and by its exact derivatives, against motors, springs and platform
    alone (legs of 1e-5 kg)."""
    robot = series()
    model = pf.Model(robot, "numpy")
    state, forces = model.equilibrium(*robot.home_pose)
    motions = SmallMotions(model._core.readable, model._core.flat(state), forces)
    by_differences, _ = slopes(model._core.readable, motions.x, motions.T, lambda x: forces + 0 * x[..., :6])
    expected = closed_form(robot, state, forces)
    for K in (by_differences, motions.KC[0]):
        found = np.sqrt(np.sort(-np.linalg.eigvals(K).real))
        assert np.max(np.abs(found / expected - 1)) <= 1e-4
    modes = model.linearise(state, forces).modes()
    assert np.max(np.abs(2 * np.pi * modes.frequency.values / expected - 1)) <= 1e-4
    assert np.min(modes.share.sel(part="drives")) >= 0.999  # nothing else gives, but for the weight's share


def test_they_hold_their_weight():
    """At rest each drive carries its strut's force: K δ = −Γ + k (θ − q_0), and what is found stays."""
    robot = series()
    model = pf.Model(robot, "numpy")
    state, forces = model.equilibrium(*robot.home_pose)
    q = model.joints(state).q
    for leg, joints, delta, force in zip(robot.legs, q, state.leg_elastic, forces, strict=True):
        servo = K_SERVO * (joints[2] - delta[0] - leg.joints[2].q_0)
        assert abs(K_DRIVE * delta[0] + force - servo) <= 1e-9 * abs(K_DRIVE * delta[0])
    there = model.direct(state, forces)
    assert np.max(np.abs(there.platform)) <= 1e-9 * 9.81
    assert np.max(np.abs(np.concatenate(there.leg_elastic))) <= 1e-9 * 9.81


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ({"mu": 1, "drive_stiffness": 1e5}, "it needs IA, the rotor's inertia"),
        ({"mu": 0, "IA": 1.0, "drive_stiffness": 1e5}, "no motor drives; set mu = 1"),
        ({"mu": 1, "IA": 1.0, "drive_stiffness": 0.0}, "Joint.drive_stiffness is 0"),
        ({"mu": 1, "IA": 1.0, "drive_stiffness": 1.0, "drive_damping": -1.0}, "Joint.drive_damping is -1"),
        ({"mu": 1, "IA": 1.0, "drive_damping": 1.0}, "without drive_stiffness"),
    ],
)
def test_bad_drives_are_refused(numbers, words):
    with pytest.raises(pf.InputError, match=words):
        pf.Joint(0, sigma=1, **numbers)
    bar = pf.Bar(mass=1.0, length=0.3, outer=0.02)
    with pytest.raises(pf.InputError, match="no rotor_inertia"):
        pf.Strut(bar, bar, drive_stiffness=1e5)


def test_files_keep_them_and_name_the_line_of_bad_ones(tmp_path):
    robot = compliant(pf.robots.gough_stewart(0))
    path = robot.to_file(tmp_path / "robot.toml")
    for leg in pf.load_robot(path).legs:
        assert (leg.joints[2].drive_stiffness, leg.joints[2].drive_damping) == (3e4, 20.0)
        assert leg.joints[1].drive_stiffness is None
    text = path.read_text()
    for old, new, words in (
        ("drive_stiffness = 30000.0", "drive_stiffness = -1.0", "drive_stiffness"),
        ("actuated = true\n", "", r"no motor drives; .* \(in files actuated = true\)"),
        ("drive_stiffness = 30000.0\n", "", "without drive_stiffness"),
    ):
        assert old in text
        path.write_text(text.replace(old, new))
        with pytest.raises(pf.InputError, match=words) as told:
            pf.load_robot(path)
        assert "robot.toml:" in str(told.value)


def test_runs_say_which_coordinates_are_drives():
    """A second held by the servo: the balance of energies, and the variables of the legs."""
    robot = series(20.0)
    model = pf.Model(robot)
    state, _ = model.equilibrium(*robot.home_pose)
    to = [[0.01, 0.0, 0.0], [0.0, 0.01, 0.01]]
    path = pf.Trajectory.of(
        state, [pf.MoveTo(np.asarray(state.position) + step, duration=0.2) for step in to]
    )
    run = pf.simulate(model, pf.Servo(model, path), state, np.linspace(0, 0.4, 9)).dataset
    assert np.array_equal(run.leg_mode_drive, np.ones((6, 1)))
    assert np.array_equal(run.leg_mode_link, np.full((6, 1), 3))
    assert run.leg_frequency.values == pytest.approx(np.full((6, 1), np.sqrt(K_DRIVE / IA)))
    total = np.max(np.abs(run.energy_springs)) + np.max(np.abs(run.energy_kinetic))
    assert float(np.max(np.abs(run.energy_residual)) / total) <= 1e-6


def test_c_code_names_them(tmp_path):
    """The state of the exported models, whose inverse prescribes the motors."""
    robot = series(20.0)
    with pytest.raises(pf.InputError, match="take output=JointOutput"):
        pf.export_c(robot, tmp_path / "none")
    pf.export_c(robot, tmp_path / "model", pf.JointOutput())
    told = (tmp_path / "model" / "model.h").read_text()
    assert "deflections of drives of leg 6, link less motor: joint 3, m" in " ".join(
        told.replace("*", "").split()
    )
    assert "6 drives that give" in (tmp_path / "model" / "README.md").read_text()
