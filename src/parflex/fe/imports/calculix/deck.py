"""Input decks of CalculiX and Abaqus, as far as nodes, solids and densities go."""

from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.fe.body.elements import ELEMENTS
from parflex.fe.imports.foreign import briefly

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


class Block(NamedTuple):
    """A keyword, its options, and the fields of its data lines."""

    keyword: str
    options: dict[str, str]
    data: list[list[str]]


class Material(NamedTuple):
    """Density and Young's modulus, in the deck's units; None where not given."""

    density: float | None
    young: float | None


class Deck(NamedTuple):
    """What a deck says, in its own units; elements by kind, node ids in Nastran's order."""

    ids: Array  # (K,)
    nodes: Array  # (K, 3)
    elements: dict[str, Array]
    materials: dict[str, Material]


def read_deck(deck: str | PathLike[str]) -> Deck:
    """Nodes, solids and materials of an input deck.

    Raises InputError where it is missing, damaged, or has masses on points.
    """
    path = Path(deck)
    places: dict[int, list[float]] = {}
    elements: dict[str, list[list[int]]] = {}
    materials: dict[str, Material] = {}
    current = ""
    try:
        for keyword, options, data in blocks(path, DEEPEST):
            if keyword == "NODE":
                places.update((int(row[0]), [float(value or 0) for value in row[1:4]]) for row in data)
            elif keyword == "ELEMENT":
                kind = solid_of(path.name, options.get("TYPE", ""))
                if kind:
                    elements.setdefault(kind, []).extend(rows_of(kind, data))
            elif keyword == "MATERIAL":
                current = options["NAME"].upper()
                materials[current] = Material(None, None)
            elif keyword in ("DENSITY", "ELASTIC"):
                field = {"DENSITY": "density", "ELASTIC": "young"}[keyword]
                if keyword == "DENSITY" or options.get("TYPE", "ISO").upper().startswith("ISO"):
                    materials[current] = materials[current]._replace(**{field: float(data[0][0])})
            elif keyword in ("MASS", "ROTARYINERTIA"):
                raise InputError(
                    f"inp {path.name} has *{keyword} on points, which is not read here; give the platform "
                    f"without it, and add it by FlexibleBody.with_payload"
                )
    except (ValueError, IndexError, KeyError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"inp {path.name} is damaged ({briefly(error)}); correct it") from None
    table = np.array([[*xyz, *[0.0] * (3 - len(xyz))] for xyz in places.values()]).reshape(-1, 3)
    if len(table) == 0 or not np.all(np.isfinite(table)):
        raise InputError(
            f"inp {path.name} has no nodes, or some that are nowhere; give the deck that was solved"
        )
    return Deck(
        ids=np.array(list(places)),
        nodes=table,
        elements={kind: in_order(kind, rows) for kind, rows in elements.items() if rows},
        materials=materials,
    )


def blocks(path: Path, depth: int) -> Iterator[Block]:
    """The keywords of a deck and of those it includes."""
    try:
        lines = path.read_text(encoding="latin-1").splitlines()
    except OSError as error:
        raise InputError(f"inp {path} cannot be read: {error.strerror or error}") from None
    block = Block("", {}, [])
    for line in lines:
        if line.startswith("**") or not line.strip():
            continue
        if not line.startswith("*"):
            block.data.append([field.strip() for field in line.split(",")])
            continue
        yield block
        keyword, *options = (field.strip() for field in line[1:].split(","))
        pairs = (option.partition("=") for option in options)
        block = Block(
            keyword.upper().replace(" ", ""),
            {key.strip().upper(): value.strip() for key, _, value in pairs},
            [],
        )
        if block.keyword == "INCLUDE":
            if depth == 0:
                raise InputError(f"inp {path.name} includes files that include one another without end")
            yield from blocks(path.parent / block.options["INPUT"].strip("\"'"), depth - 1)
    yield block


def solid_of(name: str, kind: str) -> str:
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
    """Node numbers of each element, whose lines may go on in the next ones."""
    count = len(ELEMENTS[kind].points) + 1
    numbers = [int(field) for row in data for field in row if field]
    if len(numbers) % count:
        raise ValueError(f"elements of {count - 1} nodes with {len(numbers)} numbers")
    return [numbers[k + 1 : k + count] for k in range(0, len(numbers), count)]


def in_order(kind: str, rows: list[list[int]]) -> Array:
    """(E, n), in Nastran's order of the nodes."""
    table = np.array(rows)
    return table[:, ABAQUS_ORDER[kind]] if kind in ABAQUS_ORDER else table
