"""Result files of CalculiX (frd, in ASCII): nodes, elements, and the displacements of modes.

Blocks of fixed columns, each of as many lines as its head says (CalculiX CrunchiX USER'S MANUAL,
"Result Format").
"""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from parflex.array import Array
from parflex.errors import InputError

KINDS = {1: "hex8", 2: "wedge6", 3: "tet4", 4: "hex20", 5: "wedge15", 6: "tet10"}
COUNTS = {1: 8, 2: 6, 3: 4, 4: 20, 5: 15, 6: 10}
LONG = 1  # the format with numbers of ten digits
SAME = 1e-4  # numbers that the file holds twice


class FrdElement(NamedTuple):
    """One element: its kind, the number of its material, its nodes."""

    kind: str
    material: int
    nodes: tuple[int, ...]


class FrdModes(NamedTuple):
    """What an frd file says of modes, in its own units."""

    ids: Array  # (K,)
    nodes: Array  # (K, 3)
    elements: tuple[FrdElement, ...]
    materials: dict[int, str]
    shapes: Array  # (P, K, 3)
    squares: Array  # (P,)
    modal_mass: Array  # (P,)


class Mode(NamedTuple):
    """The head of a block of displacements."""

    number: int
    square: float
    mass: float


def read_frd(path: Path) -> FrdModes:
    """The modes of an frd file.

    Raises InputError where the file is missing, damaged, binary, or without modes.
    """
    try:
        text = path.read_bytes().replace(b"\r\n", b"\n")
    except OSError as error:
        raise InputError(f"frd {path} cannot be read: {error.strerror or error}") from None
    try:
        return parsed(path.name, text.split(b"\n"))
    except (ValueError, IndexError, KeyError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"frd {path.name} is damaged ({error}); write it again") from None


def parsed(name: str, lines: Sequence[bytes]) -> FrdModes:
    """The modes of the lines of a file."""
    ids, nodes = np.zeros(0, dtype=int), np.zeros((0, 3))
    elements: tuple[FrdElement, ...] = ()
    materials: dict[int, str] = {}
    modes: list[tuple[Mode, Array]] = []
    told: dict[str, float] = {}
    at = announced = 0
    if not lines[0].startswith(b"    1C"):
        raise InputError(f"frd {name} is no result file of CalculiX; give the .frd file of a *FREQUENCY step")
    while at < len(lines) and not lines[at].startswith(b" 9999"):
        line, at = lines[at], at + 1
        if line.startswith(b"    1UMAT"):
            materials[int(line[9:14])] = line[14:].decode("latin-1").strip().upper()
        elif line.startswith(b"    2C"):
            check_ascii(name, line)
            ids, nodes = table(name, lines, at, int(line[24:36]))
            at += len(ids)
        elif line.startswith(b"    3C"):
            check_ascii(name, line)
            elements, at = read_elements(name, lines, at, int(line[24:36]))
        elif line.startswith(b"    1P"):
            key = line[5:10].decode("latin-1").strip()
            told[key] = float(line.split()[1])
            announced += key == "PMODE"
        elif line.startswith(b"  100C"):
            check_ascii(name, line)
            count = int(line[24:36])
            head = at
            while lines[at].startswith((b" -4", b" -5")):
                at += 1
            if b"MODAL" in line and lines[head].split()[1] == b"DISP":
                found, values = table(name, lines, at, count)
                if not np.array_equal(found, ids):
                    raise InputError(f"frd {name} has other nodes in a mode than in the mesh; it is damaged")
                modes.append((mode_of(name, line, told), values))
            at += count
        elif line != b" -3" and not line.startswith((b"    1C", b"    1U")):
            raise InputError(f"frd {name} is damaged in line {at}; write it again")
    if at >= len(lines):
        raise InputError(f"frd {name} has no end; it is cut short: write it again")
    if len(modes) != announced:
        raise InputError(f"frd {name} announces {announced} modes and holds {len(modes)}; write it again")
    return collected(name, ids, nodes, elements, materials, modes)


def check_ascii(name: str, line: bytes) -> None:
    """Numbers of a block are written out, with ten digits for a node."""
    if int(line[73:75]) != LONG:
        raise InputError(
            f"frd {name} is binary or of short format; write it with *NODE FILE instead of *NODE OUTPUT"
        )


def table(name: str, lines: Sequence[bytes], first: int, count: int) -> tuple[Array, Array]:
    """Node numbers (K,) and three values each (K, 3), of lines of equal length."""
    block = lines[first : first + count]
    whole = len(block) == count and first + count < len(lines) and lines[first + count] == b" -3"
    if not whole or any(len(line) != 49 or not line.startswith(b" -1") for line in block):
        raise InputError(f"frd {name} is damaged after line {first}, where {count} nodes are expected")
    rows = np.frombuffer(b"".join(block), dtype=[("key", "S3"), ("node", "S10"), ("values", "S12", 3)])
    return rows["node"].astype(int), rows["values"].astype(float)


def read_elements(
    name: str, lines: Sequence[bytes], at: int, count: int
) -> tuple[tuple[FrdElement, ...], int]:
    """The elements of a block, and the line after it."""
    found = []
    for _ in range(count):
        head, at = lines[at], at + 1
        kind, material = int(head[13:18]), int(head[23:28])
        if kind not in KINDS:
            raise InputError(
                f"frd {name} has elements that are no solids (type {kind}); write shells and beams as the "
                f"solids that CalculiX makes of them: *NODE FILE, OUTPUT=3D"
            )
        nodes: list[int] = []
        while len(nodes) < COUNTS[kind]:
            if not lines[at].startswith(b" -2"):
                raise InputError(f"frd {name} is damaged in line {at + 1}; write it again")
            nodes += [int(lines[at][k : k + 10]) for k in range(3, len(lines[at]), 10)]
            at += 1
        found.append(FrdElement(KINDS[kind], material, tuple(nodes)))
    if lines[at] != b" -3":
        raise InputError(f"frd {name} is damaged in line {at + 1}, where its elements end; write it again")
    return tuple(found), at


def mode_of(name: str, line: bytes, told: dict[str, float]) -> Mode:
    """Number, ω² and modal mass of a mode; the file says ω² as a frequency, too."""
    frequency, mass, stiffness = float(line[12:24]), told["PGM"], told["PGK"]
    square = stiffness / mass
    if not mass > 0 or abs((2 * np.pi * frequency) ** 2 - max(square, 0.0)) > SAME * abs(square) + 1e-12:
        raise InputError(f"frd {name} contradicts itself in the frequency of a mode; it is damaged")
    return Mode(int(told["PMODE"]), square, mass)


def collected(
    name: str,
    ids: Array,
    nodes: Array,
    elements: tuple[FrdElement, ...],
    materials: dict[int, str],
    modes: list[tuple[Mode, Array]],
) -> FrdModes:
    """All that was read, where it is one set of modes of one mesh."""
    numbers = [mode.number for mode, _ in modes]
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
        shapes=np.stack([values for _, values in modes]),
        squares=np.array([mode.square for mode, _ in modes]),
        modal_mass=np.array([mode.mass for mode, _ in modes]),
    )
