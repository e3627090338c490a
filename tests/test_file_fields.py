"""Every field of robot and trajectory files refuses what it cannot hold, at its line and by its name."""

import copy
import re
import warnings
from typing import Any

import pytest

import parflex as pf
from fields import all_tables, numeric, robots, tables, text_of, trajectories
from parflex.app.trajectory_file import read_plan
from parflex.app.trajectory_schema import trajectory_table
from parflex.files.robot_schema import robot_table

WRONG = {
    "text": "abc",
    "nan": float("nan"),
    "inf": float("inf"),
    "flag": True,
    "length": [0.5] * 7,
    "nested": [[[0.5]]],
    "table": {"odd": 1.0},
    "nothing": "",
}
FITTING = {  # what fits after all
    r"\w+\.(actuated|static|foreshortening)": ("flag",),  # which some bars then lack moduli for
    # one for each mode or motor: told when there is a robot
    r"\w+\.(damping_ratio|kp|kd|ki|rate)": ("length",),
}
SCHEMAS = {"robot": (robot_table(), robots), "trajectory": (trajectory_table(), trajectories)}
READ: dict[str, Any] = {"robot": pf.load_robot, "trajectory": read_plan}


def places() -> dict[str, tuple[str, dict, tuple]]:
    """Each table of the schemas, by name, with a file that has it and its place there."""
    found: dict[str, tuple[str, dict, tuple]] = {}
    for kind, (schema, documents) in SCHEMAS.items():
        for document in documents():
            for table, place in tables(schema, document):
                for field in numeric(table):
                    found.setdefault(f"{table.__name__}.{field}", (kind, document, (*place, field)))
    return found


def changed(document: Any, place: tuple, value: Any) -> Any:
    """The data with another value at a place."""
    if not place:
        return value
    data = copy.copy(document)
    data[place[0]] = changed(
        document.get(place[0]) if isinstance(data, dict) else data[place[0]], place[1:], value
    )
    return data


PLACES = places()


def test_every_field_is_listed():
    """The files above hold each field of each table that is neither a word nor a text."""
    every = [table for schema, _ in SCHEMAS.values() for table in all_tables(schema)]
    assert {f"{table.__name__}.{field}" for table in every for field in numeric(table)} == set(PLACES)


@pytest.mark.parametrize("name", PLACES)
def test_what_a_field_cannot_hold_is_refused(name, tmp_path):
    kind, document, place = PLACES[name]
    path, odd = tmp_path / f"{kind}.toml", {}
    fitting = [what for pattern, every in FITTING.items() if re.fullmatch(pattern, name) for what in every]
    for what, value in WRONG.items():
        if what in fitting:
            continue
        data = changed(document, place, value)
        path.write_text(text_of(data))
        line = list(data).index(place[0]) + 1
        try:
            with warnings.catch_warnings(action="ignore"):
                READ[kind](path)
            odd[what] = "taken"
        except pf.InputError as error:
            if not re.search(rf"{path.name}:{line}: .*\b{place[-1]}\b", str(error)):
                odd[what] = f"not named: {error}"
        except Exception as error:
            odd[what] = f"{type(error).__name__}: {error}"
    assert odd == {}
