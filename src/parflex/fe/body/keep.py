"""What takes long is computed once: arrays kept in the user's cache folder."""

from collections.abc import Callable, Sequence

from parflex.base import cache
from parflex.base.array import Array

SMALL = 3000  # unknowns below which computing is quicker than reading


def kept(parts: Sequence[object], compute: Callable[[], Sequence[Array]]) -> list[Array]:
    """The arrays that `compute` makes, and that `parts` (arrays, numbers, text) determine."""
    key = cache.key_of("fe", *parts)
    known = cache.load(key)
    if known is not None:
        return known.outputs
    arrays = list(compute())
    cache.save(key, cache.Entry(b"", [], arrays))
    return arrays
