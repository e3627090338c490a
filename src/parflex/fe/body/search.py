"""The search for the smallest basis of free–free and attachment modes that is right to a tolerance."""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.check import positive
from parflex.base.errors import NotConverged
from parflex.fe.body.accuracy import Gram, Truth, error_of, gram_of, truth_of
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.joints import Holding

COUNTS = (12, 24, 48, 96)  # free–free modes that are tried
PARTS = (1.0, 0.1, 0.01)  # of the tolerance, below which a direction is left out


class Choice(NamedTuple):
    """A basis of n free–free modes, with attachment modes or without, and the compliance that is negligible
    in it, of the largest at a place."""

    n: int
    attachment: bool
    negligible: float


def smallest(body: FreeBody, held: tuple[Holding, ...], tolerance: float, up_to: float | None) -> Choice:
    """The smallest basis right to a tolerance; directions stiffer than the tolerance tells are negligible.

    Raises NotConverged where no basis of reasonable size is that good.
    """
    most = min(positive("tolerance", tolerance), 0.5)
    truth = truth_of(body, held, most, up_to)
    for count in COUNTS:
        squares, free = body.free_modes(min(count, body.unknowns // 4))
        every = gram_of(body, np.hstack([free, truth.static.flexed]), truth.static)

        def good(columns: list[int], every: Gram = every) -> bool:
            return error_of(body, held, truth, every.only(columns)).within(tolerance)

        for n in range(len(squares) + 1):
            tried: list[int] | None = None
            for part in PARTS:  # several directions left out, each negligible, may not be together
                added = attachments(every, squares, n, truth, part * most)
                if added != tried and good([*range(n), *added]):
                    fewer = range(n, min(n + len(added), len(squares) + 1))
                    alone = next((m for m in fewer if good(list(range(m)))), None)
                    return Choice(n if alone is None else alone, alone is None, part * most)
                tried = added
    raise NotConverged(
        f"tolerance is {tolerance}, which {COUNTS[-1]} free–free modes with attachment modes do not meet; "
        f"give a larger one, or a lower up_to"
    )


def attachments(every: Gram, squares: Array, n: int, truth: Truth, negligible: float) -> list[int]:
    """The columns after the free–free ones that a basis with n of those would add."""
    total = np.diagonal(truth.static.compliance)
    modal = np.sum(every.force[:, :n] ** 2 / squares[:n], axis=1)
    return [len(squares) + int(k) for k in np.flatnonzero(truth.static.soft(total - modal, negligible))]
