"""The models of one robot on its assembly branches, each made when a state first names it."""

from collections.abc import Callable
from functools import wraps
from threading import Lock
from typing import TYPE_CHECKING, Any, TypeVar

from parflex.branches import check_joints, on_branches, other_branches
from parflex.state import State

if TYPE_CHECKING:
    from parflex.model import Model

Answer = TypeVar("Answer")


def on_branch(method: Callable[..., Answer]) -> Callable[..., Answer]:
    """The method of a model, on the assembly branch that its state names."""

    @wraps(method)
    def redirected(self: "Model", state: State, *given: Any, **named: Any) -> Answer:
        return method(self.of(state), state, *given, **named)

    return redirected


class Family:
    """A model, and those of its robot on other branches."""

    def __init__(self, first: "Model") -> None:
        self.first = first
        self._others: dict[tuple[int, ...], Model] = {}
        self._lock = Lock()

    def on(self, state: State) -> "Model":
        """The model on the branch that the joints of a state name.

        Raises InputError where they are not those of the legs.
        """
        robot = self.first.robot
        check_joints(robot, state)
        numbers = other_branches(robot, state.joints)
        if not numbers:
            return self.first
        with self._lock:
            if numbers not in self._others:
                other = type(self.first)(on_branches(robot, numbers, state.joints), self.first.backend.name)
                other.family = self
                self._others[numbers] = other
            return self._others[numbers]
