"""Lagrange's equations of a robot on a base at rest, on every mass of which the forces act that an observer
sees who turns with his floor: −m Ω × (Ω × r) of the centrifuge and −2 m Ω × v of Coriolis.

They are written by hand on the nodes of the platform and of flexible links, as the data list them, and on six
points in the place of each rigid link. Neither moments of bodies nor a base that moves are read.
"""

import casadi as ca
import numpy as np

import flexlegs
from lagrange import Lagrange, hat


class Spun(Lagrange):
    """The oracle of a robot of `flexlegs`, seen from a base that turns steadily with Ω (3,) rad/s about an
    axis through a point (3,) m, both in its axes."""

    def __init__(self, robot, name, omega, about):
        self.name, self.omega, self.about = name, ca.SX(omega), ca.SX(about)
        super().__init__(robot)

    def with_platform(self):
        frame, body = super().with_platform(), self.robot.platform
        self.with_nodes(body, frame, self.x[6 : 6 + self.N])
        return frame

    def with_body(self, moments, frame, e, ed):
        super().with_body(moments, frame, e, ed)
        for leg in self.robot.legs:
            for joint in leg.joints:
                if joint.body is not None and joint.body.moments is moments:
                    return self.with_nodes(joint.body, frame, e)
        return None

    def with_rigid(self, joint, frame):
        super().with_rigid(joint, frame)
        if joint.M:
            points, masses = stand_ins(joint)
            self.with_masses(points.T, masses, frame)

    def with_nodes(self, body, frame, e):
        """Push at the nodes of a flexible body that is bent by e."""
        bent = ca.SX(body.nodes.T)
        for k in range(body.modes):
            bent += e[k] * body.shapes[k].T
        self.with_masses(bent, self.masses_of(body), frame)

    def masses_of(self, body):
        """The masses of a body's nodes, found in the data by their places."""
        arrays = flexlegs.arrays(self.name)
        for key, places in arrays.items():
            if key.endswith("_node_positions") and np.array_equal(places, body.nodes):
                return arrays[key.replace("positions", "masses")]
        raise KeyError(body)

    def with_masses(self, points, masses, frame):
        """Push on masses (K,) at points (3, K) of a frame."""
        places = ca.repmat(frame.place, 1, len(masses)) + frame.axes @ points
        turn, away = hat(self.omega), places - ca.repmat(self.about, 1, len(masses))
        felt = -(turn @ turn @ away + 2 * turn @ self.rate(places)) @ ca.diag(ca.SX(masses))
        self.push += ca.jtimes(ca.vec(places), self.x, ca.vec(felt), True)


def stand_ins(link):
    """Six points (6, 3) in the frame of a rigid link, and their masses (6,), of its mass, MS and I."""
    com = np.asarray(link.MS) / link.M
    second = 0.5 * np.trace(link.I) * np.eye(3) - link.I - link.M * np.outer(com, com)
    squares, axes = np.linalg.eigh(second)
    assert np.min(squares) >= -1e-12 * link.M
    arms = np.sqrt(3 * np.maximum(squares, 0) / link.M) * axes
    return com + np.concatenate([arms.T, -arms.T]), np.full(6, link.M / 6)
