"""The models of one robot on its assembly branches, each made when a state first names it."""

from collections.abc import Callable
from functools import wraps
from threading import Lock
from typing import TYPE_CHECKING, Any, TypeVar

from parflex.mechanics.branches import check_joints, on_branches, other_branches
from parflex.robot.state import State

if TYPE_CHECKING:
    from parflex.model.model import Model

Answer = TypeVar("Answer")


def on_branch(method: Callable[..., Answer]) -> Callable[..., Answer]:
    """The method of a model, on the assembly branch that its state names."""

    @wraps(method)
    def redirected(self: "Model", state: State, *given: Any, **named: Any) -> Answer:
        return method(self.of(state), state, *given, **named)

    return redirected


class Family:
    """A model, and those of its robot on other branches.

    Where the model is another one with other values of its parameters, so are they.
    """

    def __init__(self, first: "Model", source: "Family | None" = None) -> None:
        self.first, self._source = first, source
        self._others: dict[tuple[int, ...], Model] = {}
        self._lock = Lock()

    def on(self, state: State) -> "Model":
        """The model on the branch that the joints of a state name.

        Raises InputError where they are not those of the legs.
        """
        robot = self.first.robot
        check_joints(robot, state)
        numbers = other_branches(robot, state.joints or ())
        if not numbers:
            return self.first
        with self._lock:
            if numbers not in self._others:
                other = self._made(state, numbers)
                other.family = self
                self._others[numbers] = other
            return self._others[numbers]

    def _made(self, state: State, numbers: tuple[int, ...]) -> "Model":
        """The model with legs on the branch that a state names."""
        first = self.first
        if self._source is not None:
            return self._source.on(state).with_parameters(first.parameters)
        robot = on_branches(first.robot, numbers, state.joints or ())
        return type(first)(robot, first.backend.name, tuple(first.parameters))
