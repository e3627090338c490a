"""Reading a TOML file: everything that is wrong with it or hardly meant, each with its line."""

import os
import re
import tomllib
import warnings
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import ParamSpec, TypeVar, cast

import numpy as np
from pydantic import ValidationError

from parflex.base.absent import absent
from parflex.base.errors import ImplausibleValue, InputError
from parflex.base.plausible import listening
from parflex.files.document import Order, too_deep, unfit
from parflex.files.lines import Where, lines_of, reached
from parflex.files.sentences import field_name, sentence, told_once
from parflex.files.tables import Table
from parflex.robot.fields import described
from parflex.robot.leg import Joint

MOST = 5  # complaints at once
LIKELY = 2  # doubts among them, where there are more complaints
LARGEST = 4_000_000  # bytes
LONGEST = 600  # characters of a complaint
LONG = re.compile(r"\d[\d_]{4000}")
FIELD = re.compile(r"(?:[A-Z]\w*\.)?(\w+(?:\.\w+)*)")  # 'Leg.rotation is …' is about the field rotation
IN_FILES = {name: column.file for name, column in described(Joint).items() if column.file}
IN_FILES |= {"polygon": "corners", "n_modes": "modes", "inertia_at_com": "inertia"}  # other arguments

T = TypeVar("T", bound=Table)
P = ParamSpec("P")
R = TypeVar("R")


