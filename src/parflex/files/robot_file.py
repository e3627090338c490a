"""Robots from files: tables to legs and platform, complaints with their lines."""

import os
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.files.leg_tables import chain_parts, placed_leg
from parflex.files.platform_tables import platform
from parflex.files.reading import Reader
from parflex.files.robot_schema import HomeTable, RobotTable, robot_table
from parflex.files.standing import check_mobility, check_posture, joints_at_home
from parflex.files.tables import rotation_of
from parflex.robot.leg import Joint
from parflex.robot.robot import Robot
from parflex.robot.state import State


class RobotFile(NamedTuple):
    """A robot, the tables of its file, and the file."""

    robot: Robot
    table: RobotTable
    reader: Reader


def load_robot(path: str | os.PathLike[str], *, joint: type[Joint] = Joint) -> Robot:
    """The robot that a file describes (docs/robot-files.md).

    `joint` is the class of its joints, for those who gave `Joint` more fields.

    Raises InputError, before anything is computed, with up to five complaints about the file, each
    a sentence that begins with its name and the line.
    """
    file = read_robot(path, joint)
    if file.table.mobility is not None:
        check_standing(file)
    return file.robot


def read_robot(path: str | os.PathLike[str], joint: type[Joint] = Joint) -> RobotFile:
    """The robot of a file, as `load_robot`, with all that the file says."""
    reader = Reader(path)
    table = reader.table(robot_table(joint))
    home = reader.attempt(("home",), checked_pose, table.home)
    parts = {name: chain_parts(reader, name, given) for name, given in table.chain.items()}
    reader.stop()
    legs = [placed_leg(reader, number, row, parts) for number, row in enumerate(table.leg)]
    body = reader.attempt(("platform",), platform, table.platform, reader.path.parent)
    reader.stop()
    robot = joined_robot(reader, legs, body, table.gravity, home)
    reader.warn()
    return RobotFile(robot, table, reader)


def check_standing(file: RobotFile) -> None:
    """Raise InputError, with the line, where the robot does not stand at its home pose: a leg that
    does not reach or is on another branch than its posture, too many freedoms, too few actuators."""
    reader, table, robot = file.reader, file.table, file.robot
    joints = reader.must(("home",), joints_at_home, robot)
    for number, row in enumerate(table.leg):
        where = ("leg", number, "posture") if row.posture else ("chain", row.chain, "posture")
        reader.must(where, check_posture, robot.legs[number], number, joints[number])
    reader.must(() if table.mobility is None else ("mobility",), check_mobility, robot, table.mobility)


def checked_pose(table: HomeTable) -> tuple[Array, Array]:
    """A checked pose (3,) m, (3, 3)."""
    state = State(table.position, rotation_of(table.rotation))
    return np.asarray(state.position), np.asarray(state.rotation)


def joined_robot(
    reader: Reader, legs: Sequence[Any], body: Any, gravity: Sequence[float], home: Any
) -> Robot:
    """The robot; its legs join one by one, so that a complaint names the leg it is about."""
    for count in range(1, len(legs) + 1):
        where = ("leg", count - 1, "attachments")
        reader.must(where, Robot, tuple(legs[:count]), body, gravity, home)
    return Robot(tuple(legs), body, gravity, home)
