"""Draws the nano-hexapod of gallery.md and prints its table: python docs/draw_nano_hexapod.py"""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import parflex as pf
from parflex.model.core import core_of
from parflex.views import plot
from parflex.views.plot.canvas import COLOURS, figure, time_label
from parflex.views.sketch import sketch

PAGE = Path(__file__).parent / "gallery.md"
PLACE, SHAKEN = (
    Path(__file__).parent / "pictures" / f"gallery_nano_{name}.png" for name in ("hexapod", "floor")
)
MOVED = (50e-6, -40e-6, 30e-6)  # m
ROWS = {  # what yields, of the turning of flexures, their tips, and the disc
    "the actuators": (False, False, False),
    "and the flexures' turning": (True, False, False),
    "and their tips": (True, True, False),
    "and the disc": (True, True, True),
}


def yielding(turning: bool, tips: bool, disc: bool) -> pf.Robot:
    """The robot without gravity, some of it ideal."""
    robot = pf.robots.nano_hexapod() if disc else pf.robots.nano_hexapod(modes=0)
    legs = [stiff(leg, turning, tips) for leg in robot.legs]
    return pf.Robot(legs, robot.platform, (0, 0, 0), robot.home_pose)


def stiff(leg: pf.Leg, turning: bool, tips: bool) -> pf.Leg:
    """A leg whose flexures turn freely, unless they do not, and hold the platform, unless they do not."""
    (tip,), joints = leg.tips, leg.joints
    flexure = tip.flexure
    assert flexure is not None
    if not turning:
        flexure = replace(flexure, stiffness=np.zeros((3, 3)))
        joints = (*(replace(joint, k=0) for joint in joints[:2]), joints[2])
    if not tips:
        flexure = replace(flexure, translation=None, translation_damping=None)
    return replace(leg, joints=joints, tips=[replace(tip, flexure=flexure)])


def hertz(robot: pf.Robot) -> np.ndarray:
    """The frequencies of the robot on its springs."""
    poles = core_of(pf.Model(robot, "numpy")).at_home.free_poles()
    found: np.ndarray = np.sort(np.abs(poles[poles.imag > 0])) / (2 * np.pi)
    return found


def table() -> str:
    """The first six frequencies by what yields, and what comes next."""
    lines = ["| what yields | the disc on its struts | next |", "|---|---|---|"]
    for words, what in ROWS.items():
        found = hertz(yielding(*what))
        following = f"{found[6]:.0f}"
        lines.append(f"| {words} | {', '.join(f'{each:.1f}' for each in found[:6])} | {following} |")
    return "\n".join(lines)


def at_place() -> Figure:
    """The robot that rests where its actuators have moved it."""
    model = pf.Model(pf.robots.nano_hexapod(), "numpy")
    position, rotation = model.robot.home_pose
    state, _ = model.equilibrium(np.asarray(position) + MOVED, rotation)
    words = ", ".join(f"{1e6 * each:.0f}" for each in MOVED)
    return plot.robot_at(sketch(model, state), f"nano-hexapod, moved by ({words}) µm")


def made() -> dict:
    """What the page's Python on the floor makes."""
    section = PAGE.read_text(encoding="utf-8").split("### On a floor that shakes")[1]
    found: dict = {}
    exec(re.findall(r"```python\n(.*?)```", section, re.DOTALL)[0], found)
    return found


def shaken(found: dict) -> Figure:
    """The floor, and the tool relative to it, over time."""
    t, floor, tool = (np.asarray(found[name]) for name in ("t", "z", "tool"))
    fig = figure(7.0, 4.2)
    above, below = fig.subplots(2, 1, sharex=True)
    above.plot(t, 1e6 * floor, color=COLOURS[0], lw=0.9)
    above.set_ylabel("floor (µm)")
    above.set_title("A sweep from 10 to 50 Hz")
    below.plot(t, 1e9 * tool, color=COLOURS[1], lw=0.9)
    below.set_ylabel("tool, relative to the floor (nm)")
    time_label(below)
    for ax in (above, below):
        ax.margins(x=0)
        ax.grid(alpha=0.3)
    return fig


if __name__ == "__main__":
    from draw_gallery import save

    print(table())
    save(at_place(), PLACE)
    save(shaken(made()), SHAKEN)
