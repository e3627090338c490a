"""One importer: what each reader of another program's files says of itself."""

from collections.abc import Callable
from typing import NamedTuple

from parflex.fe.body.basis import ComputedModes
from parflex.fe.body.free_body import FreeBody


class Importer(NamedTuple):
    """The name of a source, its reader of modes or of a body whose modes are computed here, and the names of
    the files that it takes."""

    name: str
    read: Callable[..., ComputedModes | FreeBody]
    files: tuple[str, ...]
    optional: tuple[str, ...] = ()

    @property
    def takes(self) -> str:
        """The words "nastran takes op2, bulk"."""
        return f"{self.name} takes {', '.join((*self.files, *self.optional))}"
