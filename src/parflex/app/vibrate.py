"""The command that tells where a robot resonates."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer
from rich.markup import escape

from parflex.app.commands import RobotPath, table_of
from parflex.app.terminal import ImageFormat, Out, check_format, check_writable, console
from parflex.base.errors import InputError

if TYPE_CHECKING:
    from parflex.linear.system import LinearModel
    from parflex.model.model import Model

MOTORS = ("auto", "locked", "springs", "servo")
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

    `parflex vibrate robot.toml` - a table, modes.nc and a picture of each of the lowest modes

    `parflex vibrate robot.toml --motors servo` - the same while the legs' servos hold it
    """
    from parflex.base.netcdf import saved
    from parflex.files.robot_file import check_standing, read_robot
    from parflex.model.model import Model
    from parflex.views import plot

    check_format(image)
    if motors not in MOTORS:
        raise InputError(f"--motors is {motors!r}; choose one of {', '.join(MOTORS)}")
    if count < 1:
        raise InputError(f"--modes is {count}; ask for at least one")
    file = read_robot(robot)
    check_standing(file)
    check_writable(out)
    model = Model(file.robot, "numpy")
    how, lin = held(model, motors)
    found = lin.modes()
    swinging = np.flatnonzero(found.pole_imag.values > 1e-3 * np.abs(found.pole_real.values))
    console.print(table_of(HEADS, [row_of(found, i) for i in swinging[:count]]))
    console.print(escape(sentence(found, swinging, how)))
    target = out / "modes.nc"
    saved(found, target)
    drawn = {f"mode_{i + 1}": picture(model, lin, found, i) for i in swinging[:DRAWN]}
    names = ", ".join(path.name for path in plot.save(drawn, out, image))
    console.print(f"[bold]{escape(str(target))}[/] holds all modes; pictures: {names or 'none'}")


def held(model: "Model", motors: str) -> tuple[str, "LinearModel"]:
    """The words for how the motors hold the robot, and its linear system about the equilibrium at home."""
    if motors == "auto":
        sprung = [joint.k > 0 for leg in model.robot.legs for joint in leg.joints if joint.mu]
        found = held(model, "springs" if sprung and all(sprung) else "locked")
        return found if len(found[1].A) else held(model, "servo")
    state, forces = model.equilibrium(*model.robot.home_pose)
    controller: Any = None if motors == "springs" else "locked"
    if motors == "servo":
        from parflex.simulation.laws.servo import Servo
        from parflex.simulation.moves.hold import Hold
        from parflex.simulation.trajectory import Trajectory

        controller = Servo(model, Trajectory.of(model.robot.home, [Hold(1.0)]))
    words = {
        "springs": "on its motors' springs",
        "locked": "on locked motors",
        "servo": "on its legs' servos",
    }
    return words[motors], model.linearise(state, forces, controller=controller)


def row_of(found: Any, i: int) -> tuple[str, ...]:
    """The cells of a mode."""
    mode = found.isel(mode=i)
    shares = (f"{100 * share:.0f} %" if np.isfinite(share) else "" for share in mode.share.values)
    return (str(int(mode.mode)), f"{float(mode.frequency):.5g}", f"{100 * float(mode.damping):.3g}", *shares)


def sentence(found: Any, swinging: Any, how: str) -> str:
    """The first resonance, where its energy is, and whether the robot grows unstable, in a sentence."""
    growing = float(np.max(found.growth.values, initial=0.0))
    words = ""
    if growing > 1e-6 * 2 * np.pi * float(np.max(found.frequency.values, initial=0.0)):
        words = f"unstable {how}: a motion grows e-fold in {1 / growing:.3g} s; "
    if not len(swinging):
        return f"{words}nothing swings {how}"
    first = found.isel(mode=swinging[0])
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
    """The robot displaced along a mode, as far as its largest deflection is a twelfth of its size."""
    from parflex.mechanics.closure import displaced
    from parflex.model.core import core_of
    from parflex.views import plot
    from parflex.views.sketch import sketch

    core, mode = core_of(model), found.isel(mode=i)
    body, shape = core.mechanism.platform.body, mode.shape.values
    moved = shape[:3] + np.cross(shape[3:6], body.nodes)
    bend = np.einsum("n,nka->ka", shape[6 : 6 + body.modes], body.shapes)
    largest = float(np.max(np.linalg.norm(moved + bend, axis=-1)))
    step = body.size / 12 / largest * shape
    state = core.state(displaced(core.mechanism, lin.point.x, step))
    return plot.robot_at(sketch(model, state, 1.0), f"mode {i + 1}, {float(mode.frequency):.4g} Hz")
