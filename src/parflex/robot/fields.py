"""Fields that are declared once: each says what it holds, how it is checked and who else uses it.

A dataclass of the robot's data declares its fields by the functions below. Whoever needs a list of
them reads `described`: the checks, the tables of a chain, parameters, robot files, the documentation.
"""

from collections.abc import Callable
from dataclasses import MISSING, dataclass, field, fields
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import NOT_NEGATIVE, Rule, exactly, finite, integer, obeying, of_type, scalar
from parflex.base.errors import InputError
from parflex.base.kinds import NUMBER, ByType, Kind
from parflex.base.plausible import usual

SEVERAL = (-1,)  # the shape of one number or a list of them

_KNOWN: dict[type, dict[str, "Column"]] = {}  # by dataclass, looked up for every state that is made


@dataclass(frozen=True)
class Column:
    """The description of a field, beside its name and its type.

    A field with a kind is numbers, of this `shape`. `table` puts them into the tables of a chain
    (L, n, *shape), `parameter` makes them numbers that models take when they run, and `alike` asks
    legs that are traced as one to have the same ones.
    """

    form: Callable[[str, Any], Any]  # (name, value) to the value as it is kept
    rule: Rule | None = None
    kind: Kind | ByType | None = None
    shape: tuple[int, ...] = ()
    file: str = ""  # its name in robot files
    words: str = ""  # for those who write robot files
    part: type | None = None  # the dataclass that it is one of, itself a table in robot files
    table: bool = False
    parameter: bool = False
    alike: bool = True
    default: Any = None


def about(form: Callable[[str, Any], Any], **known: Any) -> dict[str, Column]:
    """The metadata of a field: how its value is checked, and what else is known of it."""
    return {"column": Column(form, **known)}


def held(form: Callable[[str, Any], Any] | None = None, default: Any = MISSING, **known: Any) -> Any:
    """A field that is given as one type and held as another: it holds what the check makes of a value."""
    return field(default=default, metadata=about(form, **known) if form else {})


def number(
    default: ArrayLike | None,
    kind: Kind | ByType,
    file: str,
    words: str,
    rule: Rule | None = None,
    **known: Any,
) -> Any:
    """A field of a number, or of an array of the default's shape, which is a table of the chain.

    One that is infinite by default may be infinite, and no table; one that is None may be absent, and is
    zero in the table. A parameter is by default one in
    which legs that are traced as one may differ.
    """
    if default is None:
        shape, table, form = (), True, optional(scalar)
    else:
        shape, table = np.shape(default), bool(np.all(np.isfinite(default)))
        form = exact(shape) if shape else scalar if table else endless
    known = {"table": table, "alike": not known.get("parameter")} | known
    made = about(form, rule=rule, kind=kind, shape=shape, file=file, words=words, default=default, **known)
    return (
        field(default_factory=lambda: default, metadata=made)
        if shape
        else field(default=default, metadata=made)
    )


def given(
    kind: Kind | ByType,
    words: str,
    rule: Rule | None = None,
    *,
    default: Any = MISSING,
    shape: tuple[int, ...] = (),
    parameter: bool = False,
) -> Any:
    """A field of a number, or of an array of this shape, that must be given, or may be None by default."""
    known: dict[str, Any] = {"words": words, "kind": kind, "shape": shape, "rule": rule}
    known["parameter"] = parameter
    form = exact(shape) if shape else scalar
    form = optional(form) if default is None else form
    return field(default=default, metadata=about(form, default=default, **known))


def part(kind: type, words: str, default: Any = MISSING) -> Any:
    """A field that is a dataclass of fields itself."""
    form: Callable[[str, Any], Any] = partial(of_type, kind=kind)
    form = optional(form) if default is None else form
    return field(default=default, metadata=about(form, default=default, words=words, part=kind))


def count(words: str, default: int | None = 0) -> Any:
    """A field that is a whole number, not negative."""
    form = optional(integer) if default is None else integer
    return field(default=default, metadata=about(form, words=words, default=default))


def flag(words: str, default: bool) -> Any:
    """A field that is true or false."""
    return field(default=default, metadata=about(boolean, words=words, default=default))


def ratios(words: str) -> Any:
    """A field of numbers without a unit, none negative, one or several, by default zero."""
    known: dict[str, Any] = {"rule": NOT_NEGATIVE, "kind": NUMBER, "shape": SEVERAL, "default": 0.0}
    return field(default=0.0, metadata=about(one_or_several, words=words, **known))


def index(words: str) -> Any:
    """A field that is a number of something, from 0, or None."""
    return field(default=None, metadata=about(optional(integer), words=words))


def exact(shape: tuple[int | None, ...]) -> Callable[[str, Any], Any]:
    """A check for arrays of this shape."""
    return partial(exactly, shape=shape)


def batched(shape: tuple[int | None, ...]) -> Callable[[str, Any], Any]:
    """A check for batches of arrays of this shape."""
    return partial(finite, shape=shape)


def optional(form: Callable[[str, Any], Any]) -> Callable[[str, Any], Any]:
    """A check for what may be absent."""
    return partial(unless_absent, form=form)


def unless_absent(name: str, value: Any, form: Callable[[str, Any], Any]) -> Any:
    """The value as a check makes it; None for none."""
    return None if value is None else form(name, value)


def boolean(name: str, value: Any) -> bool:
    """True or false."""
    if not isinstance(value, (bool, np.bool_)):
        raise InputError(f"{name} is {value!r}; give True or False")
    return bool(value)


def one_or_several(name: str, value: Any) -> Array:
    """One number (), or several (n,)."""
    array = finite(name, value)
    return array if array.ndim < 2 else exactly(name, array, (None,))


def endless(name: str, value: Any) -> float:
    """One number, which may be infinite."""
    infinite = isinstance(value, (float, np.floating)) and np.isinf(value)
    return float(value) if infinite else scalar(name, value)


def described(kind: type) -> dict[str, Column]:
    """The columns of a dataclass by the names of its fields, in order."""
    if kind not in _KNOWN:
        _KNOWN[kind] = {x.name: x.metadata["column"] for x in fields(kind) if "column" in x.metadata}
    return _KNOWN[kind]


def check_fields(thing: Any) -> None:
    """Put each described field of a frozen dataclass into the form that it is kept in.

    Raises InputError, with the field's name, for a value that there cannot be; doubts one that is unusual.
    """
    kind, given = type(thing), vars(thing)
    for name, column in described(kind).items():
        title = f"{kind.__name__}.{name}"
        kept = column.form(title, given[name])
        if kept is not None and column.rule is not None:
            obeying(title, np.asarray(kept), column.rule)
        if column.kind is not None and kept is not None:
            usual(title, kept, column.kind.of(getattr(thing, "sigma", 0)))
        object.__setattr__(thing, name, kept)
