"""Methods under their former names."""

import warnings
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

Given = ParamSpec("Given")
Answer = TypeVar("Answer")


def renamed(old: str, method: Callable[Given, Answer]) -> Callable[Given, Answer]:
    """The method under its former name: it answers the same, and warns (DeprecationWarning)."""

    @wraps(method)
    def former(*args: Given.args, **named: Given.kwargs) -> Answer:
        warnings.warn(f"{old} is called {method.__name__} now", DeprecationWarning, stacklevel=2)
        return method(*args, **named)

    return former
