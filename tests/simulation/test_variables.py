"""The table of a result's variables: one entry more is one variable more, for all that read the table."""

import numpy as np
import pytest

import parflex as pf
from parflex.model.core import core_of
from parflex.simulation.integrate import Run
from parflex.simulation.laws.law import WORKS
from parflex.simulation.loads import Loads
from parflex.simulation.record import record
from parflex.simulation.variables import ALL_VARIABLES
from parflex.simulation.variables.variable import Variable
from parflex.views.viewer.layout import KNOWN, misfits

SPEED = Variable(
    "speed",
    ("time",),
    lambda robot: "m s-1",
    "speed of the platform frame",
    lambda run: np.linalg.norm(run.state.twist[:, :3], axis=-1),
    missed="how fast the platform is",
)
NOTHING = Variable("nothing", ("time",), "1", "a variable that this run does not have", lambda run: None)
TIMES = np.linspace(0, 0.1, 5)


@pytest.fixture(scope="module")
def recorded(model_of):
    """The dataset of two states, with more variables than usual."""
    model = model_of(2, "numpy")
    state, forces = model.equilibrium(*model.robot.home_pose)
    control = pf.JointPD(model, state, 0.0, 0.0, forces)
    law = control.bind(model, Loads(model, ()))
    states = [state, pf.State(state.position, state.rotation, (3.0, 4, 0, 0, 0, 0), state.elastic)]
    y = np.array([np.append(core_of(model).flat(each), np.zeros(WORKS)) for each in states])
    run = Run(TIMES[:2], [y], TIMES[1], done=2)
    replay = law.replay(run.t, run.x)
    return record(model, run, replay, control, {}, variables=(*ALL_VARIABLES, SPEED, NOTHING))


def test_another_variable_is_recorded(recorded):
    assert recorded["speed"].values.tolist() == [0.0, 5.0]
    assert recorded["speed"].attrs == {"units": "m s-1", "long_name": "speed of the platform frame"}
    assert "nothing" not in recorded


def test_another_variable_is_checked_by_who_reads_it(recorded):
    assert misfits(recorded, (*KNOWN, SPEED)) == []
    crooked = recorded.assign(speed=(("mode",), np.zeros(2)))
    assert misfits(crooked, (*KNOWN, SPEED)) == ["speed"]


def test_each_variable_is_labelled_as_the_table_has_it(recorded, model_of):
    names = [each.name for each in KNOWN]
    assert len(set(names)) == len(names)
    held = [each for each in ALL_VARIABLES if each.name in recorded]
    assert len(held) > 30
    for each in held:
        assert recorded[each.name].dims == each.dims
        assert recorded[each.name].attrs["units"] == each.units_for(model_of(2).robot)
        assert recorded[each.name].attrs["long_name"] == each.words
    assert {each.name for each in ALL_VARIABLES} - {each.name for each in held} == {
        "desired_position", "desired_rotation", "desired_acceleration", "acceleration_error", "pose_error",
        "rigid_forces", "leg_elastic", "leg_elastic_rate", "leg_mode_link", "leg_mode_drive", "leg_frequency",
        "leg_deformation", "spring_rest", "energy_rests", "energy_base",
        "base_position", "base_rotation", "base_twist", "base_acceleration",
        "relative_position", "relative_rotation", "relative_twist",
    }  # fmt: skip
