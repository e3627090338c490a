"""Answers of the models."""

from collections.abc import Callable
from functools import cached_property
from typing import NamedTuple

from parflex.base.array import Array
from parflex.model.core import LegsMoved


class OfPlatform(NamedTuple):
    """The part of the direct model's answer that the platform has."""

    platform: Array
    elastic: Array
    contact_forces: Array


class Accelerations(OfPlatform):
    """The direct model's answer, all in Σp.

    platform V̇_p (…, 6) m/s², rad/s²; elastic q̈_e (…, N); contact_forces (…, k, 3) N on the
    platform, by attachment. leg_joints q̈ (…, n_i) m/s², rad/s² and leg_elastic ë (…, N_i) of flexible links
    are one array per leg, computed when they are asked for.
    """

    _of_legs: Callable[[], LegsMoved]

    def with_legs(self, legs: Callable[[], LegsMoved]) -> "Accelerations":
        """The same answer, whose legs' part is found by a function when it is asked for."""
        self._of_legs = legs
        return self

    @cached_property
    def _legs(self) -> LegsMoved:
        return self._of_legs()

    @property
    def leg_joints(self) -> tuple[Array, ...]:
        """q̈ (…, n_i), one array per leg."""
        return self._legs.joints

    @property
    def leg_elastic(self) -> tuple[Array, ...]:
        """ë (…, N_i) of flexible links, one array per leg."""
        return self._legs.elastic


class WithForces(NamedTuple):
    """The part of the inverse model's answer that platform and motors have."""

    forces: Array
    elastic: Array
    platform: Array
    contact_forces: Array


class Forces(WithForces):
    """The inverse model's answer.

    forces Γ (…, m) N or N m; elastic q̈_e (…, N), platform V̇_p (…, 6) and contact_forces
    (…, k, 3) N that go with them, in Σp. leg_elastic e (…, N_i), one array per leg, is how the legs bend
    where they do so statically, `legs="static"`; None elsewhere.
    """

    leg_elastic: tuple[Array, ...] | None = None

    def with_legs(self, bend: tuple[Array, ...]) -> "Forces":
        """The same answer, of legs bent like that."""
        self.leg_elastic = bend
        return self


class DirectJacobian(NamedTuple):
    """∂(V̇_p, q̈_e), rows (6 + N), of the direct model, and ∂s̈, rows (n), of the coordinates of the legs that
    the state carries: joints, then elastic coordinates, leg by leg.

    state (…, 6 + N, 12 + 2 N + 2 n) by small motions (δp 3 in Σ0, δθ 3, δv_p 3, δω_p 3, δq_e N,
    δq̇_e N[, δs, δṡ carried]), δθ being a rotation vector in Σp: R → R exp(δθ̂); forces
    (…, 6 + N, m) by Γ; load (…, 6 + N, 6 + N) by a generalised force on (Σp, modes); parameters
    (…, 6 + N, P) by the model's parameters, one after the other. carried (…, n, 12 + 2 N + 2 n),
    carried_forces (…, n, m), carried_load (…, n, 6 + N) and carried_parameters (…, n, P) are those of s̈.
    base (…, 6 + N, 18) and carried_base (…, n, 18) are by the motion of a base, (…, 0) where there is none:
    by (δp_b 3, δθ_b 3, δv_b 3, δω_b 3, δa_b 3, δω̇_b 3) in world axes, δθ_b being R_b → exp(δθ̂_b) R_b.
    """

    state: Array
    forces: Array
    load: Array
    parameters: Array
    carried: Array
    carried_forces: Array
    carried_load: Array
    carried_parameters: Array
    base: Array
    carried_base: Array


class InverseJacobian(NamedTuple):
    """∂Γ, rows (m), of the inverse model.

    state (…, m, 12 + 2 N + 2 n) by small motions as in `DirectJacobian`, target (…, m, m) by the
    output's acceleration, base (…, m, 18) by the motion of a base, (…, m, 0) where there is none.
    """

    state: Array
    target: Array
    base: Array


class Reactions(NamedTuple):
    """Forces and moments that links receive through their joints, in the axes of the links' own frames, one
    entry per leg.

    force (…, n_i, 3) N, moment (…, n_i, 3) N m about the frame's origin. Along the joint's axis it
    holds the actuator's force less friction, spring and rotor.
    """

    force: tuple[Array, ...]
    moment: tuple[Array, ...]
