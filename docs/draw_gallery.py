"""Draws the pictures of gallery.md and prints its table: python docs/draw_gallery.py"""

import re
import warnings
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

import parflex as pf
from parflex.analysis.mobility import null_space
from parflex.analysis.small_motions import SmallMotions
from parflex.compiled import vm
from parflex.kernels import models as kernels
from parflex.mechanics.closure import displaced
from parflex.mechanics.redundancy import solvable
from parflex.model.core import core_of
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


def struts() -> pf.Robot:
    """The robot of the page's Python."""
    code, _ = re.findall(r"```python\n(.*?)```", (PICTURES.parent / "gallery.md").read_text(), re.DOTALL)
    made: dict = {}
    exec(code, made)
    return made["robot"]


def locked_modes(robot: pf.Robot) -> list[tuple[complex, pf.State]]:
    """Poles with their states, by frequency: unloaded at home, all actuated joints locked."""
    core = core_of(pf.Model(pf.Robot(robot.legs, robot.platform, (0, 0, 0), robot.home_pose)))
    home = core.flat(robot.home)
    small = SmallMotions(core.functions, home, np.zeros(robot.n_forces))
    Z = null_space(small.S / np.linalg.norm(small.S, axis=1, keepdims=True))
    hold = Z.T - Z.T @ small.B @ np.linalg.pinv(small.S @ small.B) @ small.S
    K, C = (hold @ part @ Z for part in small.KC)
    one = np.eye(len(K))
    poles, shapes = np.linalg.eig(np.block([[0 * one, one], [K, C]]))
    found = []
    for k in sorted(np.flatnonzero(poles.imag > 0), key=lambda k: abs(poles[k])):
        shape = shapes[: len(K), k]
        shape = (shape / shape[np.argmax(np.abs(shape))]).real
        moved = displaced(core.mechanism, home, 1e-4 * (small.T @ (Z @ shape)))
        found.append((poles[k], core.state(moved)))
    return found


def draw_struts() -> None:
    """A mode of the struts, and the table of the first frequencies, with rigid struts and with these."""
    robot = struts()
    bodies = [
        [j if j.body is None else replace(j, body=j.body.with_modes(())) for j in leg.joints]
        for leg in robot.legs
    ]
    legs = [replace(leg, joints=joints) for leg, joints in zip(robot.legs, bodies, strict=True)]
    rigid = pf.Robot(legs, robot.platform, home_pose=robot.home_pose)
    for each in (rigid, robot):
        found = locked_modes(each)
        print(", ".join(f"{abs(pole) / (2 * np.pi):.1f}" for pole, _ in found[:36]))
    pole, state = found[17]
    model, title = pf.Model(robot), f"a mode of {abs(pole) / (2 * np.pi):.1f} Hz"
    scale = 2 * sketch(model, state).scale
    save(plot.robot_at(sketch(model, state, scale), title), PICTURES / "gallery_struts.png")


if __name__ == "__main__":
    warnings.filterwarnings("ignore", message=".*cut a degenerate pair")
    for each in ALL_ROBOTS:
        print(row(each))
        save(picture(each), PICTURES / f"gallery_{each.build.__name__}.png")
    draw_struts()
