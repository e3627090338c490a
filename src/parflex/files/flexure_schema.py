"""The table of a tip that is a flexure in a robot file."""

from typing import Annotated

from pydantic import Discriminator, Field, Tag, model_validator

from parflex.base import kinds
from parflex.base.check import NOT_NEGATIVE, POSITIVE
from parflex.base.errors import InputError
from parflex.files.tables import THREE, Measure, Rotation, Table, several

Stiffness = Annotated[float, Measure(kinds.ANGULAR_STIFFNESS, NOT_NEGATIVE)]
Stiffness3x3 = Annotated[
    list[Annotated[list[Annotated[float, Measure(kinds.ANGULAR_STIFFNESS)]], THREE]], THREE
]
Damping = Annotated[float, Measure(kinds.ANGULAR_DAMPING, NOT_NEGATIVE)]
Damping3x3 = Annotated[list[Annotated[list[Annotated[float, Measure(kinds.ANGULAR_DAMPING)]], THREE]], THREE]
Dampings = Annotated[
    Annotated[Damping, Tag("one")] | Annotated[Damping3x3, Tag("each")], Discriminator(several)
]
Linear = Annotated[float, Measure(kinds.LINEAR_STIFFNESS, NOT_NEGATIVE)]
Linear3x3 = Annotated[list[Annotated[list[Annotated[float, Measure(kinds.LINEAR_STIFFNESS)]], THREE]], THREE]
LinearDamping = Annotated[float, Measure(kinds.LINEAR_DAMPING, NOT_NEGATIVE)]
LinearDamping3x3 = Annotated[
    list[Annotated[list[Annotated[float, Measure(kinds.LINEAR_DAMPING)]], THREE]], THREE
]
LinearDampings = Annotated[
    Annotated[LinearDamping, Tag("one")] | Annotated[LinearDamping3x3, Tag("each")], Discriminator(several)
]
SOFT = ("axial", "shear", "translation")


class FlexureTable(Table):
    """A spring, a damper and friction against the turning of a tip, and springs that let it off its point."""

    bending: Stiffness | None = Field(None, description="stiffness across the strut's direction at home")
    torsion: Stiffness | None = Field(None, description="stiffness about the strut's direction at home")
    stiffness: Stiffness3x3 | None = Field(
        None, description="instead of both: K, in the axes of the platform's section"
    )
    damping: Dampings = Field(0.0, description="alike in all directions, or D in the same axes")
    friction: Annotated[float, Measure(kinds.TORQUE, NOT_NEGATIVE)] = Field(
        0.0, description="moment of constant size"
    )
    friction_speed: Annotated[float, Measure(kinds.TURN_RATE, POSITIVE)] = Field(
        1e-3, description="over which `friction` changes sign"
    )
    rest: Rotation | None = Field(
        None, description="of the leg's section in the platform's, unloaded; by default that at home"
    )
    axial: Linear | None = Field(
        None,
        description="of a soft tip, which may leave its point: stiffness along the strut's direction",
    )
    shear: Linear | None = Field(None, description="stiffness of a soft tip across that direction")
    translation: Linear3x3 | None = Field(
        None, description="instead of both, in the axes of the platform's section"
    )
    translation_damping: LinearDampings | None = Field(
        None, description="of a soft tip, alike in all directions, or in the same axes"
    )

    @model_validator(mode="after")
    def _one_way(self) -> "FlexureTable":
        about = [name for name in ("bending", "torsion") if getattr(self, name) is not None]
        if self.stiffness is not None and about:
            raise InputError(f"gives stiffness and {about[0]}; keep one of them")
        soft = [name for name in SOFT if getattr(self, name) is not None]
        if "translation" in soft and len(soft) > 1:
            raise InputError(f"gives translation and {soft[0]}; keep one of them")
        if soft in (["axial"], ["shear"]):
            other = "shear" if soft == ["axial"] else "axial"
            raise InputError(f"gives {soft[0]} without {other}; a soft tip has both: give {other} too, or 0")
        if self.translation_damping is not None and not soft:
            raise InputError(
                "gives translation_damping, but its tip is not soft; give axial and shear stiffness too"
            )
        return self
