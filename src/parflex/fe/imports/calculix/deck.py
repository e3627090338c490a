"""The nodes, solids and densities in input decks of CalculiX and Abaqus."""

from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.fe.body.elements import ELEMENTS
from parflex.fe.imports.foreign import read, refusing

SOLIDS = {
    "C3D4": "tet4",
    "C3D6": "wedge6",
    "C3D8": "hex8",
    "C3D10": "tet10",
    "C3D15": "wedge15",
    "C3D20": "hex20",
}
ABAQUS_ORDER = {  # of a solid's nodes, where it is not Nastran's: upper edges before the upright ones
    "wedge15": [*range(9), 12, 13, 14, 9, 10, 11],
    "hex20": [*range(12), 16, 17, 18, 19, 12, 13, 14, 15],
}
# shells, membranes, beams, plane elements, trusses, springs, dashpots, gaps, points
OTHERS = ("S", "M3D", "B", "CP", "CA", "T3D", "DASHPOT", "DCOUP", "GAP", "MASS", "ROTARY", "U")
DEEPEST = 8  # files that include one another


class Keyword(NamedTuple):
    """A keyword, its options, and the fields of its data lines."""

    name: str
    options: dict[str, str]
    data: list[list[str]]


class DeckMaterial(NamedTuple):
    """Density and Young's modulus, in the deck's units; None where not given."""

    density: float | None = None
    young: float | None = None


class Deck(NamedTuple):
    """The model of a deck in its own units; elements by kind, node ids in Nastran's order."""

    ids: Array  # (K,)
    nodes: Array  # (K, 3)
    elements: dict[str, Array]
    materials: dict[str, DeckMaterial]


def read_deck(deck: str | PathLike[str]) -> Deck:
    """The nodes, solids and materials of an input deck.

    Raises InputError where it is missing, damaged, or has masses on points.
    """
    path = Path(deck)
    with refusing(f"inp {path.name} is damaged ({{}}); correct it", ValueError, IndexError, KeyError):
        found = list(keywords(path, DEEPEST))
        places = {
            int(row[0]): [float(value or 0) for value in row[1:4]]
            for keyword in found
            if keyword.name == "NODE"
            for row in keyword.data
        }
        elements: dict[str, list[list[int]]] = {}
        for _, options, data in (keyword for keyword in found if keyword.name == "ELEMENT"):
            kind = solid_kind(path.name, options.get("TYPE", ""))
            if kind:
                elements.setdefault(kind, []).extend(rows_of(kind, data))
        materials = materials_of(path.name, found)
    table = np.array([[*xyz, *[0.0] * (3 - len(xyz))] for xyz in places.values()]).reshape(-1, 3)
    if len(table) == 0 or not np.all(np.isfinite(table)):
        raise InputError(
            f"inp {path.name} has no nodes, or some that are nowhere; give the deck that was solved"
        )
    return Deck(
        ids=np.array(list(places)),
        nodes=table,
        elements={
            kind: np.array(rows)[:, ABAQUS_ORDER.get(kind, slice(None))]
            for kind, rows in elements.items()
            if rows
        },
        materials=materials,
    )


def materials_of(name: str, found: list[Keyword]) -> dict[str, DeckMaterial]:
    """The isotropic materials by name. Raises InputError where a deck has masses on points."""
    materials: dict[str, DeckMaterial] = {}
    current = ""
    for keyword, options, data in found:
        if keyword == "MATERIAL":
            current = options["NAME"].upper()
            materials[current] = DeckMaterial()
        elif keyword == "DENSITY":
            materials[current] = materials[current]._replace(density=float(data[0][0]))
        elif keyword == "ELASTIC" and options.get("TYPE", "ISO").upper().startswith("ISO"):
            materials[current] = materials[current]._replace(young=float(data[0][0]))
        elif keyword in ("MASS", "ROTARYINERTIA"):
            raise InputError(
                f"inp {name} has *{keyword} on points, which is not read here; give the platform "
                f"without it, and add it by FlexibleBody.with_payload"
            )
    return materials


def keywords(path: Path, depth: int) -> Iterator[Keyword]:
    """The keywords of a deck and of those it includes."""
    keyword = Keyword("", {}, [])
    for line in read("inp", path).decode("latin-1").splitlines():
        if line.startswith("**") or not line.strip():
            continue
        fields = [field.strip() for field in line.removeprefix("*").split(",")]
        if not line.startswith("*"):
            keyword.data.append(fields)
            continue
        yield keyword
        pairs = (option.partition("=") for option in fields[1:])
        options = {key.strip().upper(): value.strip() for key, _, value in pairs}
        keyword = Keyword(fields[0].upper().replace(" ", ""), options, [])
        if keyword.name == "INCLUDE":
            if depth == 0:
                raise InputError(f"inp {path.name} includes files that include one another without end")
            yield from keywords(path.parent / options["INPUT"].strip("\"'"), depth - 1)
    yield keyword


def solid_kind(name: str, kind: str) -> str:
    """The kind of a solid from its type, such as C3D20R; empty for what is no solid.

    Raises InputError for a type that is not known.
    """
    plain = kind.upper().rstrip("RIHT")
    if plain not in SOLIDS and not plain.startswith(OTHERS):
        raise InputError(
            f"inp {name} has elements of type {kind or '(none)'}, which is not known here; use solids"
        )
    return SOLIDS.get(plain, "")


def rows_of(kind: str, data: list[list[str]]) -> list[list[int]]:
    """The node numbers of each element, whose lines may go on in the next ones."""
    count = len(ELEMENTS[kind].points) + 1
    numbers = [int(field) for row in data for field in row if field]
    if len(numbers) % count:
        raise ValueError(f"elements of {count - 1} nodes with {len(numbers)} numbers")
    return [numbers[k + 1 : k + count] for k in range(0, len(numbers), count)]
