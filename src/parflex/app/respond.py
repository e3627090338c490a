"""The commands that tell what a machine's point does under forces: frequency responses, stability lobes."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer
from rich.markup import escape

from parflex.app.commands import RobotPath, table_of
from parflex.app.places import Band, Node, Place, band_of, frequencies, place_of, resonances, span_of
from parflex.app.terminal import ImageFormat, Out, check_format, check_writable, console
from parflex.app.vibrate import Motors, known_motors
from parflex.base.errors import InputError
from parflex.simulation.holding import held

if TYPE_CHECKING:
    from parflex.linear.system import LinearModel

POINTS = 2000  # frequencies, and as many as resonances need
FINE = 20000  # for lobes, whose speeds are read between frequencies
HEADS = ("mode", "frequency (Hz)", "damping (%)")
FLOOR = "base_"


def frf(
    robot: RobotPath,
    node: Node = None,
    from_: Annotated[
        str,
        typer.Option("--from", help='Inputs: "tool_fx,tool_fz", "force[0]", or "base_z", the floor.'),
    ] = "",
    to: Annotated[
        str,
        typer.Option(help='Outputs: "tool_z", "tool_az" (acceleration), "joint[0]", "strut[0]", "frame_x".'),
    ] = "",
    band: Band = "",
    motors: Motors = "auto",
    structural: Annotated[float, typer.Option(help="A loss factor of all stiffness, such as 0.02.")] = 0.0,
    out: Out = Path("parflex-frf"),
    image: ImageFormat = "png",
) -> None:
    """Tell how a point of the platform answers forces over frequency, or how much of the floor arrives there.

    By default the compliance of the tool along x, y and z, in the world's axes. A node is called node[5] in
    labels. The responses are saved as real and imaginary parts, with labels and units.

    Examples:

    `parflex frf robot.toml` - the [tool] of the file: bode.png, frf.nc, resonances

    `parflex frf robot.toml --node 3 --band "1..500 Hz"` - another point, a band of one's choice

    `parflex frf robot.toml --from base_x,base_z --to tool_x,tool_z` - what of the floor arrives

    `parflex frf robot.toml --from "force[0]" --to "joint[0],strut[0]"` - a motor, its encoder, its load cell
    """
    from parflex.base.netcdf import saved
    from parflex.views import plot

    check_format(image)
    known_motors(motors)
    how, lin, place, _ = asked(robot, node, motors, out)
    modes = lin.modes()
    omega = frequencies(band_of(band, modes), modes, POINTS)
    inputs = labels_of(from_) or [f"{place.name}_f{axis}" for axis in "xyz"]
    outputs = labels_of(to) or [f"{place.name}_{axis}" for axis in "xyz"]
    found = responses(lin, place, inputs, outputs)(omega, structural)
    found = found.sel(input=inputs, output=outputs)
    drawn = plot.bode(found)
    tell_resonances(modes, omega)
    console.print(escape(f"{largest(found)}, {how}"))
    target = saved(in_parts(found, how), out / "frf.nc")
    [picture] = plot.save({"bode": drawn}, out, image)
    console.print(f"[bold]{escape(str(target))}[/] holds the responses; drawn in {escape(picture.name)}")


def lobes(
    robot: RobotPath,
    stiffness: Annotated[
        str, typer.Option(help='Cutting force per depth and thickness of the chip: "800 N/mm^2", or in N/m².')
    ],
    teeth: Annotated[int, typer.Option(help="Teeth of the cutter.")],
    direction: Annotated[
        str,
        typer.Option(
            help='Direction of force and chip thickness in the world, "0,1,0"; or of each, "0.9,0.4,0;0,1,0".'
        ),
    ],
    speeds: Annotated[str, typer.Option(help='Spindle speeds in 1/min, "1000..12000".')] = "500..12000",
    node: Node = None,
    band: Band = "",
    motors: Motors = "auto",
    out: Out = Path("parflex-lobes"),
    image: ImageFormat = "png",
) -> None:
    """Tell how deep a tool may cut before it chatters, by spindle speed: the stability lobes.

    The stiffness is that of all teeth in the cut together. Below the lowest lobe the cut is stable at any
    speed; between lobes it may be deeper.

    Examples:

    `parflex lobes robot.toml --stiffness "800 N/mm^2" --teeth 4 --direction 0,1,0` - lobes.png, lobes.nc

    `parflex lobes robot.toml --stiffness 8e8 --teeth 2 --direction "0.9,0.4,0;0,1,0" --speeds 2000..20000`
    """
    from parflex.base.kinds import Kind
    from parflex.base.netcdf import saved
    from parflex.files.quantity import convert
    from parflex.linear.figures import compliance
    from parflex.linear.lobes import stability_lobes
    from parflex.views import plot

    check_format(image)
    known_motors(motors)
    kind = Kind("a cutting stiffness", "N/m^2", '8e8 or "800 N/mm^2"')
    try:
        K_s = float(stiffness) if is_number(stiffness) else convert(stiffness, kind)
    except InputError as error:
        raise InputError(f"--stiffness {error}") from None
    low, high = span_of("--speeds", speeds, "1/min")
    how, lin, place, name = asked(robot, node, motors, out)
    modes = lin.modes()
    omega = frequencies(band_of(band, modes), modes, FINE)
    tool = compliance(lin, place.node, place.offset)(omega)
    given = {"stiffness": K_s, "teeth": teeth, "direction": vectors(direction)}
    found = stability_lobes(tool, **given, speeds=np.linspace(low, high, 1000))
    console.print(escape(cut(found, how, name)))
    target = saved(found, out / "lobes.nc")
    [picture] = plot.save({"lobes": plot.lobes(found)}, out, image)
    console.print(f"[bold]{escape(str(target))}[/] holds the lobes; drawn in {escape(picture.name)}")


def asked(robot: Path, node: int | None, motors: str, out: Path) -> tuple[str, "LinearModel", Place, str]:
    """The words for how motors hold, the linear system at home, the point that is asked for, and its name."""
    from parflex.files.robot_file import check_standing, read_robot
    from parflex.model.model import Model

    file = read_robot(robot)
    place = place_of(file, node)
    check_standing(file)
    check_writable(out)
    how, lin = held(Model(file.robot, "numpy"), motors)
    return how, lin, place, place.name


def responses(lin: "LinearModel", place: Place, inputs: list[str], outputs: list[str]) -> Any:
    """The function of omega of the responses that labels name, and of others: to the floor, or to forces.

    Raises InputError where both are named together, and for labels that there are not.
    """
    from parflex.linear.figures import transmissibility
    from parflex.linear.inputs import Actuators, BaseAcceleration, NodeWrench
    from parflex.linear.outputs import FramePose, JointMotion, NodeMotion, StrutForce
    from parflex.linear.system import linear_model

    robot = lin.point.mechanism.robot
    of_floor = BaseAcceleration().labels(robot)
    floor = [label.startswith(FLOOR) for label in inputs]
    if any(floor):
        if not all(floor):
            raise InputError("--from names the floor and forces together; ask for one after the other")
        check_labels("--from", inputs, of_floor)
        named(place, robot, "--to", outputs, (NodeMotion(*place[1:]),))
        of = transmissibility(lin, place.node, place.offset)
    else:
        seen = [NodeMotion(*place[1:], of=of) for of in ("displacement", "velocity", "acceleration")]
        pushed = named(place, robot, "--from", inputs, (Actuators(), NodeWrench(*place[1:])), of_floor)
        every = named(place, robot, "--to", outputs, (*seen, JointMotion(), StrutForce(), FramePose()))
        of = linear_model(lin.point, pushed, every, lin.feedback).frf
    return lambda omega, structural: place.renamed(of(omega, structural=structural))


def named(
    place: Place, robot: Any, option: str, wanted: list[str], signals: Any, others: Sequence[str] = ()
) -> Any:
    """The signals, one of whose labels is wanted; raises InputError for labels that none has, which tells
    others that there are, too."""
    labels = [[place.label(label) for label in signal.labels(robot)] for signal in signals]
    check_labels(option, wanted, [*(label for each in labels for label in each), *others])
    return [signal for signal, each in zip(signals, labels, strict=True) if set(each) & set(wanted)]


def check_labels(option: str, wanted: list[str], known: Any) -> None:
    """Raise InputError for a label that there is not."""
    for label in wanted:
        if label not in known:
            raise InputError(f"{option} names {label!r}, which there is not; there are {', '.join(known)}")


def labels_of(text: str) -> list[str]:
    """The labels of 'a, b'."""
    return [part.strip() for part in text.split(",") if part.strip()]


def vectors(text: str) -> Any:
    """The vector of '0,1,0', or the pair of two with a semicolon between."""
    try:
        found = [[float(part) for part in vector.split(",")] for vector in text.split(";")]
    except ValueError:
        found = []
    if len(found) not in (1, 2) or any(len(vector) != 3 for vector in found):
        raise InputError(f'--direction is {text!r}; give a vector like 0,1,0, or two like "0.9,0.4,0;0,1,0"')
    return found[0] if len(found) == 1 else found


def is_number(text: str) -> bool:
    """True for a number without a unit."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def in_parts(found: Any, how: str) -> Any:
    """Responses as a Dataset of real numbers, which NetCDF and MATLAB hold."""
    import xarray as xr

    parts = {"response_real": (found.real, "real part"), "response_imag": (found.imag, "imaginary part")}
    data = {
        name: (found.dims, part.values, {"long_name": f"response of output to input, {words}"})
        for name, (part, words) in parts.items()
    }
    return xr.Dataset(data, found.coords, {"held": how})


