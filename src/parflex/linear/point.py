"""An equilibrium, and the robot's small motions ζ̈ = K ζ + C ζ̇ + … about it in coordinates of unit mass."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from parflex.analysis.mobility import null_space
from parflex.analysis.small_motions import allowed
from parflex.analysis.statics import held_load, mass, statics, stiffness
from parflex.base.array import Array, skew
from parflex.base.errors import InputError
from parflex.mechanics.chain import chain_of
from parflex.mechanics.closure import actuated_rows
from parflex.mechanics.derivatives.changes import Load
from parflex.mechanics.derivatives.sensitivity import Sensitivity, direct_sensitivity
from parflex.mechanics.joint_forces import at_motors
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.system import System, assembled, diagonal
from parflex.robot.base_motion import BaseMotion
from parflex.robot.carrying import base_of
from parflex.robot.wrench import Wrench

FRICTION = ("viscous", "smoothed", "stuck")
AT_REST = 1e-9  # m/s, rad/s: rates that are round-off
BALANCED = 1e-6  # of the largest force
ROUNDOFF = 1e-12  # of the platform's size: how far from equilibrium is nothing


@dataclass(frozen=True, eq=False)
class Point:
    """An equilibrium under forces Γ (m,) and a load; small motions are T ζ, with Tᵀ M T = 1.

    T has the rows of displacements: of Σp in Σp, of the platform's modes, of the coordinates of all legs.
    """

    mechanism: Mechanism
    system: System
    x: Array
    forces: Array
    load: Load
    T: Array  # (6 + N + z, d)
    reduction: Array  # (d, 6 + N + n): from accelerations of platform, modes and what is carried to ζ̈

    @cached_property
    def slopes(self) -> Sensitivity:
        """The derivatives of the accelerations of platform, modes and what is carried."""
        return direct_sensitivity(self.system, self.forces, self.load)

    @cached_property
    def seen(self) -> Array:
        """(6 + N + n, d), ζ̇ to the rates of platform, modes and what is carried."""
        first = 6 + self.mechanism.platform.modes
        return np.concatenate([self.T[:first], self.T[first:][self.mechanism.kept]])

    def by_place(self, rows: Array) -> Array:
        """Derivatives (r, d) by ζ, of rows (r, M) by the small motions of the state."""
        at = self.mechanism.layout.motions
        position = rows[:, at.position] @ self.system.x.rotation
        parts = [position, *(rows[:, part] for part in (at.rotation, at.elastic, at.joints))]
        return np.concatenate(parts, axis=-1) @ self.seen

    def by_rate(self, rows: Array) -> Array:
        """Derivatives (r, d) by ζ̇, of rows (r, M) by the small motions of the state."""
        at = self.mechanism.layout.motions
        parts = [rows[:, part] for part in (at.velocity, at.omega, at.elastic_rate, at.joint_rates)]
        return np.concatenate(parts, axis=-1) @ self.seen

    @cached_property
    def K(self) -> Array:
        """(d, d) 1/s²."""
        return self.reduction @ self.by_place(self.slopes.state)

    @cached_property
    def C(self) -> Array:
        """(d, d) 1/s."""
        return self.reduction @ self.by_rate(self.slopes.state)

    @cached_property
    def by_base(self) -> Array:
        """(d, 6), the relative accelerations ζ̈ by those of Σ0, linear and angular in its own axes."""
        still = BaseMotion()
        on_base = replace(self.mechanism, base=base_of(still.flat))
        x = self.system.x
        slopes = direct_sensitivity(assembled(on_base, self.x), self.forces, self.load).base
        carried = np.zeros((len(slopes), 6))
        carried[:6] = np.kron(np.eye(2), x.rotation.T) @ moved_with(x.position)
        found: Array = self.reduction @ (slopes[:, -6:] - carried)
        return found

    def leaning(self) -> Array:
        """(6, 3), the acceleration of Σ0 that is felt like its small turn: gravity leans the other way."""
        return np.concatenate([-skew(self.mechanism.gravity), np.zeros((3, 3))])

    def pushed(self, forces: Array | None = None, load: Array | None = None) -> Array:
        """(d, r), the accelerations ζ̈ that columns of Γ (m, r), or loads on the platform (6 + N, r), give."""
        if forces is not None:
            return self.reduction @ self.slopes.forces @ forces
        assert load is not None, "either forces or a load push"
        return self.reduction @ self.slopes.load @ load


def moved_with(place: Array) -> Array:
    """(6, 6), the motion of a point of Σ0 (3,), by that of Σ0 itself."""
    return np.block([[np.eye(3), -skew(place)], [np.zeros((3, 3)), np.eye(3)]])


def point_at(
    mechanism: Mechanism,
    x: Array,
    forces: Array,
    wrenches: Sequence[Wrench],
    friction: str,
    locked: bool = False,
) -> Point:
    """The point at a flat state, with actuated joints that are free, or locked.

    Raises InputError where it is no equilibrium, or a motion has no inertia.
    """
    if friction not in FRICTION:
        raise InputError(f"friction is {friction!r}; choose one of {', '.join(FRICTION)}")
    check_rest(mechanism, x)
    load = held_load(mechanism, wrenches)
    check_balance(mechanism, x, forces, load)
    held_rows = [stuck_rows(mechanism)] if friction == "stuck" else []
    held_rows += [actuated_rows(mechanism)] if locked else []
    if friction != "smoothed":
        mechanism = without_coulomb(mechanism)
    system, T = assembled(mechanism, x), allowed(mechanism, x)
    first = 6 + mechanism.platform.modes
    seen = np.concatenate([T[:first], T[first:][mechanism.kept]])
    inertia = T.T @ mass(system) @ T
    free = null_space(unit_rows(np.concatenate(held_rows) @ T)) if held_rows else np.eye(T.shape[1])
    held = free.T @ inertia @ free
    check_inertia(held)
    root = np.linalg.cholesky(held)
    to_unit = np.linalg.solve(root, free.T @ inertia) @ np.linalg.pinv(seen)
    return Point(mechanism, system, x, forces, load, np.linalg.solve(root, (T @ free).T).T, to_unit)


def check_rest(mechanism: Mechanism, x: Array) -> None:
    """Raise InputError where the flat state moves."""
    at = mechanism.layout.at
    rates = np.concatenate([x[part] for part in (at.twist, at.elastic_rate, at.joint_rates)])
    if (fastest := float(np.max(np.abs(rates), initial=0.0))) > AT_REST:
        raise InputError(
            f"state moves, with rates up to {fastest:.3g}; small motions are known about a state at rest: "
            f"take one from model.equilibrium"
        )


def check_balance(mechanism: Mechanism, x: Array, forces: Array, load: Load) -> None:
    """Raise InputError where forces are left along the motions that the closure allows, more than what
    round-off of a place leaves in stiff springs."""
    at = statics(mechanism, x, load)
    left = at.push + at.drive @ forces
    step = np.linalg.lstsq(stiffness(at, forces, load), left, rcond=1e-12)[0]
    if np.max(np.abs(step), initial=0.0) <= ROUNDOFF * mechanism.size:
        return
    weight = mechanism.platform.body.moments.m * np.linalg.norm(mechanism.gravity)
    largest, driven = (np.max(np.abs(part), initial=0.0) for part in (at.push, at.drive * forces))
    if np.max(np.abs(left), initial=0.0) > BALANCED * max(largest, driven, weight):
        raise InputError(
            f"state is no equilibrium under these forces: {np.max(np.abs(left)):.3g} N are left along a "
            f"motion that the legs allow; take both from model.equilibrium, with the same wrenches"
        )


def check_inertia(inertia: Array) -> None:
    """Raise InputError where a motion has no inertia, in units of metres."""
    values = np.linalg.eigvalsh(inertia)
    if np.any(values <= 1e-13 * np.max(values, initial=0.0)):
        raise InputError(
            "a motion that the legs allow has no inertia, so that it has no frequency; give its links mass, "
            "or their motors rotor inertia"
        )


def without_coulomb(mechanism: Mechanism) -> Mechanism:
    """The mechanism without Coulomb friction, of joints and of flexures at tips."""
    groups = []
    for group in mechanism.groups:
        chain = group.chain.with_tables({"Fs": 0.0 * group.chain.Fs})
        held = group.flexures and group.flexures._replace(friction=0.0 * group.flexures.friction)
        groups.append(group._replace(chain=chain, flexures=held))
    return replace(mechanism, groups=tuple(groups))


def stuck_rows(mechanism: Mechanism) -> Array:
    """(s, 6 + N + z), the joints with Coulomb friction, or their motors behind drives that give.

    Raises InputError where a flexure at a tip has some, or no joint does.
    """
    found: list[Array] = []
    for number in mechanism.legs:
        leg = mechanism.robot.legs[number]
        if any(tip.flexure is not None and tip.flexure.friction for tip in leg.tips):
            raise InputError(
                'friction is "stuck", but a flexure at a tip has friction, about no axis of its own; take '
                '"viscous" or "smoothed", or leave the flexure\'s friction out'
            )
        moved, n = np.eye(leg.size), len(leg.joints)
        theta = at_motors(chain_of(leg), moved[:, None, :n], moved[:, None, n:])[:, 0].T
        found.append(theta[[joint.Fs > 0 for joint in leg.joints]])
    rows = diagonal(found)
    if not len(rows):
        raise InputError('friction is "stuck", but no joint has Coulomb friction; leave it out')
    return np.hstack([np.zeros((len(rows), 6 + mechanism.platform.modes)), rows])


def unit_rows(rows: Array) -> Array:
    """Rows of length one; those of zero stay."""
    lengths = np.linalg.norm(rows, axis=1, keepdims=True)
    return rows / np.where(lengths > 0, lengths, 1.0)
