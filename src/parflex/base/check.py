"""Checks at the door: what came, what was expected, what to do."""

import math
import operator
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array, transpose
from parflex.base.errors import InputError
from parflex.base.spatial import off_orthonormal

ORTHONORMAL = 1e-9  # RᵀR − 1 of what is still a rotation


class Rule(NamedTuple):
    """A rule for values: a function that tells where an array breaks it, and its words."""

    broken: Callable[[Array], Any]
    words: str


def unsymmetric(matrix: Array) -> Any:
    """True where matrices (…, n, n) differ from their transposes by more than 1e-12 of their size."""
    size = np.max(np.abs(matrix), axis=(-2, -1), keepdims=True)
    return np.abs(matrix - transpose(matrix)) > 1e-12 * size


# of named functions, so that what holds a rule can be sent to another process
NOT_NEGATIVE = Rule(partial(operator.gt, 0), "it cannot be negative")
POSITIVE = Rule(partial(operator.ge, 0), "it must be positive")
FLAG = Rule(partial(operator.lt, 1), "it must be 0 or 1")
SYMMETRIC = Rule(unsymmetric, "it must be symmetric, with products of inertia as matrix entries")


def obeying(name: str, array: Array, rule: Rule) -> Array:
    """The array itself; raises InputError that names the first entry which breaks the rule."""
    bad = np.broadcast_to(rule.broken(array), array.shape)
    if np.any(bad):
        raise InputError(f"{name} is {array[bad][0]}{index_of(bad)}; {rule.words}")
    return array


def scalar(name: str, value: Any) -> float:
    """One finite number."""
    return float(finite(name, value, ()))


def positive(name: str, value: Any) -> float:
    """One finite number above zero."""
    return float(obeying(name, finite(name, value, ()), POSITIVE))


def integer(name: str, value: Any, lowest: int = 0) -> int:
    """One whole number, not below `lowest`."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < lowest:
        raise InputError(f"{name} is {value!r}; it must be a whole number, {lowest} or more")
    return int(value)


def of_type(name: str, value: Any, kind: type, article: str = "a") -> Any:
    """An object of parflex's own."""
    if not isinstance(value, kind):
        raise InputError(f"{name} is {type(value).__name__}; expected {article} {kind.__name__}")
    return value


def whole_numbers(name: str, values: Any, shape: tuple[int | None, ...] = (None,)) -> Array:
    """An array of whole numbers, none negative, of exactly this shape (None: any length); it may be empty."""
    exactly(name, values, shape)
    array = np.asarray(values)
    if array.size and array.dtype.kind not in "iu":
        raise InputError(f"{name} is of {array.dtype}; give whole numbers")
    return obeying(name, array.astype(np.int64), NOT_NEGATIVE)


def all_of_type(name: str, values: Any, kind: type) -> tuple[Any, ...]:
    """A sequence of parflex's own objects, as a tuple."""
    if isinstance(values, kind) or not isinstance(values, (list, tuple)):
        raise InputError(f"{name} is {type(values).__name__}; give a list or tuple of {kind.__name__}")
    for number, value in enumerate(values):
        of_type(f"{name}[{number}]", value, kind)
    return tuple(values)


def finite(name: str, value: ArrayLike, shape: tuple[int | None, ...] | None = None) -> Array:
    """A float array whose trailing axes have `shape` (None: any length); exact shape for ()."""
    try:
        array = np.array(value)
        if array.dtype.kind not in "biuf":
            raise TypeError(f"values of type {array.dtype}")
        array = array.astype(float, copy=False)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} is not an array of numbers: {error}") from None
    if shape is not None and not fits(array.shape, shape):
        wanted = ", ".join("n" if n is None else str(n) for n in shape)
        raise InputError(f"{name} has shape {array.shape}; expected ({wanted})")
    if not math.isfinite(np.vdot(array, array)) and not np.all(np.isfinite(array)):
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        at = f" at index {where}" if where else ""
        raise InputError(f"{name} is {array[where]}{at}; all values must be finite")
    return array


def fits(shape: tuple[int, ...], wanted: tuple[int | None, ...]) -> bool:
    """True where the last axes are as wanted (None: any length); all of them for ()."""
    trailing = shape[len(shape) - len(wanted) :] if wanted else shape
    return trailing == wanted or (
        len(trailing) == len(wanted)
        and all(want in (None, got) for want, got in zip(wanted, trailing, strict=True))
    )


def exactly(name: str, value: ArrayLike, shape: tuple[int | None, ...]) -> Array:
    """A float array of exactly this shape (None: any length)."""
    array = finite(name, value, shape)
    if array.ndim != len(shape):
        wanted = ", ".join("n" if n is None else str(n) for n in shape)
        raise InputError(f"{name} has shape {array.shape}; expected ({wanted})")
    return array


def rotation_matrix(name: str, value: ArrayLike) -> Array:
    """Rotation matrices (…, 3, 3): orthonormal to 1e-9 and right-handed."""
    R = finite(name, value, (3, 3))
    if R.ndim == 2 and off_orthonormal(R) <= ORTHONORMAL:
        return R
    error = np.max(np.abs(np.swapaxes(R, -1, -2) @ R - np.eye(3)), axis=(-1, -2))
    bad = (error > ORTHONORMAL) | (np.linalg.det(R) < 0)
    if np.any(bad):
        raise InputError(
            f"{name}{index_of(bad)} is not a rotation (RᵀR differs from 1 by {np.max(error):.1e}, "
            f"determinant {np.linalg.det(R)[bad][0]:.6f}); orthonormalise it, or build it with "
            f"scipy.spatial.transform.Rotation"
        )
    return R


def single_rotation(name: str, value: ArrayLike) -> Array:
    """One rotation matrix (3, 3), as `rotation_matrix` wants it."""
    return rotation_matrix(name, exactly(name, value, (3, 3)))


def index_of(bad: Array) -> str:
    """' at index (…)' of the first true entry of a batch; nothing for a single item."""
    bad = np.asarray(bad)
    if bad.ndim == 0:
        return ""
    first = tuple(int(i) for i in np.argwhere(bad)[0])
    return f" at index {first[0] if len(first) == 1 else first}"


def broadcast_together(**vectors: Array) -> None:
    """The leading axes of vectors (…, n) must broadcast together."""
    if all(v.ndim == 1 for v in vectors.values()):
        return
    try:
        np.broadcast_shapes(*(v.shape[:-1] for v in vectors.values()))
    except ValueError:
        said = ", ".join(f"{v.shape[:-1]} of {name}" for name, v in vectors.items() if v.ndim > 1)
        raise InputError(f"the leading (batch) axes are {said}; they must broadcast together") from None