def tell_resonances(modes: Any, omega: Any) -> None:
    """Print the resonances in a band."""
    swing = resonances(modes)
    own = 2 * np.pi * swing.frequency.values
    inside = np.flatnonzero((own >= omega[0]) & (own <= omega[-1]))
    rows: list[tuple[str, ...]] = [
        (str(int(mode.mode)), f"{float(mode.frequency):.5g}", f"{100 * float(mode.damping):.3g}")
        for mode in (swing.isel(mode=i) for i in inside)
    ]
    console.print(table_of(HEADS, rows))


def largest(found: Any) -> str:
    """The largest response of those that have the units of the first, and how much it is of the first, slow
    one."""
    from parflex.views.plot.entries import ratio

    alike = (found.output_units.values[:, None] == found.output_units.values[0]) & (
        found.input_units.values == found.input_units.values[0]
    )
    size = np.where(alike[..., None], np.abs(found.values), -1.0)
    o, i, w = np.unravel_index(int(np.argmax(size)), size.shape)
    unit = ratio(str(found.output_units.values[o]), str(found.input_units.values[i]))
    if size[o, i, w] <= 0:
        return "nothing answers: what would move is held; take other --motors"
    slow, slowest = size[o, i, 0], float(found.frequency.values[0])
    times = f", {size[o, i, w] / slow:.3g} times that at {slowest:.3g} Hz" if slow > 0 else ""
    value, f = f"{size[o, i, w]:.4g} {unit}".removesuffix(" 1"), float(found.frequency.values[w])
    what = f"{found.output.values[o]} to {found.input.values[i]}"
    return f"the largest response is that of {what}, {value} at {f:.4g} Hz{times}"


def cut(found: Any, how: str, name: str) -> str:
    """The depths that are stable, in a sentence."""
    limit = found.limit.values
    text = f"{name} does not chatter at any speed up to a depth of {1e3 * float(found.lowest):.3g} mm, {how}"
    best = int(np.argmax(limit))
    speed = float(found.speed.values[best])
    if not np.isfinite(limit[best]):
        return f"{text}; at {speed:.4g} 1/min no lobe in the band limits it"
    return f"{text}; the best speed is {speed:.4g} 1/min, up to {1e3 * limit[best]:.3g} mm"
