"""The commands frf and lobes: what they write, what they say, what they refuse."""

import re

import h5py
import numpy as np
import pytest

import parflex as pf
from parflex.base.netcdf import loaded

LIGHT = pf.Bar(mass=1e-5, outer=0.01, length=0.15)
SIZES = dict(base_radius=0.25, platform_radius=0.15, height=0.3, base_spread=0.35, platform_spread=0.5)
TOOL = (0.02, 0.0, 0.1)


@pytest.fixture
def hexapod(tmp_path):
    """A hexapod on springs and dampers, with a tool, in a file; and its linear system at home."""
    strut = pf.Strut(LIGHT, LIGHT, stiffness=2e6, damping=200.0)
    robot = pf.robots.hexapod(**SIZES, strut=strut, payload=pf.Payload(8.0, (0.0, 0.0, 0.05)))
    robot.to_file(tmp_path / "robot.toml")
    with (tmp_path / "robot.toml").open("a") as file:
        file.write(f"\n[tool]\nposition = {list(TOOL)}\n")
    model = pf.Model(robot, "numpy")
    lin = model.linearise(*model.equilibrium(*robot.home_pose))
    node = int(np.argmin(np.linalg.norm(robot.platform.nodes - TOOL, axis=1)))
    return lin, node, tuple(TOOL - robot.platform.nodes[node])


def complex_of(path):
    data = loaded(path)
    return data, data.response_real.values + 1j * data.response_imag.values


def test_the_compliance_of_the_tool(parflex, hexapod, tmp_path):
    """What `pf.compliance` gives at the file's frequencies, dense about resonances, with labels and units."""
    lin, node, offset = hexapod
    code, out, err = parflex("frf", "robot.toml")
    assert code == 0, err
    data, H = complex_of("parflex-frf/frf.nc")
    wanted = pf.compliance(lin, node, offset)(data.omega.values).values[:3, :3]
    assert np.allclose(H, wanted, rtol=1e-6, atol=1e-9 * np.max(np.abs(wanted)))
    assert list(data.output.values) == ["tool_x", "tool_y", "tool_z"]
    assert list(data.input.values) == ["tool_fx", "tool_fy", "tool_fz"]
    assert list(data.output_units.values) == ["m"] * 3
    assert data.frequency.attrs["units"] == "Hz"
    assert data.attrs["held"] == "on its motors' springs"
    told = re.findall(r"│ \d+ +│ ([\d.]+) ", out)
    modes = lin.modes()
    swing = modes.frequency.values[modes.pole_imag.values > 0]
    assert np.allclose([float(each) for each in told], swing, rtol=1e-4)
    o, i, w = np.unravel_index(np.argmax(np.abs(H)), H.shape)
    words = " ".join(out.split())
    assert f"that of tool_{'xyz'[o]} to tool_f{'xyz'[i]}, {abs(H[o, i, w]):.4g} m/N at" in words
    assert (tmp_path / "parflex-frf" / "bode.png").stat().st_size > 10_000


def test_the_file_is_plain_hdf5(parflex, hexapod):
    """MATLAB's ncread reads doubles and texts, no compound numbers."""
    assert parflex("frf", "robot.toml", "--from", "tool_fz", "--to", "tool_z", "--out", "one")[0] == 0
    with h5py.File("one/frf.nc") as file:
        assert file["response_real"].dtype == np.float64
        assert file["response_imag"].shape == (1, 1, file["omega"].shape[0])
        assert file["output"].asstr()[0] == "tool_z"


def test_what_of_the_floor_arrives(parflex, hexapod):
    lin, node, offset = hexapod
    code, out, err = parflex("frf", "robot.toml", "--from", "base_z", "--to", "tool_z", "--band", "2..200 Hz")
    assert code == 0, err
    data, H = complex_of("parflex-frf/frf.nc")
    wanted = pf.transmissibility(lin, node, offset)(data.omega.values).values[2, 2]
    assert np.allclose(H[0, 0], wanted, rtol=1e-6)
    assert data.frequency.values[[0, -1]] == pytest.approx([2, 200])
    assert "tool_z to base_z" in out


def test_motors_and_load_cells(parflex, hexapod):
    """As `lin.frf` has them, on locked motors or springs; --node names a node in labels."""
    code, _, err = parflex(
        "frf", "robot.toml", "--from", "force[0], node[2]_mz", "--to", "strut[1],node[2]_az", "--node", "2"
    )
    assert code == 0, err
    data, H = complex_of("parflex-frf/frf.nc")
    lin = hexapod[0]
    robot = lin.point.mechanism.robot
    model = pf.Model(robot, "numpy")
    given = dict(
        inputs=(pf.Actuators(), pf.NodeWrench(2)),
        outputs=(pf.StrutForce(), pf.NodeMotion(2, of="acceleration")),
    )
    full = model.linearise(*model.equilibrium(*robot.home_pose), **given).frf(data.omega.values)
    wanted = full.sel(input=["force[0]", "node[2]_mz"], output=["strut[1]", "node[2]_az"]).values
    assert np.allclose(H, wanted, rtol=1e-6, atol=1e-9 * np.max(np.abs(wanted)))


