"""The name that was meant."""

from collections.abc import Iterable
from difflib import get_close_matches


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The known name that is nearest to one that was given; None where none is near."""
    return next(iter(get_close_matches(name, list(known), 1)), None)
