"""Trajectory files as objects of the library."""

import os
from dataclasses import replace
from typing import Any, NamedTuple, cast

import numpy as np
from scipy.spatial.transform import Rotation

from parflex.app.trajectory_schema import MoveTable, PlanTable, trajectory_table
from parflex.base.check import single_rotation
from parflex.files.reading import Reader
from parflex.files.tables import Table, rotation_of
from parflex.model.model import Model
from parflex.robot.base_motion import BaseMotion
from parflex.robot.state import State
from parflex.simulation.laws import ALL_LAWS
from parflex.simulation.laws.choice import Choice, default_control
from parflex.simulation.laws.controller import Controller, Start
from parflex.simulation.moves import ALL_MOVES, Move, MoveTo, Pose
from parflex.simulation.surroundings.base_samples import BaseSamples
from parflex.simulation.trajectory import Trajectory

ORIGIN = Pose(np.zeros(3), np.eye(3))  # what is wrong with a move does not depend on where it begins


class Plan(NamedTuple):
    """A trajectory file that was read, ready for any robot."""

    reader: Reader
    table: PlanTable
    laws: tuple[type[Controller], ...]  # from which the file chooses its controller
    moves: tuple[type[Move], ...]  # the kinds of moves that it may name
    base: BaseSamples | None = None  # the motion of the base


def read_plan(
    path: str | os.PathLike[str],
    laws: tuple[type[Controller], ...] = ALL_LAWS,
    moves: tuple[type[Move], ...] = ALL_MOVES,
) -> Plan:
    """The plan in a trajectory file, which names one of the laws and kinds of moves.

    Raises InputError with up to five complaints, each with its line.
    """
    reader = Reader(path)
    plan = Plan(reader, reader.table(trajectory_table(laws, moves)), laws, moves)
    floor = plan.table.base
    if floor is not None:
        found = reader.attempt(("base", "file"), BaseSamples.from_file, reader.path.parent / floor.file)
        plan = plan._replace(base=found)
    for number, move in enumerate(plan.table.move):
        reader.attempt(("move", number, *move.words), move_of, plan, move, ORIGIN)
    reader.stop()
    return plan


def start_of(plan: Plan, model: Model) -> Start:
    """The start that the plan asks for, as it is seen from the base."""
    if plan.table.start == "home":
        return Start(model.robot.home, np.zeros(model.robot.n_forces))
    if plan.base is None:
        return Start(*model.equilibrium(*model.robot.home_pose))
    now = plan.base(0.0)
    at_rest = BaseMotion(now.position, now.rotation)
    there = at_rest.carried(model.robot.home)
    state, forces = model.equilibrium(there.position, there.rotation, base=at_rest)
    return Start(at_rest.seen(state), forces)


def trajectory_of(plan: Plan, start: State) -> Trajectory:
    """The trajectory of the plan, whose poses are given from the start, in world axes."""
    first, last = plan.table.rest
    pose = Pose(start.position, start.rotation)
    return Trajectory.of(start, [move_of(plan, move, pose) for move in plan.table.move], (first, last))


def move_of(plan: Plan, move: MoveTable, start: Pose) -> Move:
    """The move of a table, whose pose is given from the start."""
    for word in move.words:
        [kind] = [kind for kind in plan.moves if kind.word == word]
        value, made = getattr(move, word), cast(Any, kind)
        return cast(Move, made(**dict(value)) if isinstance(value, Table) else made(value))
    turn = single_rotation("rotation", rotation_of(move.rotation))
    turned = Rotation.from_matrix(turn) * Rotation.from_matrix(start.rotation)
    place = start.position + np.array(move.position)
    return MoveTo(place, turned.as_matrix(), duration=cast(float, move.duration))


def in_world(plan: Plan, choice: Choice, start: Start) -> Choice:
    """The choice of a control whose trajectory, where it is one in the world, begins where the base is."""
    controller = choice.controller
    if plan.base is None or controller.seen_from_base or controller.trajectory is None:
        return choice
    way = trajectory_of(plan, plan.base(0.0).carried(start.state))
    return choice._replace(controller=replace(cast(Any, controller), trajectory=way))


def planned_control(plan: Plan, model: Model, start: Start, way: Trajectory) -> Choice:
    """The control that the plan asks for, or that suits the robot where it asks for none."""
    if plan.table.controller is not None:
        return Choice(planned_controller(plan, model, start, way))
    found: Choice = plan.reader.must((), default_control, model, way)
    return found


def planned_controller(plan: Plan, model: Model, start: Start, way: Trajectory) -> Controller:
    """The controller that the plan asks for; raises InputError with its line where it does not fit."""
    table = plan.table.controller
    [law] = [law for law in plan.laws if law.kind == table.kind]
    controller: Controller = plan.reader.must(("controller",), law.planned, table, model, start, way)
    return controller
