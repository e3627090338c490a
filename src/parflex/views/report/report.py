"""The report of a result: facts, modes, figures, energies, checks, versions and the robot file."""

import base64
import os
from datetime import UTC, datetime
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from jinja2 import Environment

from parflex.base.errors import InputError
from parflex.base.version import __version__
from parflex.base.versions import versions
from parflex.simulation.machine_modes import HELD, machine_rows
from parflex.simulation.result import Result
from parflex.simulation.summary import figures_of, scope_of
from parflex.simulation.variables import ALL_VARIABLES
from parflex.simulation.variables.energy import LEDGER, RESIDUAL
from parflex.views import plot
from parflex.views.report.checks import checks_of
from parflex.views.sketch import instant_of_largest_bend, sketch_of
from parflex.views.viewer.opening import Opened, opened, showing
from parflex.views.viewer.scene import finite_part

SETTINGS = {
    "control": "control",
    "integrator": "integrator",
    "rtol": "relative tolerance",
    "atol": "absolute tolerance",
    "max_step": "largest step (s)",
    "backend": "backend",
    "parflex_version": "simulated with parflex",
}


PICTURED = {each.name for each in ALL_VARIABLES if each.pictured}


def report_of(path: str | os.PathLike[str]) -> str:
    """The report of a file that `Result.save` wrote, as one HTML text that needs nothing else.

    Raises InputError where the file cannot be read or holds no run.
    """
    source = Path(path)
    result = opened(source)
    if not result.dataset.sizes.get("time"):
        raise InputError(f"{source} holds no run: it has no instants; give the result of a simulation")
    template = resources.files(__package__).joinpath("report.html").read_text(encoding="utf-8")
    page = Environment(autoescape=True, trim_blocks=True).from_string(template)
    with showing(source):
        return page.render(contents(result, source))


def contents(result: Opened, source: Path) -> dict[str, Any]:
    """The values of the template's names."""
    data = result.dataset
    checks = checks_of(data)
    notes = [*result.notes, *lines(data, "notes"), *lines(data, "beyond_limits")]
    return {
        "title": data.attrs.get("robot") or source.stem,
        "file": source.name,
        "written": f"{datetime.now(UTC):%Y-%m-%d %H:%M} UTC",
        "parflex": __version__,
        "notes": notes,
        "verdict": str(data.attrs.get("verdict", "")),
        "stable": bool(data.attrs.get("stable", True)),
        "failed": [check for check in checks if not check.passed],
        "facts": facts(data),
        "numbers": numbers(data),
        "picture": robot_picture(data),
        "modes": modes(data),
        "leg_modes": leg_modes(data),
        "machine": machine_rows(data),
        "held": data.attrs.get(HELD, ""),
        "shapes": picture(plot.shapes_of(as_result(data))) if drawable(data) else "",
        "figures": {words: picture(fig) for words, fig in plot.over_time(as_result(data)).items()},
        "ledger": ledger(data),
        "checks": checks,
        "versions": versions(),
        "robot": str(data["robot_file"].values) if "robot_file" in data else "",
    }


def as_result(data: xr.Dataset) -> Result:
    """The dataset as the figures take it."""
    return Result(lambda: data, str(data.attrs.get("stopped", "")))


def lines(data: xr.Dataset, name: str) -> list[str]:
    """An attribute of several lines."""
    return str(data.attrs.get(name, "")).splitlines()


def picture(figure: Any) -> str:
    """A figure as the source of an image."""
    return f"data:image/svg+xml;base64,{base64.b64encode(plot.drawn(figure).svg.encode()).decode()}"


def robot_picture(data: xr.Dataset) -> str:
    """The robot where it bends most; empty where the result does not tell enough of it."""
    whole = finite_part(data)
    if whole is None or not set(data) >= PICTURED:
        return ""
    data = whole
    index = instant_of_largest_bend(as_result(data))
    when = f"t = {float(data['time'][index]):.3g} s"
    return picture(plot.robot_at(sketch_of(as_result(data), index), when))


def drawable(data: xr.Dataset) -> bool:
    """True where the platform is a flat surface whose modes can be drawn."""
    if not {"platform_triangle", "platform_node", "platform_shape"} <= set(data) or not data.sizes["mode"]:
        return False
    nodes = data["platform_node"].values
    return float(np.ptp(nodes[:, 2])) < 1e-6 * float(np.max(np.ptp(nodes, axis=0)))


def facts(data: xr.Dataset) -> dict[str, str]:
    """The facts of the run: robot, control, integration."""
    scope = {name: fact.value for name, fact in scope_of(data).items()}
    found = {"duration": f"{scope['duration']:.6g} s, {scope['instants']} instants"}
    if "leg_station" in data:
        words = ["".join(w for w in row if w[:1] in ("R", "P")) for row in data["leg_station"].values]
        kinds = ", ".join(sorted(set(words)))
        found["legs"] = f"{scope['legs']}: {kinds} (* driven), spherical at the tip"
    if "motors" in scope:
        found["motors"] = str(scope["motors"])
    modes = scope.get("elastic modes", 0)
    found["platform"] = f"{modes} elastic modes" if modes else "rigid"
    if "gravity" in data.attrs:
        found["gravity"] = f"({', '.join(f'{g:.4g}' for g in np.ravel(data.attrs['gravity']))}) m/s²"
    return found | {words: str(data.attrs[name]) for name, words in SETTINGS.items() if name in data.attrs}


def numbers(data: xr.Dataset) -> dict[str, str]:
    """The numbers by which a run is judged first; those that are checks stand among the checks."""
    told = [fact for fact in figures_of(data) if fact.unit]
    return {each.name: f"{each.value:.5g} {each.unit}" + f" ({each.of})" * bool(each.of) for each in told}


def modes(data: xr.Dataset) -> list[tuple[str, ...]]:
    """Number, rad/s, Hz and damping ratio of each mode."""
    if "frequency" not in data:
        return []
    ratio = data["damping_ratio"].values if "damping_ratio" in data else np.full(data.sizes["mode"], np.nan)
    pairs = zip(data["frequency"].values, ratio, strict=True)
    return [
        (str(k), f"{omega:.2f}", f"{omega / (2 * np.pi):.2f}", f"{zeta:.3g}")
        for k, (omega, zeta) in enumerate(pairs, start=1)
    ]


def leg_modes(data: xr.Dataset) -> list[tuple[str, ...]]:
    """Legs, link and frequencies in Hz of flexible links; legs that are alike stand together."""
    if not {"leg_mode_link", "leg_frequency"} <= set(data):
        return []
    alike: dict[tuple[int, str], list[str]] = {}
    pairs = zip(data["leg_mode_link"].values, data["leg_frequency"].values / (2 * np.pi), strict=True)
    drives = data.get("leg_mode_drive", 0 * data["leg_mode_link"]).values
    for leg, (links, found) in enumerate(pairs, start=1):
        links = np.where(drives[leg - 1], 0, links)
        for link in np.unique(links[links > 0]):
            words = ", ".join(f"{hertz:.5g}" for hertz in found[links == link])
            alike.setdefault((int(link), words), []).append(str(leg))
    return [(", ".join(legs), str(link), words) for (link, words), legs in alike.items()]


def ledger(data: xr.Dataset) -> list[tuple[str, ...]]:
    """Each energy in words: at the start, at the end, least and most, J."""
    rows = []
    for variable in (*LEDGER, RESIDUAL):
        if variable.name in data:
            term = data[variable.name].values
            values = [term[0], term[-1], np.min(term), np.max(term)]
            rows.append((variable.words, *(f"{value:.5g}" for value in values)))
    return rows
