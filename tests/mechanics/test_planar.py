"""Mechanisms of one freedom, whose closed forms are in books: a four-bar, tilting tables, lifting columns.

Legs of one joint, slides alone, and posts carry them.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import parflex as pf

CLOSED_FORM = 1e-9  # against sums of a few terms in 64 bits, the closure solved to 1e-13
FLOWN = 1e-6  # of 3 s at rtol 1e-10, m and rad
G = 9.81
BACKENDS = ("numpy", "vm", "native")


# --- a four-bar ---


@dataclass(frozen=True)
class FourBar:
    """a e^{iθ} + b e^{iθ3} = d + c e^{iθ4}: crank, coupler and rocker, uniform bars of m2, m3, m4 kg."""

    a: float = 0.1
    b: float = 0.3
    c: float = 0.25
    d: float = 0.3
    masses: tuple[float, float, float] = (0.4, 0.9, 0.7)

    def places(self, theta):
        """θ3 and θ4, the pin of coupler and rocker on the left of the line from crank pin to rocker base."""
        z = self.d - self.a * np.exp(1j * theta)
        third = np.angle(z) + np.arccos((abs(z) ** 2 + self.b**2 - self.c**2) / (2 * self.b * abs(z)))
        return third, np.angle(self.a * np.exp(1j * theta) + self.b * np.exp(1j * third) - self.d)

    def slopes(self, theta):
        """θ3′, θ4′, θ3″, θ4″ by θ: the loop, differentiated once and twice."""
        third, fourth = self.places(theta)
        crank, bar, rocker = np.exp(1j * theta), np.exp(1j * third), np.exp(1j * fourth)
        A = np.array([[self.b * bar, -self.c * rocker]])
        A = np.concatenate([A.real, A.imag])

        def solved(z):
            return np.linalg.solve(A, [z.real, z.imag])

        h3, h4 = solved(-self.a * crank)
        g3, g4 = solved(-1j * (self.a * crank + self.b * h3**2 * bar - self.c * h4**2 * rocker))
        return h3, h4, g3, g4

    def equation(self, theta, rate):
        """I and c of I θ̈ + c = τ, from T = ½ I(θ) θ̇² and V(θ), gravity along −y."""
        (h3, h4, g3, g4), (third, fourth) = self.slopes(theta), self.places(theta)
        m2, m3, m4 = self.masses
        crank, bar = np.exp(1j * theta), 0.5 * self.b * np.exp(1j * third)
        r1 = 1j * (self.a * crank + h3 * bar)  # of the coupler's centre, by θ
        r2 = -self.a * crank + (1j * g3 - h3**2) * bar
        J3, J4 = m3 * self.b**2 / 12, m4 * self.c**2 / 3
        inertia = m2 * self.a**2 / 3 + m3 * abs(r1) ** 2 + J3 * h3**2 + J4 * h4**2
        slope = m3 * (r1.conjugate() * r2).real + J3 * h3 * g3 + J4 * h4 * g4
        weight = 0.5 * m2 * self.a * np.cos(theta) + m3 * r1.imag + 0.5 * m4 * self.c * h4 * np.cos(fourth)
        return inertia, slope * rate**2 + G * weight

    def acceleration(self, theta, rate, torque):
        """θ̈."""
        inertia, c = self.equation(theta, rate)
        return (torque - c) / inertia

    def robot(self):
        """The coupler is the platform, on a hinge of two tips on the crank and one tip of the rocker."""
        bars = [
            pf.Joint(0, 0, mu, M=m, MS=(m * length / 2, 0, 0), I=m * length**2 / 3 * np.diag([0, 1, 1]))
            for mu, m, length in ((1, self.masses[0], self.a), (0, self.masses[2], self.c))
        ]
        hinge = [pf.Tip(1, (self.a, 0, z), i) for i, z in enumerate((-0.05, 0.05))]
        m, spin = self.masses[1], np.diag([1e-3, 1.0, 1.0]) * self.masses[1] * self.b**2 / 12
        held = [(0, 0, -0.05), (0, 0, 0.05), (self.b, 0, 0)]
        body = pf.FlexibleBody.rigid(m, (self.b / 2, 0, 0), spin, held)
        third, fourth = self.places(1.0)
        legs = (
            pf.Leg(np.eye(3), (0, 0, 0), bars[:1], hinge, (1.0,)),
            pf.Leg(np.eye(3), (self.d, 0, 0), bars[1:], (pf.Tip(1, (self.c, 0, 0), 2),), (fourth,)),
        )
        home = (self.a * np.cos(1.0), self.a * np.sin(1.0), 0), turned(third)
        return pf.Robot(legs, body, (0, -G, 0), home)

    def state(self, theta, rate):
        """The library's state."""
        (third, fourth), (h3, h4, *_) = self.places(theta), self.slopes(theta)
        R, v = turned(third), self.a * rate * np.array([-np.sin(theta), np.cos(theta), 0])
        position = self.a * np.array([np.cos(theta), np.sin(theta), 0])
        joints, rates = ([theta], [fourth]), ([rate], [h4 * rate])
        return pf.State(position, R, (*(R.T @ v), 0, 0, h3 * rate), joints=joints, joint_rates=rates)


