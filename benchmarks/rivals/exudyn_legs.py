"""Exudyn with legs that bend: crosses as trees of one joint; cylinders, rods and plate as floating frames."""

from itertools import pairwise
from typing import NamedTuple

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
from exudyn.rigidBodyUtilities import AngularVelocity2EulerParameters_t, RotationMatrix2EulerParameters

import oracle
from benchmarks.flexible_legs import ARRAYS, Bending
from benchmarks.rivals.exudyn import Exudyn, frame_of, inertia_at_com, row_of
from benchmarks.rivals.exudyn_modal import Cloud, Modal, add_modal

SECTION = 0.01 * np.array([[1.0, 0.0, 0.0], [-0.5, 0.75**0.5, 0.0], [-0.5, -(0.75**0.5), 0.0]])  # m
ALONG_X = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])  # x of a slide of Exudyn is our z
COARSEST, LEVELS = 1e-2, 4  # steps of numerical differentiation, each half the one before


class Parts(NamedTuple):
    """The flexible bodies of a leg, and the loads of its actuator on cylinder and rod."""

    cylinder: Modal
    rod: Modal
    loads: tuple[int, int]


class ExudynLegs(Exudyn):
    """As `Exudyn`, with a slide and a hinge between floating frames in each leg instead of a tree."""

    sample: Bending
    trees: list[Parts]

    def add_leg(self, leg, held: list[int]) -> Parts:
        """The hinge of cross and cylinder, the slide on the section at the cylinder's seat, and the ball."""
        mbs, (_, second, third) = self.mbs, leg.joints
        cross = add_cross(mbs, leg)
        hinge = items.MarkerKinematicTreeRigid(
            objectNumber=cross, linkNumber=0, localHT=frame_of(leg, second)
        )
        cylinder, seat = add_link(mbs, 2)
        knuckle = items.MarkerNodeRigid(nodeNumber=cylinder.frame)
        ends = [mbs.AddMarker(hinge), mbs.AddMarker(knuckle)]
        mbs.AddObject(items.ObjectJointRevoluteZ(markerNumbers=ends))
        gland = items.MarkerSuperElementRigid(
            bodyNumber=cylinder.body,
            meshNodeNumbers=seat,
            weightingFactors=[1 / 3] * 3,
            localHT=turned(frame_of(leg, third)[:3, :3] @ ALONG_X),
        )
        rod, _ = add_link(mbs, 3)
        piston = items.MarkerNodeRigid(nodeNumber=rod.frame, localHT=turned(ALONG_X))
        ends = [mbs.AddMarker(gland), mbs.AddMarker(piston)]
        mbs.AddObject(items.ObjectJointPrismaticX(markerNumbers=ends))
        loads = [
            mbs.AddLoad(items.LoadForceVector(markerNumber=end, loadVector=[0, 0, 0], bodyFixed=True))
            for end in ends
        ]
        tip = items.MarkerSuperElementPosition(
            bodyNumber=rod.body, meshNodeNumbers=[seat_of(3)], weightingFactors=[1.0]
        )
        ends = [mbs.AddMarker(tip), held[leg.tips[0].attachment]]
        mbs.AddObject(items.ObjectJointSpherical(markerNumbers=ends))
        return Parts(cylinder, rod, tuple(loads))

    def place(self, s: int) -> None:
        """Initial values: coordinates of the plate, then leg by leg of its cross, cylinder and rod."""
        state, mbs = self.sample.platform[s], self.mbs
        R, (v, omega) = np.asarray(state.rotation), np.reshape(state.twist, (2, 3))
        plate = Motion(R, np.asarray(state.position), R @ v, R @ omega)
        found = [*coordinates(plate, state.elastic, state.elastic_rate)]
        for number, (leg, parts) in enumerate(zip(self.sample.legs, self.trees, strict=True)):
            q, qd = self.sample.q[number][s], self.sample.qd[number][s]
            ends = np.cumsum(leg.modes)[:-1]
            e, ed = (np.split(each[number], ends) for each in (state.leg_elastic, state.leg_elastic_rate))
            _, cylinder, rod = motions(leg, q, qd, ed)
            found += [(q[:1], qd[:1]), *coordinates(cylinder, e[1], ed[1]), *coordinates(rod, e[2], ed[2])]
            for load, sign in zip(parts.loads, (-1, 1), strict=True):
                force = sign * self.sample.forces[s][number]
                mbs.SetLoadParameter(load, "loadVector", [force, 0.0, 0.0])
        values, rates = (np.concatenate(side) for side in zip(*found, strict=True))
        reference = np.array(mbs.systemData.GetODE2Coordinates(exu.ConfigurationType.Reference))
        mbs.systemData.SetODE2Coordinates(values - reference, exu.ConfigurationType.Initial)
        mbs.systemData.SetODE2Coordinates_t(rates, exu.ConfigurationType.Initial)

    def modal_accelerations(self) -> np.ndarray:
        """Of the plate, and of cylinders and rods leg by leg."""
        modes = [self.plate + 1]
        for parts in self.trees:
            modes += [parts.cylinder.modes, parts.rod.modes]
        kind = exu.OutputVariableType.Coordinates_tt
        return np.concatenate([self.mbs.GetNodeOutput(node, kind) for node in modes])

    def limit(self, s: int) -> np.ndarray:
        """The answer at state s where the step of the numerical differentiation tends to zero, extrapolated
        from halved steps."""
        steps = self.settings.timeIntegration.newton.numericalDifferentiation
        usual, found = steps.relativeEpsilon, []
        for level in range(LEVELS):
            steps.relativeEpsilon = COARSEST / 2**level
            [task] = self.direct(s).values()
            task.call()
            found.append(task.answer())
        steps.relativeEpsilon = usual
        for order in range(1, LEVELS):
            found = [fine + (fine - coarse) / (2**order - 1) for coarse, fine in pairwise(found)]
        return found[0]