class Reader:
    """A file that is being read, and the complaints and doubts about it so far.

    Raises InputError where it cannot be read or is not TOML.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        self._complaints: set[tuple[Where, str]] = set()  # places, and sentences about them
        self._doubts: set[tuple[Where, str]] = set()
        self._cause: Exception | None = None  # of a complaint that nobody thought of
        self.text = file_text(self.path)
        deep = too_deep(self.text)
        if deep:
            raise self._at(deep, "this is nested deeper than any field needs; is a bracket not closed?")
        try:
            self._document = tomllib.loads(self.text)
        except tomllib.TOMLDecodeError as error:
            words = f"not TOML: {syntax_words(error)}"
            raise self._at(syntax_line(error, self.text), words) from None
        except (ValueError, RecursionError):  # what Python does not read as a number
            before = LONG.split(self.text, maxsplit=1)[0]
            raise self._at(
                before.count("\n") + 1, "a number has thousands of digits; write it like 1.5e20"
            ) from None
        self._order = Order(self._document)
        for where, words in unfit(self._document):
            self._complaints.add((where, f"{field_name(where)} {words}"))
        self.stop()

    def table(self, kind: type[T]) -> T:
        """The whole file as tables; raises InputError with all that does not fit."""
        try:
            return kind.model_validate(self._document)
        except ValidationError as error:
            schema = kind.model_json_schema()
            errors = told_once(error.errors(include_url=False), schema)
            errors.sort(key=lambda found: self._order.of(found["loc"]))
            told = [sentence(found, self._document, schema) for found in errors[:MOST]]
            self._complaints.update(told)
            raise self._told(len(errors) - len(told)) from None

    def attempt(self, where: Where, build: Callable[P, R], /, *args: P.args, **kwargs: P.kwargs) -> R | None:
        """The result of `build`; where it raises an error, None, and one complaint more."""
        with listening() as doubts:
            try:
                with np.errstate(over="raise", divide="raise", invalid="raise"):
                    return build(*args, **kwargs)
            except InputError as error:
                self._complaints.add(self._located(where, str(error)))
            except Exception as error:  # whatever numbers that nobody thought of lead to
                self._cause = error
                words = f"nothing can be made of this ({brief(error)}); check numbers and units"
                self._complaints.add((reached(self._document, where), f"{field_name(where)}: {words}"))
            finally:
                self._doubts |= {self._located(where, words) for words in doubts}
        return None

    def must(self, where: Where, build: Callable[P, R], /, *args: P.args, **kwargs: P.kwargs) -> R:
        """The same as `attempt`, but a complaint is raised at once."""
        found = self.attempt(where, build, *args, **kwargs)
        self.stop()
        return cast(R, found)

    def stop(self) -> None:
        """Raise InputError if there are complaints."""
        if self._complaints:
            raise self._told() from self._cause

    def warn(self) -> None:
        """Warn of the doubts about what was built, by line, each once."""
        for words in self._lines(self._doubts):
            warnings.warn(words, ImplausibleValue, stacklevel=4)
        self._doubts.clear()

    def _located(self, where: Where, words: str) -> tuple[Where, str]:
        """The place and the sentence of what is said at `where`, or of the field that it begins with."""
        field = FIELD.match(words)
        steps = [IN_FILES.get(step, step) for step in field[1].split(".")] if field else []
        place = reached(self._document, (*where, *steps))
        if field and steps and len(place) == len(where) + len(steps):
            return place, field_name(place) + words[field.end() :]
        said = words[field.start(1) :] if field else words
        return place, f"{field_name(where)}: {said}"

    def _told(self, more: int = 0) -> InputError:
        """The first complaints and the doubts, which are likely their cause, by line, and the number of
        others, as an error; these alone are located."""
        doubts = self._first(self._doubts, max(LIKELY, MOST - len(self._complaints)))
        told = self._lines([*doubts, *self._first(self._complaints, MOST - len(doubts))])
        more += len(self._complaints) + len(self._doubts) - len(told)
        return InputError("\n".join([*told, *[f"… and {more} more"] * (more > 0)]))

    def _first(self, told: Iterable[tuple[Where, str]], most: int | None = None) -> list[tuple[Where, str]]:
        """The first places and sentences in the order of the file."""
        return sorted(told, key=lambda each: (self._order.of(each[0]), each[1]))[:most]

    def _lines(self, told: Iterable[tuple[Where, str]]) -> list[str]:
        """The sentences, in the order of the file, each with file and line."""
        known = self._first(told)
        lines = lines_of(self.text, [where for where, _ in known])
        return [str(self._at(line, words)) for line, (_, words) in zip(lines, known, strict=True)]

    def _at(self, line: int, words: str) -> InputError:
        return InputError(f"{self.path.name}:{line}: {printable(words)}")


def printable(words: str) -> str:
    """The words on one line, for a terminal to show and not to obey; of very many the first and the last."""
    if len(words) > LONGEST:
        words = f"{words[: LONGEST // 2]} … {words[-LONGEST // 2 :]}"
    return "".join(each if each.isprintable() else f"\\u{ord(each):04x}" for each in words)


def brief(error: Exception) -> str:
    """The kind and the first line of an error."""
    words = str(error).strip().splitlines()
    return f"{type(error).__name__}: {words[0][:200]}" if words else type(error).__name__


def file_text(path: Path, largest: int = LARGEST, what: str = "a TOML file") -> str:
    """The text of a file of at most so many bytes, without a byte order mark, lines ending with LF; raises
    InputError where there is none."""
    try:
        with path.open("rb") as file:
            data = file.read(largest + 1)
        if len(data) > largest:
            raise InputError(f"{path} is larger than {largest // 1_000_000} MB; no file of this kind is")
        return re.sub("\r+\n", "\n", data.decode("utf-8-sig"))  # converted more than once, by mail
    except FileNotFoundError:
        raise InputError(absent(path)) from None
    except UnicodeDecodeError:
        raise InputError(f"{path} is no text in UTF-8; {what} is") from None
    except InputError:
        raise
    except (OSError, ValueError) as error:  # ValueError: a name with a NUL
        raise InputError(f"{path} cannot be read: {getattr(error, 'strerror', error)}") from None


AT = re.compile(r" \(at line (\d+), column \d+\)| \(at end of document\)")


def syntax_line(error: tomllib.TOMLDecodeError, text: str) -> int:
    """The line that the parser names; the last one for 'at end of document'."""
    place = AT.search(str(error))
    return int(place.group(1)) if place and place.group(1) else text.rstrip("\n").count("\n") + 1


def syntax_words(error: tomllib.TOMLDecodeError) -> str:
    """The words of the parser, without the place."""
    words = AT.sub("", str(error))
    ends = " before the file ends" if "end of document" in str(error) else ""
    return f"{words[:1].lower()}{words[1:]}{ends}; is a bracket or a quote missing?"
