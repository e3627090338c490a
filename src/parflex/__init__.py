"""Dynamics of parallel robots with flexible platforms.

import parflex as pf
model = pf.Model(pf.robots.gough_stewart())
model.direct(model.robot.home, forces)
"""

import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

from parflex.base.errors import DynamicSingularity, InputError, NotConverged, OutOfReach, SingularPose
from parflex.base.version import __version__ as __version__

if TYPE_CHECKING:
    from parflex import fe, robots
    from parflex.export.export import export_c
    from parflex.files.robot_file import load_robot
    from parflex.mechanics.output import FrameOutput, PointOutput
    from parflex.model.model import Model
    from parflex.robot.body import FlexibleBody
    from parflex.robot.leg import Joint, Leg, Tip
    from parflex.robot.modes import Modes
    from parflex.robot.moments import Moments
    from parflex.robot.robot import Robot
    from parflex.robot.state import State
    from parflex.robot.wrench import Wrench
    from parflex.simulation.laws import ComputedTorque, Controller, JointPD
    from parflex.simulation.result import Result, load_result
    from parflex.simulation.simulate import simulate
    from parflex.simulation.trajectory import Trajectory
    from parflex.views.viewer import View, view


_HOME = {  # loaded at first use, so that `import parflex` is quick
    "ComputedTorque": "simulation.laws",
    "Controller": "simulation.laws",
    "FlexibleBody": "robot.body",
    "FrameOutput": "mechanics.output",
    "Joint": "robot.leg",
    "JointPD": "simulation.laws",
    "Leg": "robot.leg",
    "Model": "model.model",
    "Modes": "robot.modes",
    "Moments": "robot.moments",
    "PointOutput": "mechanics.output",
    "Result": "simulation.result",
    "Robot": "robot.robot",
    "State": "robot.state",
    "Tip": "robot.leg",
    "Trajectory": "simulation.trajectory",
    "View": "views.viewer",
    "Wrench": "robot.wrench",
    "export_c": "export.export",
    "load_result": "simulation.result",
    "load_robot": "files.robot_file",
    "simulate": "simulation.simulate",
    "view": "views.viewer",
}
_MODULES = {"fe": "fe", "robots": "robots", "plot": "views.plot"}

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
        found = import_module(f"parflex.{_MODULES[name]}")
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
