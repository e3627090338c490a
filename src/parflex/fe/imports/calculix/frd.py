"""Result files of CalculiX (frd, in ASCII): nodes, elements, and the displacements of modes.

Blocks of fixed columns, each of as many lines as its head says (CalculiX CrunchiX USER'S MANUAL,
"Result Format").
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.fe.body.elements import ELEMENTS
from parflex.fe.imports.foreign import BEYOND, SAME, read, refusing

KINDS = {1: "hex8", 2: "wedge6", 3: "tet4", 4: "hex20", 5: "wedge15", 6: "tet10"}
Mode = tuple[int, float, float, Array]  # number, ω², modal mass, displacements (K, 3)
LONG = 1  # the format with numbers of ten digits


class FrdElement(NamedTuple):
    """One element: its kind, the number of its material, its nodes."""

    kind: str
    material: int
    nodes: tuple[int, ...]


class FrdModes(NamedTuple):
    """The modes of an frd file, in its own units."""

    ids: Array  # (K,)
    nodes: Array  # (K, 3)
    elements: tuple[FrdElement, ...]
    materials: dict[int, str]
    shapes: Array  # (P, K, 3)
    squares: Array  # (P,)
    modal_mass: Array  # (P,)


class Block(NamedTuple):
    """A line that says what follows, and the lines that do."""

    head: bytes
    lines: Sequence[bytes]


def read_frd(path: Path) -> FrdModes:
    """The modes of an frd file.

    Raises InputError where the file is missing, damaged, binary, or without modes.
    """
    text = read("frd", path).replace(b"\r\n", b"\n")
    if not text.startswith(b"    1C"):
        raise InputError(
            f"frd {path.name} is no result file of CalculiX; give the .frd file of a *FREQUENCY step"
        )
    name = path.name
    with refusing(f"frd {name} is damaged ({{}}); write it again", ValueError, IndexError, KeyError):
        found = list(blocks(name, text.split(b"\n")))
        ids, nodes = table(name, only(name, found, b"    2C"))
        elements = read_elements(name, only(name, found, b"    3C"))
        modes = mode_blocks(name, found, ids)
        return collected(name, ids, nodes, elements, material_names(found), list(modes))


def blocks(name: str, lines: Sequence[bytes]) -> Iterator[Block]:
    """The heads of a file, with the lines that follow each, up to the end."""
    at = 0
    while at < len(lines) and not lines[at].startswith(b" 9999"):
        head, first = lines[at], at + 1
        at = first
        if head.startswith((b"    2C", b"    3C", b"  100C")):
            if int(head[73:75]) != LONG:
                raise InputError(
                    f"frd {name} is binary or of short format; write it with *NODE FILE, not *NODE OUTPUT"
                )
            while at < len(lines) and lines[at] != b" -3":
                at += 1
            yield Block(head, lines[first:at])
            at += 1
        elif head.startswith((b"    1C", b"    1U", b"    1P")):
            yield Block(head, ())
        else:
            raise InputError(f"frd {name} is damaged in line {at}; write it again")
    if at >= len(lines):
        raise InputError(f"frd {name} has no end; it is cut short: write it again")


def only(name: str, found: Sequence[Block], key: bytes) -> Block:
    """The one block of a kind."""
    some = [block for block in found if block.head.startswith(key)]
    if len(some) != 1:
        raise InputError(f"frd {name} has {len(some)} blocks of nodes or of elements; write one model")
    return some[0]


def material_names(found: Sequence[Block]) -> dict[int, str]:
    """The names of materials by their numbers."""
    heads = [block.head for block in found if block.head.startswith(b"    1UMAT")]
    return {int(head[9:14]): head[14:].decode("latin-1").strip().upper() for head in heads}


def mode_blocks(name: str, found: Sequence[Block], ids: Array) -> Iterator[Mode]:
    """The modes, each told of in lines before its displacements (K, 3)."""
    told: dict[str, float] = {}
    announced = given = 0
    for head, lines in found:
        if head.startswith(b"    1P"):
            key = head[5:10].decode("latin-1").strip()
            told[key] = float(head.split()[1])
            announced += key == "PMODE"
        elif head.startswith(b"  100C") and b"MODAL" in head and lines[0].split()[1] == b"DISP":
            rows = [line for line in lines if not line.startswith((b" -4", b" -5"))]
            nodes, values = table(name, Block(head, rows))
            if not np.array_equal(nodes, ids):
                raise InputError(f"frd {name} has other nodes in a mode than in the mesh; it is damaged")
            given += 1
            yield (*mode_of(name, head, told), values)
    if given != announced:
        raise InputError(f"frd {name} announces {announced} modes and holds {given}; write it again")


def table(name: str, block: Block) -> tuple[Array, Array]:
    """The node numbers (K,) and three values each (K, 3), of as many lines as the head says."""
    count = int(block.head[24:36])
    if len(block.lines) != count or any(len(row) != 49 or row[:3] != b" -1" for row in block.lines):
        raise InputError(f"frd {name} is damaged where {count} nodes are expected; write it again")
    rows = np.frombuffer(b"".join(block.lines), dtype=[("key", "S3"), ("node", "S10"), ("values", "S12", 3)])
    values = rows["values"].astype(float)
    if not np.all(np.abs(values) < BEYOND):
        raise InputError(
            f"frd {name} is damaged where {count} nodes are expected: a value is beyond all bounds"
        )
    return rows["node"].astype(int), values


def read_elements(name: str, block: Block) -> tuple[FrdElement, ...]:
    """Each element: a line of its kind, and lines of its nodes."""
    found, rest = [], iter(block.lines)
    for head in rest:
        kind, material = int(head[13:18]), int(head[23:28])
        if kind not in KINDS:
            raise InputError(
                f"frd {name} has elements that are no solids (type {kind}); write shells and beams as the "
                f"solids that CalculiX makes of them: *NODE FILE, OUTPUT=3D"
            )
        nodes: list[int] = []
        count = len(ELEMENTS[KINDS[kind]].points)
        while len(nodes) < count:
            line = next(rest, b"")
            if not line.startswith(b" -2"):
                raise InputError(f"frd {name} is damaged in an element; write it again")
            nodes += [int(line[k : k + 10]) for k in range(3, len(line), 10)]
        if not len(nodes) == len(set(nodes)) == count:
            raise InputError(f"frd {name} has an element with a node twice or too many; write it again")
        found.append(FrdElement(KINDS[kind], material, tuple(nodes)))
    if len(found) != int(block.head[24:36]):
        raise InputError(f"frd {name} has {len(found)} elements, not as many as it says; write it again")
    return tuple(found)


def mode_of(name: str, line: bytes, told: dict[str, float]) -> tuple[int, float, float]:
    """The number, ω² and modal mass of a mode; the file says ω² as a frequency, too."""
    frequency, mass, stiffness = float(line[12:24]), told["PGM"], told["PGK"]
    square = stiffness / mass
    if not mass > 0 or abs((2 * np.pi * frequency) ** 2 - max(square, 0.0)) > SAME * abs(square) + 1e-12:
        raise InputError(f"frd {name} contradicts itself in the frequency of a mode; it is damaged")
    return int(told["PMODE"]), square, mass


def collected(
    name: str,
    ids: Array,
    nodes: Array,
    elements: tuple[FrdElement, ...],
    materials: dict[int, str],
    modes: list[Mode],
) -> FrdModes:
    """All that was read, where it is one set of modes of one mesh."""
    numbers = [number for number, *_ in modes]
    if not modes or numbers != list(range(1, len(numbers) + 1)):
        raise InputError(
            f"frd {name} holds {len(modes)} modes, numbered {numbers[:3]} …; run one step "
            f"of *FREQUENCY with *NODE FILE and U"
        )
    if len(np.unique(ids)) != len(ids) or not elements:
        raise InputError(f"frd {name} has a node twice, or no elements; write it again")
    return FrdModes(
        ids=ids,
        nodes=nodes,
        elements=elements,
        materials=materials,
        shapes=np.stack([values for *_, values in modes]),
        squares=np.array([square for _, square, _, _ in modes]),
        modal_mass=np.array([mass for _, _, mass, _ in modes]),
    )