def turned(angle):
    return Rotation.from_euler("z", angle).as_matrix()


@cache
def four_bar(backend):
    return pf.Model(FourBar().robot(), backend)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("theta", "rate", "torque"), [(1.0, 0.0, 0.0), (2.3, 4.0, 0.7), (5.1, -6.0, -0.2)])
def test_four_bar(backend, theta, rate, torque):
    """Acceleration for a torque, torque for an acceleration, joints, torque that holds it."""
    bars, model = FourBar(), four_bar(backend)
    state, (h3, h4, g3, g4) = bars.state(theta, rate), bars.slopes(theta)
    spin = bars.acceleration(theta, rate, torque)
    wanted = h3 * spin + g3 * rate**2
    found = model.direct(state, [torque])
    assert abs(found.platform[5] - wanted) <= CLOSED_FORM * max(1, abs(wanted))
    back = model.inverse(state, [wanted], pf.FrameOutput((5,)))
    assert abs(back.forces[0] - torque) <= CLOSED_FORM
    crank, rocker = model.joint_accelerations(state, [torque])
    assert abs(crank[0] - spin) <= CLOSED_FORM * max(1, abs(spin))
    assert abs(rocker[0] - h4 * spin - g4 * rate**2) <= CLOSED_FORM * max(1, abs(spin))
    held = model.equilibrium(state.position, state.rotation)[1]
    assert abs(held[0] - bars.equation(theta, 0.0)[1]) <= CLOSED_FORM


def test_four_bar_has_one_freedom():
    """Of nine closure equations two say again that the hinge is straight and the motion plane."""
    found = four_bar("numpy").mobility(FourBar().state(1.0, 0.0))
    assert (found.freedoms, found.internal, found.redundant) == (1, 0, 2)


def test_four_bar_flies_as_its_equation():
    """3 s under a torque, over several turns of the crank."""
    bars, torque, t = FourBar(), 0.02, np.linspace(0, 3, 61)
    result = pf.simulate(four_bar("auto"), [torque], bars.state(1.0, 14.0), t, rtol=1e-10, atol=1e-12)
    assert not result.partial
    planar = solve_ivp(
        lambda _, y: (y[1], bars.acceleration(*y, torque)),
        (0, 3), (1.0, 14.0), "DOP853", t, rtol=1e-12, atol=1e-13,
    ).y[0]  # fmt: skip
    assert abs(planar[-1] - planar[0]) > 4 * np.pi
    position = bars.a * np.stack([np.cos(planar), np.sin(planar), 0 * planar], axis=-1)
    rotation = np.stack([turned(bars.places(angle)[0]) for angle in planar])
    assert np.max(np.abs(result.dataset.position.values - position)) <= FLOWN
    assert np.max(np.abs(result.dataset.rotation.values - rotation)) <= FLOWN


