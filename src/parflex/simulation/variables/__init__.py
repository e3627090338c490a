"""All variables of a result. A new one is an entry in one of these files, or a file and a line here."""

import numpy as np

from parflex.robot.joint_words import actuator_names
from parflex.simulation.variables.base import BASE_VARIABLES
from parflex.simulation.variables.energy import LEDGER, RESIDUAL
from parflex.simulation.variables.legs import LEG_VARIABLES
from parflex.simulation.variables.motion import MOTION_VARIABLES
from parflex.simulation.variables.platform import PLATFORM_VARIABLES
from parflex.simulation.variables.robot_text import ROBOT_FILE
from parflex.simulation.variables.variable import Variable
from parflex.simulation.variables.wanted import WANTED_VARIABLES

COORDINATES = (  # they label what the others hold
    Variable("time", ("time",), "s", "time", lambda run: run.t, missed="the instants"),
    Variable(
        "actuator_name",
        ("actuator",),
        "1",
        "names of the actuators",
        lambda run: np.array(actuator_names(run.robot), dtype=str),
        text=True,
    ),
)
ALL_VARIABLES = (
    *MOTION_VARIABLES,
    *BASE_VARIABLES,
    *LEG_VARIABLES,
    *PLATFORM_VARIABLES,
    *LEDGER,
    RESIDUAL,
    *WANTED_VARIABLES,
    ROBOT_FILE,
)
