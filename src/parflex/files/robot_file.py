"""Robots from files: tables to legs and platform, complaints with their lines."""

import os
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from parflex.array import Array
from parflex.files.leg_tables import chain, leg
from parflex.files.mobility import check_mobility
from parflex.files.platform_tables import platform
from parflex.files.reading import Reader
from parflex.files.robot_schema import HomeTable, RobotTable
from parflex.files.tables import rotation_matrix
from parflex.robot import Robot
from parflex.state import State


class RobotFile(NamedTuple):
    """A robot, and what its file says beside."""

    name: str
    source: str
    robot: Robot
    chains: tuple[str, ...]  # the name of each leg's chain


def load_robot(path: str | os.PathLike[str]) -> Robot:
    """The robot that a file describes (docs/robot-files.md).

    Raises InputError, before anything is computed, with up to five complaints about the file, each
    a sentence that begins with its name and the line.
    """
    return read_robot(path).robot


def read_robot(path: str | os.PathLike[str]) -> RobotFile:
    """As `load_robot`, with the names that the file gives."""
    reader = Reader(path)
    table = reader.table(RobotTable)
    home = reader.attempt(("home",), place, table.home)
    parts = {name: chain(reader, name, given) for name, given in table.chain.items()}
    reader.stop()
    legs = [leg(reader, number, row, parts) for number, row in enumerate(table.leg)]
    body = reader.attempt(("platform",), platform, table.platform, reader.path.parent)
    reader.stop()
    robot = assembled(reader, legs, body, table.gravity, home)
    if table.mobility is not None:
        reader.must((), check_mobility, robot, table.mobility)
    return RobotFile(table.name, table.source, robot, tuple(row.chain for row in table.leg))


def place(table: HomeTable) -> tuple[Array, Array]:
    """A checked pose (3,) m, (3, 3)."""
    state = State(table.position, rotation_matrix(table.rotation))
    return np.asarray(state.position), np.asarray(state.rotation)


def assembled(reader: Reader, legs: Sequence[Any], body: Any, gravity: Sequence[float], home: Any) -> Robot:
    """The robot; its legs join one by one, so that a complaint names the leg it is about."""
    for count in range(1, len(legs) + 1):
        where = ("leg", count - 1, "attachments")
        reader.must(where, Robot, tuple(legs[:count]), body, gravity, home)
    return Robot(tuple(legs), body, gravity, home)
