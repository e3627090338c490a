"""The robot that was simulated, as the text of a robot file."""

import numpy as np

from parflex.base.array import Array
from parflex.files.platform_tables import rigid_table
from parflex.files.robot_writing import modal_table, robot_text
from parflex.simulation.variables.recorded import Recorded
from parflex.simulation.variables.variable import Variable


def robot_file(run: Recorded) -> Array:
    """The text; a bending platform's file is said to be beside it."""
    robot = run.robot
    return np.array(robot_text(robot, rigid_table(robot.platform) or modal_table("robot.platform.nc")))


ROBOT_FILE = Variable("robot_file", (), "1", "the robot as a robot file (TOML)", robot_file, text=True)
