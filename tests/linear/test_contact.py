"""Contact forces and strains as outputs, against differences of the direct model."""

from dataclasses import replace

import numpy as np
import pytest

import flexlegs
import parflex as pf
from compliant import compliant
from parflex.mechanics.closure import accelerated, displaced
from parflex.model.core import core_of
from soft import softened

ROBOTS = {
    "plate": lambda: pf.robots.gough_stewart(modes=4),
    "bent legs": lambda: replace(flexlegs.mixed("gs_flexlegs"), gravity=(0.0, 0.0, -9.81)),
    "Delta": lambda: pf.robots.delta(modes=3),
    "soft tips": lambda: softened(flexlegs.mixed("gs_flexlegs"), ((1, 0), (5, 0))),
    "drives": lambda: compliant(pf.robots.gough_stewart(3), Fs=0.0),
}
NODE = 0


@pytest.mark.filterwarnings("ignore::parflex.base.errors.BeyondBasis")
@pytest.mark.parametrize("name", ROBOTS)
def test_contact_forces_are_those_of_the_direct_model(name):
    """By every motion and its rate, by motors, by a wrench that stays in the world, by the base."""
    robot = ROBOTS[name]()
    model = pf.Model(robot, "numpy")
    push = pf.Wrench(NODE, force=(30.0, -20.0, 50.0), moment=(1.0, 2.0, -1.0), frame="world")
    state, forces = model.equilibrium(*robot.home_pose, wrenches=[push])
    given = {"inputs": (pf.Actuators(), pf.NodeWrench(NODE), pf.BaseAcceleration())}
    given |= {"outputs": (pf.ContactForces(),), "wrenches": [push], "friction": "smoothed"}
    lin = model.linearise(state, forces, **given)
    core, T = core_of(model), lin.point.T
    attachments = sorted({tip.attachment for leg in robot.legs for tip in leg.tips})

    def contact(x=lin.point.x, u=forces, more=(), base=None):
        found = model.direct(core.state(x), u, [push, *more], base=base)
        return found.contact_forces[attachments].reshape(-1)

    def slope(at, step):
        return (at(step) - at(-step)) / (2 * step)

    d, h = T.shape[1], 1e-6 * core.mechanism.size
    for k, column in enumerate(T.T):
        moved = slope(lambda s, c=column: contact(displaced(core.mechanism, lin.point.x, s * c)), h)
        hurried = slope(lambda s, c=column: contact(accelerated(core.mechanism, lin.point.x, s * c)), h)
        for found, expected in ((lin.C[:, k], moved), (lin.C[:, d + k], hurried)):
            assert np.max(np.abs(found - expected)) <= 1e-6 * max(np.max(np.abs(expected)), 1.0)
    m = len(forces)
    for i in range(m):
        expected = slope(lambda s, i=i: contact(u=forces + s * np.eye(m)[i]), 1.0)
        assert np.allclose(lin.D[:, i], expected, atol=1e-8)
    for i, axis in enumerate(np.eye(6)):
        more = lambda s, a=axis: [pf.Wrench(NODE, force=s * a[:3], moment=s * a[3:], frame="world")]  # noqa: E731
        expected = slope(lambda s, more=more: contact(more=more(s)), 1.0)
        assert np.allclose(lin.D[:, m + i], expected, atol=1e-8)
        shaken = slope(lambda s, a=axis: contact(base=pf.BaseMotion(acceleration=s * a)), 1.0)
        assert np.allclose(lin.D[:, m + 6 + i], shaken, atol=1e-8 * max(np.max(np.abs(shaken)), 1.0))


def test_forces_of_the_legs_carry_what_is_put_on():
    """A wrench that grows slowly: the contact forces hold it, and turn with the platform (balance)."""
    sizes = {"base_radius": 0.5, "platform_radius": 0.3, "height": 0.6}
    sizes |= {"base_spread": 0.35, "platform_spread": 0.35}
    robot = replace(pf.robots.hexapod(**sizes, strut=STRUT), gravity=(0.0, 0.0, 0.0))
    model = pf.Model(robot, "numpy")
    state, forces = model.equilibrium(*robot.home_pose)
    lin = model.linearise(state, forces, inputs=(pf.NodeWrench(0),), outputs=(pf.ContactForces(),))
    found = lin.frf([0.0]).values[..., 0].real.reshape(6, 3, 6)
    assert np.allclose(found.sum(axis=0), -np.eye(6)[:3], atol=1e-8)
    arms = robot.platform.attachment_points - robot.platform.nodes[0]
    assert np.allclose(
        np.cross(arms[:, None], found.transpose(0, 2, 1)).sum(axis=0), -np.eye(6)[:, 3:], atol=1e-8
    )


BAR = pf.Bar(mass=0.5, length=0.35, outer=0.03)
STRUT = pf.Strut(BAR, BAR, stiffness=1e6, damping=100.0)


def test_strain_is_linear_in_the_bend():
    robot = pf.robots.gough_stewart(modes=3)
    model = pf.Model(robot, "numpy")
    shapes = np.arange(6.0).reshape(2, 3)
    lin = model.linearise(*model.equilibrium(*robot.home_pose), outputs=(pf.Strain(shapes, "MPa"),))
    assert lin.outputs == ("strain[0]", "strain[1]")
    assert lin.output_units == ("MPa", "MPa")
    assert np.allclose(lin.C[:, : len(lin.point.K)], shapes @ lin.point.T[6:9])
    with pytest.raises(pf.InputError, match="Strain.shapes has rows of 2; the platform has 3 modes"):
        model.linearise(*model.equilibrium(*robot.home_pose), outputs=(pf.Strain(np.ones((1, 2))),))


def test_contact_forces_that_are_not_unique():
    robot = pf.robots.prs3(modes=0)
    body, leg = robot.platform, robot.legs[0]
    platform = replace(body, attachments=(*body.attachments, body.attachments[0]))
    again = replace(leg, tips=[replace(leg.tips[0], attachment=3)])
    doubled = replace(robot, platform=platform, legs=(*robot.legs, again))
    model = pf.Model(doubled, "numpy")
    state, forces = model.equilibrium(*doubled.home_pose)
    with pytest.raises(pf.InputError, match="ContactForces are not unique"):
        model.linearise(state, forces, outputs=(pf.ContactForces(),))
