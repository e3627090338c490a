"""Writes down what the tests measured: every passed assertion of the form `measured <= bound`.

The documentation's tables are made from build/verification.json, so that no figure in them is typed.
"""

import inspect
import json
import re

import pytest

from places import ROOT, TESTS

FILE = ROOT / "build" / "verification.json"
NUMBER = r"(?:np\.\w+\()?([-+]?\d[\d.]*(?:e[-+]?\d+)?)\)?"
COMPARED = re.compile(rf"^{NUMBER} <=? (?:{NUMBER}|\({NUMBER} \* {NUMBER}\))\s*$")

measured: dict[str, dict] = {}


def pytest_assertion_pass(item, lineno: int, orig: str, expl: str) -> None:
    found = COMPARED.match(expl.splitlines()[0]) if expl else None
    if found is None:
        return
    value, bound, factor, other = (float(text) if text else None for text in found.groups())
    limit = bound if bound is not None else factor * other
    if not 0 < limit <= 1e-2:  # an accuracy, not a count
        return
    test = getattr(item, "originalname", item.name)
    key = f"{place(item)}::{test}"
    if key not in measured:
        measured[key] = about(item) | {"ratio": -1.0, "cases": []}
    row = measured[key]
    if item.name not in row["cases"]:
        row["cases"].append(item.name)
    if abs(value) / limit > row["ratio"]:
        row |= {"ratio": abs(value) / limit, "measured": abs(value), "bound": limit, "assertion": orig}


def place(item) -> str:
    """The path of its file among the tests."""
    return item.path.relative_to(TESTS).as_posix()


def about(item) -> dict:
    """In words: the file's subject, and what the test checks."""
    words = inspect.getdoc(item.obj) or item.originalname.removeprefix("test_").replace("_", " ")
    module = item.module.__doc__ or item.path.stem
    return {"file": place(item), "subject": module.split("\n\n")[0], "what": words.split("\n\n")[0]}


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node) -> None:
    """What a process of several has measured."""
    for key, row in getattr(node, "workeroutput", {}).get("measured", {}).items():
        known = measured.setdefault(key, row)
        worse = max(known, row, key=lambda each: each["ratio"])
        measured[key] = worse | {"cases": sorted({*known["cases"], *row["cases"]})}


def pytest_sessionfinish(session) -> None:
    """Rows of this run take the place of older ones; those of other tests stay."""
    if hasattr(session.config, "workeroutput"):
        session.config.workeroutput["measured"] = measured
        return
    if not measured:
        return
    older = json.loads(FILE.read_text()) if FILE.is_file() else {}
    rows = {key: row | {"cases": len(row["cases"])} for key, row in measured.items()}
    FILE.parent.mkdir(exist_ok=True)
    FILE.write_text(json.dumps(dict(sorted((older | rows).items())), indent=1, ensure_ascii=False))
