"""Answers that take long are computed once: kept in memory with a body, and in the user's cache folder."""

from collections.abc import Callable, Sequence
from threading import RLock
from typing import Any, TypeVar

from parflex.base import cache
from parflex.base.array import Array

Answer = TypeVar("Answer")

ANSWERS = 8  # answers that one memory holds; the oldest goes first


class Memory:
    """The newest answers by what was asked, each computed by one thread while the others wait."""

    def __init__(self) -> None:
        self._lock = RLock()
        self._known: dict[str, Any] = {}

    def recall(
        self, key: str, compute: Callable[[], Answer], enough: Callable[[Answer], bool] = lambda _: True
    ) -> Answer:
        """The answer known by that key where it is `enough`, else a new one."""
        with self._lock:
            known: Answer | None = self._known.get(key)
            if known is None or not enough(known):
                known = self._known[key] = compute()
                while len(self._known) > ANSWERS:
                    del self._known[next(iter(self._known))]
            return known


def kept(parts: Sequence[object], compute: Callable[[], Sequence[Array]]) -> list[Array]:
    """The arrays that `compute` makes and that `parts` (arrays, numbers, text) determine, from the folder."""
    key = cache.key_of("fe", *parts)
    known = cache.load(key)
    if known is not None:
        return known.outputs
    arrays = list(compute())
    cache.save(key, cache.Entry(b"", [], arrays))
    return arrays
