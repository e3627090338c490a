"""Robots from the tables of a file: legs one by one, or a hexapod; their platform and its payload."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.base.kinds import LENGTH
from parflex.base.plausible import derived, usual
from parflex.files.described import built
from parflex.files.flexure_tables import at_home
from parflex.files.leg_tables import chain_parts, placed_leg
from parflex.files.platform_tables import platform
from parflex.files.reading import Reader
from parflex.files.robot_schema import HomeTable, RobotTable
from parflex.files.standing import joints_at_home, settled
from parflex.files.tables import rotation_of
from parflex.robot.leg import Leg
from parflex.robot.payload import Payload
from parflex.robot.robot import Robot
from parflex.robot.state import State
from parflex.robot.strut import Strut
from parflex.robots.hexapod import assembled, disc
from parflex.robots.hexapod_geometry import HexapodGeometry


def robot_of_legs(reader: Reader, table: RobotTable) -> Robot:
    """The robot of a file that has chains and legs."""
    assert table.home is not None
    home = reader.attempt(("home",), checked_pose, table.home)
    parts = {name: chain_parts(reader, name, given) for name, given in table.chain.items()}
    reader.stop()
    legs = [placed_leg(reader, number, row, parts) for number, row in enumerate(table.leg)]
    body = laden_platform(reader, table)
    reader.stop()
    robot = reader.must(("home",), settled, joined_robot(reader, legs, body, table.gravity, home))
    return with_springs_at_rest(reader, table, with_flexures(reader, table, robot))


def robot_of_hexapod(reader: Reader, table: RobotTable) -> Robot:
    """The robot of a file that has a hexapod."""
    where, given = ("hexapod",), table.hexapod
    assert given is not None
    geometry = built(reader, where, HexapodGeometry, given)
    strut = given.strut and built(reader, (*where, "strut"), Strut, given.strut)
    reader.stop()
    body = laden_platform(reader, table, geometry)
    reader.stop()
    return reader.must(where, assembled, geometry, strut, body, table.gravity)


def laden_platform(reader: Reader, table: RobotTable, geometry: HexapodGeometry | None = None) -> Any:
    """The platform with its payload, None where there are complaints; a hexapod has a disc by default."""
    if table.platform is None:
        assert geometry is not None
        body: Any = disc(geometry)
    else:
        joints = None if geometry is None else geometry.platform_joints
        body = reader.attempt(("platform",), platform, table.platform, reader.path.parent, joints)
    payload = table.payload and built(reader, ("payload",), Payload, table.payload)
    return reader.attempt(("payload",), payload.on, body) if payload and body else body


def with_springs_at_rest(reader: Reader, table: RobotTable, robot: Robot) -> Robot:
    """The robot whose springs of chains by kind are at rest at home, where the file says nothing else."""
    chains: list[Any] = [table.chain[name] for name in table.chains]
    loose = [getattr(chain, "stiffness", 0) and chain.rest is None for chain in chains]
    if not any(loose):
        return robot
    q = reader.must(("home",), joints_at_home, robot)
    with derived():
        legs = [at_rest(leg, at) if free else leg for leg, at, free in zip(robot.legs, q, loose, strict=True)]
        return replace(robot, legs=legs)


def with_flexures(reader: Reader, table: RobotTable, robot: Robot) -> Robot:
    """The robot whose flexures bend across, and twist about, the directions of their struts at home."""
    rows: list[Any] = [getattr(table.chain[name], "tips", ()) for name in table.chains]
    if not any(row.flexure for tips in rows for row in tips):
        return robot
    q, turn = reader.must(("home",), joints_at_home, robot), robot.home_pose[1]
    legs = []
    for name, leg, tips, at in zip(table.chains, robot.legs, rows, q, strict=True):
        held = list(leg.tips)
        for t, row in enumerate(tips):
            if row.flexure is not None:
                where = ("chain", name, "tips", t, "flexure")
                held[t] = reader.must(where, at_home, row.flexure, leg, held[t], at, turn)
        legs.append(replace(leg, tips=held))
    return replace(robot, legs=legs)


def at_rest(leg: Leg, q: Array) -> Leg:
    """The leg whose motor's spring is at rest at joint values (n,), without round-off, so that legs that are
    alike have the same."""
    pairs = zip(leg.joints, q, strict=True)
    return replace(leg, joints=[replace(j, q_0=float(f"{at:.13g}")) if j.mu else j for j, at in pairs])


def checked_pose(table: HomeTable) -> tuple[Array, Array]:
    """A checked pose (3,) m, (3, 3)."""
    usual("position", table.position, LENGTH)
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