# --- tilting tables ---

HINGES = {
    "two posts": [
        pf.Leg(np.eye(3), (0, y, 0), (), (pf.Tip(0, attachment=i),)) for i, y in enumerate((0.1, -0.1))
    ],
    "a post with two balls": [
        pf.Leg(np.eye(3), (0, 0, 0), (), [pf.Tip(0, (0, y, 0), i) for i, y in enumerate((0.1, -0.1))])
    ],
    "a crank": [
        pf.Leg(
            np.eye(3),
            (0, 0, 0),
            (pf.Joint(0, 0, alpha=np.pi / 2, M=0.1, I=np.eye(3) * 1e-9),),
            [pf.Tip(1, (0, 0, z), i) for i, z in enumerate((-0.1, 0.1))],
            (0.0,),
        )
    ],
}
CYLINDER = {"alpha": np.pi / 2, "M": 1.0, "MS": (0, -0.1, 0), "I": np.diag([0.02, 0.001, 0.02])}
ROD = {"alpha": np.pi / 2, "M": 0.5, "MS": (0, 0, -0.1), "I": np.diag([0.02, 0.02, 0.001])}
JACK = pf.Leg(
    np.eye(3),
    (0.5, 0, -0.6),
    (pf.Joint(0, 0, alpha=-np.pi / 2), pf.Joint(1, 0, **CYLINDER), pf.Joint(2, 1, 1, **ROD)),
    (pf.Tip(3, attachment=2),),
)
TABLE = pf.FlexibleBody.rigid(
    10.0, (0.25, 0, 0), np.diag([0.1, 0.3, 0.4]), [(0, 0.1, 0), (0, -0.1, 0), (0.5, 0, 0)]
)
SPIN = 0.3 + 10.0 * 0.25**2  # of the table about its hinge, kg m²


def tilted(table, angle, rate):
    """The table turned about the y axis, tip up for negative angles; the crank about −y."""
    R = Rotation.from_euler("y", angle).as_matrix()
    joints = [np.array([-angle]) if leg.pattern == "R" else None for leg in table.legs]
    return pf.State((0, 0, 0), R, (0, 0, 0, 0, rate, 0), joints=joints)


def tilting(angle, rate, force):
    """θ̈ of I θ̈ + ½ I′ θ̇² + V′ = 0, the primes by differences.

    The jack turns in the plane: its cylinder about its base with 0.02 kg m² and a first moment of 0.1 kg m,
    the rod about its tip with 0.02 kg m², 0.5 kg and 0.1 kg m, the wrong way along it.
    """

    def inertia_and_potential(theta):
        """I(θ), and V(θ) with that of the motor's force."""
        tip = np.array([0.5 * np.cos(theta) - 0.5, -0.5 * np.sin(theta) + 0.6])
        up, length = np.array([-0.5 * np.sin(theta), -0.5 * np.cos(theta)]), np.sqrt(tip @ tip)
        axis = tip / length
        slide, swing = axis @ up, (axis[0] * up[1] - axis[1] * up[0]) / length
        rod = 0.5 * slide**2 + (0.5 * length**2 - 2 * 0.1 * length + 0.02) * swing**2
        potential = 10 * G * -0.25 * np.sin(theta) + 0.1 * G * axis[1] + G * (0.5 * tip[1] - 0.1 * axis[1])
        return SPIN + 0.02 * swing**2 + rod, potential - force * length

    e = 1e-4
    (I_m, V_m), (inertia, _), (I_p, V_p) = (inertia_and_potential(angle + s) for s in (-e, 0, e))
    return -((V_p - V_m) + 0.5 * (I_p - I_m) * rate**2) / (2 * e) / inertia


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("hinge", HINGES)
def test_tilting_table(hinge, backend):
    """Level, half of the table and the rod rest on the jack; tilted and moving, as Lagrange says."""
    robot = pf.Robot((*HINGES[hinge], JACK), TABLE)
    model = pf.Model(robot, backend)
    assert np.allclose(model.equilibrium(*robot.home_pose)[1], 49.05 + 4.905, rtol=0, atol=CLOSED_FORM)
    for angle, rate, force in ((-0.3, 0.0, 0.0), (0.2, 1.5, 80.0)):
        found = model.direct(tilted(robot, angle, rate), [force]).platform
        wanted = tilting(angle, rate, force)
        assert abs(found[4] - wanted) <= 1e-6 * max(1, abs(wanted))  # of the differences
        assert np.max(np.abs(np.delete(found, 4))) <= CLOSED_FORM * abs(wanted)
    found = model.mobility(robot.home)
    assert found.freedoms == 1


