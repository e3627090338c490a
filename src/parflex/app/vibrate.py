"""The command that tells where a robot resonates."""

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer
from rich.markup import escape

from parflex.app.commands import RobotPath, table_of
from parflex.app.terminal import ImageFormat, Out, check_format, check_writable, console
from parflex.base.errors import InputError
from parflex.simulation.holding import MOTORS, growth, held, row_of, swinging

if TYPE_CHECKING:
    from parflex.linear.system import LinearModel
    from parflex.model.model import Model
    from parflex.views.viewer import View

DRAWN = 6  # modes that have a picture
HEADS = ("mode", "frequency (Hz)", "damping (%)", "platform", "legs", "drives", "other")

Motors = Annotated[
    str,
    typer.Option(
        help='How motors hold: "locked", on their "springs", or by the default "servo"; "auto" takes springs '
        "where all motors have one, else locks them, and takes servos where nothing swings then."
    ),
]


def vibrate(
    robot: RobotPath,
    motors: Motors = "auto",
    count: Annotated[int, typer.Option("--modes", help="How many modes to tell.")] = 20,
    out: Out = Path("parflex-vibrate"),
    image: ImageFormat = "png",
) -> None:
    """Tell where the whole machine resonates at home: frequencies, damping, and where the energy is.

    Gravity and preload count, and may soften: their share then is negative. Friction is left out.

    Examples:

    `parflex vibrate robot.toml` - a table, modes.nc, pictures, and a page in which it swings

    `parflex vibrate robot.toml --motors servo` - the same while the legs' servos hold it
    """
    from parflex.base.netcdf import saved
    from parflex.files.robot_file import check_standing, read_robot
    from parflex.model.model import Model
    from parflex.views import plot

    check_format(image)
    known_motors(motors)
    if count < 1:
        raise InputError(f"--modes is {count}; ask for at least one")
    file = read_robot(robot)
    check_standing(file)
    check_writable(out)
    model = Model(file.robot, "numpy")
    how, lin = held(model, motors)
    found = lin.modes()
    which = swinging(found)
    console.print(table_of(HEADS, [row_of(found, i) for i in which[:count]]))
    console.print(escape(sentence(found, which, how)))
    target = out / "modes.nc"
    saved(found, target)
    drawn = {f"mode_{i + 1}": picture(model, lin, found, i) for i in which[:DRAWN]}
    names = ", ".join(path.name for path in plot.save(drawn, out, image))
    console.print(f"[bold]{escape(str(target))}[/] holds all modes; pictures: {names or 'none'}")
    if len(which) and find_spec("k3d"):
        shown = page(lin, (robot.name, how)).save(out / "modes.html")
        console.print(f"[bold]{escape(str(shown))}[/] shows the robot swing in them; open it in any browser")


def known_motors(motors: str) -> None:
    """Raise InputError for an unknown word."""
    if motors not in MOTORS:
        raise InputError(f"--motors is {motors!r}; choose one of {', '.join(MOTORS)}")


def sentence(found: Any, which: Any, how: str) -> str:
    """The first resonance, where its energy is, and whether the robot grows unstable, in a sentence."""
    growing = growth(found)
    words = f"unstable {how}: a motion grows e-fold in {1 / growing:.3g} s; " if growing else ""
    if not len(which):
        return f"{words}nothing swings {how}"
    first = found.isel(mode=which[0])
    text = f"{words}the machine first resonates at {float(first.frequency):.4g} Hz {how}"
    share = first.share.values
    if np.all(np.isfinite(share)):
        part = str(found.part.values[int(np.argmax(share))])
        text += f"; most of the energy of deformation is in {PARTS[part]}"
    return text


PARTS = {
    "platform": "the platform",
    "legs": "the links of the legs",
    "drives": "the drives and the springs of the motors",
    "other": "flexures, other springs and gravity",
}


def picture(model: "Model", lin: "LinearModel", found: Any, i: int) -> Any:
    """The robot displaced along a mode, as far as its largest displacement is a twelfth of its size."""
    from parflex.mechanics.closure import displaced
    from parflex.model.core import core_of
    from parflex.views import plot
    from parflex.views.sketch import sketch
    from parflex.views.viewer.swing_frames import frames_of, largest_motions

    core, mode = core_of(model), found.isel(mode=i)
    shape, size = mode["shape"].values, model.robot.platform.size
    [largest] = largest_motions(lin, frames_of(lin, shape[None]))
    step = size / 12 / largest * shape
    state = core.state(displaced(core.mechanism, lin.point.x, step))
    return plot.robot_at(sketch(model, state, 1.0), f"mode {i + 1}, {float(mode.frequency):.4g} Hz")


def page(lin: "LinearModel", facts: tuple[str, ...]) -> "View":
    """The robot swinging in its modes."""
    from parflex.views.viewer.page import View, swinging_page
    from parflex.views.viewer.swings import modes_as_swings

    return View(swinging_page(modes_as_swings(lin, facts)))
