"""Flexible links to robot files: beams by their dimensions, other bodies in files beside."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from parflex.fe.modal_file import save_body
from parflex.robot.beam import Beam, BeamBody
from parflex.robot.body import FlexibleBody
from parflex.robot.fields import described


class LinkFiles:
    """The entries of flexible links, and the files that they name, beside a robot file: one for all links of
    the same numbers."""

    def __init__(self, stem: str) -> None:
        self._stem = stem
        self._names: dict[tuple[Any, ...], str] = {}
        self._bodies: dict[str, FlexibleBody] = {}

    def entries(self, body: FlexibleBody | None) -> dict[str, Any]:
        """The entries of a joint that has this body; none of a rigid link."""
        if body is None:
            return {}
        if isinstance(body, BeamBody) and body.beam is not None and numbers(body.beam.body) == numbers(body):
            return {"beam": beam_entries(body.beam)}
        name = self._names.setdefault(numbers(body), f"{self._stem}.link-{len(self._names) + 1}.nc")
        self._bodies[name] = body
        return {"body": {"kind": "modal", "file": name}}

    def save(self, folder: Path) -> None:
        """Write the files that were named; raises InputError where one cannot be written."""
        for name, body in self._bodies.items():
            save_body(body, folder / name)


def beam_entries(beam: Beam) -> dict[str, Any]:
    """The table of a beam without what is by default."""
    values = {name: (getattr(beam, name), column.default) for name, column in described(Beam).items()}
    plain = {name: (np.asarray(value).tolist(), default) for name, (value, default) in values.items()}
    return {name: value for name, (value, default) in plain.items() if repr(value) != repr(default)}


def numbers(body: FlexibleBody) -> tuple[Any, ...]:
    """Every number of a body, to the last bit."""
    return tuple(bits((*body.moments, *arrays(body))))


def arrays(body: FlexibleBody) -> tuple[Any, ...]:
    """The arrays of a body beside its moments."""
    return (
        *(body.nodes, body.shapes, body.rotation_shapes, body.stiffness, body.damping, body.attachments),
        *(body.triangles, body.foreshortening),
    )


def bits(values: Iterable[Any]) -> Iterator[tuple[Any, ...] | None]:
    """Shapes and bytes of arrays; None of what is not there."""
    for value in values:
        array = None if value is None else np.asarray(value, dtype=float)
        yield None if array is None else (array.shape, array.tobytes())
