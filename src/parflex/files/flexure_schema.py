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


class FlexureTable(Table):
    """A spring, a damper and friction against the turning of a tip."""

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

    @model_validator(mode="after")
    def _one_way(self) -> "FlexureTable":
        about = [name for name in ("bending", "torsion") if getattr(self, name) is not None]
        if self.stiffness is not None and about:
            raise InputError(f"gives stiffness and {about[0]}; keep one of them")
        return self
