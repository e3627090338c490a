"""Exudyn (BSD 3-Clause): legs as kinematic trees, a rigid or modal plate, tied by ideal spherical joints."""

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
from exudyn.rigidBodyUtilities import AngularVelocity2EulerParameters_t, RotationMatrix2EulerParameters
from scipy.spatial.transform import Rotation

from benchmarks.rivals.base import Rival, Task, actuated
from benchmarks.rivals.exudyn_modal import Cloud, add_modal
from oracle import screw
from sample import Sample

exu.config.printToConsole = False


class Exudyn(Rival):
    """In Exudyn's leanest coordinates: a minimal tree per leg, seven coordinates and the modes of the plate.

    The inertia IA of rotors is a mass matrix of its own on the joints' node. The sparse solver is as fast as
    the dense ones at rest; in motion it has the closure differentiated constraint by constraint.
    """

    name = "Exudyn"
    tolerance = 1e-7  # in motion
    remark = (
        "has no call for the direct model and no inverse model: these are the accelerations with which its "
        "implicit solver starts a run; in motion it differentiates the closure numerically, which costs time "
        "and digits, at rest it does not"
    )

    def __init__(self, sample: Sample) -> None:
        super().__init__(sample)
        self.container = exu.SystemContainer()
        self.mbs = self.container.AddSystem()
        self.plate, held = self.add_plate()
        self.trees = [self.add_leg(leg, held) for leg in sample.legs]
        self.sensors = self.add_sensors()
        self.mbs.Assemble()
        self.settings = exu.SimulationSettings()
        quiet(self.settings)
        self.settings.timeIntegration.generalizedAlpha.computeInitialAccelerations = True
        self.settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
        self.settings.linearSolver.reuseAnalyzedPattern = True

    def add_plate(self) -> tuple[int, list[int]]:
        """Its node, and a marker per attachment."""
        body = self.sample.body
        build = add_modal_plate if body.modes else add_rigid_plate
        return build(self.mbs, self.sample)

    def add_leg(self, leg, held: list[int]) -> int:
        """The leg's tree, on a node of its joint coordinates, tied to the plate."""
        mbs, n = self.mbs, len(leg.joints)
        zero = [0.0] * n
        node = mbs.AddNode(
            items.NodeGenericODE2(
                numberOfODE2Coordinates=n,
                referenceCoordinates=zero,
                initialCoordinates=zero,
                initialCoordinates_t=zero,
            )
        )
        kinds = [exu.JointType.PrismaticZ if j.sigma else exu.JointType.RevoluteZ for j in leg.joints]
        tree = mbs.AddObject(
            items.ObjectKinematicTree(
                nodeNumber=node,
                gravity=self.sample.gravity,
                jointTypes=kinds,
                linkParents=[joint.antecedent - 1 for joint in leg.joints],
                jointHTs=[frame_of(leg, joint) for joint in leg.joints],
                linkInertiasCOM=exu.Matrix3DList([inertia_at_com(j.M, j.MS, j.I) for j in leg.joints]),
                linkCOMs=exu.Vector3DList([np.asarray(j.MS) / j.M for j in leg.joints]),
                linkMasses=[joint.M for joint in leg.joints],
                jointForceVector=zero,
            )
        )
        rotors = np.diag([joint.IA for joint in leg.joints])
        mbs.AddObject(items.ObjectGenericODE2(nodeNumbers=[node], massMatrix=rotors))
        for tip in leg.tips:
            end = items.MarkerKinematicTreeRigid(
                objectNumber=tree, linkNumber=tip.frame - 1, localPosition=tip.offset
            )
            ends = [mbs.AddMarker(end), held[tip.attachment]]
            mbs.AddObject(items.ObjectJointSpherical(markerNumbers=ends))
        return tree

    def add_sensors(self) -> list[int]:
        """Of position, attitude and modes."""
        kinds = [exu.OutputVariableType.Position, exu.OutputVariableType.RotationMatrix]
        nodes = [self.plate] * 2
        if self.sample.body.modes:
            kinds, nodes = [*kinds, exu.OutputVariableType.Coordinates], [*nodes, self.plate + 1]
        return [
            self.mbs.AddSensor(items.SensorNode(nodeNumber=node, outputVariableType=kind, storeInternal=True))
            for node, kind in zip(nodes, kinds, strict=True)
        ]

    def place(self, s: int) -> None:
        """Initial values: the state and forces of the sample."""
        state, mbs = self.sample.platform[s], self.mbs
        R, twist = np.asarray(state.rotation), np.asarray(state.twist)
        turn = RotationMatrix2EulerParameters(R)
        turning = AngularVelocity2EulerParameters_t(R @ twist[3:], turn)
        q = np.concatenate([state.position, turn, state.elastic, *(leg[s] for leg in self.sample.q)])
        qd = np.concatenate([R @ twist[:3], turning, state.elastic_rate, *(leg[s] for leg in self.sample.qd)])
        reference = np.array(mbs.systemData.GetODE2Coordinates(exu.ConfigurationType.Reference))
        mbs.systemData.SetODE2Coordinates(q - reference, exu.ConfigurationType.Initial)
        mbs.systemData.SetODE2Coordinates_t(qd, exu.ConfigurationType.Initial)
        forces = np.zeros(len(actuated(self.sample)))
        forces[actuated(self.sample)] = self.sample.forces[s]
        ends = np.cumsum([len(leg.joints) for leg in self.sample.legs])[:-1]
        for tree, part in zip(self.trees, np.split(forces, ends), strict=True):
            mbs.SetObjectParameter(tree, "jointForceVector", part)

    def direct(self, s: int) -> dict[str, Task]:
        self.place(s)
        solver, mbs, R = exu.MainSolverImplicitSecondOrder(), self.mbs, self.sample.platform[s].rotation
        solver.InitializeSolver(mbs, self.settings)

        def call() -> None:
            solver.InitializeSolverInitialConditions(mbs, self.settings)

        def answer() -> np.ndarray:
            linear = mbs.GetNodeOutput(self.plate, exu.OutputVariableType.Acceleration)
            angular = R.T @ mbs.GetNodeOutput(self.plate, exu.OutputVariableType.AngularAcceleration)
            return np.concatenate([R.T @ linear, angular, self.modal_accelerations()])

        return {"initial accelerations": Task(call, answer)}

    def modal_accelerations(self) -> np.ndarray:
        """Of the plate."""
        qdd = np.array(self.mbs.systemData.GetODE2Coordinates_tt())
        return qdd[7 : 7 + self.sample.body.modes]

    def simulate(self, times: np.ndarray, steps: int, rho: float | None) -> np.ndarray:
        """The run from state 0 (T, 6 + N): position, attitude as a rotation vector, bend.

        Generalised α of spectral radius ρ; for None the trapezoidal rule with closures on velocities.
        """
        self.place(0)
        settings = exu.SimulationSettings()
        quiet(settings)
        run = settings.timeIntegration
        run.endTime, run.numberOfSteps = times[-1], steps
        run.newton.useModifiedNewton = True
        if rho is None:
            run.generalizedAlpha.useNewmark = run.generalizedAlpha.useIndex2Constraints = True
        else:
            run.generalizedAlpha.spectralRadius = rho
        settings.solutionSettings.sensorsWritePeriod = times[1] - times[0]
        if not self.mbs.SolveDynamic(settings):
            raise RuntimeError("Exudyn's solver did not reach the end")
        read = [np.asarray(self.mbs.GetSensorStoredData(sensor))[:, 1:] for sensor in self.sensors]
        turns = Rotation.from_matrix(read[1].reshape(-1, 3, 3)).as_rotvec()
        return np.hstack([read[0], turns, *read[2:]])


