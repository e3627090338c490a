"""A strut whose length a motor sets: a cylinder, a rod that slides in it, and their drive."""

from dataclasses import dataclass
from typing import Any, ClassVar

from parflex.base import kinds
from parflex.base.check import NOT_NEGATIVE, POSITIVE
from parflex.base.errors import InputError
from parflex.base.held import MaybeGiven
from parflex.robot.bar import Bar
from parflex.robot.fields import check_fields, given, part
from parflex.robot.words import told


@dataclass(frozen=True, eq=False)
class Drive:
    """A motor at a joint, with what is there beside it; SI units, those of a slide or of a turning joint.

    `stroke` (2,) are the joint's limits. A spring of `stiffness` acts beside the motor, about `rest`, by
    default where the joint is at home, and `damping` on its rate; `rotor_inertia` is the motor's, as seen
    at the joint. `drive_stiffness` is a compliance in series, between the motor and what it moves, with
    `drive_damping` beside it (`Joint`); it needs a rotor_inertia.

    Raises InputError where a number is negative, the limits are not from low to high, or a drive's compliance
    has no rotor behind it.
    """

    sigma: ClassVar[int] = 0  # 1 where it slides
    stroke: MaybeGiven = given(kinds.POSITION, "lowest and highest joint value", default=None, shape=(2,))
    stiffness: float = given(kinds.STIFFNESS, "of a spring beside the motor", NOT_NEGATIVE, default=0.0)
    damping: float = given(kinds.DAMPING, "effort per rate", NOT_NEGATIVE, default=0.0)
    rest: float | None = given(
        kinds.POSITION, "joint value where the spring is at rest; by default that at home", default=None
    )
    rotor_inertia: float = given(
        kinds.JOINT_INERTIA, "of the motor, as seen at the joint", NOT_NEGATIVE, default=0.0
    )

    drive_stiffness: float | None = given(
        kinds.STIFFNESS, "of a compliance between the motor and what it moves", POSITIVE, default=None
    )
    drive_damping: float = given(kinds.DAMPING, "of that compliance", NOT_NEGATIVE, default=0.0)

    def __post_init__(self) -> None:
        check_fields(self)
        if self.drive_stiffness is not None and not self.rotor_inertia:
            raise InputError(
                f"{type(self).__name__}.drive_stiffness is {self.drive_stiffness}, but the motor behind it "
                f"has no rotor_inertia; give that, as seen at the joint"
            )
        if self.drive_stiffness is None and self.drive_damping:
            raise InputError(
                f"{type(self).__name__}.drive_damping is {self.drive_damping} without drive_stiffness, "
                f"beside which it acts; give both, or neither"
            )
        if self.stroke is not None and not self.stroke[0] < self.stroke[1]:
            low, high = self.stroke.tolist()
            raise InputError(f"{type(self).__name__}.stroke is {[low, high]}; give the lower limit first")

    __repr__ = told

    @property
    def of_joint(self) -> dict[str, Any]:
        """The fields of the actuated joint."""
        spring = {"k": self.stiffness, "q_0": self.rest or 0.0, "Fv": self.damping, "IA": self.rotor_inertia}
        limits = {} if self.stroke is None else {"q_min": self.stroke[0], "q_max": self.stroke[1]}
        drive = {"drive_stiffness": self.drive_stiffness, "drive_damping": self.drive_damping}
        return {"sigma": self.sigma, "mu": 1, **spring, **limits, **drive}


@dataclass(frozen=True, eq=False)
class Telescope:
    """A cylinder and the rod that slides in it; each begins at its own joint, at the ends of the leg."""

    cylinder: Bar = part(Bar, "the bar on the base's joint, from there")
    rod: Bar = part(Bar, "the bar on the platform's joint, from there")


@dataclass(frozen=True, eq=False)
class Strut(Drive, Telescope):
    """A cylinder that hangs on the base's joint, a rod that ends in the platform's, and their drive.

    The joint value is the length of the strut, between the centres of its two joints: `stroke` (2,) m are
    its shortest and its longest, `rest` m is by default that at home.

    Raises InputError where a number is negative or the limits are not from low to high.

    >>> bar = Bar(mass=0.2, length=0.25)
    >>> Strut(cylinder=bar, rod=bar, stroke=(0.3, 0.4)).stroke.tolist()
    [0.3, 0.4]
    """

    sigma: ClassVar[int] = 1

    __repr__ = told
