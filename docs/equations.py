"""The paper beside the code: what is printed, what is used, and the lines that are it."""

import re
import tomllib
from collections.abc import Iterable
from html import escape
from pathlib import Path
from typing import NamedTuple

PAPER = Path(__file__).with_name("paper.toml")
SOURCES = Path(__file__).parent.parent / "src" / "parflex"
TAG = re.compile(r"^(.*?)#\s*Eqs?\. (\d+(?:, \d+)*)")


class Equation(NamedTuple):
    """A formula in LaTeX as printed, and as used where that differs; without a number, its place."""

    printed: str
    number: int | None = None
    place: str = ""
    used: str = ""
    why: str = ""
    unused: str = ""

    @property
    def where(self) -> str:
        """As one refers to it."""
        return self.place or f"({self.number})"


class Line(NamedTuple):
    """A line of code and its place."""

    code: str
    at: str


def sections() -> dict[str, list[Equation]]:
    """The equations of the paper by section."""
    read = tomllib.loads(PAPER.read_text(encoding="utf-8"))
    return {part["title"]: [Equation(**row) for row in part["equation"]] for part in read["section"]}


def every_equation() -> list[Equation]:
    """In the paper's order."""
    return [each for rows in sections().values() for each in rows]


def lines() -> dict[int, list[Line]]:
    """The lines of code that are tagged with the number of an equation."""
    found: dict[int, list[Line]] = {}
    for path in sorted(SOURCES.rglob("*.py")):
        for row, text in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
            tag = TAG.match(text)
            for number in re.findall(r"\d+", tag[2]) if tag else ():
                line = Line(tag[1].strip(), f"{path.relative_to(SOURCES)}:{row}")
                found.setdefault(int(number), []).append(line)
    return found


def contradictions(listed: Iterable[Equation], found: Iterable[int]) -> list[str]:
    """What is wrong, a sentence each, with the equations listed and the numbers found in the code.

    Nothing is where every equation has code, or a reason to have none.
    """
    tagged, rows = set(found), [each for each in listed if each.number]
    used, unused = ({each.number for each in rows if bool(each.unused) == reason} for reason in (False, True))
    wrong = {
        "tagged in the code, and not in the paper": tagged - used - unused,
        "neither in the code nor said to be unused": used - tagged,
        "in the code, and said to be unused": unused & tagged,
    }
    return [f"Eq. {number} is {words}" for words, numbers in wrong.items() for number in sorted(numbers)]


def beside_the_code() -> str:
    """All equations in HTML, each with its lines of code."""
    tagged = lines()
    return "\n\n".join(
        f"### {title}\n\n" + "\n".join(row(each, tagged.get(each.number or 0, [])) for each in rows)
        for title, rows in sections().items()
    )


def row(equation: Equation, found: list[Line]) -> str:
    """An equation, with what is used instead where it is misprinted, and its code."""
    formula = f"<div>{mathml(equation.printed)}</div>"
    if equation.used:
        formula = (
            f'<div class="misprint"><span>printed</span> {mathml(equation.printed)}</div>'
            f"<div><span>used</span> {mathml(equation.used)}</div><div><span>{equation.why}</span></div>"
        )
    code = "".join(f"<div><code>{escape(line.code)}</code><span>{line.at}</span></div>" for line in found)
    if equation.unused:
        code = f"<div><span>not used: {equation.unused}</span></div>"
    return (
        f'<div class="equation"><div class="number">{equation.where}</div><div class="beside">'
        f'<div class="formula">{formula}</div><div class="code">{code}</div></div></div>'
    )


def mathml(latex: str) -> str:
    """A formula that browsers draw by themselves; hats, like dots, stand free of their letters."""
    from latex2mathml.converter import convert

    return convert(latex).replace(' accent="true"', "")


def errata() -> list[tuple[str, str]]:
    """Where the paper is misprinted, and how."""
    return [(each.where, each.why) for each in every_equation() if each.used]
