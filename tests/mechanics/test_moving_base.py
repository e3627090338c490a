"""A floor that moves: bent legs, flexures, carried joints and a Delta against Lagrange's equations, and what
physics says of frames that move.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import flexlegs
import parflex as pf
from differences import by_column, difference, moved
from floors import moving_base, shifted
from gives import everything
from lagrange import Lagrange, errors
from measures import random_states, relative
from parflex.kernels import motion
from soft import pulled_off
from spun import Spun

AGREED = 1e-10  # two solutions in 64 bits; 6e-12 is reached
SAME = 1e-9  # of the issue; 1e-12 is reached, 5e-11 by turning


@cache
def named(name):
    """A robot of bent legs, some rigid and some that carry their joints, with flexures."""
    return flexlegs.mixed(name)


def carried(state, base):
    """The state in the world of one seen from the base."""
    R, (v, omega) = np.asarray(base.rotation), np.split(np.asarray(base.twist), 2)
    away, rotation = R @ state.position, R @ state.rotation
    twist = state.twist + np.concatenate([rotation.T @ (v + np.cross(omega, away)), rotation.T @ omega])
    return replace(state, position=base.position + away, rotation=rotation, twist=twist)


def at(name, seed):
    """Robot, model, a state in the world on a base, the base, and forces."""
    robot, base = named(name), moving_base(seed)
    model, state = pf.Model(robot, "numpy"), carried(flexlegs.moving(robot, seed), base)
    legs = model.joints(state, base=base)
    state = replace(state, joints=legs.q, joint_rates=legs.qd)
    return robot, model, state, base, 100.0 * np.random.default_rng(seed).normal(size=robot.n_forces)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("name", flexlegs.NAMES)
def test_a_moving_base_obeys_lagranges_equations(name, seed):
    """Accelerations, contact forces, energies and the floor's power; legs closed, carried, and of a Delta."""
    robot, model, state, base, forces = at(name, seed)
    answer = Lagrange(robot)(state, forces, base)
    found = errors(answer, model, state, forces, base)
    assert max(found.values()) <= AGREED, found
    assert max(answer.gap, answer.gap_rate) <= 1e-10
    assert sum(model.energies(state, base=base)) == pytest.approx(answer.energy, rel=1e-12)
    core = model._core.on(base)
    powers = core.functions(motion.derivative).run(x=core.flat(state), forces=forces)["powers"]
    assert powers[-1] == pytest.approx(answer.floor_power, rel=1e-9)


@pytest.mark.parametrize("backend", ["vm", "native"])
def test_every_backend_sees_the_base(backend):
    """Also the flat call, and a batch of motions of the base."""
    robot = pf.robots.gough_stewart(2)
    readable, model = pf.Model(robot, "numpy"), pf.Model(robot, backend)
    bases = [moving_base(seed) for seed in range(3)]
    parts = ("position", "rotation", "twist", "acceleration")
    batch = pf.BaseMotion(*(np.stack([getattr(base, part) for base in bases]) for part in parts))
    forces = np.linspace(10.0, 60.0, 6)
    states = [carried(random_states(robot, 1, 7)[0], base) for base in bases]
    fields = ("position", "rotation", "twist", "elastic", "elastic_rate")
    many = pf.State(*(np.stack([getattr(state, field) for state in states]) for field in fields))
    found = model.direct(many, forces, base=batch)
    flat, out = model.compiled(), np.zeros(8)
    for i, (state, base) in enumerate(zip(states, bases, strict=True)):
        expected = readable.direct(state, forces, base=base)
        assert relative(found.platform[i], expected.platform) <= 1e-11
        flat.direct(flat.pack(state), forces, out, base=np.array(base.flat))
        assert relative(out[:6], expected.platform) <= 1e-11
        back = model.inverse(state, expected.platform, base=base)
        assert relative(back.forces, forces) <= 1e-8


@pytest.mark.parametrize("name", flexlegs.NAMES)
def test_a_base_at_the_origin_is_none(name):
    robot = named(name)
    model, state = pf.Model(robot, "numpy"), flexlegs.moving(robot, 1)
    forces = np.ones(robot.n_forces)
    there, none = (model.direct(state, forces, base=base) for base in (pf.BaseMotion(), None))
    assert relative(there.platform, none.platform) <= 1e-12
    assert relative(there.contact_forces, none.contact_forces) <= 1e-12


@pytest.mark.parametrize("name", flexlegs.NAMES)
def test_a_constant_acceleration_is_gravity(name):
    """Seen from a base that accelerates with a, gravity is g − a, whatever its velocity."""
    robot, a = named(name), np.array([3.0, -2.0, 4.0])
    base = pf.BaseMotion(twist=(1.0, 2.0, -1.0, 0, 0, 0), acceleration=(*a, 0, 0, 0))
    state, forces = flexlegs.moving(robot, 2), 100.0 * np.ones(robot.n_forces)
    found = pf.Model(robot, "numpy").direct(carried(state, base), forces, base=base)
    heavy = pf.Model(replace(robot, gravity=robot.gravity - a), "numpy").direct(state, forces)
    absolute = np.concatenate([state.rotation.T @ a, np.zeros(3)])
    assert relative(found.platform - absolute, heavy.platform) <= SAME
    assert relative(found.elastic, heavy.elastic) <= SAME
    assert relative(found.contact_forces, heavy.contact_forces) <= SAME


