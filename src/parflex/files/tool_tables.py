"""The tool and the sensors of a robot file against its robot."""

import re

from parflex.base.errors import InputError
from parflex.base.kinds import LENGTH
from parflex.base.plausible import usual
from parflex.files.reading import Reader
from parflex.files.robot_schema import RobotTable
from parflex.files.tables import rotation_of
from parflex.files.tool_schema import LegSensor, Place
from parflex.robot.robot import Robot

NAME = re.compile(r"[A-Za-z_][\w-]*")  # as signals of a control system may be called


def check_tool_and_sensors(reader: Reader, table: RobotTable, robot: Robot) -> None:
    """Raise InputError, with their lines, where the tool or sensors name what the robot does not have."""
    if table.tool is not None:
        reader.attempt(("tool",), check_place, table.tool, robot)
        reader.attempt(("tool",), rotation_of, table.tool.rotation)
    for name, sensor in table.sensor.items():
        where = ("sensor", name)
        reader.attempt(where, check_name, name)
        if isinstance(sensor, LegSensor):
            reader.attempt(where, check_leg, sensor, robot)
            continue
        reader.attempt(where, check_place, sensor, robot)
        reader.attempt(where, check_sensor, sensor, table)
    reader.stop()


def check_name(name: str) -> None:
    """Raise InputError for a name that is no label of a signal."""
    if not NAME.fullmatch(name):
        raise InputError(f"the name is {name!r}; give letters, digits, _ and -, a letter first")


def check_place(place: Place, robot: Robot) -> None:
    """Raise InputError for a node that the platform does not have; doubt a point far away."""
    count = len(robot.platform.nodes)
    if place.node is not None and place.node >= count:
        raise InputError(f"node is {place.node}; the platform has nodes 0 … {count - 1}")
    if place.position is not None:
        usual("position", place.position, LENGTH)


def check_leg(sensor: LegSensor, robot: Robot) -> None:
    """Raise InputError for a leg that there is not."""
    if sensor.leg is not None and sensor.leg >= len(robot.legs):
        raise InputError(f"leg is {sensor.leg}; there are legs 0 … {len(robot.legs) - 1}")


def check_sensor(sensor: Place, table: RobotTable) -> None:
    """Raise InputError for a sensor without a place, or whose direction is none."""
    if sensor.position is None and sensor.node is None and table.tool is None:
        raise InputError("has no position, and the file no [tool]; give position or node, or the tool")
    direction = getattr(sensor, "direction", None)
    if direction is not None and not any(direction):
        raise InputError(f"direction is {direction}; give one")