def test_lobes_of_the_tool(parflex, hexapod, tmp_path):
    lin, node, offset = hexapod
    code, out, err = parflex(
        "lobes", "robot.toml", "--stiffness", "80 N/mm^2", "--teeth", "4", "--direction", "0,1,0",
        "--speeds", "500..6000",
    )  # fmt: skip
    assert code == 0, err
    data = loaded("parflex-lobes/lobes.nc")
    tool = pf.compliance(lin, node, offset)(data.omega.values)
    wanted = pf.stability_lobes(tool, stiffness=8e7, teeth=4, direction=(0, 1, 0), speeds=data.speed.values)
    assert np.allclose(data.limit, wanted.limit, rtol=1e-6)
    assert data.speed.values[[0, -1]] == pytest.approx([500, 6000])
    assert f"at any speed up to a depth of {1e3 * float(wanted.lowest):.3g} mm" in " ".join(out.split())
    assert (tmp_path / "parflex-lobes" / "lobes.png").stat().st_size > 10_000
    same = parflex("lobes", "robot.toml", "--stiffness", "8e7", "--teeth", "4", "--direction", "0,2,0;0,1,0")
    assert same[0] == 0
    assert float(loaded("parflex-lobes/lobes.nc").lowest) == pytest.approx(float(data.lowest), rel=1e-9)


CUT = ("lobes", "robot.toml", "--teeth", "4", "--direction")


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (("frf", "robot.toml", "--from", "tool_q"), "--from names 'tool_q', which there is not; there are"),
        (("frf", "robot.toml", "--to", "base_z"), "--to names 'base_z', which there is not"),
        (("frf", "robot.toml", "--from", "base_z,force[0]"), "names the floor and forces together"),
        (("frf", "robot.toml", "--band", "50..5"), "--band is '50..5'; give two positive numbers"),
        (("frf", "robot.toml", "--band", "5..50 rad"), "--band is '5..50 rad'"),
        (("frf", "robot.toml", "--node", "99"), "--node is 99; the platform has nodes 0 … 5"),
        (("frf", "robot.toml", "--motors", "loose"), "--motors is 'loose'; choose one of"),
        (("frf", "robot.toml", "--structural", "-1"), "structural is -1.0; a loss factor is not negative"),
        (("frf", "robot.toml", "--format", "gif"), "--format is 'gif'"),
        ((*CUT, "0,1", "--stiffness", "8e7"), "--direction is '0,1'; give a vector like 0,1,0"),
        ((*CUT, "0,1,0", "--stiffness", "8 N"), "--stiffness is \"8 N\", which is not a cutting stiffness"),
        ((*CUT, "0,1,0", "--stiffness", "-8"), "stiffness"),
        ((*CUT, "0,1,0", "--stiffness", "8e7", "--speeds", "9"), "--speeds is '9'"),
        ((*CUT, "0,1,0", "--stiffness", "8e7", "--band", "0.01..0.02"), "nowhere negative"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said(parflex, hexapod, words, complaint):
    code, _, err = parflex(*words)
    assert code == 2
    assert complaint in " ".join(err.split())


def test_a_robot_without_a_tool(parflex):
    pf.robots.hexapod(**SIZES, strut=pf.Strut(LIGHT, LIGHT, stiffness=2e6)).to_file("bare.toml")
    code, _, err = parflex("frf", "bare.toml")
    assert code == 2
    assert "bare.toml has no [tool]; add one, with a position, or name a node" in " ".join(err.split())
    assert parflex("frf", "bare.toml", "--node", "0")[0] == 0


def test_a_rigid_robot_on_locked_motors_answers_nothing(parflex, hexapod):
    code, _, err = parflex("frf", "robot.toml", "--motors", "locked")
    assert (code, "nothing swings" in err) == (2, True)
    code, out, _ = parflex("frf", "robot.toml", "--motors", "locked", "--band", "1..100")
    assert (code, "nothing answers" in out) == (0, True)


def test_help_teaches(parflex):
    for command in ("frf", "lobes"):
        code, out, _ = parflex(command, "--help")
        assert code == 0
        assert "Examples" in out
        assert f"parflex {command} robot.toml" in out