@pytest.mark.parametrize("kind", ["bent legs", "everything gives"])
@pytest.mark.parametrize("name", flexlegs.NAMES)
def test_a_base_that_turns_steadily_is_centrifuge_and_coriolis(name, kind):
    """Expected: the robot at rest with −m Ω × (Ω × r) − 2 m Ω × v on every node by hand (`support/spun.py`),
    whose platform's acceleration goes to the world by Coriolis's theorem. Platform and legs are flexible."""
    robot = named(name) if kind == "bent legs" else everything(name)
    state = flexlegs.moving(robot, 3) if kind == "bent legs" else pulled_off(robot, 3)
    legs = pf.Model(robot, "numpy").joints(state)
    state = replace(state, joints=legs.q, joint_rates=legs.qd)
    forces = 100.0 * np.random.default_rng(3).normal(size=robot.n_forces)
    R, o = Rotation.from_rotvec([0.4, -0.7, 0.9]).as_matrix(), np.array([0.5, -0.3, 0.8])
    omega, about = np.array([3.0, -2.0, 4.0]), np.array([0.2, 0.1, -0.4])  # rad/s and m, in the base's axes
    v, still = np.cross(R @ omega, -R @ about), np.zeros(3)
    base = pf.BaseMotion(o, R, np.append(v, R @ omega), np.append(np.cross(R @ omega, v), still))

    turned = replace(robot, gravity=R.T @ robot.gravity)
    seen = Spun(turned, name, omega, about)(state, forces)
    T, away = np.asarray(state.rotation), np.asarray(state.position) - about
    v, w = (T @ part for part in np.split(np.asarray(state.twist), 2))
    a = np.cross(omega, np.cross(omega, away) + 2 * v)
    wanted = seen._replace(platform=seen.platform + np.append(T.T @ a, T.T @ np.cross(omega, w)))
    found = errors(wanted, pf.Model(robot, "numpy"), carried(state, base), forces, base)
    assert max(found.values()) <= SAME, found
    unforced = Lagrange(turned)(state, forces)
    assert relative(unforced.elastic, wanted.elastic) >= 1e5 * SAME  # these forces are felt


def test_derivatives_on_a_base_are_those_of_the_model():
    """By the base and by the state, against central differences; legs that bend, of a robot that closes by
    itself, so that every motion is one."""
    robot = pf.robots.gough_stewart(2)
    model, base = pf.Model(robot, "numpy"), moving_base(0)
    state, forces = carried(random_states(robot, 1, 3)[0], base), np.linspace(10.0, 60.0, 6)
    core = model._core.on(base)
    x = core.flat(state)

    def answer(there, on=base):
        found = model.direct(there, forces, base=on)
        return np.concatenate([found.platform, found.elastic])

    found = model.direct_jacobian(state, forces, base=base)
    by_base = difference(lambda d: answer(state, shifted(base, d)), 18)
    assert by_column(found.base, by_base) <= 1e-7
    by_state = difference(lambda d: answer(core.state(moved(x, d))), core.mechanism.layout.motion_size)
    assert by_column(found.state, by_state) <= 1e-7

    target = np.linspace(-1.0, 1.0, 6)
    by_base = difference(lambda d: model.inverse(state, target, base=shifted(base, d)).forces, 18)
    assert by_column(model.inverse_jacobian(state, target, base=base).base, by_base) <= 1e-7


@pytest.mark.parametrize("name", flexlegs.NAMES)
def test_derivatives_keep_the_invariances(name):
    """Robot and base moved together feel nothing; gravity g − a; a velocity of both that is steady."""
    robot, model, state, base, forces = at(name, 1)
    found, R = model.direct_jacobian(state, forces, base=base), np.asarray(state.rotation)
    by_state = np.concatenate([found.state, found.carried])
    by_base = np.concatenate([found.base, found.carried_base])
    scale = np.max(np.abs(by_base[:, 12:15]))
    assert np.max(np.abs(by_state[:, :3] + by_base[:, :3])) <= SAME * np.max(np.abs(by_state[:, :3]))
    assert np.max(np.abs(by_state[:, 6:9] @ R.T + by_base[:, 6:9])) <= SAME * np.max(np.abs(by_base[:, 6:9]))
    heavy = pf.Model(robot, "numpy", parameters=["gravity"])
    weighed = heavy.direct_jacobian(state, forces, base=base)
    by_gravity = np.concatenate([weighed.parameters, weighed.carried_parameters])
    absolute = np.zeros_like(by_gravity)
    absolute[:3] = R.T  # a frame that falls with g
    assert np.max(np.abs(by_base[:, 12:15] - (absolute - by_gravity))) <= SAME * scale


def test_an_equilibrium_goes_with_a_base_that_accelerates_steadily():
    robot = pf.robots.gough_stewart(2)
    model = pf.Model(robot, "numpy")
    R = Rotation.from_euler("z", 0.3).as_matrix()
    base = pf.BaseMotion((1.0, 2.0, 0.5), R, (0.4, 0, 0.1, 0, 0, 0), (1.0, -2.0, 3.0, 0, 0, 0))
    home = robot.home
    state, forces = model.equilibrium(base.position + R @ home.position, R @ home.rotation, base=base)
    found = model.direct(state, forces, base=base)
    gone = np.concatenate([state.rotation.T @ np.asarray(base.acceleration)[:3], np.zeros(3)])
    assert np.max(np.abs(found.platform - gone)) <= 1e-8
    assert np.max(np.abs(found.elastic)) <= 1e-6
    with pytest.raises(pf.InputError, match=r"base turns, BaseMotion.twist\[3:\] is \[0.0, 0.0, 1.0\]"):
        model.equilibrium(home.position, home.rotation, base=pf.BaseMotion(twist=(0, 0, 0, 0, 0, 1.0)))
