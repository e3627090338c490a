"""Draws the pictures of gallery.md and prints its table: python docs/draw_gallery.py"""

import warnings
from io import BytesIO
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

import parflex as pf
from parflex.compiled import vm
from parflex.kernels import models as kernels
from parflex.mechanics.redundancy import solvable
from parflex.robots import ALL_ROBOTS, Entry
from parflex.views import plot
from parflex.views.sketch import sketch

PICTURES = Path(__file__).parent / "pictures"
MOVE_TIME, INSTANT = 0.5, 0.6  # s: past the first pose, where the platform turns round
COLOURS = 256  # of a picture, which keeps the files small


def in_motion(entry: Entry) -> tuple[pf.Model, pf.State]:
    """The robot under computed torque along its moves, at the instant."""
    model = pf.Model(entry.build())
    start, _ = model.equilibrium(*model.robot.home_pose)
    way = pf.Trajectory.through(start, entry.moves, MOVE_TIME, rest=(0, 0))
    control = pf.ComputedTorque(model, way, kp=400.0, kd=40.0, output=pf.FrameOutput(entry.output))
    run = pf.simulate(model, control, start, np.linspace(0.0, INSTANT, 3), rtol=1e-6, atol=1e-8)
    return model, run.state(-1)


def picture(entry: Entry) -> Figure:
    """The robot in motion, its platform bent."""
    return plot.robot_at(sketch(*in_motion(entry)), f"{entry.name}, t = {INSTANT} s")


def save(figure: Figure, path: Path) -> None:
    """As PNG of few colours."""
    buffer = BytesIO()
    figure.savefig(buffer, dpi=110)
    few = Image.open(buffer).convert("RGB").quantize(COLOURS, Image.Quantize.MAXCOVERAGE)
    few.save(path, optimize=True)


def row(entry: Entry) -> str:
    """The line of the table."""
    robot = entry.build()
    found = pf.Model(robot, "numpy").mobility(robot.home)
    cost = vm.trace(kernels.direct(solvable(robot))).n_instructions()
    legs = f"{len(robot.legs)} × {robot.legs[0].word}"
    cells = (
        f"[{entry.name}](#{entry.build.__name__})", f"`{entry.build.__name__}`", legs, found.freedoms,
        found.actuators, found.rows, robot.platform.modes, f"{cost / 1e3:.1f}k", entry.source,
    )  # fmt: skip
    return "| " + " | ".join(map(str, cells)) + " |"


if __name__ == "__main__":
    warnings.filterwarnings("ignore", message=".*cut a degenerate pair")
    for each in ALL_ROBOTS:
        print(row(each))
        save(picture(each), PICTURES / f"gallery_{each.build.__name__}.png")
