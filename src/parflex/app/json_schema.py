"""JSON schemas of the file formats, for editors that complete and check while one types."""

import json
from collections.abc import Callable
from typing import Any

from parflex.app.trajectory_schema import trajectory_table
from parflex.files.robot_schema import robot_table

ALL_SCHEMAS: dict[str, Callable[[], dict[str, Any]]] = {
    "robot": robot_table().model_json_schema,
    "trajectory": trajectory_table().model_json_schema,
}


def schema_text(name: str) -> str:
    """The schema of a format, as its file has it."""
    return json.dumps(ALL_SCHEMAS[name](), indent=1, ensure_ascii=False) + "\n"
