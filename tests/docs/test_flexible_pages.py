"""The figures that the pages on legs that bend tell, to the digits in which they tell them."""

import re

import draw_gallery
import numpy as np
import pytest

import parflex as pf
from places import DOCS

GALLERY = (DOCS / "gallery.md").read_text(encoding="utf-8")
PAGE = (DOCS / "flexible-legs.md").read_text(encoding="utf-8")
CODE, _ = re.findall(r"```python\n(.*?)```", GALLERY, re.DOTALL)

pytestmark = pytest.mark.slow


def hertz(robot: pf.Robot) -> np.ndarray:
    """The frequencies with locked motors, without load."""
    return np.array([abs(pole) for pole, _ in draw_gallery.locked_modes(robot)]) / (2 * np.pi)


def numbers(text: str) -> list[float]:
    return [float(each) for each in re.findall(r"\d+(?:\.\d+)?", text)]


def test_frequencies_of_the_gallery():
    """The row of struts that bend: 21 frequencies one by one, then where the next bending begins and ends."""
    (row,) = re.findall(r"^\| that bend (.*)$", GALLERY, re.MULTILINE)
    *first, begin, end, following = numbers(row)
    found = hertz(draw_gallery.struts())
    assert np.round(found[:21], 1).tolist() == sorted(first)
    assert np.round(found[[21, 32, 33]]).tolist() == [begin, end, following]
    assert (DOCS / "pictures" / "gallery_struts.png").stat().st_size > 10_000


SHAPES = {  # of tube and rod
    "`bending=1`": ("bending=1", "bending=1"),
    "`bending=2`": ("bending=2", "bending=2"),
    "`bending=1`, the tube with `static=True`": ("bending=1, static=True", "bending=1"),
    "`bending=0`, both with `static=True`": ("bending=0, static=True", "bending=0, static=True"),
    "`bending=1`, both with `static=True`": ("bending=1, static=True", "bending=1, static=True"),
    "`bending=4`, both with `static=True`": ("bending=4, static=True", "bending=4, static=True"),
}


def test_frequencies_by_shapes():
    """The lowest of the struts, which comes after that of the platform on them, and how far it is off."""
    rows = re.findall(r"^\| (`bending=.*?) \| ([\d.]+) \| ([\d.]*)(?: %)? ?\|$", PAGE, re.MULTILINE)
    told = {words: (value, off) for words, value, off in rows}
    assert told.keys() == SHAPES.keys()
    found = {}
    for words, shapes in SHAPES.items():
        start, middle, end = CODE.replace("modes=9", "modes=0").split("bending=0, static=True")
        code = start + shapes[0] + middle + shapes[1] + end
        made: dict = {}
        exec(code, made)
        found[words] = hertz(made["robot"])[1]
    best = list(found.values())[-1]
    for words, (value, off) in told.items():
        assert value == written(found[words], value)
        assert not off or off == written(100 * (found[words] / best - 1), off)


def written(value: float, like: str) -> str:
    """A number with as many decimals as another that is written."""
    return f"{value:.{len(like.partition('.')[2])}f}"
