"""Control laws: one more is one more file, and a controller is a function that one may call in loops."""

import threading
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import parflex as pf
from measures import relative
from parflex.app.trajectory_file import planned_controller, read_plan, start_of, trajectory_of
from parflex.app.trajectory_schema import trajectory_table
from parflex.base.kinds import NUMBER
from parflex.kernels.motion import motion
from parflex.kernels.motion_jacobian import motion_jacobian
from parflex.mechanics import dynamics
from parflex.mechanics.derivatives.joint_tangent import joint_tangent
from parflex.mechanics.system import joint_rates
from parflex.simulation.laws import ALL_LAWS
from parflex.simulation.laws.controller import Controller, TableEntry
from parflex.simulation.laws.law import Law

TIMES = np.linspace(0, 0.05, 6)


def dampers(mechanism, places):
    """The motion under dampers on the actuated joints; the row is (damping 1)."""

    def law(system, t, row, load):
        u = -row * joint_rates(system)
        return u, dynamics.direct_of(system, u, load)

    return motion("dampers", mechanism, 1, law, places)


def dampers_jacobian(mechanism, places):
    def drive(system, t, row):
        return -row * joint_rates(system), -row[..., None] * joint_tangent(system)[1]

    return motion_jacobian(dampers(mechanism, places), places, drive)


@dataclass(frozen=True, eq=False)
class Dampers(Controller):
    """A law as its file would have it."""

    kind = "dampers"
    about = "Dampers on the actuated joints."
    entries = (TableEntry("damping", NUMBER, "N s/m or N m s/rad", 1.0),)

    model: pf.Model
    damping: float

    def law(self, model):
        vars(self)["laws"] = vars(self).get("laws", 0) + 1
        return Law(dampers, dampers_jacobian, np.array([self.damping]))

    @classmethod
    def planned(cls, table: Any, model, start, way):
        return cls(model, table.damping)


WITH_DAMPERS = (*ALL_LAWS, Dampers)
FILE = """\
format = "parflex-trajectory-1"
start = "home"
[[move]]
duration = 1
[controller]
kind = "dampers"
damping = 2e4
"""


@pytest.mark.parametrize("backend", ["vm", "native"])
@pytest.mark.parametrize("method", ["DOP853", "Radau"])
def test_another_law_is_compiled_and_integrated(model_of, backend, method):
    """Explicitly, and implicitly with its derivative: as springs and dampers without the springs."""
    model = model_of(1, backend)
    own, known = (
        pf.simulate(model, law, model.robot.home, TIMES, method=method, rtol=1e-9, atol=1e-11).dataset
        for law in (Dampers(model, 2e4), pf.JointPD(model, model.robot.home, 0.0, 2e4))
    )
    assert np.max(np.abs(own.position - known.position)) <= 1e-9
    assert relative(own.forces, known.forces) <= 1e-6


def test_another_law_has_its_table_in_trajectory_files(model_of, tmp_path):
    path = tmp_path / "way.toml"
    path.write_text(FILE)
    plan = read_plan(path, WITH_DAMPERS)
    start = start_of(plan, model_of(1))
    controller = planned_controller(plan, model_of(1), start, trajectory_of(plan, start.state))
    assert isinstance(controller, Dampers)
    assert controller.damping == 2e4
    table = trajectory_table(WITH_DAMPERS).model_json_schema()["$defs"]["DampersTable"]
    assert table["properties"]["damping"]["default"] == 1.0
    assert table["description"] == "Dampers on the actuated joints."
    with pytest.raises(pf.InputError, match="dampers"):
        read_plan(path)


@pytest.mark.parametrize("law", [law for law in ALL_LAWS if law.kind])
def test_laws_of_files_say_what_they_are(law):
    assert law.about.endswith(".")
    assert law.entries
    assert all(entry.words for entry in law.entries)


def test_a_controller_is_bound_once_for_each_thread(model_of):
    """Called in loops, also by several threads at once, it gives what it gives alone."""
    model = model_of(1, "vm")
    home = model.robot.home
    states = [pf.State(home.position, home.rotation, twist) for twist in 0.1 * np.eye(6)]
    expected = [Dampers(model, 2e4)(0.0, state) for state in states]
    hold, found = Dampers(model, 2e4), [[], []]

    def work(own):
        for _ in range(50):
            own.append([hold(0.0, state) for state in states])

    threads = [threading.Thread(target=work, args=(own,)) for own in found]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert np.shape(found) == (2, 50, 6, 6)
    assert np.array_equal(found, np.broadcast_to(expected, (2, 50, 6, 6)))
    assert vars(hold)["laws"] == 2
