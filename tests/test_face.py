"""The public face: names under which other programs call the library."""

import ast
import inspect
from importlib import import_module

import numpy as np
import pytest

import parflex as pf


def test_type_checkers_see_what_is_loaded_at_first_use():
    """The imports for type checkers are of every public name, from the module where it is defined."""
    told = {}
    for node in ast.walk(ast.parse(inspect.getsource(pf))):
        if isinstance(node, ast.ImportFrom) and node.module.startswith("parflex"):
            told |= {name.name: node.module for name in node.names if name.asname == name.name}
    assert set(told) == {*pf.__all__, "__version__"}
    for name, module in told.items():
        assert getattr(pf, name) is getattr(import_module(module), name)


@pytest.mark.parametrize(
    ("old", "new", "answer"),
    [
        ("legs", "joints", lambda ask, model: ask(model.robot.home)),
        ("pose", "forward", lambda ask, model: ask(actuated(model))),
        ("poses", "forward_all", lambda ask, model: ask(actuated(model), starts=2)),
        ("static", "equilibrium", lambda ask, model: ask(*model.robot.home_pose)),
    ],
)
def test_former_names_answer_and_warn(old, new, answer):
    model = pf.Model(pf.robots.rps3(), "numpy")
    expected = leaves(answer(getattr(model, new), model))
    with pytest.warns(DeprecationWarning, match=f"{old} is called {new} now") as caught:
        found = leaves(answer(getattr(model, old), model))
    assert caught[0].filename == __file__
    assert all(np.array_equal(a, b) for a, b in zip(found, expected, strict=True))


def test_what_things_are_is_told_in_five_lines(model_of):
    model = model_of(10)
    robot = model.robot
    poses = pf.Trajectory.through(robot.home, [[[0.0, 0.0, 0.1], [0.0, 0.0, 0.2]]], 1.0)
    wrench = pf.Wrench(3, np.ones((20, 3)))
    told = [model, robot, robot.home, robot.platform, robot.platform.moments, robot.legs[0], poses, wrench]
    for thing in told:
        words = repr(thing)
        assert type(thing).__name__ in words
        assert words.count("\n") < 5
        assert len(words) < 500
    assert "6 legs RRP*, 6 motors" in repr(robot)
    assert "10 modes, 30.1 … 190 Hz" in repr(robot)


def actuated(model):
    """The actuated joints of a 3-RPS at home."""
    return [q[1] for q in model.joints(model.robot.home).q]


def leaves(answer):
    """The arrays of an answer, one after the other."""
    if isinstance(answer, pf.State):
        return [answer.position, answer.rotation, answer.elastic]
    if isinstance(answer, (list, tuple)):
        return [leaf for part in answer for leaf in leaves(part)]
    return [answer]
