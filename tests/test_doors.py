"""Every public callable that takes numbers refuses what is none, by a sentence that names the argument."""

import inspect
import re
import warnings
from collections.abc import Iterator
from typing import Any

import pytest

import parflex as pf
from arguments import Door
from doors import DOORS as OF_ROBOTS
from fe_doors import DOORS as OF_PLATFORMS

DOORS = OF_ROBOTS | OF_PLATFORMS
MADE = (tuple, BaseException)  # results and errors
UNLISTED = {  # public callables that are not in the tables, and why
    r"FlexibleBody|Compiled|LinearModel|Result|Mobility|OutputReport": "the library makes them",
    r"Verdict|View|Modes": "the library makes them",
    r"Controller|Output": "abstract",
    r"fe\.(FreeBody|SolidMesh|ComputedModes|Basis|\w*Report)(\.rows)?": "the library makes them",
    r"fe\.FreeBody\.\w+": "the matrices' own unknowns, for bases",
    r"\w+\.(bind|law|planned|wanted_joints|segments|end)": "called by runs, which have checked",
    r"\w+\.(check|joints|labels|motion|position|push|rows|units|wrench_map)": "called by linearise",
    r"\w*Output\.(check|drift|free|gain|lengths|linear|of|seen)": "called by models, which have checked",
    r"fe\.\w+\.(columns|modes)": "of an abstract basis, or called with a body that has joints",
    r"Trajectory\.(at|rows)": "`sample` without checks",
    r"Controller\.verdict": "says nothing",
    r"Model\.(legs|pose|poses|static)": "former names of others",
    r"\w+\.(save|to_file|to_matlab|from_file)|load_\w+|view": "take a path, or a run",
    r"fe\.(read_\w+|calculix_body|mesh_from|step_mesh|write_fields|import_modes)": "take files",
    r"plot\.\w+": "draw results",
}


def public() -> Iterator[tuple[str, Any]]:
    """Names and callables of the public face; neither exceptions nor results, which are tuples."""
    for name in pf.__all__:
        thing = getattr(pf, name)
        parts = getattr(thing, "__all__", ())
        inner = {f"{name}.{part}": getattr(thing, part) for part in parts} if parts else {name: thing}
        for full, found in inner.items():
            if callable(found) and not issubclass(found if isinstance(found, type) else object, MADE):
                yield full, found
                if isinstance(found, type):
                    yield from methods(full, found)


def methods(name: str, kind: type) -> Iterator[tuple[str, Any]]:
    """The public methods that take something."""
    for part in dir(kind):
        found = getattr(kind, part)
        routine = inspect.isfunction(found) or inspect.ismethod(found)
        if routine and not part.startswith("_") and arguments(found):
            yield f"{name}.{part}", found


def arguments(call: Any) -> dict[str, inspect.Parameter]:
    """The parameters of a callable, without self."""
    every = inspect.signature(call).parameters.items()
    return {name: each for name, each in every if name not in ("self", "cls")}


PUBLIC = dict(public())


def required(name: str, door: Door) -> dict[str, Any]:
    """Good values of the arguments that must be given."""
    must = [n for n, each in arguments(PUBLIC[name]).items() if each.default is each.empty]
    return {n: door.takes[n].good for n in must if n in door.takes}


def test_every_public_callable_is_listed():
    """In the tables with all its arguments, or with a reason; the list names nothing that there is not."""
    unknown = [
        name for name in PUBLIC if name not in DOORS and not any(re.fullmatch(x, name) for x in UNLISTED)
    ]
    assert unknown == []
    assert set(DOORS) <= set(PUBLIC)
    assert all(any(re.fullmatch(x, name) for name in PUBLIC) for x in UNLISTED)
    for name, door in DOORS.items():
        assert {*door.takes, *door.other.split()} == set(arguments(PUBLIC[name])), name


@pytest.mark.parametrize(("name", "argument"), [(n, a) for n, door in DOORS.items() for a in door.takes])
def test_what_is_wrong_is_refused_by_name(name, argument):
    door, (_, bad, word) = DOORS[name], DOORS[name].takes[argument]
    given, odd = required(name, door), {}
    for what, value in bad.items():
        try:
            with warnings.catch_warnings(action="ignore"):
                door.call(**(given | {argument: value}))
            odd[what] = "taken"
        except pf.InputError as error:
            if not re.search(rf"\b({word or argument})\b", str(error)):
                odd[what] = f"not named: {error}"
        except Exception as error:
            odd[what] = f"{type(error).__name__}: {error}"
    assert odd == {}


@pytest.mark.parametrize("name", DOORS)
def test_what_is_right_is_taken(name):
    """So that what is wrong is refused for the reason that is meant."""
    door = DOORS[name]
    if name not in ("export_c", "fe.write_modes"):  # which write
        with warnings.catch_warnings(action="ignore"):
            door.call(**required(name, door))
