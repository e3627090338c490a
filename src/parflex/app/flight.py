"""A robot flown along a trajectory file: the run, and its pictures."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from parflex.app.trajectory_file import Plan, planned_controller, start_of, trajectory_of
from parflex.files.robot_file import RobotFile
from parflex.model.core import core_of
from parflex.model.model import Model
from parflex.simulation.result import Result
from parflex.simulation.simulate import simulate
from parflex.views.sketch import instant_of_largest_bend, sketch_of


class Flight(NamedTuple):
    """A model, and the run that it flew."""

    model: Model
    result: Result


def fly(
    file: RobotFile, plan: Plan, backend: str = "auto", say: Callable[[str], None] = lambda words: None
) -> Flight:
    """The robot of a file along the plan of another.

    Raises InputError where they do not fit each other, with the line.
    """
    model, table = Model(file.robot, backend), plan.table
    say("looking for the start")
    start = start_of(plan, model)
    way = trajectory_of(plan, start.state)
    say(f"compiling the models ({core_of(model).functions.backend.version()})")
    controller = planned_controller(plan, model, start, way)
    say(f"flying the trajectory ({way.duration:.4g} s)")
    times = np.linspace(0.0, way.duration, max(2, round(way.duration / table.sample_time) + 1))
    result = simulate(
        model, controller, start.state, times, rtol=table.rtol, atol=table.atol, max_step=table.max_step
    )
    result.dataset.attrs["robot"] = file.table.name
    result.dataset["robot_file"] = result.dataset["robot_file"].copy(data=file.reader.text)
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
    if "acceleration_error" in result.dataset:
        drawn["accelerations"] = plot.accelerations(result)
    return plot.save(drawn, directory, suffix)
