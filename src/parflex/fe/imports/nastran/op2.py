"""Modes in an OUTPUT2 file of Nastran, read by pyYeti once its frame is known to be whole."""

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.fe.imports.foreign import BEYOND, SAME, read
from parflex.fe.imports.nastran.pyyeti import nastran

DISPLACEMENTS = ("OUGV1", "OUG1", "BOUGV1", "BOPHIG")  # the last two in the basic coordinate system
SUPERELEMENT_TABLES = ("SELIST", "EMAP", "MAPS", "GEOM1S", "BGPDTS", "EQEXINS")
REAL_MODES = 2  # approach code
TABLES = (1, 7)  # table codes of displacements and eigenvectors


class Op2Modes(NamedTuple):
    """The modes of an OP2 file, in its own units and output coordinate systems."""

    ids: Array  # (K,)
    shapes: Array  # (P, K, 3)
    rotations: Array  # (P, K, 3)
    squares: Array  # (P,)
    modal_mass: Array | None  # (P,) generalised masses
    weights: Array | None  # (6, 6) of the grid point weight generator, about its reference point
    basic: bool


class Words(NamedTuple):
    """NumPy's names of the integers and reals that a file holds."""

    integer: str
    real: str


def read_op2(path: Path) -> Op2Modes:
    """The modes of an OP2 file.

    Raises InputError where the file is missing, damaged, of superelements, or without modes.
    """
    words = check_frame(path)
    reader = nastran("op2")
    try:
        with reader.OP2(str(path)) as file:
            return modes_in(path.name, file, words)
    except InputError:
        raise
    except Exception as error:  # pyYeti raises many kinds for a damaged file
        raise InputError(f"op2 {path.name} is damaged ({type(error).__name__}); write it again") from None


def check_frame(path: Path) -> Words:
    """The byte order and word size of a file whose records all fit.

    After a key n > 0 comes a record of n words, else another key; each between its lengths.
    """
    data = read("op2", path)
    for order in "<>":
        if len(data) >= 4 and (size := struct.unpack(order + "i", data[:4])[0]) in (4, 8):
            break
    else:
        raise InputError(f"op2 {path.name} is no OUTPUT2 file; ask Nastran for PARAM,POST,-1")
    words = Words(f"{order}i{size}", f"{order}f{size}")
    at = key = 0
    while at < len(data):
        length = size * key if key > 0 else size
        end = at + 8 + length
        if not data[at : at + 4] == data[end - 4 : end] == struct.pack(order + "i", length):
            break
        key = 0 if key > 0 else int(np.frombuffer(data[at + 4 : end - 4], words.integer)[0])
        at = end
    if at < len(data) or key != 0:
        raise InputError(
            f"op2 {path.name} is damaged or cut short at byte {at} of {len(data)}; write it again"
        )
    return words


def modes_in(name: str, file: Any, words: Words) -> Op2Modes:
    """The modes of an opened file."""
    tables = set(file.dbdct)
    if apart := sorted(tables & set(SUPERELEMENT_TABLES)):
        raise InputError(
            f"op2 {name} is of a model in superelements ({', '.join(apart)}); solve the model in one piece"
        )
    shown = [table for table in DISPLACEMENTS if table in tables]
    if not shown:
        raise InputError(
            f"op2 {name} holds no modes (tables: {', '.join(sorted(tables)) or 'none'}); run SOL 103 with "
            f"DISPLACEMENT(PLOT) = ALL and PARAM,POST,-1"
        )
    modes = list(displacements(name, file, shown[0], words))
    numbers = [number for number, *_ in modes]
    if not numbers or np.any(np.diff(numbers) != 1):
        raise InputError(
            f"op2 {name} has {len(numbers)} modes, numbered {numbers[:3]} …; run one subcase of SOL 103"
        )
    ids = modes[0][2]
    if any(not np.array_equal(ids, other) for _, _, other, _ in modes):
        raise InputError(f"op2 {name} has other nodes in one mode than in another; it is damaged")
    values = np.stack([motion for *_, motion in modes])
    squares = np.array([square for _, square, _, _ in modes])
    weights = file.rdop2gpwg() if "OGPWG" in tables else None
    return Op2Modes(
        ids=ids,
        shapes=values[..., :3],
        rotations=values[..., 3:],
        squares=squares,
        modal_mass=generalised_masses(name, file, squares, words),
        weights=None if weights is None else np.array(weights["m66"], dtype=float),
        basic=shown[0].startswith("B"),
    )


def displacements(
    name: str, file: Any, table: str, words: Words
) -> Iterator[tuple[int, float, Array, Array]]:
    """The number, ω², node numbers (K,) and motion (K, 6) of each mode."""
    for block in file.dbdct[table]:
        file.set_position(block.start)
        file.rdop2nt()
        while (ident := file.rdop2record("bytes")) is not None:
            data = file.rdop2record("bytes")
            code = np.frombuffer(ident, words.integer)
            square = float(np.frombuffer(ident, words.real)[5])
            real = (code[0] // 10, code[8], code[9]) == (REAL_MODES, 1, 8)
            if not real or code[1] % 1000 not in TABLES:
                raise InputError(
                    f"op2 {name} holds {table} of another analysis than real modes (approach "
                    f"{code[0] // 10}, table {code[1]}, format {code[8]}); run SOL 103"
                )
            rows = np.frombuffer(data, words.integer).reshape(-1, 8)
            values = np.frombuffer(data, words.real).reshape(-1, 8)[:, 2:].astype(float)
            grid = rows[:, 1] == 1
            if not np.all(grid | (rows[:, 1] == 2)):
                raise InputError(f"op2 {name} is damaged in mode {code[4]}: a node is of no known type")
            if not np.all(np.abs(values[grid]) < BEYOND) or not abs(square) < BEYOND:
                raise InputError(f"op2 {name} is damaged in mode {code[4]}: a value is beyond all bounds")
            yield int(code[4]), square, rows[grid, 0] // 10, values[grid]


def generalised_masses(name: str, file: Any, squares: Array, words: Words) -> Array | None:
    """The modal masses (P,) from the table of real eigenvalues; None where there is none.

    It says λ, ω, f, μ and λ μ, of which only λ and μ are news: the rest tells whether it is whole.
    """
    if "LAMA" not in file.dbdct:
        return None
    file.set_position("LAMA")
    file.rdop2nt()
    file.rdop2record("bytes")
    kind = np.dtype([("order", words.integer, 2), ("reals", words.real, 5)])
    table = np.frombuffer(file.rdop2record("bytes"), kind)["reals"].astype(float)
    if len(table) < len(squares):
        raise InputError(
            f"op2 {name} has {len(squares)} modes, but frequencies of {len(table)}; write it again"
        )
    value, omega, cycles, mass, stiffness = table[: len(squares)].T
    size = np.max(np.abs(squares))
    twice = np.stack(
        [
            (value - squares) / size,
            (omega**2 - np.abs(value)) / size,
            (2 * np.pi * cycles - omega) / np.sqrt(size),
            (stiffness - value * mass) / np.max(np.abs(value * mass)),
        ]
    )
    if not np.all(np.abs(twice) <= SAME) or not np.all(mass > 0):
        raise InputError(f"op2 {name} contradicts itself in the table of eigenvalues; it is damaged")
    return mass
