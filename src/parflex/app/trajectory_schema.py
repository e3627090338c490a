"""The tables of a trajectory file, format "parflex-trajectory-1"."""

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from parflex.files import quantity
from parflex.files.tables import ZEROS, Measure, Point, Rotation, Table, Time, Whole, several

FORMAT = "parflex-trajectory-1"

Lasting = Annotated[float, Measure(quantity.TIME, negative=False, zero=False)]
Tolerance = Annotated[float, Measure(quantity.NUMBER, negative=False, zero=False)]
PoseGain = Annotated[float, Measure(quantity.POSE_GAIN, negative=False)]
RateGain = Annotated[float, Measure(quantity.RATE_GAIN, negative=False)]
JointGain = Annotated[float, Measure(quantity.NUMBER, negative=False)]

PoseGains = Annotated[
    Annotated[PoseGain, Tag("one")] | Annotated[list[PoseGain], Tag("each")], Discriminator(several)
]
RateGains = Annotated[
    Annotated[RateGain, Tag("one")] | Annotated[list[RateGain], Tag("each")], Discriminator(several)
]
JointGains = Annotated[
    Annotated[JointGain, Tag("one")] | Annotated[list[JointGain], Tag("each")], Discriminator(several)
]


class MoveTable(Table):
    """A pose to go to, as a displacement from the start in world axes."""

    position: Point = Field(ZEROS, description="displacement from the start")
    rotation: Rotation = Field(ZEROS, description="rotation vector or matrix, from the start")
    duration: Lasting = Field(description="the time it takes, in s")


class TorqueTable(Table):
    """Forces from the inverse model, with feedback of the pose: computed torque."""

    kind: Literal["computed-torque"]
    rows: list[Whole] | None = Field(None, description="the rows of the pose that it follows; all six")
    kp: PoseGains = Field(0.0, description="stiffness of the feedback, 1/s²; one, or six")
    kd: RateGains = Field(0.0, description="damping of the feedback, 1/s; one, or six")


class SpringTable(Table):
    """Springs and dampers on the actuated joints, which hold the start."""

    kind: Literal["joint-pd"]
    kp: JointGains = Field(description="N/m or N m/rad; one, or one for each motor")
    kd: JointGains = Field(description="N s/m or N m s/rad; one, or one for each motor")


class TrajectoryTable(Table):
    """A motion through poses, what drives it, and how it is integrated."""

    format: Literal["parflex-trajectory-1"] = Field(description='"parflex-trajectory-1"')
    start: Literal["equilibrium", "home"] = Field("equilibrium", description="bent by weight, or not")
    rest: Annotated[list[Time], Field(min_length=2, max_length=2)] = Field(
        [0.5, 0.5], description="times at rest before the first move and after the last"
    )
    move: list[MoveTable] = Field(min_length=1, description="the moves in order, one [[move]] each")
    controller: TorqueTable | SpringTable = Field(discriminator="kind", description="the table [controller]")
    sample_time: Lasting = Field(5e-3, description="between output times")
    rtol: Tolerance = Field(1e-7, description="relative error of a step")
    atol: Tolerance = Field(1e-9, description="absolute error of a step")
    max_step: Lasting | None = Field(None, description="longest step; by default a fiftieth of the run")
