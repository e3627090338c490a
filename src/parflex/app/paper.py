"""Section 6 of the paper: the robot, its trajectory, the run, the figures."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from parflex.model.core import core_of
from parflex.model.model import Model
from parflex.robot.modes import Modes
from parflex.robot.robot import Robot
from parflex.robot.state import State
from parflex.robots.gough_stewart import MOVES, TABLE_2, gough_stewart, held, plate
from parflex.simulation.laws.computed_torque import ComputedTorque
from parflex.simulation.result import Result
from parflex.simulation.simulate import simulate
from parflex.simulation.trajectory import Trajectory
from parflex.views.sketch import instant_of_largest_bend, sketch_of

SAMPLE_TIME = 5e-3  # s between output times
RTOL, ATOL = 1e-7, 1e-9

MOVE_TIME = 1.25  # s
REST = (0.5, 0.5)  # s, the rest periods at both ends


class PaperRun(NamedTuple):
    """The results of Section 6."""

    modes: Modes
    robot: Robot
    trajectory: Trajectory
    result: Result


def trajectory(robot: Robot) -> Trajectory:
    """The trajectory of the paper: rest, three poses away from home, back to rest."""
    return Trajectory.through(robot.home, MOVES, MOVE_TIME, REST)


def run(
    modes: int = 10,
    frequencies: str = "converged",
    undeformed: bool = False,
    backend: str = "auto",
    say: Callable[[str], None] = lambda words: None,
) -> PaperRun:
    """The paper's Fig. 3: trajectory, inverse model, direct model, integration.

    The run starts from the static equilibrium under gravity, or undeformed.
    """
    say("modes of the free plate")
    computed = plate(modes, frequencies)
    robot = gough_stewart(platform=held(computed))
    model = Model(robot, backend)
    way = trajectory(robot)
    start: State = robot.home if undeformed else model.equilibrium(*robot.home_pose)[0]
    say(f"compiling the models ({core_of(model).functions.backend.version()})")
    controller = ComputedTorque(model, way)
    count = round(way.duration / SAMPLE_TIME) + 1
    say(f"flying the trajectory ({way.duration:.1f} s)")
    times = np.linspace(0.0, way.duration, count)
    result = simulate(model, controller, start, times, rtol=RTOL, atol=ATOL)
    result.dataset.attrs["robot"] = "Gough-Stewart robot of Section 6"
    result.dataset.attrs["notes"] = "\n".join(frequency_notes(computed, frequencies))
    return PaperRun(computed, robot, way, result)


def frequency_notes(modes: Modes, frequencies: str) -> list[str]:
    """The notes about the plate's frequencies that a reader of the results must know."""
    notes = list(modes.notes)
    if frequencies == "published":
        notes.append("frequencies are those of Table 2, shapes are computed")
    elif len(modes.frequencies) >= 8:
        notes.append(
            "modes 8-10 lie 8-9 % below Table 2, whose mesh was too coarse for them: ours are within "
            f"{100 * np.max(modes.frequency_error[:10]):.2f} % of those of a mesh twice as coarse"
        )
    return notes


def figures(paper: PaperRun, directory: Path, suffix: str = "png") -> list[Path]:
    """Draw and save the pictures of Section 6 in `directory`."""
    from parflex.views import plot

    result, modes = paper.result, paper.modes
    notes = str(result.dataset.attrs["notes"]).splitlines()
    index = instant_of_largest_bend(result)
    drawn = {
        "fig4_actuator_forces": plot.actuator_forces(result),
        "fig5_accelerations": plot.accelerations(result),
        "fig6_origin_deformation": plot.origin_deformation(result),
        "fig7_attachment_deformation": plot.attachment_deformation(result),
        "energy": plot.energy(result),
        "robot": plot.robot_at(sketch_of(result, index), f"t = {float(result.dataset.time[index]):.2f} s"),
    }
    if len(modes.frequencies):
        drawn["modes"] = plot.mode_shapes(modes)
        drawn["table2_frequencies"] = plot.frequency_table(modes.frequencies, np.array(TABLE_2), notes)
    return plot.save(drawn, directory, suffix)
