"""Small motions of a robot as the page swings them: its modes, and how it gives under a static load."""

from typing import NamedTuple

from parflex.base.array import Array
from parflex.linear.system import LinearModel
from parflex.simulation.holding import growth, row_of, swinging

HEADS = ("mode", "Hz", "damping %", "platform", "legs", "drives", "other")


class Swing(NamedTuple):
    """A motion δ cos φ − δ' sin φ of displacements (6 + N + z,), or a ramp from none to δ."""

    title: str
    row: tuple[str, ...]  # of the table
    shape: Array  # δ
    quarter: Array | None = None  # δ', none of a ramp
    hertz: float = 0.0


class Force(NamedTuple):
    """A force of a load, in the world, and what it does to its point."""

    place: Array  # (3,) m
    force: Array  # (3,) N
    moved: Array  # (3,) m


class Swings(NamedTuple):
    """The motions of a robot about an equilibrium, the table that lists them, and what is to be said."""

    lin: LinearModel
    swings: list[Swing]
    heads: tuple[str, ...]
    rows: list[tuple[str, ...]]
    notes: tuple[str, ...]
    facts: tuple[str, ...] = ()  # about the robot
    forces: tuple[Force, ...] = ()  # of a load


def modes_as_swings(lin: LinearModel, facts: tuple[str, ...] = ()) -> Swings:
    """The modes that swing, the lowest first."""
    modes = lin.modes()
    found = [
        Swing(
            f"mode {i + 1}: {float(modes.frequency[i]):.4g} Hz",
            row_of(modes, i),
            modes["shape"].values[i],
            modes.shape_imag.values[i],
            float(modes.frequency[i]),
        )
        for i in swinging(modes)
    ]
    notes = []
    if growing := growth(modes):
        notes.append(f"Unstable: a motion grows e-fold in {1 / growing:.3g} s.")
    if not found:
        notes.append("Nothing swings: the robot has no modes as it is held.")
    rows = [each.row for each in found]
    return Swings(lin, found, HEADS, rows, tuple(notes), facts)
