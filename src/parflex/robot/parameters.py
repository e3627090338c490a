"""Numbers of a robot that models take when they run: inertias, friction, springs, beams, payload, gravity.

A parameter is named by Python's own path into a robot. All parameters of a model are one vector
θ (P,), and the mechanics with θ is that of the robot with the numbers in its tables.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array, join
from parflex.base.check import NOT_NEGATIVE, Rule, finite, obeying
from parflex.base.errors import InputError
from parflex.base.nearest import nearest
from parflex.robot.beam import Beam, BeamBody
from parflex.robot.beam_section import CHANGING
from parflex.robot.body import FlexibleBody
from parflex.robot.fields import Column, described
from parflex.robot.flexure import MATRICES, Flexure, check_not_negative
from parflex.robot.leg import Joint, Leg, Tip
from parflex.robot.robot import Robot

OF_MODES = ("frequencies", "damping_ratio")


def of(kind: type) -> dict[str, Column]:
    """The fields of a joint or a flexure that are parameters, by name."""
    return {name: column for name, column in described(kind).items() if column.parameter}


OF_MASS = ("M", "MS", "I")  # which a flexible link has in its body
OF_DRIVE = ("drive_stiffness", "drive_damping")  # which only a joint with a compliant drive has
OF_BEAM, OF_FLEXURE = "body.beam.", "flexure."  # the ways from a joint and from a tip to their numbers
BORE = (OF_BEAM + "inner", OF_BEAM + "outer")
KINDS = (
    "gravity, legs[i].joints[j].X or legs[*].joints[j].X with X one of " + ", ".join(of(Joint)) + ", or of "
    "body.beam." + ", body.beam.".join(CHANGING) + " where the link is a beam, legs[i].tips[j].flexure.X "
    "with X one of " + ", ".join(of(Flexure)) + ", "
    "platform.frequencies, platform.damping_ratio, and platform.payload[node]; indices count from 0"
)
GEOMETRY = {name for kind in (Joint, Tip, Leg) for name in described(kind)} - set(of(Joint)) - {"joints"}
GEOMETRY |= {"posture", "home_pose", "nodes", "shapes", "rotation_shapes", "attachments"}

Values = Mapping[str, Any]


class Parameter(NamedTuple):
    """Some entries of θ: the number `field` of joint or tip `number` of legs, of the platform, or gravity."""

    name: str
    field: str
    shape: tuple[int, ...]
    legs: tuple[int, ...] = ()
    number: int = 0  # of a joint, of a tip, or of the node that a payload is on
    rule: Rule | None = None

    @property
    def size(self) -> int:
        """The number of its entries in θ."""
        return int(np.prod(self.shape, dtype=int))


class Parameters:
    """The named parameters of a robot, one after the other in θ (P,).

    Raises InputError for names that are no parameters of the robot.
    """

    def __init__(self, robot: Robot, names: Sequence[str]) -> None:
        if isinstance(names, str) or not isinstance(names, Sequence):
            raise InputError(f"parameters is {type(names).__name__}; give a list of names: {KINDS}")
        self.first = robot
        known = every_parameter(robot) if names else {}
        self.items = tuple(named_parameter(robot, known, name) for name in names)
        check_apart(self.items)
        self.size = sum(item.size for item in self.items)
        self.own = join([np.zeros(0), *(own_value(robot, item).reshape(-1) for item in self.items)])

    @property
    def names(self) -> tuple[str, ...]:
        """The names, as they were given."""
        return tuple(item.name for item in self.items)

    def vector(self, values: Values, others: Array) -> Array:
        """θ (…, P) with some values, leading axes broadcast; the others as in θ (P,).

        Raises InputError for other names, and values that the robot itself would refuse.
        """
        if not isinstance(values, Mapping):
            raise InputError(f"parameters is {type(values).__name__}; give a dict of names and values")
        for name in values:
            if name not in self.names:
                raise InputError(self._unknown(name))
        parts = {item.name: part for item, part in self.split(others)}
        for item in self.items:
            if item.name in values:
                parts[item.name] = checked(item, values[item.name])
        flat = {
            item.name: value.reshape(value.shape[: value.ndim - len(item.shape)] + (item.size,))
            for item, value in zip(self.items, parts.values(), strict=True)
        }
        try:
            theta = join([np.zeros(0), *flat.values()])
        except ValueError:
            said = ", ".join(f"{value.shape[:-1]} of {name}" for name, value in flat.items())
            raise InputError(
                f"parameters: the leading (batch) axes are {said}; they must broadcast together"
            ) from None
        check_bores(self.first, self.items, parts)
        return theta

    def split(self, theta: Array) -> list[tuple[Parameter, Array]]:
        """The parameters with their values (*shape) in θ (P,)."""
        ends = np.cumsum([item.size for item in self.items])
        return [
            (item, theta[end - item.size : end].reshape(item.shape))
            for item, end in zip(self.items, ends, strict=True)
        ]

    def _unknown(self, name: object) -> str:
        """The complaint about a value for something that is not among the parameters."""
        if not self.names:
            return (
                f"parameters: {name!r} is given, but the model has none; name those that are to change when "
                f"it is made, pf.Model(robot, parameters=[{name!r}])"
            )
        return f"parameters: {name!r} is none of this model{meant(name, self.names)}; it has " + ", ".join(
            self.names
        )


def every_parameter(robot: Robot) -> dict[str, Parameter]:
    """The parameters of a robot by name; one that all legs have is shared by them under legs[*]."""
    body, count = robot.platform, len(robot.legs)
    of_body = [Parameter("gravity", "gravity", (3,))]
    if body.modes:
        of_body += [Parameter(f"platform.{x}", x, (body.modes,), rule=NOT_NEGATIVE) for x in OF_MODES]
    of_body += [
        Parameter(f"platform.payload[{node}]", "payload", (), (), node, NOT_NEGATIVE)
        for node in range(len(body.nodes))
    ]
    of_legs: dict[tuple[int, str], list[Parameter]] = {}
    for i, leg in enumerate(robot.legs):
        for one in of_leg(i, leg):
            of_legs.setdefault((one.number, one.field), []).append(one)
    shared = [
        alike[0]._replace(name=alike[0].name.replace("legs[0]", "legs[*]"), legs=tuple(range(count)))
        for alike in of_legs.values()
        if len(alike) == count
    ]
    return {item.name: item for item in chain(of_body, shared, *of_legs.values())}


def of_leg(i: int, leg: Leg) -> Iterator[Parameter]:
    """The parameters of a leg's joints, of links that are beams, and of flexures at its tips."""
    for j, joint in enumerate(leg.joints):
        for field, column in of(type(joint)).items():
            elsewhere = field in OF_MASS and joint.body is not None
            absent = field in OF_DRIVE and joint.drive_stiffness is None
            if not elsewhere and not absent:
                yield Parameter(f"legs[{i}].joints[{j}].{field}", field, column.shape, (i,), j, column.rule)
        if isinstance(joint.body, BeamBody):
            for field in CHANGING:
                rule, way = described(Beam)[field].rule, OF_BEAM + field
                yield Parameter(f"legs[{i}].joints[{j}].{way}", way, (), (i,), j, rule)
    for t, tip in enumerate(leg.tips):
        if tip.flexure is not None:
            for field, column in of(Flexure).items():
                if getattr(tip.flexure, field) is None:
                    continue
                way = OF_FLEXURE + field
                yield Parameter(f"legs[{i}].tips[{t}].{way}", way, column.shape, (i,), t, column.rule)


