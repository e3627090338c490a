"""Robots from files, complaints with their lines."""

import os
from typing import NamedTuple

from parflex.base.errors import InputError
from parflex.files.reading import Reader
from parflex.files.robot_schema import RobotTable, robot_table
from parflex.files.robot_tables import robot_of_hexapod, robot_of_legs
from parflex.files.standing import check_mobility, check_posture, check_stroke, joints_at_home
from parflex.files.tool_tables import check_tool_and_sensors
from parflex.robot.leg import Joint
from parflex.robot.robot import Robot


class RobotFile(NamedTuple):
    """A robot, the tables of its file, and the file."""

    robot: Robot
    table: RobotTable
    reader: Reader


def load_robot(path: str | os.PathLike[str], *, joint: type[Joint] = Joint) -> Robot:
    """The robot that a file describes (docs/robot-files.md).

    `joint` is the class of its joints, for those who gave `Joint` more fields.

    Raises InputError, before anything is computed, with up to five complaints about the file, each
    a sentence that begins with its name and the line; warns of an `ImplausibleValue` in the same way.
    """
    file = read_robot(path, joint)
    strokes = any(getattr(table, "stroke", None) for table in file.table.chain.values())
    if file.table.mobility is not None or strokes:
        check_standing(file)
    return file.robot


def read_robot(path: str | os.PathLike[str], joint: type[Joint] = Joint) -> RobotFile:
    """The robot of a file, as `load_robot`, with all that the file says."""
    reader = Reader(path)
    table = reader.table(robot_table(joint))
    reader.must((), check_complete, table)
    robot = (robot_of_legs if table.hexapod is None else robot_of_hexapod)(reader, table)
    check_tool_and_sensors(reader, table, robot)
    reader.warn()
    return RobotFile(robot, table, reader)


def check_complete(table: RobotTable) -> None:
    """Raise InputError where tables are missing, or say what others say."""
    if table.hexapod is None:
        for name, given in (("home", table.home), ("platform", table.platform)):
            if given is None:
                raise InputError(f"{name} is missing; give the table [{name}], or describe a [hexapod]")
    for name in ("home", "chain", "leg"):
        if table.hexapod is not None and getattr(table, name):
            raise InputError(f"{name} is given beside [hexapod], which makes legs and home; keep one of them")


def check_standing(file: RobotFile) -> None:
    """Raise InputError, with the line, where the robot does not stand at its home pose: a leg that
    does not reach, is beyond its stroke or on another branch than its posture, too many freedoms, too few
    actuators."""
    reader, table, robot = file.reader, file.table, file.robot
    joints = reader.must(("home",), joints_at_home, robot)
    for number, row in enumerate(table.leg):
        chain = ("chain", row.chain)
        where = ("leg", number) if row.posture else chain
        reader.must((*where, "posture"), check_posture, robot.legs[number], number, joints[number])
        if getattr(table.chain[row.chain], "stroke", None):
            reader.must(chain, check_stroke, robot.legs[number], number, joints[number])
    reader.must(() if table.mobility is None else ("mobility",), check_mobility, robot, table.mobility)
