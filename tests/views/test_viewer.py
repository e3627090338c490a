"""What goes into the page: the parts of robots of all kinds, long runs, large platforms, stresses."""

import re

import numpy as np
import pytest
import xarray as xr

import flexlegs
import parflex as pf
import solid_plates
from parflex.mechanics.paths import shares
from parflex.views.viewer.layout import KNOWN
from parflex.views.viewer.opening import ESSENTIAL, MISSED, judged
from parflex.views.viewer.page import packed, page_of
from parflex.views.viewer.parts import Legs, legs_of, parts_of
from parflex.views.viewer.scene import MOST_INSTANTS, scene_of
from parflex.views.viewer.solids import ball, cone, cylinder, drum


def short_run(robot: pf.Robot) -> pf.Result:
    """Held for 5 ms by its motors."""
    model = pf.Model(robot, "numpy")
    start, forces = model.equilibrium(*robot.home_pose)
    hold = pf.JointPD(model, start, kp=1e5, kd=1e3, forces=forces)
    return pf.simulate(model, hold, start, np.linspace(0, 5e-3, 3), rtol=1e-4, atol=1e-6, max_step=5e-3)


@pytest.mark.parametrize("entry", pf.robots.ALL_ROBOTS, ids=lambda entry: entry.build.__name__)
def test_parts_of_every_robot(entry):
    """A motor for each actuator, a ball for each attachment, a pin for each hinge, and no part twice."""
    robot = entry.build(modes=0)
    legs = legs_of(short_run(robot).dataset)
    kinds = [(part.moves["kind"], part.moves.get("at"), part.colour) for part in parts_of(legs)]
    motors = {(kind, at) for kind, at, colour in kinds if colour == 0xD55E00 and kind != "link"}
    sleeves = [part for part in parts_of(legs) if part.moves["kind"] == "link" and part.colour == 0xD55E00]
    assert len(motors) + len(sleeves) == robot.n_forces
    tips = np.argwhere(legs.words == "tip")
    at_tips = {int(p * legs.words.shape[1] + s) for p, s in tips}
    assert {at for kind, at, _ in kinds if kind == "solid"} >= at_tips
    hinges = sum(1 for leg in robot.legs for joint in leg.joints if joint.sigma == 0)
    assert sum(kind == "pin" for kind, _, _ in kinds) == hinges
    moved = [item for item in kinds if item[0] in ("pin", "solid")]
    assert len(moved) == len(set(moved))


def test_axes_of_joints_are_those_of_the_frames():
    """A slide points along its axis: its joint frame lies on it, as far as the joint says."""
    robot = pf.robots.gough_stewart(modes=0)
    data = short_run(robot).dataset
    slide = data["leg_path"][:, :, 3] - data["leg_path"][:, :, 2]
    expected = data["leg_axis"][:, :, 3].values * data["joint"].values[:, :, 2, None]
    assert np.max(np.abs(slide.values - expected)) <= 1e-12
    axes = np.linalg.norm(data["leg_axis"].values, axis=-1)
    assert np.allclose(axes, np.isin(data["leg_station"].values, ["R", "P*"])[None])


SOLIDS = {cylinder: np.pi, cone: np.pi / 3, drum: 2 * np.pi, ball: 4 * np.pi / 3}


@pytest.mark.parametrize("make", SOLIDS, ids=lambda make: make.__name__)
def test_solids_are_closed_and_face_outwards(make):
    """Their volume, as the flux of r/3 through the surface, is a little less than that of the round one."""
    solid = make()
    a, b, c = (solid.vertices[solid.triangles[:, k]] for k in range(3))
    assert 0.9 < np.sum(a * np.cross(b, c)) / 6 / SOLIDS[make] < 1
    facing = np.sum(np.cross(b - a, c - a) * solid.normals[solid.triangles].sum(axis=1), axis=1)
    assert np.all(facing > -1e-12)


def test_shares_go_from_the_base_to_the_tip():
    points = np.array([[[[0, 0, 0], [0, 0, 0], [0, 0, 1], [0, 3, 1], [0, 3, 1.0]]]])
    assert np.allclose(shares(points), [0, 0, 0.25, 1, 1])


def test_rails_are_as_long_as_the_way():
    t = np.linspace(0, 1, 11)
    points = np.zeros((11, 1, 3, 3))
    points[:, 0, 1:, 0] = t[:, None]
    points[:, 0, 2, 2] = 1
    axes = np.zeros_like(points)
    axes[:, :, 1, 0] = 1
    legs = Legs(points, axes, np.array([["base", "P*", "tip"]]), np.array([1]), 0.01)
    rail = parts_of(legs)[0]
    ends = [rail.still @ [0, 0, z, 1] for z in (0, 1)]
    assert np.allclose(ends, [[-0.08, 0, 0, 1], [1.08, 0, 0, 1]])