def named_parameter(robot: Robot, known: Mapping[str, Parameter], name: object) -> Parameter:
    """The parameter of a name.

    Raises InputError where the robot has none of that name.
    """
    text = name if isinstance(name, str) else ""
    if text in known:
        return known[text]
    if text.rpartition(".")[2].partition("[")[0] in GEOMETRY:
        raise InputError(
            f"parameters: {name!r} is geometry, which is folded into the compiled code; build another robot "
            f"with it. Parameters are {KINDS}"
        )
    likely = [item.name for item in known.values() if item.field != "payload" or item.number < 100]
    raise InputError(
        f"parameters: {name!r} is no parameter of this robot{meant(text, likely)}; there are "
        f"{KINDS}. It has {len(robot.legs)} legs, {len(robot.platform.nodes)} nodes and "
        f"{robot.platform.modes} modes"
    )


def meant(name: object, known: Sequence[str]) -> str:
    """A question that names what may have been meant; nothing where nothing is near."""
    found = nearest(str(name), known)
    return f" (did you mean {found}?)" if found else ""


def check_apart(items: Sequence[Parameter]) -> None:
    """Raise InputError where two names stand for one number."""
    taken: dict[object, str] = {}
    for item in items:
        for leg in item.legs or (-1,):
            place = (item.field, leg, item.number)
            if place in taken:
                raise InputError(
                    f"parameters: {taken[place]!r} and {item.name!r} are the same number; name it once"
                )
            taken[place] = item.name


