"""The public face: names under which other programs call the library."""

import numpy as np
import pytest

import parflex as pf


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
