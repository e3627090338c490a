"""Couplings of joints in robot files, read and written."""

from typing import Annotated, Any

import numpy as np
from pydantic import Field

from parflex.base import kinds
from parflex.files.tables import Measure, Table, Whole
from parflex.robot.coupling import Coupling

Entry = Annotated[float, Measure(kinds.NUMBER)]
Square = list[list[Entry]]


class CouplingTable(Table):
    """A stiffness and damping on joints of a leg together, each the antecedent of the next; SI units."""

    joints: list[Whole] = Field(min_length=1, description="their numbers in the chain, from 1")
    stiffness: Square = Field(description="K, a row for each joint: N/m, N/rad and N m/rad")
    damping: Square | None = Field(None, description="D, likewise")
    rest: list[Entry] | None = Field(None, description="joint values without load, m and rad; by default 0")


def coupling_of(row: CouplingTable) -> Coupling:
    """The coupling of a table; raises InputError as `Coupling`."""
    more = {name: vars(row)[name] for name in ("damping", "rest") if vars(row)[name] is not None}
    return Coupling(tuple(row.joints), row.stiffness, **more)


def coupling_entries(coupling: Coupling) -> dict[str, Any]:
    """The table of a coupling, without what is by default."""
    row: dict[str, Any] = {"joints": list(coupling.joints)}
    for name in ("stiffness", "damping", "rest"):
        value = np.asarray(getattr(coupling, name))
        if name == "stiffness" or np.any(value):
            row[name] = value.tolist()
    return row
