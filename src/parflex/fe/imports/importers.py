"""The importers by name: what the robot file and the command line know them by."""

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, NamedTuple

from numpy.typing import ArrayLike

from parflex.base.errors import InputError
from parflex.fe.body.attach import attached, first
from parflex.fe.body.basis import FreeFreeWithAttachment
from parflex.fe.body.free_body import FreeBody
from parflex.fe.imports.calculix.calculix import calculix_body, read_calculix
from parflex.fe.imports.matrices import read_matrices
from parflex.fe.imports.modal_arrays import read_arrays
from parflex.fe.imports.nastran.nastran import read_nastran
from parflex.fe.imports.sources import modes as right_modes
from parflex.robot.modes import Modes

Path = str | PathLike[str]


class Importer(NamedTuple):
    """A reader of modes, or of a body whose modes are computed here, and the files it takes."""

    read: Callable[..., Modes | FreeBody]
    files: tuple[str, ...]
    optional: tuple[str, ...] = ()


IMPORTERS = {
    "nastran": Importer(read_nastran, ("op2", "bulk")),
    "calculix": Importer(read_calculix, ("frd", "inp")),
    "calculix-matrices": Importer(calculix_body, ("matrices", "inp")),
    "matrices": Importer(read_matrices, ("stiffness", "mass", "nodes"), ("unknowns",)),
    "arrays": Importer(read_arrays, ("path",)),
}


def import_modes(
    program: str,
    files: Mapping[str, Path],
    units: str,
    modes: int | None = None,
    ids: Sequence[int | Sequence[int]] | None = None,
    points: ArrayLike | None = None,
    radius: float | None = None,
    say: Callable[[str], None] = print,
) -> Modes:
    """The modes of a platform from the files of a program, held at nodes by id or at points.

    files by the names of the reader's arguments, such as op2 and bulk; `modes` are the lowest to keep, by
    default all. With matrices they are computed: so many free–free modes, by default as many as make the
    basis right to 1 %, and residual attachment modes at the points.

    Raises InputError for a program or file that is not known, and what the reader raises.
    """
    if program not in IMPORTERS:
        raise InputError(f"program is {program!r}; choose one of {', '.join(IMPORTERS)}")
    importer = IMPORTERS[program]
    given = {name: path for name, path in files.items() if path is not None}
    missing = [name for name in importer.files if name not in given]
    strange = [name for name in given if name not in (*importer.files, *importer.optional)]
    if missing or strange:
        wrong = f"{missing[0]} is not given" if missing else f"{strange[0]} is not one of its files"
        raise InputError(f"{wrong}; {program} takes {', '.join((*importer.files, *importer.optional))}")
    options: dict[str, Any] = {"units": units, "say": say}
    read = importer.read(**given, **options)
    if isinstance(read, FreeBody):
        return computed(read, modes, ids, points, radius)
    found = first(read, modes)
    return found if ids is None and points is None else attached(found, ids, points, radius)


def computed(
    body: FreeBody,
    modes: int | None,
    ids: Sequence[int | Sequence[int]] | None,
    points: ArrayLike | None,
    radius: float | None,
) -> Modes:
    """Modes of matrices in the basis that is right for joints."""
    if ids is not None or points is None:
        raise InputError(
            "points is not given; name the points at which legs hold: matrices have no modes yet"
        )
    if modes is None:
        return right_modes(body, points, radius=radius)
    return FreeFreeWithAttachment(modes, points, radius=radius).modes(body)
