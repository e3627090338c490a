"""The one table of a joint's fields: a field that is added to it reaches all that read it."""

import pickle
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest

import parflex as pf
from parflex.base import kinds
from parflex.base.check import NOT_NEGATIVE, of_type
from parflex.files.robot_schema import robot_table
from parflex.mechanics.chain import chain_of
from parflex.mechanics.joint_forces import stretch
from parflex.mechanics.legs.base import joints_at
from parflex.robot.fields import about, described, number

DOCS = Path(__file__).parents[2] / "docs"
CUBIC = kinds.ByType(kinds.Kind("a stiffness", "N m/rad^3", "30"), kinds.Kind("a stiffness", "N/m^3", "2e5"))


@dataclass(frozen=True, eq=False)
class Bearing:
    """A part that a joint may have."""

    play: float


def a_bearing(name, value):
    """The check of an optional part."""
    if value is not None:
        of_type(name, value, Bearing)
    return value


@dataclass(frozen=True, eq=False)
class Cubic(pf.Joint):
    """A joint with one number more, and with one part that it may have."""

    k3: float = number(0.0, CUBIC, "cubic", "of a hard spring", NOT_NEGATIVE, parameter=True)
    bearing: Bearing | None = field(default=None, metadata=about(a_bearing))


VALUE = 0.1 + 0.2  # a number with all its bits
NAME = "legs[*].joints[2].k3"


def robot():
    """The paper's robot, with a hard spring on its sliders."""
    old = pf.robots.gough_stewart(0)
    first, second, third = old.legs[0].joints
    joints = (first, second, Cubic(**vars(third), k3=VALUE, bearing=Bearing(0.1)))
    return replace(old, legs=tuple(replace(leg, joints=joints) for leg in old.legs))


def test_it_is_checked():
    with pytest.raises(pf.InputError, match=r"Cubic.k3 is -1.0; it cannot be negative"):
        Cubic(0, 0, k3=-1)
    with pytest.raises(pf.InputError, match=r"Cubic.k3 is nan"):
        Cubic(0, 0, k3=np.nan)
    with pytest.raises(pf.InputError, match=r"Cubic.bearing is float; expected a Bearing"):
        Cubic(0, 0, bearing=0.1)


def test_it_is_a_table_of_the_chain():
    """Zero for joints that have none; a formula reads it by its name."""
    chain = chain_of(robot().legs[0])
    assert np.array_equal(chain.k3, [[0.0, 0.0, VALUE]])
    force = chain.k3 * stretch(chain, joints_at(chain, np.array([[0.3, 0.2, 2.0]]))) ** 3
    assert force == pytest.approx(np.array([[0.0, 0.0, 8.0 * VALUE]]))
    assert "bearing" not in chain.tables
    with pytest.raises(AttributeError, match="no table 'k4'"):
        _ = chain.k4


def test_a_chain_goes_to_another_process():
    chain = chain_of(robot().legs[0])
    sent = pickle.loads(pickle.dumps(chain))
    assert all(np.array_equal(sent.tables[name], table) for name, table in chain.tables.items())


def test_it_is_a_parameter():
    model = pf.Model(robot(), "numpy", parameters=[NAME])
    other = model.with_parameters({NAME: 7.0})
    assert {leg.joints[2].k3 for leg in other.robot.legs} == {7.0}
    batch = model.direct(robot().home, np.zeros(6), parameters={NAME: [1.0, 2.0]})
    assert batch.platform.shape == (2, 6)
    with pytest.raises(pf.InputError, match=r"k3'\] is -2.0 at index 1; it cannot be negative"):
        model.with_parameters({NAME: [1.0, -2.0]})
    with pytest.raises(pf.InputError, match="no parameter of this robot"):
        pf.Model(robot(), parameters=["legs[*].joints[1].k3"])


def test_it_goes_to_files_and_back(tmp_path):
    path = robot().to_file(tmp_path / "robot.toml")
    again = pf.load_robot(path, joint=Cubic)
    assert [joint.k3 for joint in again.legs[5].joints] == [0.0, 0.0, VALUE]
    assert again.to_file(tmp_path / "again.toml").read_text().replace("again", "robot") == path.read_text()
    path.write_text(path.read_text().replace(f"cubic = {VALUE}", 'cubic = "2 kN/m^3"'))
    assert pf.load_robot(path, joint=Cubic).legs[0].joints[2].k3 == pytest.approx(2000.0)
    with pytest.raises(pf.InputError, match="cubic is not known"):
        pf.load_robot(path)


def test_it_is_in_the_schema():
    tables = robot_table(Cubic).model_json_schema()["$defs"]
    assert tables["Prismatic"]["properties"]["cubic"]["description"] == "of a hard spring"
    assert "N/m^3" in str(tables["Prismatic"]["properties"]["cubic"])
    assert "N m/rad^3" in str(tables["Revolute"]["properties"]["cubic"])


def test_the_documentation_has_a_row_for_each_field():
    page = (DOCS / "robot-files.md").read_text(encoding="utf-8")
    for column in described(pf.Joint).values():
        if column.file:
            first = np.reshape(column.default, -1)[0]
            default = "none" if first is None or np.isinf(first) else f"{first:g}"
            assert f"| `{column.file}` | {column.words} | {column.kind.unit} | {default} |\n" in page
    parameters = ", ".join(f"`{name}`" for name, column in described(pf.Joint).items() if column.parameter)
    assert f"X one of {parameters}, " in (DOCS / "parameters.md").read_text(encoding="utf-8")
