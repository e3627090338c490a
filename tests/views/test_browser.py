"""The exported page and the live one in a real browser, headless Chromium under software rendering."""

import json
import os
import shutil
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

import flexlegs
import parflex as pf
from parflex.simulation.holding import held

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
PICTURES = Path(os.environ.get("PARFLEX_SCREENSHOTS", "build/screenshots"))
SIZE = {"width": 1280, "height": 720}
PATIENCE = 300.0  # s; a busy machine is no failure

pytestmark = pytest.mark.skipif(
    CHROMIUM is None, reason="NO BROWSER TESTS: there is no chromium here (apt-get install chromium)"
)


@pytest.fixture(scope="module")
def run(flown) -> pf.Result:
    return flown.result


@pytest.fixture(scope="module")
def saved(run, tmp_path_factory) -> Path:
    return run.save(tmp_path_factory.mktemp("paper") / "result.nc")


@pytest.fixture(scope="module")
def exported(saved) -> Path:
    return pf.view(saved).save(saved.with_name("robot.html"))


@pytest.fixture(scope="module")
def browser():
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        arguments = ["--no-sandbox", "--enable-unsafe-swiftshader"]
        opened = playwright.chromium.launch(executable_path=CHROMIUM, args=arguments)
        yield opened
        opened.close()


TWO_FRAMES = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"


