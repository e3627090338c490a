"""The table of a joint in a robot file, made of the fields of the joint, read and written."""

from functools import cache
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field, create_model, model_validator

from parflex.base.errors import InputError
from parflex.files.described import entry, table_of, values_of
from parflex.files.link_schema import LinkTable
from parflex.files.tables import Flag, Point, Table, Whole
from parflex.robot.beam import Beam
from parflex.robot.fields import Column, described
from parflex.robot.leg import Joint

BeamTable: Any = table_of(Beam)


class JointTable(Table):
    """A joint and the link it carries, in modified Denavit-Hartenberg parameters."""

    sigma: ClassVar[int]
    joint: ClassVar[type[Joint]]  # whose fields the table has
    actuated: Flag = Field(False, description="whether a motor drives it")
    antecedent: Whole | None = Field(None, description="joint before it, from 1; 0 is the base")
    com: Point | None = Field(None, description="centre of mass in the link's frame")
    beam: BeamTable | None = Field(
        None, description="a flexible link, a tube or bar, instead of mass, com and inertia"
    )
    body: LinkTable | None = Field(None, description="any flexible link, likewise")

    @model_validator(mode="after")
    def _one_centre(self) -> "JointTable":
        if self.com is not None and vars(self)["first_moment"] is not None:
            raise InputError("gives com and first_moment; keep one of them")
        return self

    @model_validator(mode="after")
    def _one_link(self) -> "JointTable":
        flexible = [name for name in ("beam", "body") if getattr(self, name) is not None]
        rigid = [name for name in ("mass", "com", "first_moment", "inertia") if name in self.model_fields_set]
        ways = flexible + rigid
        if flexible and len(ways) > 1:
            raise InputError(f"gives {ways[0]} and {ways[1]}, each the mass of the link; keep one of them")
        return self


class Revolute(JointTable):
    """A joint that turns about z."""

    sigma: ClassVar[int] = 0
    type: Literal["revolute"]


class Prismatic(JointTable):
    """A joint that slides along z."""

    sigma: ClassVar[int] = 1
    type: Literal["prismatic"]


def joint_table(kind: type[JointTable], joint: type[Joint]) -> type[JointTable]:
    """The table of a revolute or prismatic joint, with an entry for each field of the joint's class."""
    entries: dict[str, Any] = {column.file: entry(column, kind.sigma) for column in in_files(joint).values()}
    made: type[JointTable] = create_model(kind.__name__, __base__=kind, __doc__=kind.__doc__, **entries)
    made.joint = joint
    return made


def in_files(joint: type[Joint]) -> dict[str, Column]:
    """The fields of a joint that have an entry in files, by the joint's own names."""
    return {name: column for name, column in described(joint).items() if column.file}


def joint_of(table: JointTable, before: int, link: dict[str, Any]) -> Joint:
    """The joint of a table, with `before` joints before it and the fields of its flexible link."""
    given = values_of(table.joint, table) | link
    if table.com is not None:
        given["MS"] = given["M"] * np.array(table.com)
    given["antecedent"] = before if table.antecedent is None else table.antecedent
    return table.joint(**given | {"sigma": table.sigma, "mu": int(table.actuated)})


def joint_entries(joint: Joint, before: int) -> dict[str, Any]:
    """The table of a joint and its rigid link without what is by default, with `before` joints before it."""
    far = {} if joint.antecedent == before else {"antecedent": joint.antecedent}
    driven = {"actuated": True} if joint.mu else {}
    kind: Any = type(joint)
    values = {
        file: value
        for name, file, default in numbers(kind)
        if repr(value := written(getattr(joint, name))) != default
    }
    return {"type": ("revolute", "prismatic")[joint.sigma], **far, **driven, **values}


@cache
def numbers(joint: Any) -> list[tuple[str, str, str]]:
    """The numbers of a kind of joint, plain ones first: name, name in files, and the default as text."""
    columns = sorted(
        in_files(joint).items(), key=lambda item: item[1].shape != () or item[1].default in (np.inf, -np.inf)
    )
    return [(name, column.file, repr(written(column.default))) for name, column in columns]


def written(value: Any) -> Any:
    """Numbers as TOML has them; of a matrix that is symmetric to the bit XX, YY, ZZ, XY, XZ, YZ alone."""
    if value is None or isinstance(value, float):
        return value
    matrix = np.asarray(value, dtype=float)
    if matrix.ndim == 2 and repr(matrix.tolist()) == repr(matrix.T.tolist()):
        return [float(matrix[at]) for at in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    return matrix.tolist()
