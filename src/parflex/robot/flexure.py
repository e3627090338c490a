"""Flexures: springs, dampers and friction against the turning of spherical joints."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from parflex.base import kinds
from parflex.base.array import Array
from parflex.base.check import NOT_NEGATIVE, POSITIVE, exactly, finite, obeying, single_rotation
from parflex.base.errors import InputError
from parflex.base.held import Given, MaybeGiven
from parflex.robot.fields import check_fields, given, held, number, optional
from parflex.robot.words import told

MATRICES = ("stiffness", "damping", "translation", "translation_damping")


@dataclass(frozen=True, eq=False)
class Flexure:
    """Stiffness, damping and friction of a tip against rotation, and against being pulled off where it is
    soft; SI units and radians.

    The energy is ½ θᵀ K θ with `stiffness` K (3, 3) N m/rad and θ = 2 tan(φ/2) times the axis of the
    rotation from rest, which is that of the leg's section seen from the platform's; `damping` (3, 3)
    N m s/rad acts on their relative angular velocity ω, and so does `friction` ω/√(ω² + v²) N m with
    v = `friction_speed` rad/s. All are in the axes of the platform's section. `rest` (3, 3) is the rotation
    without load, by default that at home.

    With `translation` K_t (3, 3) N/m the tip is soft: it may leave the platform's point by g, in the same
    axes, and the force K_t g + D_t ġ, with D_t = `translation_damping` (3, 3) N s/m, draws both together.
    Without, it holds the point.

    Raises InputError where a matrix is not symmetric or has a negative direction, or friction is negative,
    and where only `translation_damping` is given.
    """

    stiffness: Given = number(
        np.zeros((3, 3)), kinds.ANGULAR_STIFFNESS, "stiffness", "K, in N m/rad", parameter=True
    )
    damping: Given = number(
        np.zeros((3, 3)), kinds.ANGULAR_DAMPING, "damping", "D, in N m s/rad", parameter=True
    )
    friction: float = number(
        0.0, kinds.TORQUE, "friction", "moment of constant size", NOT_NEGATIVE, parameter=True
    )
    friction_speed: float = number(
        1e-3, kinds.TURN_RATE, "friction_speed", "over which `friction` changes sign", POSITIVE
    )
    rest: MaybeGiven = held(optional(single_rotation), default=None)
    translation: MaybeGiven = given(
        kinds.LINEAR_STIFFNESS, "K_t of a soft tip, in N/m", default=None, shape=(3, 3), parameter=True
    )
    translation_damping: MaybeGiven = given(
        kinds.LINEAR_DAMPING, "D_t of a soft tip, in N s/m", default=None, shape=(3, 3), parameter=True
    )

    def __post_init__(self) -> None:
        check_fields(self)
        if self.translation is None and self.translation_damping is not None:
            raise InputError(
                "Flexure.translation_damping is given without translation, by which a tip is soft; give "
                "translation=numpy.zeros((3, 3)) where the damper is alone"
            )
        if self.translation is not None and self.translation_damping is None:
            object.__setattr__(self, "translation_damping", np.zeros((3, 3)))
        for name in MATRICES:
            if getattr(self, name) is not None:
                check_not_negative(f"Flexure.{name}", getattr(self, name))

    __repr__ = told

    @property
    def soft(self) -> bool:
        """True where the tip may leave the platform's point."""
        return self.translation is not None

    @staticmethod
    def about(
        axis: ArrayLike,
        *,
        bending: float = 0.0,
        torsion: float = 0.0,
        damping: float = 0.0,
        axial: float | None = None,
        shear: float | None = None,
        translation_damping: float = 0.0,
    ) -> "Flexure":
        """A flexure alike in all directions across an axis n (3,): K = k_b (1 − n nᵀ) + k_t n nᵀ, N m/rad.

        With `axial` k_a and `shear` k_s, N/m, it is soft: K_t = k_s (1 − n nᵀ) + k_a n nᵀ. damping
        (N m s/rad) and translation_damping (N s/m) are the same in all directions.

        Raises InputError for an axis without a direction, for a number that is negative, and where only one
        of axial and shear is given.
        """
        n = exactly("axis", axis, (3,))
        n = n / max(float(np.max(np.abs(n))), np.finfo(float).tiny)
        if not np.any(n):
            raise InputError(f"axis is {n.tolist()}; give a direction")
        if (axial is None) != (shear is None):
            lacking = "axial" if axial is None else "shear"
            raise InputError(f"{lacking} is missing; a soft flexure needs axial and shear, in N/m")
        numbers = {"bending": bending, "torsion": torsion, "damping": damping}
        numbers["translation_damping"] = translation_damping
        if axial is not None and shear is not None:
            numbers |= {"axial": axial, "shear": shear}
        for name, value in numbers.items():
            obeying(name, finite(name, value, ()), NOT_NEGATIVE)
        along = np.outer(n, n) / (n @ n)
        across = np.eye(3) - along
        turning = bending * across + torsion * along, damping * np.eye(3)
        if axial is None or shear is None:
            if translation_damping:
                raise InputError("translation_damping is given without axial and shear, in N/m; give both")
            return Flexure(*turning)
        pulled = shear * across + axial * along
        return Flexure(*turning, translation=pulled, translation_damping=translation_damping * np.eye(3))


def check_not_negative(name: str, matrix: Array) -> None:
    """Raise InputError where a matrix is not symmetric, or has a direction in which it is negative."""
    largest = float(np.max(np.abs(matrix)))
    off = float(np.max(np.abs(matrix - matrix.T)))
    if off > 1e-9 * largest:
        raise InputError(f"{name} differs from its transpose by {off:.3g}; give a symmetric matrix")
    lowest = float(np.linalg.eigvalsh(matrix)[0])
    if lowest < -1e-9 * largest:
        raise InputError(
            f"{name} has the principal value {lowest:.3g}; it must not be negative in any direction"
        )
