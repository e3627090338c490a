"""Valid robot and trajectory files as data, which hold every table of their schemas; fields of tables."""

import json
import math
import tomllib
from collections.abc import Iterator
from importlib.resources import files
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel

from parflex.app.templates import filled
from parflex.app.templates.starts import STARTS

Place = tuple[str | int, ...]

MATERIAL = {"young": 7e10, "poisson": 0.3, "density": 2700.0, "damping_ratio": 0.01}
PLATFORMS = {  # those that the templates lack
    "rigid": {"mass": 4.0, "inertia": [0.1, 0.1, 0.2, 0, 0, 0], "attachments": [[0.3, 0, 0]]},
    "modal": {"file": "none.nc"},
    "solid": {"file": "none.step", **MATERIAL},
    "disc": {"diameter": 0.3, "thickness": 0.02, **MATERIAL},
    "imported": {"program": "nastran", "files": {"op2": "none.op2"}, "units": "SI"},
}
BEAM = {"end": [0.0, 0, 0.6], "outer": 0.03, "young": 2e11, "poisson": 0.3, "density": 7850.0}
PART = {"kind": "solid", "file": "none.step", "frame": [0.0, 0, 0], "interfaces": [[0.0, 0, 0.6]], **MATERIAL}
FOREIGN = {"kind": "imported", "program": "matrices", "files": {"stiffness": "none.npz"}, "units": "SI"}
BODIES = {"kind": "modal", "file": "none.nc"}, PART, FOREIGN
LINKS = {"beam": BEAM}, *({"body": body} for body in BODIES)  # those that the templates lack
FLEXURE = {"bending": 5.0, "torsion": 9.0}
COUPLING = {"joints": [1, 2], "stiffness": [[5.0, 1.0], [1.0, 4.0]]}
CONTROLLERS = (
    {"kind": "servo"},
    {"kind": "computed-torque", "kp": 400.0, "kd": 40.0},
    {"kind": "joint-pd", "kp": 1e5, "kd": 1e3},
)
MOVES = {"hold": 1.0, "circle": {"radius": 0.01, "frequency": 2.0}}


def template(name: str, robot: str = "gough-stewart") -> dict[str, Any]:
    """A template of `parflex init` as data."""
    text = (files("parflex.app.templates") / f"{name}.toml").read_text(encoding="utf-8")
    return tomllib.loads(filled(text, STARTS[robot]))


def robots() -> Iterator[dict[str, Any]]:
    """The templates, with all that they lack."""
    sensors = {"a": {"type": "accelerometer"}, "b": {"type": "encoder"}}
    for name in STARTS:
        more = {"tool": {"position": [0.0, 0, 0]}, "payload": {"mass": 1.0}, "sensor": sensors}
        yield template(name, name) | more
    for link in LINKS:
        joint = {"type": "prismatic", "actuated": True, "alpha": 1.5707963267948966} | link
        tip = {"frame": 3, "offset": [0.0, 0, 0.6], "flexure": FLEXURE}
        rigid = template("gough-stewart")["chain"]["ups"]["joints"][:2]
        chain = {"joints": [*rigid, joint], "tips": [tip], "couplings": [COUPLING]}
        yield template("gough-stewart") | {"chain": {"ups": chain}}
    for kind, platform in PLATFORMS.items():
        yield template("gough-stewart") | {"platform": {"kind": kind} | platform}


def trajectories() -> Iterator[dict[str, Any]]:
    """The template, under each law and with each move."""
    for law in CONTROLLERS:
        yield template("trajectory") | {"controller": law}
    for word, move in MOVES.items():
        yield template("trajectory") | {"move": [{word: move}]}


def text_of(data: dict[str, Any]) -> str:
    """The file, a line for each entry of it."""
    return "".join(f"{key} = {inline(value)}\n" for key, value in data.items())


def inline(value: Any) -> str:
    """A value of TOML on one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {inline(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(inline, value)) + "]"
    return str(value) if isinstance(value, float) and not math.isfinite(value) else json.dumps(value)


def tables(table: type[BaseModel], data: Any, place: Place = ()) -> Iterator[tuple[type[BaseModel], Place]]:
    """The tables of a schema that a file has, and where."""
    yield table, place
    for name, field in table.model_fields.items():
        if name in data:
            yield from within(field.annotation, data[name], (*place, name))


def within(kind: Any, data: Any, place: Place) -> Iterator[tuple[type[BaseModel], Place]]:
    """The tables in a field's value."""
    if isinstance(data, dict):
        known = [each for each in parts(kind) if is_table(each)]
        own = [each for each in known if fits(each, data)]
        if own:
            yield from tables(own[0], data, place)
        else:
            for key, value in data.items():
                yield from within(kind, value, (*place, key))
    elif isinstance(data, list):
        for number, value in enumerate(data):
            yield from within(kind, value, (*place, number))


def fits(table: type[BaseModel], data: dict[str, Any]) -> bool:
    """True for the table that a file's value is of: it knows all its keys, and has its words."""
    words = {name: get_args(f.annotation) for name, f in table.model_fields.items() if is_word(f.annotation)}
    known = set(data) <= set(table.model_fields)
    must = all(name in data for name, field in table.model_fields.items() if field.is_required())
    return known and must and all(data.get(name) in choices for name, choices in words.items())


def parts(kind: Any) -> list[Any]:
    """A type and all types in it."""
    inner = () if get_origin(kind) is Literal else get_args(kind)
    return [kind, *(each for part in inner for each in parts(part))]


def is_table(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseModel)


def is_word(kind: Any) -> bool:
    return get_origin(kind) is Literal


def all_tables(table: type[BaseModel]) -> set[type[BaseModel]]:
    """A schema's tables."""
    inner = {p for f in table.model_fields.values() for p in parts(f.annotation) if is_table(p)}
    return {table}.union(*(all_tables(each) for each in inner))


def numeric(table: type[BaseModel]) -> list[str]:
    """The fields of a table that are neither words nor text."""
    kinds = {name: field.annotation for name, field in table.model_fields.items()}
    texts = {str, type(None)}
    return [
        n for n, kind in kinds.items() if not is_word(kind) and not set(get_args(kind) or [kind]) <= texts
    ]
