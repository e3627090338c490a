"""Options that measure something: plain numbers in SI units, or numbers with a unit, as in files."""

from typing import NamedTuple

from parflex.base import kinds
from parflex.base.errors import InputError
from parflex.base.kinds import Kind


class Form(NamedTuple):
    """The way that several lengths are written in one option, and an example."""

    words: str
    example: str


FORMS = {
    "--corner": Form("x,y", "0.5,0.2"),
    "--hole": Form("x,y,radius", "0.5,0.2,0.1"),
    "--attach": Form("x,y,z", "0.5,0.2,0.1"),
    "--tool": Form("x,y,z", "0.5,0.2,0.1"),
}


def measured(option: str, text: str, kind: Kind) -> float:
    """The SI value of an option's "0.02" or "20 mm".

    Raises InputError for another text, and for a unit that does not measure the kind.
    """
    from parflex.files.quantity import convert

    try:
        return convert(number_in(text), kind)
    except InputError as error:
        raise InputError(f"{option} {error}") from None


def number_in(text: str) -> float | str:
    """The number that a text is; the text itself where it is more."""
    try:
        return float(text)
    except ValueError:
        return text


def coordinates(option: str, text: str) -> tuple[float, ...]:
    """Lengths, m, from "x,y" or "x mm, y mm", as many as the option's form has.

    Raises InputError for another text, and where some of them have a unit and others, not 0, have none.
    """
    form, parts = FORMS[option], [part.strip() for part in text.split(",")]
    metric = form.example.replace(",", " m, ") + " m"
    if len(parts) != form.words.count(",") + 1 or not all(parts):
        raise InputError(
            f'{option} is {text!r}; write it as "{form.words}" in metres, like {form.example}, or with '
            f'units, like "{metric}"'
        )
    bare = [part for part in parts if number_in(part) != part and number_in(part) != 0]
    if bare and any(number_in(part) == part for part in parts):
        raise InputError(
            f"{option} is {text!r}, of which {bare[0]} has no unit; give each number a unit, or none for m"
        )
    return tuple(measured(option, part, kinds.LENGTH) for part in parts)
