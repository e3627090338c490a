"""The facts of a run that are told first, by whoever shows it."""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr

from parflex.base.array import Array
from parflex.simulation.variables.energy import LEDGER, RESIDUAL


class Fact(NamedTuple):
    """One number with its name and unit; `of` says whose it is, where there are several."""

    name: str
    value: float
    unit: str = ""
    of: str = ""


def scope_of(data: xr.Dataset) -> dict[str, Fact]:
    """The extent of what was simulated, by name: duration, instants, legs, motors, elastic modes."""
    counts = {"instants": "time", "legs": "leg", "motors": "actuator", "elastic modes": "mode"}
    found = [Fact(name, data.sizes[dim]) for name, dim in counts.items() if dim in data.sizes]
    if "time" in data.coords and data.sizes["time"]:
        found.append(Fact("duration", float(data["time"][-1] - data["time"][0]), "s"))
    return {fact.name: fact for fact in found}


def figures_of(data: xr.Dataset) -> list[Fact]:
    """The numbers by which a run is judged, as far as its variables tell them."""
    return [fact for needed, tell in FIGURES.items() if needed in data for fact in tell(data)]


def errors(data: xr.Dataset) -> Iterator[Fact]:
    """The largest differences from the trajectory."""
    pose = np.abs(data["pose_error"].values)
    yield Fact("largest position error", np.max(pose[:, :3], initial=0.0), "m")
    yield Fact("largest attitude error", np.max(pose[:, 3:], initial=0.0), "rad")


def servo_error(data: xr.Dataset) -> Iterator[Fact]:
    """The differences of the actuated joints from what the control wants."""
    error, units = data["joint_error"], str(data["joint_error"].attrs.get("units", ""))
    if error.size:
        yield Fact("largest error of an actuated joint", float(np.max(np.abs(error.values))), units)
        yield Fact("rms error of the actuated joints", float(np.sqrt(np.mean(error.values**2))), units)


def actuator_force(data: xr.Dataset) -> Iterator[Fact]:
    """The largest force of an actuator, and which it is."""
    largest = np.max(np.abs(data["forces"].values), axis=0, initial=0.0)
    if largest.size:
        worst = int(np.argmax(largest))
        name = str(data["actuator_name"].values[worst]) if "actuator_name" in data else f"motor {worst + 1}"
        units = str(data["forces"].attrs.get("units", ""))
        yield Fact("largest actuator force", float(largest[worst]), units, name)


def base_acceleration(data: xr.Dataset) -> Iterator[Fact]:
    """The largest acceleration of the base."""
    yield Fact("largest acceleration of the base", longest(data["base_acceleration"][:, :3]), "m/s²")


def contact_force(data: xr.Dataset) -> Iterator[Fact]:
    """The largest force between a leg and the platform."""
    yield Fact("largest force at a spherical joint", longest(data["contact_forces"]), "N")


def deformation(data: xr.Dataset) -> Iterator[Fact]:
    """The largest deformation where the platform is held."""
    yield Fact("largest deformation at an attachment", 1e3 * longest(data["attachment_deformation"]), "mm")


def leg_deformation(data: xr.Dataset) -> Iterator[Fact]:
    """The largest displacement of a leg's points by bending, and whose it is."""
    moved = np.linalg.norm(data["leg_deformation"].values, axis=-1).max(axis=(0, 2), initial=0.0)
    if moved.size:
        worst = int(np.argmax(moved))
        leg = f"leg {int(data['path_leg'].values[worst])}" if "path_leg" in data else ""
        yield Fact("largest displacement of a leg by bending", 1e3 * float(moved[worst]), "mm", leg)


def balance(data: xr.Dataset) -> Iterator[Fact]:
    """The residual of the energies' balance over the largest change of an energy or work."""
    terms: list[Array] = [data[term.name].values for term in LEDGER if term.name in data]
    change = max((float(np.max(np.abs(term - term[0]))) for term in terms), default=0.0) or 1.0
    residual = float(np.max(np.abs(data[RESIDUAL.name].values)))
    yield Fact("energy balance / largest change", residual / change)


def longest(vectors: xr.DataArray) -> float:
    """The length of the longest vector."""
    return float(np.max(np.linalg.norm(vectors.values, axis=-1), initial=0.0))


FIGURES: dict[str, Callable[[xr.Dataset], Iterator[Fact]]] = {  # by the variable that they need
    "pose_error": errors,
    "joint_error": servo_error,
    "base_acceleration": base_acceleration,
    "forces": actuator_force,
    "contact_forces": contact_force,
    "attachment_deformation": deformation,
    "leg_deformation": leg_deformation,
    RESIDUAL.name: balance,
}
