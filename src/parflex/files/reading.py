"""Reading a TOML file: everything that is wrong with it or hardly meant, each with its line."""

import os
import re
import tomllib
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import ParamSpec, TypeVar, cast

from pydantic import ValidationError

from parflex.base.absent import absent
from parflex.base.errors import ImplausibleValue, InputError
from parflex.base.plausible import listening
from parflex.files.lines import Where, line_of, reached
from parflex.files.sentences import field_name, sentences
from parflex.files.tables import Table
from parflex.robot.fields import described
from parflex.robot.leg import Joint

MOST = 5  # complaints at once
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
        self._complaints: list[tuple[int, str]] = []
        self._doubts: list[tuple[int, str]] = []
        self.text = file_text(self.path)
        try:
            self._document = tomllib.loads(self.text)
        except tomllib.TOMLDecodeError as error:
            line = syntax_line(error, self.text)
            self._complaints.append(self._at(line, f"not TOML: {syntax_words(error)}"))
            raise self._told() from None

    def table(self, kind: type[T]) -> T:
        """The whole file as tables; raises InputError with all that does not fit."""
        try:
            return kind.model_validate(self._document)
        except ValidationError as error:
            for where, words in sentences(error.errors(), self._document, kind.model_json_schema()):
                self._complaints.append(self._line(where, words))
            raise self._told() from None

    def attempt(self, where: Where, build: Callable[P, R], /, *args: P.args, **kwargs: P.kwargs) -> R | None:
        """The result of `build`; where it raises InputError, None, and one complaint more."""
        with listening() as doubts:
            try:
                return build(*args, **kwargs)
            except InputError as error:
                self._complaints.append(self._located(where, str(error)))
                return None
            finally:
                self._doubts += [self._located(where, words) for words in doubts]

    def must(self, where: Where, build: Callable[P, R], /, *args: P.args, **kwargs: P.kwargs) -> R:
        """The same as `attempt`, but a complaint is raised at once."""
        found = self.attempt(where, build, *args, **kwargs)
        self.stop()
        return cast(R, found)

    def stop(self) -> None:
        """Raise InputError if there are complaints."""
        if self._complaints:
            raise self._told() from None

    def warn(self) -> None:
        """Warn of the doubts about what was built, by line, each once."""
        for _, words in sorted(set(self._doubts)):
            warnings.warn(words, ImplausibleValue, stacklevel=4)
        self._doubts.clear()

    def _located(self, where: Where, words: str) -> tuple[int, str]:
        """The line and the sentence of what is said at `where`, or of the field there that it begins with."""
        field = FIELD.match(words)
        steps = [IN_FILES.get(step, step) for step in field[1].split(".")] if field else []
        place = reached(self._document, (*where, *steps))
        if field and steps and len(place) == len(where) + len(steps):
            return self._line(place, field_name(place) + words[field.end() :])
        said = words[field.start(1) :] if field else words
        return self._line(place, f"{field_name(where)}: {said}")

    def _told(self) -> InputError:
        """The complaints, by line, as one error."""
        told = [words for _, words in sorted(set(self._complaints))]
        rest = [f"… and {len(told) - MOST} more"] if len(told) > MOST else []
        return InputError("\n".join(told[:MOST] + rest))

    def _line(self, where: Where, words: str) -> tuple[int, str]:
        """A line, and the sentence that names file and line."""
        return self._at(line_of(self.text, where), words)

    def _at(self, line: int, words: str) -> tuple[int, str]:
        return line, f"{self.path.name}:{line}: {words}"


def file_text(path: Path) -> str:
    """The text of a file; raises InputError where there is none."""
    try:
        return path.read_text(encoding="utf-8").replace("\r\n", "\n")
    except FileNotFoundError:
        raise InputError(absent(path)) from None
    except UnicodeDecodeError:
        raise InputError(f"{path} is no text in UTF-8; a TOML file is") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}") from None


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
