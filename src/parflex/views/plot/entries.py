"""The entries of frequency responses that a picture shows: chosen by label, with their units."""

from collections.abc import Mapping, Sequence
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.nearest import nearest
from parflex.views.plot.canvas import COLOURS

MOST = 36  # entries in one picture
NOTHING = 1e-9  # of the largest response in the same units: one that symmetry makes zero
DIMS = ("output", "input", "omega")
UNIT_OF_GAIN = "1"


class Entry(NamedTuple):
    """The response of an output to an input, of several systems."""

    output: str
    input: str
    unit: str
    curves: dict[str, tuple[Array, Array]]  # by system: frequencies (w,) Hz and responses (w,)
    silent: bool  # nothing but round-off


def entries_of(
    frf: Any, outputs: Sequence[str] | None, inputs: Sequence[str] | None
) -> tuple[list[list[Entry]], list[str]]:
    """The entries in rows of outputs, and the names of the systems.

    Raises InputError for what is no frequency response, labels that there are not, and more entries or
    systems than a picture holds.
    """
    given = {name: whole(name, each) for name, each in named(frf).items()}
    first = next(iter(given.values()))
    rows = chosen("outputs", outputs, first.output.values)
    columns = chosen("inputs", inputs, first.input.values)
    if len(rows) * len(columns) > MOST:
        raise InputError(
            f"frf has {len(rows)} outputs and {len(columns)} inputs, and a picture holds {MOST} entries; "
            f"choose some with outputs=[…] and inputs=[…], such as outputs=[{rows[0]!r}]"
        )
    for name, each in given.items():
        chosen(f"outputs of {name!r}", rows, each.output.values)
        chosen(f"inputs of {name!r}", columns, each.input.values)
    found = [[entry(given, o, i) for i in columns] for o in rows]
    largest: dict[str, float] = {}
    for each in chain(*found):
        largest[each.unit] = max(largest.get(each.unit, 0.0), size(each))
    every = [
        [each._replace(silent=size(each) <= NOTHING * largest[each.unit]) for each in row] for row in found
    ]
    return every, list(given)


def named(frf: Any) -> dict[str, Any]:
    """Responses by the names of their systems; a single one has an empty name."""
    given = dict(frf) if isinstance(frf, Mapping) else {"": frf}
    if not 1 <= len(given) <= len(COLOURS):
        raise InputError(f"frf holds {len(given)} systems; give one to {len(COLOURS)}, by name")
    return given


def whole(name: str, frf: Any) -> Any:
    """The response with all three dimensions, above zero frequency, in their order."""
    words = f"frf{name and f'[{name!r}]'}"
    if not {"omega"} <= set(getattr(frf, "dims", ())) or not set(DIMS) <= set(getattr(frf, "coords", ())):
        raise InputError(f"{words} is no response (output, input, omega); give what lin.frf(omega) returns")
    for dim in ("output", "input"):
        frf = frf if dim in frf.dims else frf.expand_dims(dim)
    frf = frf.transpose(*DIMS).sortby("omega")
    frf = frf.isel(omega=frf.omega.values > 0)
    if frf.sizes["omega"] < 2:
        raise InputError(f"{words} has fewer than two frequencies above zero; give a band")
    if not np.all(np.isfinite(frf.values)):
        raise InputError(f"{words} holds values that are not finite; leave those frequencies out")
    return frf


def chosen(what: str, wanted: Sequence[str] | None, known: Any) -> list[str]:
    """The labels that are wanted, by default all."""
    labels = [str(label) for label in known]
    given = [wanted] if isinstance(wanted, str) else labels if wanted is None else list(wanted)
    for label in given:
        if label not in labels:
            close = nearest(str(label), labels)
            known = f"did you mean {close!r}?" if close else f"there are {', '.join(labels)}"
            raise InputError(f"{what} names {label!r}, which there is not; {known}")
    if not given:
        raise InputError(f"{what} is empty; name one at least")
    return given


def entry(given: dict[str, Any], output: str, input: str) -> Entry:
    """The response of one output to one input, of all systems."""
    curves, unit = {}, ""
    for name, frf in given.items():
        one = frf.sel(output=output, input=input)
        curves[name] = (one.omega.values / (2 * np.pi), one.values)
        if "output_units" in one.coords and "input_units" in one.coords:
            unit = ratio(*(str(one.coords[f"{side}_units"].item()) for side in ("output", "input")))
    return Entry(output, input, unit, curves, False)


def common(labels: list[str]) -> str:
    """The part that all labels begin with, up to an underscore, such as "node[5]_"."""
    heads = {label[: label.rfind("_") + 1] for label in labels}
    return heads.pop() if len(heads) == 1 else ""


class Words(NamedTuple):
    """The names of entries in pictures: the beginning that all labels share is told once."""

    outputs: str  # what all outputs begin with
    inputs: str

    @staticmethod
    def of(rows: list[list[Entry]]) -> "Words":
        """The names of entries in rows of outputs."""
        return Words(common([row[0].output for row in rows]), common([each.input for each in rows[0]]))

    def entry(self, entry: Entry) -> str:
        """The entry without that."""
        return f"{entry.input.removeprefix(self.inputs)} → {entry.output.removeprefix(self.outputs)}"

    @property
    def place(self) -> str:
        """The shared beginnings, for a title; empty where there are none."""
        ends = [part.removesuffix("_") for part in (self.inputs, self.outputs)]
        return "" if not any(ends) else f" of {ends[0]}" if ends[0] == ends[1] else f", {told(*ends)}"


def told(inputs: str, outputs: str) -> str:
    """The places of inputs and outputs."""
    parts = (("inputs at", inputs), ("outputs at", outputs))
    return ", ".join(f"{words} {place}" for words, place in parts if place)


def size(entry: Entry) -> float:
    """The largest magnitude of all systems."""
    return max(float(np.max(np.abs(values))) for _, values in entry.curves.values())


def ratio(output: str, input: str) -> str:
    """The unit of a response, as it is printed; "1" where both are alike."""
    if output == input:
        return UNIT_OF_GAIN
    above, below = (raised(unit) for unit in (output, input))
    above = f"({above})" if "/" in above else above
    return f"{above}/({below})" if set(below) & set("/ ") else f"{above}/{below}"


def raised(unit: str) -> str:
    """A unit with its exponents above the line."""
    return unit.replace("^2", "²").replace("^4", "⁴")
