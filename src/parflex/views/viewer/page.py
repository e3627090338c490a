"""A result as one HTML file that plays offline: K3D's own snapshot with our controls about it."""

import base64
import html
import json
import os
import zlib
from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.writing import replacing
from parflex.linear.system import LinearModel
from parflex.robot.wrench import Wrench
from parflex.simulation.result import Result
from parflex.simulation.summary import scope_of
from parflex.views import plot
from parflex.views.viewer.drawing import drawn
from parflex.views.viewer.loads import load_as_swing
from parflex.views.viewer.opening import Opened, judged, opened, showing
from parflex.views.viewer.scene import MOST_INSTANTS, Scene, scene_of
from parflex.views.viewer.stress import with_stress
from parflex.views.viewer.swing_page import body_of, swinging_scene
from parflex.views.viewer.swings import Swings, modes_as_swings

SPEEDS = (0.02, 0.05, 0.1, 0.25, 0.5, 1, 2, 5)
CANVAS = '<div id="canvasTarget"></div>'  # where K3D draws, in its snapshot and in our page
EMPTY = f"<!doctype html><html><head></head><body>{CANVAS}</body></html>"

AGAIN = '<meta http-equiv="refresh" content="2">'  # looks whether there is a robot by now


class View:
    """A moving robot in a page: shown by notebooks, written by `save`; `html` is its text."""

    def __init__(self, text: str) -> None:
        self.html = text

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the page, whole or not at all; raises InputError where it cannot be written."""
        target = Path(path)
        with replacing(target) as part:
            part.write(self.html.encode())
        return target

    def _repr_html_(self) -> str:
        """The page in a frame of its own, for notebooks."""
        style = "width:100%;height:640px;border:1px solid #d8dee5"
        return f'<iframe srcdoc="{html.escape(self.html)}" style="{style}" title="robot"></iframe>'


def view(
    result: Result | LinearModel | str | os.PathLike[str],
    *,
    curves: bool = True,
    modes: str | os.PathLike[str] | None = None,
    wrenches: Sequence[Wrench] = (),
) -> View:
    """The robot of a result, or of a file that `Result.save` wrote, moving in a page.

    The page is one HTML text that needs nothing else; it bends the platform itself, from the mode shapes and
    the elastic coordinates. `curves` puts the figures of the run beside it; `modes`, the modal
    file of a platform with elements, lets it be coloured by von Mises stress. What a file lacks
    is said in it.

    Of a linear system, `model.linearise(…)`, the page shows the robot as it swings in each of its modes,
    beside the table of them; with `wrenches`, the robot as it gives under a static load, by its stiffness
    about the equilibrium.

    Raises InputError where a file cannot be read, modes are of another platform, k3d is not installed, a
    load has no deflection since nothing holds the robot, or an argument does not go with the others.
    """
    if isinstance(result, LinearModel):
        if modes is not None:
            raise InputError("modes colour a result by stress; a linear system has its own: leave them out")
        return View(swinging_page(load_as_swing(result, wrenches) if wrenches else modes_as_swings(result)))
    if not isinstance(result, Result | str | os.PathLike):
        raise InputError(
            f"result is {type(result).__name__}; give the Result of a run, the path of its file, or the "
            f"linear system of a robot, model.linearise(…)"
        )
    if wrenches:
        raise InputError("wrenches load a linear system, model.linearise(…); a result has its own")
    found = judged(result.dataset) if isinstance(result, Result) else opened(Path(result))
    name = "" if isinstance(result, Result) else Path(result).name
    if modes is not None:
        found = found._replace(dataset=with_stress(found.dataset, Path(modes)))
    with showing(Path(name or "the result")):
        return View(page_of(found, name, curves))


def page_of(result: Opened, name: str = "", curves: bool = True, live: str = "", stamp: str = "") -> str:
    """The page of a result; `live` is where it asks whether its file has another time stamp by now."""
    scene = scene_of(result)
    body: dict[str, Any] = {
        "title": result.dataset.attrs.get("robot") or name or "Parallel robot",
        "facts": facts_of(result, name),
        "notes": notes_of(result, scene),
        "curves": curves_of(result) if curves else [],
        "speeds": SPEEDS,
        "meta": None,
    }
    if scene is None:
        return page_around(EMPTY.replace("<head>", f"<head>{AGAIN}") if live else EMPTY, body, "")
    return moving(scene, body, {"live": live, "stamp": stamp})


def swinging_page(told: Swings) -> str:
    """The page of small motions of a robot."""
    return moving(swinging_scene(told), {"speeds": SPEEDS, "meta": None} | body_of(told), {})


def moving(scene: Scene, body: dict[str, Any], more: dict[str, Any]) -> str:
    """The page of a scene."""
    snapshot, ids, parts = drawn(scene)
    layout, data = packed(scene.arrays)
    meta = {"swings": [], "live": "", "stamp": ""} | scene.meta | more
    meta |= {
        "plates": ids,
        "parts": [part.moves | {"ids": own} for part, own in zip(scene.parts, parts, strict=True)],
        "colourings": {key: each.for_page() for key, each in scene.colourings.items()},
        "colouring": next(iter(scene.colourings)),
        "arrays": layout,
        "speed": 1,
        "playing": True,
    }
    script = f"{ours('swings.js')}\n{ours('viewer.js')}"
    code = f"(async (K3D) => {{\n{script}\n}})(K3DInstance).catch(window.parflexFailed);"
    return page_around(snapshot.get_snapshot(additional_js_code=code), body | {"meta": meta}, data)


def page_around(snapshot: str, body: dict[str, Any], data: str) -> str:
    """K3D's page with our head, and our body about its canvas."""
    page = Environment(autoescape=True, trim_blocks=True).from_string(ours("body.html")).render(body)
    title = html.escape(f"{body['title']} · parflex")
    meta = json.dumps(body["meta"]).replace("<", "\\u003c")
    head = (
        '<link rel="icon" href="data:,"><meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{title}</title>"
        f"<style>{ours('viewer.css')}</style><script>{ours('failures.js')}</script>"
    )
    held = (
        f'<script type="application/json" id="parflex-meta">{meta}</script>'
        f'<script type="text/plain" id="parflex-data">{data}</script>'
    )
    start, end = snapshot.index("<title>") if "<title>" in snapshot else 0, snapshot.find("</title>")
    if end > 0:
        snapshot = snapshot[:start] + snapshot[end + len("</title>") :]
    snapshot = snapshot.replace("</head>", f"{head}</head>", 1)
    return snapshot.replace(CANVAS, f"{page}{held}", 1)


