"""The cards of Nastran's bulk data, which pyYeti reads."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.fe.imports.foreign import encoding_of, refusing
from parflex.fe.imports.nastran.pyyeti import nastran
from parflex.fe.imports.unit_systems import Units

Card = list[Any]

CARDS = r"^(GRID|GRDSET|PARAM|CORD|CONM|MAT[0-9]|P[A-Z]|C[A-Z]|SE|ENDDATA)"


@dataclass(frozen=True)
class Bulk:
    """Cards by name, and the values of parameters."""

    name: str
    cards: dict[str, list[Card]]
    units: Units

    def of(self, name: str) -> list[Card]:
        """All cards of a name."""
        return self.cards.get(name, [])

    def parameter(self, name: str, default: float) -> float:
        """The last PARAM of a name."""
        values = [card[1] for card in self.of("PARAM") if str(card[0]).upper() == name and len(card) > 1]
        return self.number("PARAM " + name, values[-1]) if values else default

    def number(self, what: str, value: Any) -> float:
        """A field as a finite number; blank is 0."""
        if value == "":
            return 0.0
        if isinstance(value, (int, float)) and np.isfinite(value):
            return float(value)
        raise InputError(f"bulk {self.name} has {value!r} where {what} needs a number")

    def fields(self, card: Card, first: int, count: int, what: str) -> Array:
        """Fields as numbers; those that are not there are 0."""
        values = [*card, *[""] * (first + count)][first : first + count]
        return np.array([self.number(what, value) for value in values])

    def by_id(self, *names: str) -> dict[int, tuple[str, Card]]:
        """Cards by their first field."""
        return {
            int(self.fields(card, 0, 1, name)[0]): (name, card) for name in names for card in self.of(name)
        }


def cards_of(path: Path) -> dict[str, list[Card]]:
    """All cards of a file and of those it includes, by name."""
    rdcards = nastran("bulk").rdcards
    options = {"regex": True, "return_var": "list", "blank": ""}
    with refusing(f"bulk {path.name} cannot be read ({{}}); write it again", Exception):
        try:
            options["encoding"] = encoding_of(path)
            first = rdcards(str(path), CARDS, keep_name=True, **options) or []
            names = {str(card[0]).rstrip("*").strip().upper() for card in first}
            # names and fields apart: with both, pyYeti 1.4 misplaces fields of continued free-format cards
            return {n: rdcards(str(path), rf"^{re.escape(n)}\s*([*,\s]|$)", **options) or [] for n in names}
        except OSError as error:
            raise InputError(
                f"bulk {error.filename or path} cannot be read: {error.strerror or error}"
            ) from None
