"""Types of dataclass fields that are given as one type and hold another."""

from typing import Any, Protocol, TypeAlias, TypeVar

from numpy.typing import ArrayLike

from parflex.base.array import Array

Giving = TypeVar("Giving", contravariant=True)
Holding = TypeVar("Holding", covariant=True)


class Held(Protocol[Giving, Holding]):
    """The type of a dataclass field that is given as one type and holds another, for type checkers."""

    def __get__(self, holder: object, owner: Any = None) -> Holding: ...

    def __set__(self, holder: object, value: Giving) -> None: ...


Given: TypeAlias = Held[ArrayLike, Array]  # takes anything array-like, holds a checked float array
MaybeGiven: TypeAlias = Held[ArrayLike | None, Array | None]  # may be missing
