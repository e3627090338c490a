"""Trajectory files: what a robot is to do, as objects of the library."""

import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from parflex.app.trajectory_schema import SpringTable, TorqueTable, TrajectoryTable
from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.files.reading import Reader
from parflex.files.tables import rotation_matrix
from parflex.mechanics.output import FrameOutput
from parflex.robot.state import State
from parflex.simulation.control import ComputedTorque, Controller, JointPD
from parflex.simulation.trajectory import Trajectory

if TYPE_CHECKING:
    from parflex.model.model import Model


class Plan(NamedTuple):
    """A trajectory file that was read, ready for any robot."""

    reader: Reader
    table: TrajectoryTable


class Start(NamedTuple):
    """Where a run starts, and the forces that hold the robot there."""

    state: State
    forces: Array  # (m,); zero where the start is not an equilibrium


def read_plan(path: str | os.PathLike[str]) -> Plan:
    """The plan in a trajectory file.

    Raises InputError with up to five complaints, each with its line.
    """
    reader = Reader(path)
    table = reader.table(TrajectoryTable)
    for number, move in enumerate(table.move):
        reader.attempt(("move", number), rotation_matrix, move.rotation)
    reader.stop()
    return Plan(reader, table)


def start_of(plan: Plan, model: "Model") -> Start:
    """The start that the plan asks for."""
    if plan.table.start == "home":
        return Start(model.robot.home, np.zeros(model.robot.n_forces))
    return Start(*model.equilibrium(*model.robot.home_pose))


def trajectory_of(plan: Plan, start: State) -> Trajectory:
    """Through the poses of the plan, each given from the start, in world axes."""
    moves, turn = plan.table.move, Rotation.from_matrix(np.asarray(start.rotation))
    positions = [start.position, *(start.position + np.array(move.position) for move in moves)]
    turns = [turn, *(Rotation.from_matrix(rotation_matrix(move.rotation)) * turn for move in moves)]
    rotations = np.stack([each.as_matrix() for each in turns])
    first, last = plan.table.rest
    return Trajectory(np.stack(positions), rotations, [move.duration for move in moves], (first, last))


def controller_of(plan: Plan, model: "Model", start: Start, way: Trajectory) -> Controller:
    """The controller that the plan asks for; raises InputError with its line where it does not fit."""
    table = plan.table.controller
    make = ALL_CONTROLLERS[table.kind]
    return plan.reader.must(("controller",), make, table, model, start, way)


def computed_torque(table: TorqueTable, model: "Model", start: Start, way: Trajectory) -> ComputedTorque:
    """Along the trajectory, in the rows that are named."""
    chosen: dict[str, Any] = {} if table.rows is None else {"output": FrameOutput(tuple(table.rows))}
    return ComputedTorque(model, way, kp=table.kp, kd=table.kd, **chosen)


def joint_pd(table: SpringTable, model: "Model", start: Start, way: Trajectory) -> JointPD:
    """At the start; raises InputError for a trajectory that leaves it."""
    if np.ptp(way.positions, axis=0).any() or np.ptp(way.rotations, axis=0).any():
        raise InputError(
            'kind is "joint-pd", which holds the start, but a move leaves it; give moves without position '
            'and rotation, or kind = "computed-torque"'
        )
    return JointPD(model, start.state, table.kp, table.kd, start.forces)


ALL_CONTROLLERS: dict[str, Callable[..., Controller]] = {
    "computed-torque": computed_torque,
    "joint-pd": joint_pd,
}
