"""A robot flown along a trajectory file: the run, and its pictures."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from parflex.app.trajectory_file import Plan, in_world, planned_control, start_of, trajectory_of
from parflex.base.errors import InputError
from parflex.files.robot_file import RobotFile
from parflex.model.core import core_of
from parflex.model.model import Model
from parflex.robot.joint_words import beyond_strokes
from parflex.robot.robot import Robot
from parflex.simulation.laws.choice import Choice
from parflex.simulation.laws.controller import Start
from parflex.simulation.laws.verdict import Verdict
from parflex.simulation.leg_motion import leg_motion
from parflex.simulation.machine_modes import add_machine_modes
from parflex.simulation.result import Result
from parflex.simulation.simulate import simulate
from parflex.simulation.trajectory import Trajectory
from parflex.views.sketch import instant_of_largest_bend, sketch_of

INSTANTS = 500  # of a trajectory, at which strokes are looked at


class Flight(NamedTuple):
    """A model, and the run that it flew."""

    model: Model
    result: Result


class Prepared(NamedTuple):
    """A robot at the start of a plan, with the controller that drives it and what is to be expected of it."""

    file: RobotFile
    plan: Plan
    model: Model
    start: Start
    way: Trajectory
    choice: Choice
    verdict: Verdict | None
    doubts: list[str]  # about strokes that the trajectory asks for


def prepare(
    file: RobotFile, plan: Plan, backend: str = "auto", say: Callable[[str], None] = lambda words: None
) -> Prepared:
    """The robot of a file at the start of the plan of another, which names its control or takes the default.

    Raises InputError where they do not fit each other, with the line.
    """
    model = Model(file.robot, backend)
    say("looking for the start")
    start = start_of(plan, model)
    way = trajectory_of(plan, start.state)
    say("looking whether the control is stable")
    choice = in_world(plan, planned_control(plan, model, start, way), start)
    verdict = choice.controller.verdict(start.state)
    return Prepared(file, plan, model, start, way, choice, verdict, stroke_doubts(file.robot, way))


def stroke_doubts(robot: Robot, way: Trajectory) -> list[str]:
    """A line for each leg whose stroke a trajectory exceeds; none where the legs do not allow its poses."""
    times = np.linspace(0.0, way.duration, INSTANTS)
    try:
        return beyond_strokes(robot, leg_motion(Model(robot, "numpy"), way, times).positions)
    except InputError:
        return []


def fly(prepared: Prepared, say: Callable[[str], None] = lambda words: None) -> Flight:
    """The robot along its plan."""
    file, plan, model, start, way, choice, verdict, _ = prepared
    table = plan.table
    say(f"flying the trajectory ({way.duration:.4g} s) on {core_of(model).functions.backend.version()}")
    times = np.linspace(0.0, way.duration, max(2, round(way.duration / table.sample_time) + 1))
    result = simulate(
        model,
        choice.controller,
        start.state if plan.base is None else plan.base(0.0).carried(start.state),
        times,
        base=plan.base,
        rtol=table.rtol,
        atol=table.atol,
        max_step=table.max_step,
    )
    attributes = result.dataset.attrs
    attributes["robot"] = file.table.name
    if verdict is not None:
        attributes["verdict"], attributes["stable"] = str(verdict), int(verdict.stable)
    result.dataset["robot_file"] = result.dataset["robot_file"].copy(data=file.reader.text)
    add_machine_modes(result.dataset, model)
    return Flight(model, result)


def figures(flight: Flight, directory: Path, suffix: str = "png") -> list[Path]:
    """Draw and save the pictures of a run in `directory`."""
    from parflex.views import plot

    result, modes = flight.result, flight.model.robot.platform.modes
    index = instant_of_largest_bend(result)
    when = f"t = {float(result.dataset['time'][index]):.2f} s"
    drawn = {
        "robot": plot.robot_at(sketch_of(result, index), when),
        "forces": plot.actuator_forces(result),
        "energy": plot.energy(result),
    }
    if modes:
        drawn["deformation"] = plot.attachment_deformation(result)
    if "base_position" in result.dataset:
        drawn["base"] = plot.base_motion(result)
    if "acceleration_error" in result.dataset:
        drawn["accelerations"] = plot.accelerations(result)
    return plot.save(drawn, directory, suffix)