# --- lifting columns ---

SLIDE = pf.Joint(0, 1, 1, M=0.1)


def column(x, y, attachments, offsets=((0, 0, 0),)):
    tips = [pf.Tip(1, offset, i) for offset, i in zip(offsets, attachments, strict=True)]
    return pf.Leg(np.eye(3), (x, y, 0), (SLIDE,), tips, (0.0,))


def slab(*points):
    return pf.FlexibleBody.rigid(10.0, (0, 0, 0), np.eye(3), points)


def one_column():
    """The slab sits firmly on one slide, by three balls."""
    corners = (0.1, 0, 0), (-0.1, 0.1, 0), (-0.1, -0.1, 0)
    return pf.Robot((column(0, 0, (0, 1, 2), corners),), slab(*corners))


def two_columns():
    """And rests on another one beside it."""
    one = one_column()
    points = [*one.platform.attachment_points, (0.8, 0, 0)]
    return pf.Robot((*one.legs, column(0.8, 0, (3,))), slab(*points))


def three_columns():
    """Three slides, on a ball each, at 0, 2.1 and 4.2 rad."""
    points = [(np.cos(angle), np.sin(angle), 0.0) for angle in (0, 2.1, 4.2)]
    return pf.Robot([column(*p[:2], (i,)) for i, p in enumerate(points)], slab(*points))


HELD = {  # the force of each motor at rest; where there is a choice the shortest
    one_column: [10.1 * G],
    two_columns: [10.2 * G / 2] * 2,
    three_columns: [33.57569513, 33.89160974, 33.57569513],  # moments about two axes, to the digits given
}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("robot", HELD, ids=lambda robot: robot.__name__)
def test_lifting_columns(robot, backend):
    """At rest they share the weight; 1 % more on each lifts all that moves."""
    model = pf.Model(robot(), backend)
    state, forces = model.equilibrium((0, 0, 0), np.eye(3))
    assert np.allclose(forces, HELD[robot], rtol=0, atol=5e-9)
    mass = 10 + 0.1 * len(forces)
    found = model.direct(state, 1.01 * forces)
    assert abs(found.platform[2] - 0.01 * G) <= CLOSED_FORM
    assert np.max(np.abs(np.delete(found.platform, 2))) <= CLOSED_FORM
    rows = (2, 3, 4) if robot is three_columns else (2,)
    up = model.inverse(state, np.eye(len(rows))[0], pf.FrameOutput(rows))
    assert abs(np.sum(up.forces) - mass * (G + 1)) <= 1e-6
    t = np.linspace(0, 0.5, 6)
    result = pf.simulate(model, 1.01 * forces, state, t, rtol=1e-10, atol=1e-12)
    assert np.max(np.abs(result.dataset.position.values[:, 2] - 0.005 * G * t**2)) <= 1e-9


def test_a_table_that_tips_off_its_columns_stops():
    """Three balls on vertical slides tilt by small angles alone; beyond, it is told where a gap opens."""
    model = pf.Model(three_columns())
    state, forces = model.equilibrium((0, 0, 0), np.eye(3))
    with pytest.warns(pf.PartialRun, match="the legs cannot follow"):
        result = pf.simulate(model, forces + [3.0, 0, 0], state, np.linspace(0, 0.5, 11))
    assert "the legs cannot follow: a gap of" in result.stopped
    assert np.max(np.abs(result.dataset.position.values[:, :2])) <= 1e-6
