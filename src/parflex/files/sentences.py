"""Sentences for what pydantic finds: each names field, value and remedy."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from parflex.base.nearest import nearest
from parflex.files.lines import Where, reached
from parflex.files.quantity import shown

Schema = dict[str, Any]


TABLE = re.compile(r"a (valid )?dictionary( or instance of \w+)?")
OURS = {
    "a valid integer": "a whole number",
    "a valid list": "a list in brackets",
    "a valid string": "a text",
}
MOST_UNKNOWN = 100  # keys that are looked at for misspelt names


def told_once(errors: Sequence[Any], schema: Schema) -> list[Any]:
    """The errors of pydantic's that are worth telling.

    A field that is missing because its name is misspelt is not told twice, and a file of another
    format is told as that alone.
    """
    errors = [found for found in errors if found["loc"] == ("format",)] or errors
    lacking = {found["loc"] for found in errors if found["type"] == "missing"}
    unknown = [found["loc"] for found in errors if found["type"] == "extra_forbidden"] if lacking else []
    meant = {(*where[:-1], likely(where, schema)) for where in unknown[:MOST_UNKNOWN]}
    return [found for found in errors if found["loc"] not in meant & lacking]


def sentence(found: Mapping[str, Any], document: Any, schema: Schema) -> tuple[Where, str]:
    """The place in a document and the sentence of one of pydantic's errors."""
    return reached(document, place(found, schema)), words_of(found, document, schema)


def place(found: Mapping[str, Any], schema: Schema) -> Where:
    """The place of an error; for a table of unknown kind, that of its kind."""
    where: Where = found["loc"]
    if found["type"] != "union_tag_invalid":
        return where
    return (*where, resolved(node_at(schema, where, schema), schema)["discriminator"]["propertyName"])


def words_of(found: Mapping[str, Any], document: Any, schema: Schema) -> str:
    """One error of pydantic's in words."""
    where, kind, value = found["loc"], found["type"], found["input"]
    field = field_name(reached(document, where))
    context = found.get("ctx", {})
    if kind == "value_error":
        return f"{field} {context['error']}"
    if kind == "missing":
        return f"{field_name((*reached(document, where), where[-1]))} is missing{remedy(schema, where)}"
    if kind == "extra_forbidden":
        close = likely(where, schema)
        hint = f"did you mean {close}?" if close else f"known here: {', '.join(names(where, schema))}"
        return f"{field} is not known; {hint}"
    if kind in ("union_tag_not_found", "union_tag_invalid"):
        return tag_sentence(field, value, resolved(node_at(schema, where, schema), schema))
    if kind in ("too_short", "too_long"):
        wanted = f"at least {context['min_length']}" if kind == "too_short" else f"{context['max_length']}"
        return f"{field} has {context['actual_length']} entries; give {wanted}"
    words = str(found["msg"]).replace("Input should be", "expected")
    for theirs, ours in OURS.items():
        words = words.replace(theirs, ours)
    return f"{field} is {shown(value)}; {TABLE.sub('a table', words)}"


def field_name(where: Where) -> str:
    """'leg[2].origin' for ("leg", 2, "origin"); 'the file' for the whole."""
    steps = [f"[{step}]" if isinstance(step, int) else f".{step}" for step in where]
    return "".join(steps).lstrip(".") or "the file"


def remedy(schema: Schema, where: Sequence[str | int]) -> str:
    """A remedy for a missing field, in the words of the schema where it describes the field."""
    words = node_at(schema, where, schema).get("description", "")
    return f"; give {words}" if words else "; give it"


def names(where: Where, schema: Schema) -> list[str]:
    """The keys of the table that the value at `where` is in."""
    return list(resolved(node_at(schema, where[:-1], schema), schema).get("properties", {}))


def likely(where: Where, schema: Schema) -> str:
    """The known key most like the unknown last step; empty where none is."""
    return nearest(str(where[-1]), names(where, schema)) or ""


def tag_sentence(field: str, value: Any, node: Schema) -> str:
    """A table whose kind is missing or unknown: a joint without an axis."""
    rule = node["discriminator"]
    key, choices = rule["propertyName"], " or ".join(f'"{tag}"' for tag in rule["mapping"] if tag)
    if key in value:
        return f"{field}.{key} is {shown(value[key])}; choose {choices}"
    what = "is a joint without an axis" if "revolute" in rule["mapping"] else f"has no {key}"
    return f"{field} {what}; give {key} = {choices}"


def node_at(node: Schema, where: Sequence[str | int], root: Schema) -> Schema:
    """The part of a JSON schema for what is at `where`; steps that pydantic adds are left out."""
    if not where:
        return node
    step, rest = where[0], where[1:]
    return node_at(follow(resolved(node, root), step, root), rest, root)


def follow(node: Schema, step: str | int, root: Schema) -> Schema:
    """One step down; the node itself for a tag that no key or entry stands for."""
    if step in node.get("properties", {}):
        return dict(node["properties"][step])
    if step in node.get("discriminator", {}).get("mapping", {}):
        return resolved({"$ref": node["discriminator"]["mapping"][step]}, root)
    if isinstance(step, int) and "items" in node:
        return dict(node["items"])
    more = node.get("additionalProperties")
    return dict(more) if isinstance(more, dict) else node


def resolved(node: Schema, root: Schema) -> Schema:
    """The definition a node refers to, or the node; of one that may be missing what it otherwise is."""
    there = [each for each in node.get("anyOf", ()) if each != {"type": "null"}]
    if len(there) == 1:
        return resolved(there[0], root)
    return dict(root["$defs"][node["$ref"].rsplit("/", 1)[1]]) if "$ref" in node else node