def add_cross(mbs, leg) -> int:
    """The first link, on its own joint coordinate."""
    joint = leg.joints[0]
    node = items.NodeGenericODE2(
        numberOfODE2Coordinates=1,
        referenceCoordinates=[0.0],
        initialCoordinates=[0.0],
        initialCoordinates_t=[0.0],
    )
    return mbs.AddObject(
        items.ObjectKinematicTree(
            nodeNumber=mbs.AddNode(node),
            jointTypes=[exu.JointType.RevoluteZ],
            linkParents=[-1],
            jointHTs=[frame_of(leg, joint)],
            linkInertiasCOM=exu.Matrix3DList([inertia_at_com(joint.M, joint.MS, joint.I)]),
            linkCOMs=exu.Vector3DList([np.asarray(joint.MS) / joint.M]),
            linkMasses=[joint.M],
        )
    )


def add_link(mbs, j: int) -> tuple[Modal, list[int]]:
    """Link j, from 1, of its nodes, and three nodes without mass about its seat, which its section moves."""
    names = "node_positions", "node_masses", "shapes", "rotation_shapes", "frequencies", "damping_ratio"
    r, m, shapes, turns, omega, zeta = (ARRAYS[f"link{j}_{name}"] for name in names)
    seat, count = seat_of(j), len(r)
    about = shapes[:, seat, None] + np.cross(turns[:, seat, None], SECTION)  # (N, 3, 3)
    link = Cloud(
        positions=np.concatenate([r, r[seat] + SECTION]),
        masses=np.concatenate([m, np.zeros(3)]),
        shapes=np.moveaxis(np.concatenate([shapes, about], axis=1), 0, -1),
        stiffness=omega**2,
        damping=2 * zeta * omega,
    )
    return add_modal(mbs, link, (0.0, 0.0, 0.0)), list(range(count, count + 3))


def seat_of(j: int) -> int:
    """The node of link j that holds what follows."""
    return int(ARRAYS[f"link{j}_interface_nodes"][0])


def turned(axes: np.ndarray) -> np.ndarray:
    """A frame with these axes (4, 4)."""
    frame = np.eye(4)
    frame[:3, :3] = axes
    return frame


class Motion(NamedTuple):
    """Axes, origin, velocity and angular velocity of a frame, in the world."""

    axes: np.ndarray
    origin: np.ndarray
    velocity: np.ndarray
    omega: np.ndarray


def coordinates(motion: Motion, e: np.ndarray, ed: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Values and rates of a floating frame, then of its modes."""
    turn = RotationMatrix2EulerParameters(motion.axes)
    turning = AngularVelocity2EulerParameters_t(motion.omega, turn)
    frame = np.concatenate([motion.origin, turn]), np.concatenate([motion.velocity, turning])
    return [frame, (e, ed)]


def motions(leg, q: np.ndarray, qd: np.ndarray, ed: list[np.ndarray]) -> list[Motion]:
    """Of the links of a leg, one on the other, whose elastic rates are ė, one array per link; straight where
    another link sits on them."""
    at, found = Motion(leg.rotation, leg.origin, np.zeros(3), np.zeros(3)), []
    for j, joint in enumerate(leg.joints):
        seat, moved, spun = seat_motion(leg, j, ed)
        axes, arm = at.axes, row_of(joint) @ oracle.screw(2, *((0.0, q[j]) if joint.sigma else (q[j], 0.0)))
        omega = at.omega + axes @ spun
        velocity = at.velocity + np.cross(at.omega, axes @ seat) + axes @ moved
        velocity = velocity + np.cross(omega, axes @ (arm[:3, 3] - seat))
        own = np.zeros((2, 3))
        own[0 if joint.sigma else 1] = qd[j] * (axes @ arm[:3, 2])
        at = Motion(axes @ arm[:3, :3], at.origin + axes @ arm[:3, 3], velocity + own[0], omega + own[1])
        found.append(at)
    return found


def seat_motion(leg, j: int, ed: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Place, velocity and angular velocity, in the frame of the link before joint j, from 0, of its seat."""
    body, seat = leg.joints[j - 1].body if j else None, leg.seats.joints[j]
    if body is None:
        return np.zeros(3), np.zeros(3), np.zeros(3)
    place, shapes, turns = body.attachment_points, body.attachment_shapes, body.attachment_turns
    return place[seat], shapes[seat] @ ed[j - 1], turns[seat] @ ed[j - 1]
