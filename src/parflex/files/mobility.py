"""The freedoms that an author expects of a platform, against those the legs leave it."""

from typing import Any

from parflex.errors import InputError
from parflex.model import Model
from parflex.robot import Robot
from parflex.state import State


def mobility(model: Model, state: State) -> Any:
    """What the legs leave the platform at a state; None where the model cannot tell."""
    known = getattr(model, "mobility", None)
    return None if known is None else known(state)


def check_mobility(robot: Robot, expected: int) -> None:
    """Raise InputError where the robot at home has not the freedoms that were expected."""
    found = mobility(Model(robot), robot.home)
    if found is not None and found.freedoms != expected:
        raise InputError(
            f"mobility is {expected}, but the legs leave the platform {found.freedoms} freedoms at home; "
            f"correct the axes of the legs' joints, or the number"
        )
