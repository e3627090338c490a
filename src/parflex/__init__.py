"""Dynamics of parallel robots with flexible platforms.

import parflex as pf
model = pf.Model(pf.robots.gough_stewart())
model.direct(model.robot.home, forces)
"""

import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

from parflex.errors import DynamicSingularity, InputError, NotConverged, OutOfReach, SingularPose

if TYPE_CHECKING:
    from parflex import fe, robots
    from parflex.body import FlexibleBody
    from parflex.compiled.c.export import export_c
    from parflex.control import ComputedTorque, Controller, JointPD
    from parflex.files.robot_file import load_robot
    from parflex.legs import Joint, Leg, Tip
    from parflex.model import Model
    from parflex.modes import Modes, Moments
    from parflex.output import FrameOutput, PointOutput
    from parflex.result import Result, load_result
    from parflex.robot import Robot
    from parflex.simulation import simulate
    from parflex.state import State, Wrench
    from parflex.trajectory import Trajectory
    from parflex.viewer import View, view

__version__ = "0.1.0"

_HOME = {  # loaded at first use, so that `import parflex` is quick
    "ComputedTorque": "control",
    "Controller": "control",
    "FlexibleBody": "body",
    "FrameOutput": "output",
    "Joint": "legs",
    "JointPD": "control",
    "Leg": "legs",
    "Model": "model",
    "Modes": "modes",
    "Moments": "modes",
    "PointOutput": "output",
    "Result": "result",
    "Robot": "robot",
    "State": "state",
    "Tip": "legs",
    "Trajectory": "trajectory",
    "View": "viewer",
    "Wrench": "state",
    "export_c": "compiled.c.export",
    "load_result": "result",
    "load_robot": "files.robot_file",
    "simulate": "simulation",
    "view": "viewer",
}
_MODULES = ("fe", "robots", "plot")

__all__ = [
    "ComputedTorque",
    "Controller",
    "DynamicSingularity",
    "FlexibleBody",
    "FrameOutput",
    "InputError",
    "Joint",
    "JointPD",
    "Leg",
    "Model",
    "Modes",
    "Moments",
    "NotConverged",
    "OutOfReach",
    "PointOutput",
    "Result",
    "Robot",
    "SingularPose",
    "State",
    "Tip",
    "Trajectory",
    "View",
    "Wrench",
    "export_c",
    "fe",
    "load_result",
    "load_robot",
    "robots",
    "simulate",
    "view",
]


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        found = import_module(f"parflex.{name}")
    elif name in _HOME:
        found = getattr(import_module(f"parflex.{_HOME[name]}"), name)
    else:
        raise AttributeError(
            f"module 'parflex' has no attribute {name!r}", name=name, obj=sys.modules[__name__]
        )
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
