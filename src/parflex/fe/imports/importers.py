"""All importers, as the robot file and the command line know them."""

from collections.abc import Mapping, Sequence
from os import PathLike

from numpy.typing import ArrayLike

from parflex.base.errors import InputError
from parflex.fe import sources
from parflex.fe.body.attach import attached, first
from parflex.fe.body.basis import ComputedModes
from parflex.fe.body.free_body import FreeBody
from parflex.fe.imports import matrices, modal_arrays
from parflex.fe.imports.calculix import calculix, storage
from parflex.fe.imports.importer import Importer
from parflex.fe.imports.nastran import nastran

IMPORTERS = (
    nastran.IMPORTER,
    calculix.IMPORTER,
    storage.IMPORTER,
    matrices.IMPORTER,
    modal_arrays.IMPORTER,
)


def import_modes(
    program: str,
    files: Mapping[str, str | PathLike[str]],
    units: str,
    modes: int | None = None,
    ids: Sequence[int | Sequence[int]] | None = None,
    points: ArrayLike | None = None,
    radius: float | None = None,
    importers: Sequence[Importer] = IMPORTERS,
) -> ComputedModes:
    """The modes of a platform from the files of a program, held at nodes by id or at points.

    files by the names of the reader's arguments, such as op2 and bulk; `modes` are the lowest to keep, by
    default all. With matrices they are computed: so many free–free modes, by default as many as make the
    basis right to 1 %, and residual attachment modes at the points. The check report is `report` of them.

    Raises InputError for a program or file that is not known, and what the reader raises.
    """
    read = read_files(program, files, units, importers)
    if isinstance(read, FreeBody):
        if ids is not None or points is None:
            raise InputError(
                "points is not given; name the points at which legs hold: matrices have no modes yet"
            )
        return sources.modes(read, points, radius=radius, n=modes)
    found = first(read, modes)
    if ids is None and points is None:
        return found
    return attached(found, ids, points, radius)


def read_files(
    program: str,
    files: Mapping[str, str | PathLike[str]],
    units: str,
    importers: Sequence[Importer] = IMPORTERS,
) -> ComputedModes | FreeBody:
    """The modes, or the body whose modes have to be computed, of the files of a program.

    Raises InputError for a program or file that is not known, and what the reader raises.
    """
    by_name = {importer.name: importer for importer in importers}
    if program not in by_name:
        raise InputError(f"program is {program!r}; choose one of {', '.join(by_name)}")
    importer = by_name[program]
    given = {name: path for name, path in files.items() if path is not None}
    missing = [name for name in importer.files if name not in given]
    strange = [name for name in given if name not in (*importer.files, *importer.optional)]
    if missing or strange:
        wrong = f"{missing[0]} is not given" if missing else f"{strange[0]} is not one of its files"
        raise InputError(f"{wrong}; {importer.takes}")
    return importer.read(**given, units=units)
