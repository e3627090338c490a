"""The page in which a robot swings in its modes, or gives under a load, beside the table of them."""

from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.base.version import __version__
from parflex.robot.words import counted
from parflex.views.sketch import SHOWN
from parflex.views.viewer.opening import Opened
from parflex.views.viewer.parts import Part, borne_arrow
from parflex.views.viewer.scene import ARROW, Scene, scene_of
from parflex.views.viewer.swing_frames import Frames, as_dataset, frames_of, largest_motions
from parflex.views.viewer.swings import Swing, Swings

LEAST = 0.1  # of the largest motion as drawn: the bend of the platform that has the full colour, at least


def swinging_scene(told: Swings) -> Scene:
    """The scene: the robot at rest and, of each motion, its two displacements as they are drawn at first."""
    shapes = [shape for each in told.swings for shape in (each.shape, quarter(each))]
    frames = frames_of(told.lin, np.array(shapes).reshape(len(shapes), told.lin.point.T.shape[0]))
    size = float(np.max(np.ptp(told.lin.point.mechanism.platform.body.nodes, axis=0), initial=0.0)) or 1.0
    largest = np.max(largest_motions(told.lin, frames).reshape(-1, 2), axis=1, initial=0.0)
    factors = SHOWN * size / np.where(largest > 0, largest, np.inf)
    drawn = frames.with_motions(np.repeat(factors, 2))
    scene = scene_of(Opened(as_dataset(told.lin, drawn), ()))
    assert scene is not None, "a robot has a place"
    more = {
        "scale": 1.0,
        "bends": False,
        "start": 0.0,
        "end": 1.0,
        "swings": [
            for_page(each, scene, drawn, k, SHOWN * size, float(factors[k]))
            for k, each in enumerate(told.swings)
        ],
    }
    parts = [*scene.parts, *arrows(told, size, float(np.max(factors, initial=0.0)))]
    return scene._replace(meta=scene.meta | more, parts=parts, still=True)


def arrows(told: Swings, size: float, factor: float) -> list[Part]:
    """The forces of a load above the platform, the largest as long as a part of the platform's size; factor
    is how many times larger the motion is drawn."""
    largest = max((float(np.linalg.norm(each.force)) for each in told.forces), default=1.0)
    up = told.lin.point.system.x.rotation[:, 2]
    parts = []
    for place, force, moved in told.forces:
        way = ARROW * size / largest * force
        start = place - way if force @ up < 0 else place
        parts += borne_arrow(start, way, 0.012 * size, factor * moved)
    return parts


def quarter(swing: Swing) -> Array:
    """The displacements a quarter of a period before, zero of a ramp."""
    return 0.0 * swing.shape if swing.quarter is None else swing.quarter


def for_page(swing: Swing, scene: Scene, drawn: Frames, k: int, most: float, factor: float) -> dict[str, Any]:
    """The numbers of a motion for the page: `most` m is its largest displacement as drawn, `factor` times
    what it is, and `peaks` are the values with the full colour."""
    elastic = drawn.elastic[1 + 2 * k : 3 + 2 * k] - drawn.elastic[0]
    ramp = swing.quarter is None
    return {
        "title": swing.title,
        "hertz": swing.hertz,
        "ramp": ramp,
        "most": most if factor else 0.0,
        "factor": factor,
        "peaks": {name: max(each.largest(elastic), LEAST * most) for name, each in scene.colourings.items()},
    }


def body_of(told: Swings) -> dict[str, Any]:
    """The words of the page."""
    robot = told.lin.point.mechanism.robot
    modes = told.lin.point.mechanism.platform.modes
    return {
        "title": "A static load"
        if told.swings and told.swings[0].quarter is None
        else "Modes of the machine",
        "facts": [
            *told.facts,
            f"{counted(len(robot.legs), 'leg')}, {counted(robot.n_forces, 'motor')}",
            counted(modes, "elastic mode") if modes else "rigid platform",
            f"parflex {__version__}",
        ],
        "notes": list(told.notes),
        "curves": [],
        "heads": told.heads,
        "rows": told.rows,
    }
