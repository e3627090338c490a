"""The lowest frequencies of a robot about many equilibria at once."""

from dataclasses import replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array, transpose
from parflex.base.check import integer, of_type
from parflex.base.errors import InputError
from parflex.linear.closed import gains_of
from parflex.model import inputs as checked
from parflex.model.core import core_of
from parflex.model.derivatives import direct_jacobian_of
from parflex.model.linearising import LOCKED
from parflex.model.model import Model
from parflex.robot.robot import Robot
from parflex.robot.state import State

SWINGS = 1e-6  # of |λ|: poles with a smaller imaginary part do not swing


class Frequencies(NamedTuple):
    """The lowest pairs of poles about equilibria (…,), and the fastest growth.

    hertz (…, count) is |λ| / 2π, damping (…, count) of the critical; both are NaN behind the last pair of a
    robot that has fewer. growth (…,) 1/s is the largest real part of a pole, at least zero.
    """

    hertz: Array
    damping: Array
    growth: Array


def natural_frequencies(
    model: Model,
    state: State,
    forces: ArrayLike,
    *,
    count: int = 6,
    damped: bool = True,
    controller: Any = None,
) -> Frequencies:
    """The lowest natural frequencies about equilibria (…,), as `model.linearise` has them of each.

    state and forces (…, m) are those of `model.equilibrium`. Without damping, damped=False, it is some times
    quicker. A controller with gains, or "locked" motors, as in `model.linearise`; Coulomb friction is left
    out. Robots whose legs close by themselves are taken together, compiled, on their motors' springs, or on
    servos where nothing in the legs gives; others, and locked motors, are linearised one by one.

    Raises InputError for a count below one, and as `model.linearise`.
    """
    of_type("model", model, Model)
    if integer("count", count) < 1:
        raise InputError(f"count is {count}; ask for at least one frequency")
    if not isinstance(damped, bool):
        raise InputError(f"damped is {type(damped).__name__}; give True or False")
    x, u = core_of(model).flat(of_type("state", state, State)), checked.forces(core_of(model), forces)
    batch = np.broadcast_shapes(x.shape[:-1], u.shape[:-1])
    x, u = np.broadcast_to(x, (*batch, x.shape[-1])), np.broadcast_to(u, (*batch, u.shape[-1]))
    if together(model, controller):
        K, C = slopes(model, x, u, controller)
        return swinging(poles_of(K, C, damped), count)
    rows = [slopes_of_one(model, *pair, controller) for pair in zip(flat(x), flat(u), strict=True)]
    found = [swinging(poles_of(K, C, damped), count) for K, C in rows]
    parts = (np.stack(part).reshape((*batch, *np.shape(part[0]))) for part in zip(*found, strict=True))
    return Frequencies(*parts)


def together(model: Model, controller: Any) -> bool:
    """True where every motion of platform, modes and carried coordinates is one that the closure allows, and
    the motors' motions follow from the inertia."""
    mechanism = core_of(model).mechanism
    return mechanism.closed and (
        controller is None
        or not ((isinstance(controller, str) and controller == LOCKED) or mechanism.layout.carried)
    )


def flat(rows: Array) -> Array:
    """Rows (…, n) one after the other."""
    return rows.reshape(-1, rows.shape[-1])


def slopes(model: Model, x: Array, forces: Array, controller: Any) -> tuple[Array, Array]:
    """K and C (…, d, d) of robots of which every small motion is one of platform, modes and carried
    coordinates, d of them."""
    plain = rubbing_left_out(model.robot, model.backend) if rubs(model.robot) else model
    core = core_of(plain)
    states = core_of(model).state(x)
    found, at = direct_jacobian_of(core, states, forces, (), None), core.mechanism.layout.motions
    rows = np.concatenate([found.state, found.carried], axis=-2)
    position = rows[..., at.position] @ states.rotation
    K = np.concatenate(
        [position, rows[..., at.rotation], rows[..., at.elastic], rows[..., at.joints]], axis=-1
    )
    rates = (at.velocity, at.omega, at.elastic_rate, at.joint_rates)
    C = np.concatenate([rows[..., part] for part in rates], axis=-1)
    if controller is not None:
        kp, kd, ki = gains_of(controller, core.mechanism.n_forces)
        if np.any(ki):
            raise InputError("controller integrates, which frequencies do not know; linearise one by one")
        B = np.concatenate([found.forces, found.carried_forces], axis=-2)
        mass = np.linalg.inv(found.load)
        S = transpose(B[..., : mass.shape[-1], :]) @ mass  # B = M⁻¹ Sᵀ
        K, C = K - (B * kp) @ S, C - (B * kd) @ S
    return K, C


def slopes_of_one(model: Model, x: Array, forces: Array, controller: Any) -> tuple[Array, Array]:
    """K and C (d, d) of one robot, whatever its legs are."""
    lin = model.linearise(core_of(model).state(x), forces, controller=controller)
    d = lin.point.T.shape[1]
    return lin.own[d : 2 * d, :d], lin.own[d : 2 * d, d : 2 * d]


def poles_of(K: Array, C: Array, damped: bool) -> Array:
    """The poles (…, 2 d) of ζ̈ = K ζ + C ζ̇, or of ζ̈ = K ζ."""
    if not damped:
        roots = np.sqrt(np.linalg.eigvals(K).astype(complex))
        return np.concatenate([roots, -roots], axis=-1)
    d = K.shape[-1]
    A = np.zeros((*K.shape[:-2], 2 * d, 2 * d))
    A[..., :d, d:] = np.eye(d)
    A[..., d:, :d], A[..., d:, d:] = K, C
    return np.asarray(np.linalg.eigvals(A))


def swinging(poles: Array, count: int) -> Frequencies:
    """The lowest pairs of poles (…, p)."""
    size = np.abs(poles)
    pairs = poles.imag > SWINGS * size
    order = np.argsort(np.where(pairs, size, np.inf), axis=-1)[..., :count]
    some = np.take_along_axis(pairs, order, axis=-1)
    size, real = (np.take_along_axis(part, order, axis=-1) for part in (size, poles.real))
    hertz, damping = (np.where(some, part, np.nan) for part in (size / (2 * np.pi), -real / size))
    missing = [(0, 0)] * (hertz.ndim - 1) + [(0, count - hertz.shape[-1])]
    hertz, damping = (np.pad(part, missing, constant_values=np.nan) for part in (hertz, damping))
    growth = np.maximum(np.max(poles.real, axis=-1, initial=0.0), 0.0)
    return Frequencies(hertz, damping, growth)


def rubs(robot: Robot) -> bool:
    """True where a joint or a flexure has Coulomb friction."""
    joints = any(joint.Fs for leg in robot.legs for joint in leg.joints)
    return joints or any(
        tip.flexure is not None and tip.flexure.friction > 0 for leg in robot.legs for tip in leg.tips
    )


@lru_cache(maxsize=16)
def rubbing_left_out(robot: Robot, backend: str) -> Model:
    """The model of the robot without Coulomb friction."""
    legs = []
    for leg in robot.legs:
        joints = [replace(joint, Fs=0.0) for joint in leg.joints]
        tips = [
            tip if tip.flexure is None else replace(tip, flexure=replace(tip.flexure, friction=0.0))
            for tip in leg.tips
        ]
        legs.append(replace(leg, joints=joints, tips=tips))
    return Model(replace(robot, legs=legs), backend)
