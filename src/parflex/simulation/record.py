"""The labelled dataset of a run: every variable of the table that the run has."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from parflex.base.array import Array
from parflex.base.version import __version__
from parflex.model.core import core_of
from parflex.model.model import Model
from parflex.robot.joint_words import beyond_limits
from parflex.simulation.integrate import Run
from parflex.simulation.laws.controller import Controller
from parflex.simulation.laws.law import Replay
from parflex.simulation.result import FORMAT
from parflex.simulation.variables import ALL_VARIABLES, COORDINATES
from parflex.simulation.variables.legs import side_by_side
from parflex.simulation.variables.recorded import Recorded
from parflex.simulation.variables.variable import Variable

Labelled = tuple[tuple[str, ...], Array, dict[str, str]]  # dimensions, values, attributes
NUMBERED = (
    "leg",
    "actuator",
    "attachment",
    "leg_mode",
    "spring",
)  # dimensions whose entries are numbered from 1


def record(
    model: Model,
    run: Run,
    replay: Replay,
    controller: Controller,
    settings: dict[str, Any],
    variables: Sequence[Variable] = ALL_VARIABLES,
) -> xr.Dataset:
    """The dataset of an integrated run and of what its law did."""
    core, robot = core_of(model), model.robot
    recorded = Recorded(core, run, replay, controller)
    labels = {each.name: labelled(each, recorded) for each in variables}
    data = {name: entry for name, entry in labels.items() if entry is not None}
    sizes = {dim: n for dims, values, _ in data.values() for dim, n in zip(dims, values.shape, strict=True)}
    time, names = COORDINATES
    coords: dict[str, Any] = {
        "time": labelled(time, recorded),
        "axis": list("xyz"),
        "component": ["x", "y", "z", "rx", "ry", "rz"],
        "mode": np.arange(1, robot.platform.modes + 1),
        "actuator_name": (names.dims, names.of(recorded)),
    }
    coords |= {dim: np.arange(1, sizes[dim] + 1) for dim in NUMBERED if dim in sizes}
    attributes = {
        "format": FORMAT,
        "partial": int(bool(run.stopped)),
        "stopped": run.stopped,
        "parflex_version": __version__,
        "backend": core.functions.backend.version(),
        "control": controller.kind or type(controller).__name__,
        "gravity": np.asarray(robot.gravity),
        "beyond_limits": beyond_limits(robot, side_by_side(recorded.joints.q, len(run.t))),
        "units_note": "SI units and radians; Σp is the platform frame, Σ0 the world",
        **settings,
    }
    return xr.Dataset(data, coords, attributes)


def labelled(variable: Variable, recorded: Recorded) -> Labelled | None:
    """The variable as xarray takes it: dimensions, values, attributes; None where the run has none."""
    values = variable.of(recorded)
    if values is None:
        return None
    return variable.dims, values, {"units": variable.units_for(recorded.robot), "long_name": variable.words}
