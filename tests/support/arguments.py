"""Kinds of arguments of public callables: a value that each takes, and all that is wrong for it."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

NAN, INF, UP = float("nan"), float("inf"), np.eye(3)
BAD = {"text": "abc", "complex": 1j, "object": object(), "mapping": {}, "ragged": [[1.0], [1.0, 2.0]]}
NONE = {"None": None}


class Argument(NamedTuple):
    """A value that is taken, those that are not, by name, and what names the argument in the complaint."""

    good: Any
    bad: dict[str, Any]
    word: str = ""


class Door(NamedTuple):
    """A callable, its arguments, and those that are neither numbers nor objects of parflex, by name."""

    call: Callable[..., Any]
    takes: dict[str, Argument]
    other: str = ""


def number(
    good: float = 1.0, *, none: bool = False, word: str = "", more: dict[str, Any] | None = None
) -> Argument:
    """One finite number."""
    bad = BAD | {"nan": NAN, "inf": INF, "list": [good, good], "objects": np.array([good], dtype=object)}
    return Argument(good, bad | (more or {}) | ({} if none else NONE), word)


def positive(good: float = 1.0, **known: Any) -> Argument:
    return number(good, more={"zero": 0.0, "negative": -1.0}, **known)


def whole(good: int = 0, *, none: bool = False, word: str = "") -> Argument:
    """A whole number, not negative."""
    bad = BAD | {"nan": NAN, "inf": INF, "half": 1.5, "negative": -1, "flag": True, "list": [good, good]}
    return Argument(good, bad | ({} if none else NONE), word)


def flag(good: bool = True) -> Argument:
    """True or false."""
    return Argument(good, BAD | NONE | {"number": 1, "list": [True]})


def array(good: Any, *, none: bool = False, word: str = "", shape: bool = True) -> Argument:
    """Finite numbers, of a shape that (7, 5) is not."""
    given = np.asarray(good, dtype=float)
    spoilt = {"nan": NAN, "inf": INF, "minus inf": -INF}
    bad = BAD | {name: np.full(given.shape, value) for name, value in spoilt.items()}
    bad |= {"complex array": given * 1j, "objects": given.astype(object), "texts": given.astype(str).tolist()}
    bad |= {"shape": np.ones((7, 5))} if shape else {}
    return Argument(good, bad | ({} if none else NONE), word)


def rotation(good: Any = UP, **known: Any) -> Argument:
    """A rotation matrix: orthonormal, not mirrored."""
    good = np.asarray(good)
    wrong = {"stretched": np.diag([1.0, 1, 2]), "sheared": UP + 0.1 * np.eye(3, k=1)}
    wrong |= {"mirrored": np.diag([1.0, 1, -1]), "zero": np.zeros((3, 3)), "turned over": -UP}
    found = array(good, **known)
    spread = {name: np.broadcast_to(value, good.shape) for name, value in wrong.items()}
    return found._replace(bad=found.bad | spread)


def thing(good: Any, *, none: bool = False, word: str = "", **more: Any) -> Argument:
    """An object of parflex's own."""
    bad = {**BAD, "number": 1.0, "list": [good], **more}
    return Argument(good, bad | ({} if none else NONE), word)


def things(good: Any, *, none: bool = False, word: str = "", **more: Any) -> Argument:
    """A sequence of parflex's own objects."""
    bad = {**BAD, "number": 1.0, "numbers": [1.0], "nothings": [None], **more}
    return Argument(good, bad | ({} if none else NONE), word)


def other(good: Any, *, word: str = "", **bad: Any) -> Argument:
    """What takes values of its own sort."""
    return Argument(good, bad, word)


def vector(size: int) -> Argument:
    """A buffer of a flat call, which reads its contents unchecked."""
    bad = array(np.zeros(size)).bad
    return Argument(
        np.zeros(size), {name: bad[name] for name in bad if "nan" not in name and "inf" not in name}
    )
