"""Texts of files with what people, programs and attackers put into them."""

import re

import numpy as np
import xarray as xr

from spoil import spoilt

NUMBER = re.compile(r'(?<![\w".])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])')
QUOTED = re.compile(r'"[^"\n]*"')

VALUES = (
    *("1e308", "-1e308", "1e-300", "1e400", "-0.0", "nan", "inf", "-inf", "5e-324", "0", "-1", "7", "true"),
    *("[]", "{}", '""', '"a\\u0000b"', '"3 furlong"', '"1 kg**9**9**9"', '"1 m^9^9^9"', '"1 (m**99)**99"'),
    *("9223372036854775807", "9223372036854775808", "0x" + "f" * 400, "2030-01-01", '"1e999 m"', '"é"'),
    *("[[1, 0, 0], [0, 1, 0], [0, 0, 2]]", "[[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]", "[0, 0, 1e300]"),
    *(
        "[[1, 0, 0], [0, 1, 0], [0, 0, -1]]",
        "[" * 80 + "]" * 80,
        '"' + "1" * 500 + '"',
        '"1 ' + "k" * 500 + '"',
    ),
)


def hostile(text: str, rng: np.random.Generator) -> bytes:
    """The text with one to three things changed: numbers up to 1e400, values, keys, lines, bytes."""
    for _ in range(int(rng.integers(1, 4))):
        text = CHANGES[int(rng.integers(len(CHANGES)))](text, rng)
    data = text.encode()
    return spoilt(data, rng) if rng.random() < 0.2 else data


def replaced(text: str, pattern: re.Pattern, new: str, rng: np.random.Generator) -> str:
    """One match of the pattern, by chance, replaced."""
    found = list(pattern.finditer(text))
    if not found:
        return text
    one = found[int(rng.integers(len(found)))]
    return text[: one.start()] + new + text[one.end() :]


def large(text: str, rng: np.random.Generator) -> str:
    """A whole number of up to 400 digits, now and then of 5000."""
    digits = 5000 if rng.random() < 0.05 else int(rng.integers(1, 401))
    return replaced(text, NUMBER, "".join(map(str, rng.integers(1, 10, digits))), rng)


def real(text: str, rng: np.random.Generator) -> str:
    """A real number of any size."""
    return replaced(text, NUMBER, f"{rng.normal():.3f}e{int(rng.integers(-330, 400))}", rng)


def value(text: str, rng: np.random.Generator) -> str:
    """Another kind of value, for a number or for a text."""
    new = VALUES[int(rng.integers(len(VALUES)))]
    return replaced(text, NUMBER if rng.random() < 0.6 else QUOTED, new, rng)


def line(text: str, rng: np.random.Generator) -> str:
    """A line lost, doubled, or moved."""
    lines = text.split("\n")
    at, to = rng.integers(len(lines), size=2)
    one = lines.pop(int(at))
    lines[int(to) : int(to)] = [one] * int(rng.integers(3))
    return "\n".join(lines)


def key(text: str, rng: np.random.Generator) -> str:
    """A key misspelt, or made of many."""
    new = ("x", "a.b", '"c d"', ".".join("k" * 60), "#")[int(rng.integers(5))]
    return replaced(text, re.compile(r"(?m)^\w+(?= =)"), new, rng)


def editor(text: str, rng: np.random.Generator) -> str:
    """A byte order mark, other line ends, a NUL."""
    return ("\ufeff" + text, text.replace("\n", "\r\n"), text.replace(" ", "\0", 1))[int(rng.integers(3))]


CHANGES = (large, real, value, line, key, editor)


def other_dataset(data: xr.Dataset, rng: np.random.Generator) -> xr.Dataset:
    """A dataset that lacks an attribute or a variable, or has another in its place."""
    names, attrs = sorted(map(str, data.variables)), sorted(data.attrs)
    name, attr = names[int(rng.integers(len(names)))], attrs[int(rng.integers(len(attrs)))]
    match int(rng.integers(7)):
        case 0:
            return data.drop_attrs(deep=False).assign_attrs(
                {k: v for k, v in data.attrs.items() if k != attr}
            )
        case 1:
            return data.assign_attrs({attr: (3.5, "word", -1, np.zeros(3), "")[int(rng.integers(5))]})
        case 2:
            return data.drop_vars(name)
        case 3:
            return data.drop_vars(name).assign({name: ("other", np.arange(3.0))})
        case 4:
            words = data[name].dtype.kind in "US"
            return data.assign({name: (data[name].dims, np.full(data[name].shape, 0.5 if words else "word"))})
        case 5:
            dims = sorted(map(str, data.sizes))
            return data.isel({dims[int(rng.integers(len(dims)))]: slice(0, int(rng.integers(2)))})
        case _:
            values = data[name].values.copy()
            if values.dtype.kind in "if" and values.size:
                values.flat[int(rng.integers(values.size))] = (10**6, -7)[int(rng.integers(2))]
            return data.assign({name: (data[name].dims, values)})