class Page:
    """A page that is open, with what it complained about."""

    def __init__(self, browser, address: str, size: dict = SIZE, offline: bool = True) -> None:
        self.complaints: list[str] = []
        self.asked: list[str] = []
        context = browser.new_context(viewport=size, offline=offline)
        context.set_default_timeout(1000 * PATIENCE)
        self.page = context.new_page()
        self.page.on("console", lambda said: said.type == "error" and self.complaints.append(said.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.goto(address)

    def ready(self) -> "Page":
        return self.until("window.parflex?.state.firstPicture")

    def until(self, words: str) -> "Page":
        self.page.wait_for_function(words)
        return self

    def tell(self, words: str, argument=None):
        return self.page.evaluate(words, argument)

    def keep(self, name: str) -> Path:
        """A screenshot, once the still picture is fine."""
        self.until("!window.parflex || parflex.K3D.getWorld().renderer.getPixelRatio() === 2")
        self.tell(TWO_FRAMES)
        PICTURES.mkdir(parents=True, exist_ok=True)
        self.page.screenshot(path=PICTURES / f"{name}.png")
        return PICTURES / f"{name}.png"

    def close(self) -> None:
        self.page.context.close()


@pytest.fixture
def open_page(browser):
    opened: list[Page] = []

    def one(address: str, **options) -> Page:
        opened.append(Page(browser, address, **options))
        return opened[-1]

    yield one
    for each in opened:
        each.close()


@pytest.fixture(scope="module")
def page(browser, exported):
    """The exported page, offline."""
    opened = Page(browser, exported.as_uri()).ready()
    yield opened
    opened.close()


PLATE = """() => {
  const plate = parflex.plates[parflex.state.colouring], made = plate.geometry.attributes;
  return {position: [...made.position.array], colour: [...(made.uv ?? made.attributes).array],
          place: [...plate.matrix.elements], scale: parflex.state.scale};
}"""


def shown(page: Page, t: float) -> dict:
    """What the drawn platform consists of at a time, from the buffers that the graphics card gets."""
    page.tell("(t) => parflex.go(t)", t)
    return {name: np.array(value) for name, value in page.tell(PLATE).items()}


def test_one_file_of_at_most_6_MB(exported):
    assert exported.stat().st_size <= 6e6
    text = exported.read_text()
    assert 'src="http' not in text
    assert 'href="http' not in text


def test_nothing_is_fetched_and_nothing_complains(page, exported):
    asked = [url for url in page.asked if not url.startswith(("data:", "blob:"))]
    assert asked == [exported.as_uri()]
    assert page.complaints == []


@pytest.mark.parametrize("index", [137, 560, 901])
def test_shown_deflection_is_that_of_the_dataset(page, run, index):
    """Nodes as drawn, less their places at rest, over the scale, against shapes times elastic coordinates."""
    data = run.dataset
    bend = np.einsum("n,nka->ka", data["elastic"].values[index], data["platform_shape"].values)
    found = shown(page, float(data["time"][index]))
    nodes, scale = data["platform_node"].values, float(found["scale"])
    assert scale > 1
    drawn = found["position"].reshape(-1, 3) - nodes
    every = np.einsum("tn,nka->tka", data["elastic"].values, data["platform_shape"].values)
    largest = np.max(np.abs(every))
    assert np.max(np.abs(drawn / scale - bend)[:, 2]) <= 1e-6 * largest
    # along x and y the coordinate at rest, of the size of the platform, is rounded to single precision
    assert (
        np.max(np.abs(drawn / scale - bend))
        <= 1e-6 * largest + np.finfo(np.float32).eps * np.abs(nodes).max()
    )


def test_slider_moves_platform_and_colours(page, run):
    slider = page.page.locator("#slider")
    at = []
    for t in (0.5, 2.8):
        slider.fill(str(t))
        slider.dispatch_event("input")
        at.append({name: np.array(value) for name, value in page.tell(PLATE).items()})
        expected = run.dataset["position"].interp(time=t).values
        place = at[-1]["place"].reshape(4, 4).T
        assert np.allclose(place[:3, 3], expected, atol=1e-6)
    assert np.max(np.abs(at[1]["place"] - at[0]["place"])) > 1e-2
    assert np.max(np.abs(at[1]["colour"] - at[0]["colour"])) > 0.1
    cursor = page.page.locator(".cursor").first
    assert page.page.locator(".curve").count() == 5
    assert "translateX" in cursor.get_attribute("style")


def test_colour_is_the_deflection(page, run):
    """From the middle of the scale, in parts of the largest deflection of the run."""
    data = run.dataset
    every = np.einsum("tn,nk->tk", data["elastic"].values, data["platform_shape"].values[..., 2])
    found = shown(page, float(data["time"][560]))
    colour = found["colour"].reshape(len(data["platform_node"]), -1)[:, 0]
    assert np.allclose(2 * colour - 1, every[560] / np.max(np.abs(every)), atol=1e-5)


def test_scale_mode_legs_and_forces(page, run):
    small = shown(page, 1.0)
    page.page.locator("#scale").fill("0")
    assert np.allclose(shown(page, 1.0)["position"].reshape(-1, 3)[:, 2], 0)
    page.page.locator("#scale").fill(str(page.tell("parflex.meta.scales.indexOf(parflex.meta.scale)")))
    assert np.array_equal(shown(page, 1.0)["position"], small["position"])
    page.page.locator("#motion").select_option("3")
    page.tell("() => { parflex.play(false); parflex.state.phase = 0.25; parflex.draw(); }")
    shape = run.dataset["platform_shape"].values[2, :, 2]
    drawn = np.array(page.tell(PLATE)["position"]).reshape(-1, 3)[:, 2]
    assert np.allclose(drawn / np.max(np.abs(drawn)), shape / np.max(np.abs(shape)), atol=1e-6)
    frequency = float(run.dataset["frequency"][2])
    assert f"{frequency:.1f} rad/s" in page.page.locator("#clock").inner_text()
    assert not page.tell("parflex.parts[0].ids[0].visible")
    page.keep("mode3_1280")
    shown(page, 1.0)
    assert page.tell("parflex.parts[0].ids[0].visible")
    page.page.locator("#forces").uncheck()
    arrows = "parflex.parts.filter(p => p.kind === 'arrow').some(p => p.ids[0].visible)"
    assert not page.tell(arrows)
    page.page.locator("#forces").check()
    assert page.tell(arrows)


def test_arrow_is_the_contact_force(page, run):
    """Its end less its beginning, against the force of the dataset in the world."""
    data = run.dataset.isel(time=560)
    shown(page, float(data["time"]))
    ends = page.tell("""() => parflex.parts.filter(p => p.kind === 'arrow').map(p => p.ids.map(
        o => [...o.matrix.elements]))""")
    drawn = [np.array(head)[12:15] + np.array(head)[8:11] - np.array(shaft)[12:15] for shaft, head in ends]
    force = data["contact_forces"].values @ data["rotation"].values.T
    factor = page.tell("parflex.meta.metresPerNewton")
    assert np.allclose(drawn, factor * force, atol=1e-5)


def test_playing_goes_on_and_pausing_stops(page):
    shown(page, 1.0)
    page.page.locator("#speed").select_option("0.25")
    page.page.locator("#play").click()
    page.until("parflex.state.time > 1.0")
    page.page.locator("#play").click()
    stopped = page.tell("parflex.state.time")
    page.tell(TWO_FRAMES)
    assert page.tell("parflex.state.time") == stopped
    page.page.locator("#speed").select_option("1")


TUBES = """() => parflex.parts.filter(p => p.kind === "tube").map(p => {
  const {position, normal} = p.ids[0].geometry.attributes;
  return {from: p.from, to: p.to, width: p.width, ring: [...position.array], normal: [...normal.array]};
})"""


@pytest.mark.parametrize("modes", [None, ()], ids=["bending platform", "rigid platform"])
def test_legs_bend_with_the_slider(open_page, tmp_path, modes):
    """The middles of the drawn tubes' rings, against the legs' points moved by their deformation so many
    times; their rings are round and across the axis."""
    robot = flexlegs.robot("gs_flexlegs")
    platform = robot.platform if modes is None else robot.platform.with_modes(modes)
    model = pf.Model(pf.Robot(robot.legs, platform, robot.gravity, robot.home_pose))
    state = pf.State(*robot.home_pose, leg_elastic=flexlegs.states("gs_flexlegs")[0].leg_elastic)
    run = pf.simulate(model, np.zeros(6), state, np.linspace(0, 0.01, 6), rtol=1e-6)
    page = open_page(pf.view(run).save(tmp_path / "page.html").as_uri()).ready()
    page.tell("(t) => parflex.go(t)", 0.004)
    data = run.dataset.isel(time=2)
    for _ in range(2):
        scale = page.tell("parflex.state.scale")
        points = data["leg_path"].values + (scale - 1) * data["leg_deformation"].values
        tubes = page.tell(TUBES)
        assert len(tubes) == 12
        for tube in tubes:
            rings = np.reshape(tube["ring"], (tube["to"] - tube["from"] + 1, -1, 3))
            curve = points.reshape(-1, 3)[tube["from"] : tube["to"] + 1]
            assert np.allclose(rings.mean(axis=1), curve, rtol=0, atol=1e-6)
            spokes = np.linalg.norm(rings - curve[:, None], axis=-1)
            assert np.allclose(spokes, tube["width"], rtol=0, atol=1e-6)
            assert np.allclose(np.linalg.norm(np.reshape(tube["normal"], (-1, 3)), axis=-1), 1, atol=1e-6)
        page.page.locator("#scale").fill(str(page.tell("parflex.meta.scales.length") - 6))
    assert page.tell("parflex.state.scale") == 300
    page.keep(f"flexible_legs_{platform.modes}")
    assert page.complaints == []


@pytest.mark.slow
@pytest.mark.parametrize(("width", "height"), [(1280, 720), (1920, 1080), (600, 900)])
def test_picture_at_window_sizes(open_page, exported, width, height):
    """The robot is there, and no control is outside the window."""
    page = open_page(exported.as_uri(), size={"width": width, "height": height}).ready()
    page.tell("parflex.go(2.8)")
    page.keep(f"robot_{width}")
    assert page.tell("document.documentElement.scrollWidth") <= width
    for name in ("#play", "#slider", "#motion", "#forces"):
        box = page.page.locator(name).bounding_box()
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= width
    canvas = page.page.locator("#robot canvas").first.bounding_box()
    assert canvas["width"] > 0.5 * min(width, 900)
    assert canvas["height"] > 250


@pytest.mark.slow
def test_live_page_follows_its_file(open_page, saved, tmp_path):
    """Served by the command; where the file is written anew, the page shows the new one."""
    path = tmp_path / "live.nc"
    shutil.copy(saved, path)
    command = [sys.executable, "-m", "parflex", "view", str(path), "--no-browser"]
    server = subprocess.Popen(
        command, stdout=subprocess.PIPE, text=True, env={**os.environ, "COLUMNS": "200"}
    )
    killer = threading.Timer(PATIENCE, server.kill)
    killer.start()
    try:
        address = server.stdout.readline().split("http://")[1].split(";")[0]
        page = open_page(f"http://{address}", offline=False).ready()
        before = page.tell("parflex.meta.modes")
        assert before == 10
        page.page.locator("#slider").fill("2.0")
        assert page.tell("parflex.state.time") == pytest.approx(2.0, abs=0.01)
        page.tell("window.old = true")
        pf.load_result(saved).dataset.isel(mode=slice(0, 4)).to_netcdf(path, engine="h5netcdf")
        page.until("!window.old && window.parflex?.meta.modes === 4")
        path.write_bytes(saved.read_bytes()[:100_000])
        page.until("!!document.querySelector('#blank')")
        assert "truncated" in page.page.locator("#banner").inner_text()
        assert page.complaints == []
    finally:
        killer.cancel()
        server.terminate()
        server.communicate(timeout=PATIENCE)


def spoiled(data, name: str):
    """A dataset in which something is not as it should be, and the words that say so."""
    if name == "partial":
        data.attrs |= {"partial": 1, "stopped": "at 2.1 s: leg 3 does not reach"}
        return data.isel(time=slice(0, 420)), "Partial: the run stopped at 2.1 s: leg 3"
    if name == "other version":
        data.attrs["format"] = "parflex-result-9"
        return data.drop_vars(["leg_axis", "frequency"]), "format 'parflex-result-9'"
    if name == "no mesh":
        return data.drop_vars(["platform_triangle"]), "No platform mesh"
    if name == "no platform":
        return data.drop_vars(
            ["platform_triangle", "platform_node", "platform_shape"]
        ), "the platform's nodes"
    return data.drop_vars(["position"]), "where the platform is (position)"


@pytest.mark.slow
@pytest.mark.parametrize("name", ["partial", "other version", "no mesh", "no platform", "no position"])
def test_what_is_missing_is_said_and_the_rest_is_shown(open_page, run, tmp_path, name):
    data, words = spoiled(run.dataset.copy(), name)
    path = tmp_path / "result.nc"
    data.to_netcdf(path, engine="h5netcdf")
    page = open_page(pf.view(path).save(tmp_path / "page.html").as_uri())
    if name != "no position":
        page.ready()
        page.tell("parflex.go(1.5)")
    else:
        assert "cannot be drawn" in page.page.locator("#blank").inner_text()
    assert words in page.page.locator("#banner").inner_text()
    assert page.page.locator(".curve").count() >= 4
    page.keep(f"bad_{name.replace(' ', '_')}")
    assert page.complaints == []


@contextmanager
def jupyterlab(folder: Path):
    """The address of a JupyterLab that serves a folder."""
    pytest.importorskip("jupyterlab", reason="JupyterLab runs the notebook")
    places = {f"JUPYTER_{kind}_DIR": str(folder / kind) for kind in ("CONFIG", "DATA", "RUNTIME")}
    command = [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", "--ServerApp.port=0"]
    with open(folder / "log.txt", "w") as log:
        server = subprocess.Popen(command, cwd=folder, env=os.environ | places, stderr=log)
        try:
            until = time.monotonic() + PATIENCE
            while not (told := list(folder.glob("RUNTIME/jpserver-*.json"))) and time.monotonic() < until:
                time.sleep(0.2)
            assert told, (folder / "log.txt").read_text()
            about = json.loads(told[0].read_text())
            yield f"{about['url']}doc/tree/robot.ipynb?token={about['token']}"
        finally:
            server.terminate()
            server.wait(timeout=PATIENCE)


def shown_by_first_cell(page):
    """The frame that it shows; it is run again where nothing has come of it for a while.

    JupyterLab drops keys while it connects to its kernel, and what a kernel says while it connects anew.
    """
    from playwright.sync_api import TimeoutError as Late

    page.wait_for_selector("[data-status=idle]", state="attached")
    until = time.monotonic() + PATIENCE
    while True:
        page.locator(".jp-CodeCell .cm-content").first.click()
        page.keyboard.press("Control+Enter")
        try:
            return page.wait_for_selector(".jp-OutputArea iframe", timeout=30_000)
        except Late:
            said = page.locator(".jp-CodeCell").first.inner_text()
            assert time.monotonic() < until, f"the cell shows no frame: {said}"


@pytest.mark.slow
def test_notebook_in_jupyterlab(open_page, saved, run, tmp_path):
    """A cell that is run there: its frame plays, and the slider puts the platform where the dataset says."""
    import nbformat

    shutil.copy(saved, tmp_path / "result.nc")
    cell = nbformat.v4.new_code_cell("import parflex as pf\npf.view('result.nc', curves=False)")
    python = {"kernelspec": {"name": "python3", "display_name": "Python 3"}}
    nbformat.write(nbformat.v4.new_notebook(cells=[cell], metadata=python), tmp_path / "robot.ipynb")
    with jupyterlab(tmp_path) as address:
        page = open_page(address, offline=False)
        shown = shown_by_first_cell(page.page)
        frame = shown.content_frame()
        frame.wait_for_function("window.parflex?.state.firstPicture")
        assert frame.locator("#robot canvas").first.is_visible()
        before = frame.evaluate("parflex.state.time")
        frame.wait_for_function("(before) => parflex.state.time > before + 0.1", arg=before)
        frame.locator("#slider").fill("2.8")
        place = np.reshape(frame.evaluate(PLATE)["place"], (4, 4)).T
        assert np.allclose(place[:3, 3], run.dataset["position"].interp(time=2.8).values, atol=1e-6)
        page.keep("jupyterlab_1280")
    assert page.complaints == []
    own = (address.split("doc/")[0], "data:", "blob:")
    assert [url for url in page.asked if not url.startswith(own)] == []


@pytest.mark.slow
def test_stress_in_the_page_is_that_of_the_recovery(open_page, tmp_path):
    """A solid plate in its first mode: the page's von Mises stress at every node, to single precision."""
    import xarray as xr

    import solid_plates

    modes = solid_plates.modes()
    q = np.zeros((2, len(modes.frequencies)))
    q[1, 0] = 1e-3
    data = xr.Dataset(
        {
            "position": (("time", "axis"), np.zeros((2, 3))),
            "rotation": (("time", "axis", "platform_axis"), np.stack([np.eye(3)] * 2)),
            "elastic": (("time", "mode"), q),
            "platform_node": (("node", "axis"), modes.nodes),
            "platform_shape": (("mode", "node", "axis"), modes.shapes),
            "platform_triangle": (("triangle", "corner"), modes.triangles),
        },
        {"time": [0.0, 1.0]},
        {"format": "parflex-result-1"},
    )
    data.to_netcdf(tmp_path / "result.nc", engine="h5netcdf")
    pf.fe.write_modes(modes, tmp_path / "modes.nc", attachments=solid_plates.JOINTS, origin=(0, 0, 0))
    made = pf.view(tmp_path / "result.nc", modes=tmp_path / "modes.nc").save(tmp_path / "page.html")
    page = open_page(made.as_uri()).ready()
    page.page.locator("#colouring").select_option("stress")
    colour = shown(page, 1.0)["colour"]
    expected = pf.fe.recover(modes, q[1]).mises[np.unique(modes.triangles)]
    found = colour.reshape(len(expected), -1)[:, 0]
    assert np.max(np.abs(found - expected / np.max(expected))) <= 1e-5
    assert "von Mises stress (MPa)" in page.page.locator("#legend").inner_text()
    page.keep("stress_1280")
    assert page.complaints == []


@pytest.fixture(scope="module")
def swinging(browser, tmp_path_factory):
    """The linear system of a plate on cranks with locked motors, and the page of its modes."""
    model = pf.Model(pf.robots.rus6(modes=3), "numpy")
    lin = held(model, "locked")[1]
    path = pf.view(lin).save(tmp_path_factory.mktemp("swinging") / "modes.html")
    opened = Page(browser, path.as_uri()).ready()
    yield lin, opened
    opened.close()


def world_nodes(page: Page) -> np.ndarray:
    """(K, 3) m, the platform's nodes as they are drawn."""
    drawn = page.tell(PLATE)
    place = np.array(drawn["place"]).reshape(4, 4).T
    return np.reshape(drawn["position"], (-1, 3)) @ place[:3, :3].T + place[:3, 3]


def moved_nodes(lin, shape: np.ndarray) -> np.ndarray:
    """(K, 3), the displacement of the platform's nodes by its definition."""
    body, x = lin.point.mechanism.platform.body, lin.point.system.x
    own = body.nodes + np.einsum("n,nka->ka", x.elastic, body.shapes)
    bend = np.einsum("n,nka->ka", shape[6 : 6 + body.modes], body.shapes)
    return (shape[:3] + np.cross(shape[3:6], own) + bend) @ x.rotation.T


def test_modes_swing(swinging):
    """Nodes less those in the middle are in proportion to the mode's shape, and to the amplitude: what
    the page turns is bent already, which errs by the square of the motion, here a tenth of that at first."""
    lin, page = swinging
    modes = lin.modes()
    for k in (1, 2):
        page.page.locator("#swings tbody tr").nth(k).click()
        assert f"mode {k + 1}: {float(modes.frequency[k]):.4g} Hz" in page.page.locator("#clock").inner_text()
        drawn = []
        for amplitude in ("0", "0.05", "0.1"):
            page.page.locator("#amplitude").fill(amplitude)
            page.tell("parflex.go(0.0)")
            drawn.append(world_nodes(page))
        once, twice = drawn[1] - drawn[0], drawn[2] - drawn[0]
        shape = moved_nodes(lin, modes["shape"].values[k])
        factor = np.sum(once * shape) / np.sum(shape**2)
        assert factor > 0
        assert np.max(np.abs(once - factor * shape)) < 0.004 * np.max(np.abs(once))
        assert np.max(np.abs(twice - 2 * once)) < 0.004 * np.max(np.abs(twice))
        page.page.locator("#amplitude").fill("0.05")
        page.tell("parflex.go(0.5)")
        assert np.max(np.abs(world_nodes(page) - drawn[0] + once)) < 0.008 * np.max(np.abs(once))
        page.page.locator("#amplitude").fill("1")
    words = page.page.locator("#largest").inner_text()
    assert "times slower than it is" in words
    assert "a mode has no size of its own" in words
    page.tell("parflex.go(0.0)")
    page.keep("machine_mode3")
    assert page.complaints == []


def test_arrow_keys_choose_modes_and_space_plays(swinging):
    _, page = swinging
    page.page.locator("#swings tbody tr").first.click()
    chosen = "[...document.querySelectorAll('#swings tr.chosen td')].at(0).textContent"
    for key, number in (("ArrowDown", "2"), ("ArrowRight", "3"), ("ArrowDown", "3"), ("ArrowUp", "2")):
        page.page.keyboard.press(key)
        assert page.tell(chosen) == number
    page.page.keyboard.press("Space")
    page.until("parflex.state.playing && parflex.state.time > 0")
    page.page.keyboard.press("Space")
    assert not page.tell("parflex.state.playing")
    asked = [url for url in page.asked if not url.startswith(("data:", "blob:"))]
    assert len(asked) == 1


def test_a_load_is_drawn_in_proportion(swinging, open_page, tmp_path):
    """At half of the ramp's period the whole deflection, many times; the arrow's head is at the moved node.
    Its turn, which is drawn linearly, and the bend together err by the square of the motion as drawn."""
    lin, _ = swinging
    made = pf.view(lin, wrenches=[pf.Wrench(0, (9, 0, -4))]).save(tmp_path / "load.html")
    page = open_page(made.as_uri()).ready()
    page.tell("parflex.go(0)")
    rest = world_nodes(page)
    page.tell("parflex.go(0.5)")
    moved = world_nodes(page) - rest
    factor = page.tell("parflex.meta.swings[0].factor")
    with pytest.warns(pf.BeyondBasis):  # the page says it in its banner
        C = pf.compliance(lin, 0)(np.zeros(1)).values[:, :, 0].real
    assert "Node 0 is asked for, where its modes lack" in page.page.locator("#banner").inner_text()
    deflection = C[:3] @ [9, 0, -4, 0, 0, 0]
    assert np.allclose(moved[0], factor * deflection, atol=0.02 * np.max(np.abs(moved)))
    head = page.tell("[...parflex.parts.filter(p => p.kind === 'borne').at(-1).ids[0].matrix.elements]")
    tip = np.array(head)[12:15] + np.array(head)[8:11]
    assert np.allclose(tip, rest[0] + factor * deflection, atol=1e-4)
    page.keep("static_load")
    assert "times larger than it is" in page.page.locator("#largest").inner_text()
    assert page.complaints == []
