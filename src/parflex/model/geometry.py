"""The geometry of a robot: joints, closure, forward geometry and mobility; it knows no forces."""

from numpy.typing import ArrayLike

from parflex.analysis import forward, health, mobility
from parflex.mechanics.ordering import Joints
from parflex.mechanics.system import examined
from parflex.model.core import Core, joints_at
from parflex.model.inputs import Floor
from parflex.model.renamed import renamed
from parflex.robot.state import State


class Geometry:
    """The methods of `Model` that need no forces."""

    _core: Core

    def joints(self, state: State, *, base: Floor = None) -> Joints:
        """Joint positions and rates of the legs: inverse geometry and kinematics."""
        return joints_at(self._core.on(base), state)

    def mobility(self, state: State) -> mobility.Mobility:
        """Freedoms, redundant constraints, and singularities of both kinds with their directions.

        Raises InputError for a batch or a state off the closure, OutOfReach.
        """
        mechanism = self._core.mechanism
        x = mobility.reached(mechanism, health.single("state", self._core.flat(state)))
        found = examined(mechanism, x)[1]
        health.check_reach(mechanism, found)
        health.check_gaps(mechanism, found)
        return mobility.mobility(mechanism, x)

    def project(self, state: State, *, base: Floor = None) -> State:
        """The state on the closure nearest to a state: what the legs allow.

        The platform's pose and twist are moved, and its bend only where they do not suffice.

        Raises NotConverged where there is none near, OutOfReach where a leg does not reach its tip
        at the given one.
        """
        core = self._core.on(base)
        return core.state(health.on_closure(core.mechanism, state))

    def forward(self, joints: ArrayLike, guess: State | None = None, *, sag: bool = False) -> State:
        """Forward geometry: the state at rest whose actuated joints are as given (m,), m and rad.

        It is looked for from the guess, by default home, with the guess's bend; with sag the
        platform bends under its own weight.

        Raises NotConverged where no pose is found from there.
        """
        return self._core.state(forward.forward(self._core.mechanism, joints, guess, sag))

    def forward_all(
        self, joints: ArrayLike, guess: State | None = None, *, starts: int = 200, seed: int = 0
    ) -> list[State]:
        """All poses found whose actuated joints are as given (m,), the nearest to the guess first.

        Newton's method is started at the guess and at random about it; on the branches of the legs'
        inverse geometry that the robot states. An empty list says that none was found.
        """
        found = forward.forward_all(self._core.mechanism, joints, guess, starts, seed)
        return [self._core.state(x) for x in found]

    legs = renamed("legs", joints)
    pose = renamed("pose", forward)
    poses = renamed("poses", forward_all)
