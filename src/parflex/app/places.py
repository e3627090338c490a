"""Places and bands that commands on vibration are told."""

import re
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import numpy as np
import typer

from parflex.base.array import Array
from parflex.base.errors import InputError

if TYPE_CHECKING:
    from parflex.files.robot_file import RobotFile

NUMBER = r"\s*(\d+\.?\d*(?:[eE][-+]?\d+)?)\s*"
APART = 1e-9  # of a frequency: two that are one
LOBE = np.linspace(-8.0, 8.0, 65)  # about a resonance, of its half bandwidth

Node = Annotated[
    int | None,
    typer.Option(help="The node of the platform that is asked for; by default the [tool] of the robot file."),
]
Band = Annotated[
    str, typer.Option(help='Frequencies "1..500" or "1..500 Hz"; by default about the lowest resonances.')
]


class Place(NamedTuple):
    """A point of the platform: its name in labels, its node, and its offset (3,) m from it."""

    name: str
    node: int
    offset: tuple[float, float, float]

    def label(self, label: str) -> str:
        """A label that begins with the name of the place."""
        from parflex.linear.outputs import NodeMotion

        own = NodeMotion(self.node, self.offset).name
        return self.name + label.removeprefix(own) if label.startswith(own) else label

    def renamed(self, data: Any) -> Any:
        """Responses with such labels."""
        found = {dim: [self.label(str(label)) for label in data[dim].values] for dim in ("output", "input")}
        return data.assign_coords(found)


def place_of(file: "RobotFile", node: int | None) -> Place:
    """The node, or the tool of the file: its node, or a point that is fixed to the nearest one.

    Raises InputError where the file has no tool and no node is given.
    """
    body, tool, name = file.robot.platform, file.table.tool, file.reader.path.name
    if node is not None:
        if not 0 <= node < len(body.nodes):
            raise InputError(f"--node is {node}; the platform has nodes 0 … {len(body.nodes) - 1}")
        return Place(f"node[{node}]", node, (0.0, 0.0, 0.0))
    if tool is None:
        raise InputError(
            f"{name} has no [tool]; add one, with a position, or name a node of the platform, --node 0 … "
            f"{len(body.nodes) - 1}"
        )
    if tool.node is not None:
        return Place("tool", tool.node, (0.0, 0.0, 0.0))
    point = np.asarray(tool.position)
    nearest = int(np.argmin(np.linalg.norm(body.nodes - point, axis=1)))
    x, y, z = (point - body.nodes[nearest]).tolist()
    return Place("tool", nearest, (x, y, z))


def span_of(option: str, text: str, unit: str) -> tuple[float, float]:
    """The two numbers of '1..500', with or without their unit.

    Raises InputError for another text, and where the second is not larger.
    """
    found = re.fullmatch(rf"{NUMBER}\.\.{NUMBER}(?:{re.escape(unit)})?\s*", text)
    low, high = (float(part) for part in found.groups()) if found else (0.0, 0.0)
    if not 0 < low < high:
        raise InputError(f"{option} is {text!r}; give two positive numbers, the lower first, like 1..500")
    return low, high


def band_of(text: str, modes: Any) -> tuple[float, float]:
    """The band (Hz) of an option, by default from a tenth of the lowest resonance to twice the twelfth."""
    if text:
        return span_of("--band", text, "Hz")
    f = resonances(modes).frequency.values
    if not len(f):
        raise InputError("nothing swings, so that there are no resonances to show; give --band 1..500")
    return float(f[0]) / 10, 2 * float(f[min(11, len(f) - 1)])


def resonances(modes: Any) -> Any:
    """The modes that swing."""
    return modes.isel(mode=modes.pole_imag.values > 1e-3 * np.abs(modes.pole_real.values))


def frequencies(band: tuple[float, float], modes: Any, count: int) -> Array:
    """Circular frequencies (w,) rad/s in a band, evenly on a logarithmic scale, and dense about
    resonances."""
    swing = resonances(modes)
    peaks = swing.frequency.values[:, None] * (1 + np.maximum(swing.damping.values, 1e-5)[:, None] * LOBE)
    every = np.concatenate([np.geomspace(*band, count), peaks.ravel()])
    found = np.unique(every[(every >= band[0]) & (every <= band[1])])
    return 2 * np.pi * found[np.diff(found, prepend=0.0) > APART * found]
