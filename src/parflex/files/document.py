"""A TOML document before its tables are made: its order, and what would make work without end."""

import re
from typing import Any

from parflex.files.lines import DEPTHS, TOKENS, Where, reached

DEEPEST = 50  # arrays and tables in one another
DOTTED = re.compile(rf"(?<![\w-])(?:[\w-]*\.){{{DEEPEST}}}")
WHOLE = range(-(2**63), 2**63)  # the whole numbers of TOML


class Order:
    """The order in which a document gives its values."""

    def __init__(self, document: Any) -> None:
        self._document = document
        self._known: dict[int, dict[str, int]] = {}  # places of the keys of tables, by the tables' identities

    def of(self, where: Where) -> tuple[int, ...]:
        """A rank: the places of the steps that lead somewhere; the earlier value has the smaller one."""
        node, found = self._document, []
        for step in reached(node, where):
            if isinstance(step, str):
                keys = self._known.setdefault(id(node), {})
                if not keys:
                    keys.update({key: place for place, key in enumerate(node)})
                found.append(keys[step])
            else:
                found.append(step)
            node = node[step]
        return tuple(found)


def too_deep(text: str) -> int:
    """The first line, from 1, with more open brackets or parts of a key than any field needs; 0 for none."""
    plain = TOKENS.sub(lambda token: token[0] if token[0] in DEPTHS else "\n" * token[0].count("\n"), text)
    dotted = DOTTED.search(re.sub("[ \t]+", "", plain))
    if dotted:
        return dotted.string.count("\n", 0, dotted.start()) + 1
    depth, line = 0, 1
    for token in re.findall(r"[][{}\n]", plain):
        depth += DEPTHS.get(token, 0)
        line += token == "\n"
        if depth > DEEPEST:
            return line
    return 0


def unfit(document: Any) -> list[tuple[Where, str]]:
    """The places that are nested too deep, or whose whole numbers are beyond TOML's, each with words."""
    found: list[tuple[Where, str]] = []
    left: list[tuple[Where, Any]] = [((), document)]
    while left:
        where, node = left.pop()
        if isinstance(node, int) and node not in WHOLE:
            found.append((where, "is a whole number beyond 64 bits; write it with a point, like 1.5e20"))
        elif not isinstance(node, (dict, list)):
            continue
        elif len(where) > DEEPEST:
            return [(where[:3], "is nested deeper than any field needs; give it as the documentation does")]
        else:
            steps = node.items() if isinstance(node, dict) else enumerate(node)
            left += [((*where, step), value) for step, value in steps]
    return found
