"""The page that groups every public name."""

import inspect
import re

import parflex as pf
from places import DOCS


def public_names():
    """The public names as the page has them: of the library, of its three modules, of a model."""
    yield from (f"pf.{name}" for name in pf.__all__)
    yield from (f"pf.fe.{name}" for name in pf.fe.__all__)
    yield from (f"pf.plot.{name}" for name in pf.plot.__all__)
    for name, method in inspect.getmembers(pf.Model):
        former = getattr(method, "__name__", name) != name
        if not name.startswith("_") and not former:
            yield f"model.{name}"


def test_every_public_name_has_its_place():
    found = re.findall(r"`((?:pf|model)\.[\w.]+)`", (DOCS / "api.md").read_text(encoding="utf-8"))
    assert set(public_names()) == set(found)
    robots = re.findall(r"`(\w+)`", (DOCS / "api.md").read_text(encoding="utf-8"))
    assert set(pf.robots.__all__) <= set(robots)
