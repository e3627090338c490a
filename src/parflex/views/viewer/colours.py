"""Fields that a platform can be coloured by, and the colours."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array

# matplotlib's RdBu_r and viridis at equal steps, red, green, blue from 0 to 255
DIVERGING = (
    (5, 48, 97), (33, 102, 172), (67, 147, 195), (146, 197, 222), (209, 229, 240), (247, 247, 247),
    (253, 219, 199), (244, 165, 130), (214, 96, 77), (178, 24, 43), (103, 0, 31),
)  # fmt: skip
RISING = (
    (68, 1, 84), (72, 40, 120), (62, 73, 137), (49, 104, 142), (38, 130, 142), (31, 158, 137),
    (53, 183, 121), (110, 206, 88), (181, 222, 43), (253, 231, 37),
)  # fmt: skip

Field = Callable[[Array], Array]  # of elastic coordinates (T, N): values (T, K)


class Colouring(NamedTuple):
    """A field over the platform's nodes, what it is called, and how it is shown."""

    words: str
    units: str  # of the legend
    factor: float  # from SI to those
    colours: tuple[tuple[int, int, int], ...]
    signed: bool
    field: Field
    high: float  # the largest value of the run, SI

    def largest(self, elastic: Array) -> float:
        """The largest absolute value of the field for elastic coordinates (T, N)."""
        pieces = np.array_split(elastic, max(1, len(elastic) // 64))
        return max(float(np.max(np.abs(self.field(piece)), initial=0.0)) for piece in pieces)

    def for_page(self) -> dict[str, Any]:
        """The description that the page reads."""
        return {
            "words": self.words,
            "units": self.units,
            "factor": self.factor,
            "low": -self.high if self.signed else 0.0,
            "high": self.high,
            "colours": [f"rgb({r},{g},{b})" for r, g, b in self.colours],
        }


def colourings_of(shapes: Array, stress: Array | None, elastic: Array) -> dict[str, Colouring]:
    """The colourings of a result: deflection where the platform bends, stress where the result has it."""
    if not len(shapes):
        return {"plain": Colouring("", "", 1.0, RISING, False, lambda q: np.zeros((len(q), 1)), 0.0)}
    found = {
        "deflection": Colouring(
            "deflection along z_p", "mm", 1e3, DIVERGING, True, lambda q: q @ shapes[..., 2], 0.0
        ),
        "magnitude": Colouring(
            "deformation",
            "mm",
            1e3,
            RISING,
            False,
            lambda q: np.linalg.norm(np.tensordot(q, shapes, 1), axis=-1),
            0.0,
        ),
    }
    if stress is not None:
        found["stress"] = Colouring(
            "von Mises stress",
            "MPa",
            1e-6,
            RISING,
            False,
            lambda q: von_mises(np.tensordot(q, stress, 1)),
            0.0,
        )
    return {name: each._replace(high=each.largest(elastic)) for name, each in found.items()}


def von_mises(stress: Array) -> Array:
    """The von Mises stress (…,) Pa of components xx, yy, zz, xy, yz, xz (…, 6)."""
    xx, yy, zz, xy, yz, xz = np.moveaxis(stress, -1, 0)
    squares = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(0.5 * squares + 3 * (xy**2 + yz**2 + xz**2)))