@pytest.fixture(scope="module")
def bending() -> tuple[xr.Dataset, pf.Modes]:
    """A solid plate that swings in its modes, without legs."""
    modes = solid_plates.modes()
    t = np.linspace(0, 1, 31)
    elastic = 1e-3 * np.sin(np.outer(t, 1 + np.arange(len(modes.frequencies)))) / modes.frequencies * 100
    data = {
        "position": (("time", "axis"), np.zeros((31, 3))),
        "rotation": (("time", "axis", "platform_axis"), np.broadcast_to(np.eye(3), (31, 3, 3))),
        "elastic": (("time", "mode"), elastic),
        "platform_node": (("node", "axis"), modes.nodes),
        "platform_shape": (("mode", "node", "axis"), modes.shapes),
        "platform_triangle": (("triangle", "corner"), modes.triangles),
        "frequency": (("mode",), modes.frequencies),
    }
    return xr.Dataset(data, {"time": t}, {"format": "parflex-result-1"}), modes


@pytest.fixture(scope="module")
def stressed(bending, tmp_path_factory):
    """Its result and its modal file."""
    data, modes = bending
    folder = tmp_path_factory.mktemp("solid")
    pf.fe.write_modes(modes, folder / "modes.nc", attachments=solid_plates.JOINTS, origin=(0, 0, 0))
    data.to_netcdf(folder / "result.nc", engine="h5netcdf")
    return folder


def test_von_mises_stress_is_that_of_the_recovery(bending, stressed):
    """From six components of each mode, against the tensors of the recovery at every instant."""
    from parflex.views.viewer.stress import with_stress

    data, modes = bending
    scene = scene_of(judged(with_stress(data, stressed / "modes.nc")))
    seen = np.unique(modes.triangles)
    expected = pf.fe.recover(modes, data["elastic"].values).mises[:, seen]
    found = scene.colourings["stress"].field(data["elastic"].values)
    assert np.max(np.abs(found - expected)) <= 1e-9 * np.max(expected)
    assert scene.colourings["stress"].high == pytest.approx(np.max(expected))
    assert scene.arrays["stress"].shape == (len(modes.shapes), len(seen), 6)


def test_modes_of_another_platform_are_refused(run_of_paper, stressed):
    with pytest.raises(pf.InputError, match="are not those of the result"):
        pf.view(run_of_paper, modes=stressed / "modes.nc")


@pytest.fixture(scope="module")
def run_of_paper() -> pf.Result:
    return short_run(pf.robots.gough_stewart(modes=3))


def test_inner_nodes_are_left_out(bending):
    data, modes = bending
    scene = scene_of(judged(data))
    assert len(scene.platform.nodes) == len(np.unique(modes.triangles)) < len(modes.nodes)
    drawn, given = (
        body[triangles] for body, triangles in
        ((scene.platform.nodes, scene.platform.triangles), (modes.nodes, modes.triangles))
    )  # fmt: skip
    assert np.array_equal(drawn, given)


def test_long_runs_are_thinned_and_it_is_said(bending):
    data, _ = bending
    t = np.linspace(0, 60, 60_001)
    rest = {
        "position": (("time", "axis"), np.stack([t, 0 * t, 0 * t], axis=1)),
        "rotation": (("time", "axis", "platform_axis"), np.broadcast_to(np.eye(3), (len(t), 3, 3))),
    }
    long = xr.Dataset(rest, {"time": t}, data.attrs)
    scene = scene_of(judged(long))
    assert scene.meta["instants"] == MOST_INSTANTS
    assert scene.meta["end"] == 60
    text = page_of(judged(long), "long.nc", curves=False)
    assert "2000 of the 60001 instants are in this page" in text
    assert len(text) < 3e6


def test_what_is_not_finite_is_left_out_and_said(run_of_paper):
    data = run_of_paper.dataset.copy(deep=True)
    data["position"][1:] = np.nan
    found = judged(data)
    assert found.notes == (
        "Not finite at some instants, which are left out: where the platform is (position).",
    )
    assert scene_of(found).meta["instants"] == 1


def test_packing_is_single_precision_in_order():
    import base64
    import zlib

    arrays = {"a": np.arange(6.0).reshape(2, 3), "b": np.array([np.pi])}
    layout, text = packed(arrays)
    raw = np.frombuffer(zlib.decompress(base64.b64decode(text)), dtype="<f4")
    assert layout == {"a": {"offset": 0, "length": 6}, "b": {"offset": 24, "length": 1}}
    assert np.array_equal(raw, np.float32([0, 1, 2, 3, 4, 5, np.pi]))


def test_page_survives_names_with_markup(run_of_paper):
    data = run_of_paper.dataset.copy()
    data.attrs["robot"] = "</script><b>robot</b>"
    text = page_of(judged(data), "x.nc", curves=False)
    assert "<b>robot</b>" not in text
    assert "&lt;/script&gt;&lt;b&gt;robot&lt;/b&gt;" in text


def test_notebooks_get_the_page_in_a_frame(run_of_paper):
    shown = pf.view(run_of_paper)._repr_html_()
    assert shown.startswith("<iframe srcdoc=")
    assert "parflex-data" in shown


