"""Dynamics of parallel robots with flexible platforms.

import parflex as pf
model = pf.Model(pf.robots.gough_stewart())
model.direct(model.robot.home, forces)
"""

import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

from parflex.base.doors import register
from parflex.base.version import __version__ as __version__

if TYPE_CHECKING:
    from parflex import fe as fe, robots as robots
    from parflex.analysis.mobility import Mobility as Mobility
    from parflex.analysis.zero_dynamics import OutputReport as OutputReport
    from parflex.base.errors import (
        BeyondBasis as BeyondBasis,
        DynamicSingularity as DynamicSingularity,
        ImplausibleValue as ImplausibleValue,
        InputError as InputError,
        NoForeshortening as NoForeshortening,
        NotConverged as NotConverged,
        OutOfReach as OutOfReach,
        PartialRun as PartialRun,
        SingularPose as SingularPose,
        UnstableEquilibrium as UnstableEquilibrium,
    )
    from parflex.export.export import export_c as export_c
    from parflex.files.robot_file import load_robot as load_robot
    from parflex.files.spectrum_file import load_psd as load_psd
    from parflex.linear.contact import (
        ContactForces as ContactForces,
        Strain as Strain,
    )
    from parflex.linear.figures import (
        compliance as compliance,
        dynamic_stiffness as dynamic_stiffness,
        transmissibility as transmissibility,
    )
    from parflex.linear.inputs import (
        Actuators as Actuators,
        BaseAcceleration as BaseAcceleration,
        NodeWrench as NodeWrench,
        Reference as Reference,
    )
    from parflex.linear.lobes import stability_lobes as stability_lobes
    from parflex.linear.outputs import (
        Accelerometer as Accelerometer,
        FramePose as FramePose,
        JointMotion as JointMotion,
        NodeMotion as NodeMotion,
        StrutForce as StrutForce,
    )
    from parflex.linear.spectra import power_spectrum as power_spectrum
    from parflex.linear.system import LinearModel as LinearModel
    from parflex.mechanics.cartesian import Cartesian as Cartesian
    from parflex.mechanics.energy import Energies as Energies
    from parflex.mechanics.ordering import Joints as Joints
    from parflex.mechanics.output import (
        FrameOutput as FrameOutput,
        JointOutput as JointOutput,
        Output as Output,
        PointOutput as PointOutput,
    )
    from parflex.model.flat import Compiled as Compiled
    from parflex.model.frequencies import (
        Frequencies as Frequencies,
        natural_frequencies as natural_frequencies,
    )
    from parflex.model.model import Model as Model
    from parflex.model.results import (
        Accelerations as Accelerations,
        DirectJacobian as DirectJacobian,
        Forces as Forces,
        InverseJacobian as InverseJacobian,
        Reactions as Reactions,
    )
    from parflex.model.sag import sag as sag
    from parflex.robot.bar import Bar as Bar
    from parflex.robot.base_motion import BaseMotion as BaseMotion
    from parflex.robot.beam import beam as beam
    from parflex.robot.body import FlexibleBody as FlexibleBody
    from parflex.robot.coupling import Coupling as Coupling
    from parflex.robot.flexure import Flexure as Flexure
    from parflex.robot.leg import Joint as Joint, Leg as Leg, Tip as Tip
    from parflex.robot.modes import Modes as Modes
    from parflex.robot.moments import Moments as Moments
    from parflex.robot.payload import Payload as Payload
    from parflex.robot.robot import Robot as Robot
    from parflex.robot.state import State as State
    from parflex.robot.strut import Strut as Strut
    from parflex.robot.wrench import Wrench as Wrench
    from parflex.simulation.laws.computed_torque import ComputedTorque as ComputedTorque
    from parflex.simulation.laws.controller import Controller as Controller
    from parflex.simulation.laws.joint_pd import JointPD as JointPD
    from parflex.simulation.laws.servo import Servo as Servo
    from parflex.simulation.laws.verdict import Verdict as Verdict
    from parflex.simulation.leg_motion import LegMotion as LegMotion, leg_motion as leg_motion
    from parflex.simulation.moves.circle import Circle as Circle
    from parflex.simulation.moves.hold import Hold as Hold
    from parflex.simulation.moves.move_to import MoveTo as MoveTo
    from parflex.simulation.result import (
        Result as Result,
        RunStopped as RunStopped,
        load_result as load_result,
    )
    from parflex.simulation.simulate import simulate as simulate
    from parflex.simulation.surroundings.base_samples import BaseSamples as BaseSamples
    from parflex.simulation.trajectory import Trajectory as Trajectory
    from parflex.views import plot as plot
    from parflex.views.viewer import View as View, view as view

_NAMES = {  # of each module; loaded at first use, so that `import parflex` is quick
    "analysis.mobility": "Mobility",
    "analysis.zero_dynamics": "OutputReport",
    "base.errors": "BeyondBasis DynamicSingularity ImplausibleValue InputError NoForeshortening NotConverged "
    "OutOfReach PartialRun SingularPose UnstableEquilibrium",
    "export.export": "export_c",
    "files.robot_file": "load_robot",
    "files.spectrum_file": "load_psd",
    "linear.contact": "ContactForces Strain",
    "linear.figures": "compliance dynamic_stiffness transmissibility",
    "linear.inputs": "Actuators BaseAcceleration NodeWrench Reference",
    "linear.lobes": "stability_lobes",
    "linear.outputs": "Accelerometer FramePose JointMotion NodeMotion StrutForce",
    "linear.spectra": "power_spectrum",
    "linear.system": "LinearModel",
    "mechanics.cartesian": "Cartesian",
    "mechanics.energy": "Energies",
    "mechanics.ordering": "Joints",
    "mechanics.output": "FrameOutput JointOutput Output PointOutput",
    "model.flat": "Compiled",
    "model.frequencies": "Frequencies natural_frequencies",
    "model.model": "Model",
    "model.results": "Accelerations DirectJacobian Forces InverseJacobian Reactions",
    "model.sag": "sag",
    "robot.bar": "Bar",
    "robot.base_motion": "BaseMotion",
    "robot.beam": "beam",
    "robot.body": "FlexibleBody",
    "robot.coupling": "Coupling",
    "robot.flexure": "Flexure",
    "robot.leg": "Joint Leg Tip",
    "robot.modes": "Modes",
    "robot.moments": "Moments",
    "robot.payload": "Payload",
    "robot.robot": "Robot",
    "robot.state": "State",
    "robot.strut": "Strut",
    "robot.wrench": "Wrench",
    "simulation.laws.computed_torque": "ComputedTorque",
    "simulation.laws.controller": "Controller",
    "simulation.laws.joint_pd": "JointPD",
    "simulation.laws.servo": "Servo",
    "simulation.laws.verdict": "Verdict",
    "simulation.leg_motion": "LegMotion leg_motion",
    "simulation.moves.circle": "Circle",
    "simulation.moves.hold": "Hold",
    "simulation.moves.move_to": "MoveTo",
    "simulation.result": "Result RunStopped load_result",
    "simulation.simulate": "simulate",
    "simulation.surroundings.base_samples": "BaseSamples",
    "simulation.trajectory": "Trajectory",
    "views.viewer": "View view",
}
_HOME = {name: module for module, names in _NAMES.items() for name in names.split()}
_MODULES = {"fe": "fe", "plot": "views.plot", "robots": "robots"}

__all__ = sorted([*_HOME, *_MODULES])

register("Robot.to_file", "parflex.files.robot_writing:save_robot")


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
    return [*__all__, "__version__"]
