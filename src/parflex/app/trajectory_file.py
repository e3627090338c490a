"""Trajectory files as objects of the library."""

import os
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from parflex.app.trajectory_schema import PlanTable, trajectory_table
from parflex.files.reading import Reader
from parflex.files.tables import rotation_of
from parflex.model.model import Model
from parflex.robot.state import State
from parflex.simulation.laws import ALL_LAWS
from parflex.simulation.laws.choice import Choice, default_control
from parflex.simulation.laws.controller import Controller, Start
from parflex.simulation.trajectory import Trajectory


class Plan(NamedTuple):
    """A trajectory file that was read, ready for any robot."""

    reader: Reader
    table: PlanTable
    laws: tuple[type[Controller], ...]  # from which the file chooses its controller


def read_plan(path: str | os.PathLike[str], laws: tuple[type[Controller], ...] = ALL_LAWS) -> Plan:
    """The plan in a trajectory file, which names one of the laws.

    Raises InputError with up to five complaints, each with its line.
    """
    reader = Reader(path)
    table = reader.table(trajectory_table(laws))
    for number, move in enumerate(table.move):
        reader.attempt(("move", number), rotation_of, move.rotation)
    reader.stop()
    return Plan(reader, table, laws)


def start_of(plan: Plan, model: Model) -> Start:
    """The start that the plan asks for."""
    if plan.table.start == "home":
        return Start(model.robot.home, np.zeros(model.robot.n_forces))
    return Start(*model.equilibrium(*model.robot.home_pose))


def trajectory_of(plan: Plan, start: State) -> Trajectory:
    """The trajectory through the poses of the plan, each given from the start, in world axes."""
    moves, turn = plan.table.move, Rotation.from_matrix(np.asarray(start.rotation))
    positions = [start.position, *(start.position + np.array(move.position) for move in moves)]
    turns = [turn, *(Rotation.from_matrix(rotation_of(move.rotation)) * turn for move in moves)]
    rotations = np.stack([each.as_matrix() for each in turns])
    first, last = plan.table.rest
    return Trajectory(np.stack(positions), rotations, [move.duration for move in moves], (first, last))


def planned_control(plan: Plan, model: Model, start: Start, way: Trajectory) -> Choice:
    """The controller that the plan asks for, or the one that suits the robot where it asks for none.

    Raises InputError with its line where it does not fit.
    """
    table = plan.table.controller
    if table is None:
        found: Choice = plan.reader.must((), default_control, model, way)
        return found
    [law] = [law for law in plan.laws if law.kind == table.kind]
    return Choice(plan.reader.must(("controller",), law.planned, table, model, start, way))