def test_without_k3d_the_remedy_is_said(run_of_paper, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "k3d", None)
    with pytest.raises(pf.InputError, match=r"pip install \"parflex\[view\]\""):
        pf.view(run_of_paper)


def dropped(data: xr.Dataset, name: str) -> xr.Dataset:
    return data.drop_vars(name)


def of_other_dimensions(data: xr.Dataset, name: str) -> xr.Dataset:
    values = data[name].values
    return data.drop_vars(name).assign({name: ([f"d{k}" for k in range(values.ndim)], values)})


def of_another_kind(data: xr.Dataset, name: str) -> xr.Dataset:
    """Words for numbers, and numbers for words."""
    other = 0.5 if data[name].dtype.kind == "U" else "word"
    return data.assign({name: (data[name].dims, np.full(data[name].shape, other))})


def without_units(data: xr.Dataset, name: str) -> xr.Dataset:
    return data.assign({name: (data[name].dims, data[name].values)})


def with_a_hole(data: xr.Dataset, name: str) -> xr.Dataset:
    """Of reals the last is not finite; whole numbers point nowhere."""
    values = data[name].values.copy()
    if values.dtype.kind in "if" and values.size:
        values[-1] = np.nan if values.dtype.kind == "f" else 10**6
    return data.assign({name: (data[name].dims, values)})


SPOILT = (dropped, of_other_dimensions, of_another_kind, without_units, with_a_hole)


@pytest.mark.parametrize("spoil", SPOILT)
def test_spoilt_variables_are_told_and_the_rest_is_shown(run_of_paper, spoil):
    """Each variable in turn; a robot is left but where nothing tells where its platform is."""
    whole = run_of_paper.dataset
    names = {each.name for each in KNOWN} & set(whole.variables)
    told, blank = set(), set()
    for name in names:
        result = judged(spoil(whole, name))
        told |= {name} & set(re.findall(r"\((\w+)\)", " ".join(result.notes)))
        blank |= {name} if scene_of(result) is None else set()
    changed = set() if spoil is without_units else set(MISSED) & names
    changed -= {"leg_station"} if spoil is with_a_hole else set()
    assert changed <= told
    assert blank == (set() if spoil in (without_units, with_a_hole) else set(ESSENTIAL))


@pytest.fixture(scope="module")
def bent_run() -> pf.Result:
    """Struts that bend, released at home for 2 ms."""
    robot = flexlegs.robot("gs_flexlegs")
    return pf.simulate(pf.Model(robot), np.zeros(6), robot.home, [0, 1e-3, 2e-3], rtol=1e-6)


@pytest.mark.parametrize("spoil", SPOILT)
def test_spoilt_variables_of_bent_legs_leave_the_robot(bent_run, spoil):
    """Each in turn: the page is drawn, its legs straight where nothing tells how they bend."""
    whole = bent_run.dataset
    assert judged(whole).notes[1:] == ()  # the first says that the platform has no surface
    for name in ("leg_elastic", "leg_mode_link", "leg_frequency", "leg_deformation", "leg_station"):
        result = judged(spoil(whole, name))
        scene = scene_of(result)
        assert scene is not None
        straight = name == "leg_deformation" and spoil in (dropped, of_other_dimensions, of_another_kind)
        assert ("leg_share" in scene.arrays) == (straight and "leg_station" in result.dataset)
        whole_page = pf.plot.over_time(pf.Result(lambda data=result.dataset: data, ""))
        assert ("Bending of the legs" in whole_page) == (not straight)


def test_a_whole_run_has_nothing_to_tell(run_of_paper):
    assert judged(run_of_paper.dataset).notes == ()


@pytest.mark.parametrize("spoil", SPOILT)
@pytest.mark.parametrize("name", ["forces", "actuator_name", "energy_kinetic"])
def test_figures_are_drawn_of_what_is_left(run_of_paper, spoil, name):
    left = judged(spoil(run_of_paper.dataset, name)).dataset
    assert "Deformation at the origin" in pf.plot.over_time(pf.Result(lambda: left, ""))


def test_a_run_without_instants_is_said_to_be_one(run_of_paper):
    page = page_of(judged(run_of_paper.dataset.isel(time=slice(0, 0))))
    assert "No instants" in page
    assert 'id="blank"' in page


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "no NetCDF-4 file: file signature not found"),
        (b"a,b\n1,2\n", "file signature not found"),
        (None, "folder"),
    ],
)
def test_what_is_no_result_is_refused_in_a_sentence(tmp_path, content, words):
    path = tmp_path / "result.nc"
    path.write_bytes(content) if content is not None else path.mkdir()
    with pytest.raises(pf.InputError, match=words) as said:
        pf.view(path)
    assert "\n" not in str(said.value)


def test_what_is_no_result():
    with pytest.raises(
        pf.InputError,
        match="result is Robot; give the Result of a run, the path of its file, or the linear system",
    ):
        pf.view(pf.robots.rps3())