def quiet(settings: "exu.SimulationSettings") -> None:
    """No files, no words."""
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWriteFileHeader = False
    settings.timeIntegration.verboseMode = 0


def frame_of(leg, joint) -> np.ndarray:
    """The joint's frame at q = 0 in its antecedent's, or in the world (4, 4)."""
    if joint.antecedent:
        return row_of(joint)
    base = np.eye(4)
    base[:3, :3], base[:3, 3] = leg.rotation, leg.origin
    return base @ row_of(joint)


def row_of(joint) -> np.ndarray:
    """The joint's frame at q = 0 in its antecedent's, the base's included (4, 4)."""
    return screw(2, joint.gamma, joint.b) @ screw(0, joint.alpha, joint.d) @ screw(2, joint.theta, joint.r)


def inertia_at_com(M: float, MS, inertia) -> np.ndarray:
    """(3, 3), from the tensor about the frame's origin."""
    com = np.asarray(MS) / M
    return np.asarray(inertia) - M * (com @ com * np.eye(3) - np.outer(com, com))


def add_rigid_plate(mbs, sample: Sample) -> tuple[int, list[int]]:
    """One rigid body with Euler parameters."""
    moments = sample.body.moments
    J = np.trace(moments.P0) * np.eye(3) - moments.P0
    node = mbs.AddNode(
        items.NodeRigidBodyEP(referenceCoordinates=[0, 0, 0, 1, 0, 0, 0], initialVelocities=[0] * 7)
    )
    body = mbs.AddObject(
        items.ObjectRigidBody(
            nodeNumber=node,
            mass=moments.m,
            centerOfMass=moments.MS0 / moments.m,
            inertia=[J[0, 0], J[1, 1], J[2, 2], J[1, 2], J[0, 2], J[0, 1]],
        )
    )
    weight = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=body))
    mbs.AddLoad(items.LoadMassProportional(markerNumber=weight, loadVector=sample.gravity))
    points = sample.body.attachment_points
    return node, [mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=body, localPosition=p)) for p in points]


def add_modal_plate(mbs, sample: Sample) -> tuple[int, list[int]]:
    """A floating frame with modes, from the oracle's cloud of point masses, whose integrals are the plate's.

    The attachments are nodes without mass in front of the cloud.
    """
    cloud, held = sample.cloud, len(sample.cloud.attachments)
    plate = Cloud(
        positions=np.concatenate([cloud.attachments, cloud.positions]),
        masses=np.concatenate([np.zeros(held), cloud.masses]),
        shapes=np.concatenate([cloud.attachment_shapes, np.moveaxis(cloud.shapes, 0, -1)]),
        stiffness=cloud.stiffness,
        damping=cloud.damping,
    )
    made = add_modal(mbs, plate, sample.gravity)
    one = [
        items.MarkerSuperElementPosition(bodyNumber=made.body, meshNodeNumbers=[i], weightingFactors=[1.0])
        for i in range(held)
    ]
    return made.frame, [mbs.AddMarker(marker) for marker in one]