def ours(name: str) -> str:
    """The text of a file of our page."""
    return resources.files(__package__).joinpath("assets", name).read_text(encoding="utf-8")


def packed(arrays: dict[str, Array]) -> tuple[dict[str, dict[str, int]], str]:
    """The place and length of each array in bytes that are single floats, deflated, in base 64."""
    layout, pieces, offset = {}, [], 0
    for name, values in arrays.items():
        piece = np.ascontiguousarray(values, dtype="<f4")
        layout[name] = {"offset": offset, "length": piece.size}
        pieces.append(piece.tobytes())
        offset += piece.nbytes
    return layout, base64.b64encode(zlib.compress(b"".join(pieces), 9)).decode()


def facts_of(result: Opened, name: str) -> list[str]:
    """The facts of the run, in a few words each."""
    data, facts = result.dataset, [name] if name else []
    if not data:
        return facts
    scope = {name: fact.value for name, fact in scope_of(data).items()}
    if scope.get("legs") and scope.get("motors"):
        facts.append(f"{scope['legs']} legs, {scope['motors']} motors")
    modes = scope.get("elastic modes", 0)
    facts.append(f"{modes} elastic modes" if modes else "rigid platform")
    if "duration" in scope:
        facts.append(f"{scope['duration']:.4g} s simulated")
    return [*facts, f"parflex {data.attrs.get('parflex_version', '?')}"]


def notes_of(result: Opened, scene: Scene | None) -> list[str]:
    """The notes that the reader of the view must know."""
    notes, count = list(result.notes), result.dataset.sizes.get("time", 0)
    if scene is not None and count > MOST_INSTANTS:
        notes.append(f"{scene.meta['instants']} of the {count} instants are in this page.")
    return notes


def curves_of(result: Opened) -> list[dict[str, Any]]:
    """The figures of the run, with the places of their cursors in percent."""
    figures: list[dict[str, Any]] = []
    if not result.dataset.sizes.get("time"):
        return figures
    for words, figure in plot.over_time(Result(lambda: result.dataset, "")).items():
        svg, boxes = plot.drawn(figure)
        places = [
            {"low": left, "high": right, "top": 100 * (1 - top), "height": 100 * (top - bottom)}
            for left, bottom, right, top in boxes
        ]
        figures.append({"title": words, "data": base64.b64encode(svg.encode()).decode(), "boxes": places})
    return figures
