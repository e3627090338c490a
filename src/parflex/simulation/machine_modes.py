"""The modes of the whole machine at home, kept with the result of a run."""

from typing import TYPE_CHECKING, Any

import numpy as np

from parflex.base.errors import InputError
from parflex.simulation.holding import held, row_of, swinging

if TYPE_CHECKING:
    from parflex.model.model import Model

MOST = 20
NAMES = {
    "machine_mode": "mode",
    "machine_part": "part",
    "machine_frequency": "frequency",
    "machine_damping": "damping",
    "machine_share": "share",
}
HELD = "machine_held"  # the attribute that says in words how the motors hold the robot


def add_machine_modes(data: Any, model: "Model") -> None:
    """Put the lowest twenty modes of the robot at home into a result's dataset, as `parflex vibrate` tells
    them: machine_frequency (machine_mode) Hz, machine_damping and machine_share (machine_mode,
    machine_part).

    Nothing is put where the robot has no equilibrium at home, or nothing swings.
    """
    try:
        how, lin = held(model, "auto")
    except InputError:
        return
    modes = lin.modes()
    which = swinging(modes)[:MOST]
    if len(which):
        some = modes[["frequency", "damping", "share"]].isel(mode=which)
        data.update(some.rename({each: name for name, each in NAMES.items()}))
        data.attrs[HELD] = how


def machine_rows(data: Any) -> list[tuple[str, ...]]:
    """Number, frequency in Hz, damping in percent and shares of each mode; none where the result has none."""
    if not set(NAMES) <= set(data.variables) or not np.all(np.isfinite(data["machine_frequency"])):
        return []
    names = ["machine_frequency", "machine_damping", "machine_share"]
    modes = data[names].rename(NAMES)
    return [row_of(modes, i) for i in range(modes.sizes["mode"])]
