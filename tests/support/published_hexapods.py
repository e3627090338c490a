"""Hexapods that others have published, with the figures that go with them."""

from dataclasses import replace
from math import radians, sqrt

import numpy as np

import parflex as pf


def dehaeze():
    """Dehaeze's hexapod of identification.org (stewart-simscape): offsets of 15 mm, {M} 90 mm above the base,
    no gravity."""
    bar = pf.Bar(mass=0.1, outer=0.01, length=0.05)
    sketch = dict(base_radius=0.115, platform_radius=0.09, height=0.06, base_offset=0.015)
    sketch |= dict(platform_offset=-0.015, base_spread=radians(20), platform_spread=radians(20))
    points = pf.robots.hexapod(**sketch).platform.attachment_points
    across = 1.0 * (3 * 0.1**2 + 0.01**2) / 12
    disc = pf.FlexibleBody.rigid(1.0, (0, 0, -0.005), np.diag([across, across, 0.005]), points)
    strut = pf.Strut(bar, bar, stiffness=20e6, damping=20)
    return replace(pf.robots.hexapod(**sketch, strut=strut, platform=disc), gravity=(0, 0, 0))


def compliance_point(robot):
    """The offset from node 0 of the point 45 mm above {M}, about which compliances are published."""
    return tuple(np.array([0, 0, 0.045]) - robot.platform.nodes[0])


def cubic(mass, k, L, m, inertia, damping=0.0):
    """Preumont's cubic hexapod, struts along the edges of a cube of edge L, each of two bars of `mass` kg;
    and the offset from node 0 of the cube's centre, where the platform's centre of mass is."""
    sketch = dict.fromkeys(("base_radius", "platform_radius"), L * sqrt(2 / 3))
    sketch |= dict(height=L / sqrt(3), base_spread=0.0, platform_spread=0.0)
    centre = np.array([0, 0, -L / (2 * sqrt(3))])
    points = pf.robots.hexapod(**sketch).platform.attachment_points
    body = pf.FlexibleBody.rigid(m, centre, np.diag(inertia), points)
    bar = pf.Bar(mass=mass, outer=0.01, length=0.15)
    robot = pf.robots.hexapod(**sketch, strut=pf.Strut(bar, bar, stiffness=k, damping=damping), platform=body)
    return replace(robot, gravity=(0, 0, 0)), tuple(centre - body.nodes[0])


def hold(robot, offset=(0.0, 0.0, 0.0)):
    """The linear system at home: actuators and a wrench in, the point's pose and the struts' forces out."""
    model = pf.Model(robot, "numpy")
    state, forces = model.equilibrium(*robot.home_pose)
    inputs = (pf.Actuators(), pf.NodeWrench(0, offset))
    outputs = (pf.NodeMotion(0, offset), pf.StrutForce())
    return model.linearise(state, forces, inputs=inputs, outputs=outputs)