def check_bores(robot: Robot, items: Sequence[Parameter], values: Mapping[str, Array]) -> None:
    """Raise InputError where a beam's inner diameter is not less than its outer one."""
    given = {(item.field, leg, item.number): values[item.name] for item in items for leg in item.legs}
    for field, leg, number in given:
        if field not in BORE:
            continue
        joint = robot.legs[leg].joints[number]
        inner, outer = (given.get((name, leg, number), attrgetter(name)(joint)) for name in BORE)
        wide = np.asarray(inner) >= outer
        if np.any(wide):
            inner, outer = (np.broadcast_to(value, wide.shape)[wide][0] for value in (inner, outer))
            raise InputError(
                f"parameters: legs[{leg}].joints[{number}].{BORE[0]} is {inner}; it must be less than outer, "
                f"which is {outer}"
            )


def own_value(robot: Robot, item: Parameter) -> Array:
    """The value (*shape) that the robot itself has.

    Raises InputError where legs that are to share one have different ones.
    """
    body = robot.platform
    if item.field == "gravity":
        return np.asarray(robot.gravity)
    if item.field == "payload":
        return np.zeros(())
    if item.field in OF_MODES:
        return modal_values(body)[OF_MODES.index(item.field)]
    legs = [robot.legs[leg] for leg in item.legs]
    parts = [leg.tips if item.field.startswith(OF_FLEXURE) else leg.joints for leg in legs]
    values = [np.asarray(attrgetter(item.field)(part[item.number])) for part in parts]
    if not all(np.array_equal(value, values[0]) for value in values):
        raise InputError(
            f"parameters: {item.name!r} is one value for all legs, but theirs differ; name each leg"
        )
    return values[0]


def modal_values(body: FlexibleBody) -> tuple[Array, Array]:
    """Frequencies (N,) rad/s and damping ratios (N,) of a body.

    Raises InputError for a mode that has damping and no stiffness.
    """
    lame = np.flatnonzero((body.stiffness == 0) & (body.damping > 0))
    if len(lame):
        raise InputError(
            f"parameters: mode {lame[0] + 1} of the platform has damping but no frequency, and so no damping "
            f"ratio; give it a frequency"
        )
    return body.frequencies, body.damping_ratios


def checked(item: Parameter, value: Any) -> Array:
    """A value (…, *shape) of a parameter; a damping ratio may be one for all modes, () or (…, 1).

    Raises InputError as the robot itself would.
    """
    name = f"parameters[{item.name!r}]"
    if item.field == "damping_ratio" and np.shape(value)[-1:] in ((), (1,)):
        value = np.broadcast_to(finite(name, value), np.shape(value)[:-1] + item.shape)
    array = finite(name, value, item.shape or None)
    if item.field in [OF_FLEXURE + name for name in MATRICES]:
        for matrix in array.reshape(-1, *item.shape):
            check_not_negative(name, matrix)
    return array if item.rule is None else obeying(name, array, item.rule)
