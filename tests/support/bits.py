"""Every number of a robot, to the last bit."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

import parflex as pf


def bits(robot: pf.Robot) -> dict[str, bytes]:
    """The shape and the bytes of each array and number, by its way from the robot."""
    return {name: str(value.shape).encode() + value.tobytes() for name, value in leaves(robot).items()}


def leaves(robot: pf.Robot) -> dict[str, np.ndarray]:
    """Each array and number, by its way from the robot; what is not there is not a number."""
    return dict(each_leaf("robot", robot))


def each_leaf(name: str, value: Any) -> Iterator[tuple[str, np.ndarray]]:
    if is_dataclass(value):
        for field in fields(value):
            if field.name not in ("beam", "basis"):  # which made the body whose numbers are compared
                yield from each_leaf(f"{name}.{field.name}", getattr(value, field.name))
    elif isinstance(value, tuple):
        yield f"{name} entries", np.array(float(len(value)))
        for number, each in enumerate(value):
            yield from each_leaf(f"{name}[{number}]", each)
    else:
        yield name, np.asarray(value, dtype=float)
