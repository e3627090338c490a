"""Modes from Nastran: bulk data for nodes and masses, OP2 for the modes."""

from os import PathLike
from pathlib import Path

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.progress import waiting
from parflex.fe.body.basis import ComputedModes
from parflex.fe.body.integrals import RigidBody
from parflex.fe.imports.acceptance import accepted
from parflex.fe.imports.free_checks import nodes_at_rest
from parflex.fe.imports.imported import ImportedModes, cosines, inner, rigid_body_of
from parflex.fe.imports.importer import Importer
from parflex.fe.imports.nastran.bulk_data import BulkModel, read_bulk
from parflex.fe.imports.nastran.op2 import Op2Modes, read_op2
from parflex.fe.imports.unit_systems import Units, units_named

SINGLE = 1e-6  # error that single precision leaves in ΦᵀMΦ, with room to spare
LIKE_ONE = 0.1  # modal masses of the slowest modes this near to one are meant to be one


def read_nastran(
    op2: str | PathLike[str],
    bulk: str | PathLike[str] | None = None,
    units: str = "",
) -> ComputedModes:
    """The elastic modes of a free platform that Nastran computed (SOL 103), MASS- or MAX-normalised.

    op2 holds the modes (PARAM,POST,-1 and DISPLACEMENT(PLOT) = ALL), bulk the nodes and masses; units
    of both: "SI", "mm-tonne-s", "in-lbf" and others. Masses are those of shells, solids, rods, bars
    and CONM2 cards, lumped or, with PARAM,COUPMASS,1 and for elements with midside nodes, consistent.
    The check report is `modes.report`.

    Raises InputError where a file is damaged or of another model, the model is held or in
    superelements, masses are not known, or the units make a material that nothing has.
    """
    system = units_named(units)
    with waiting("reading the files of Nastran"):
        modes = read_op2(Path(op2))
        check_not_held(Path(op2).name, modes)
        if bulk is None:
            raise InputError(
                f"bulk is not given, and op2 {Path(op2).name} has no masses of nodes; give the bulk data "
                f"that Nastran solved"
            )
        names = f"{Path(op2).name} and {Path(bulk).name}"
        return accepted(on_grids(names, modes, read_bulk(Path(bulk), system), system))


def check_not_held(name: str, modes: Op2Modes) -> None:
    """Raise InputError where a node stays in its place in all modes."""
    still = nodes_at_rest(modes.shapes)
    if len(still) and np.all(np.isfinite(modes.shapes)):
        raise InputError(
            f"op2 {name} is of a model that is held, not free: node {modes.ids[still[0]]} moves in no mode; "
            f"remove the constraints (SPC) and solve again"
        )


def on_grids(name: str, modes: Op2Modes, model: BulkModel, units: Units) -> ImportedModes:
    """The modes on the nodes of the bulk data, in SI units and basic components."""
    grids = model.ids[model.ids > 0]
    if not np.array_equal(modes.ids, grids):
        apart = np.setxor1d(modes.ids, grids)
        example = f", such as {apart[0]}" if len(apart) else ", in another order"
        raise InputError(
            f"op2 has modes of {len(modes.ids)} nodes, bulk has {len(grids)} grids, and they are not the same"
            f"{example}: give files of one model, with DISPLACEMENT(PLOT) = ALL"
        )
    turn = np.broadcast_to(np.eye(3), model.to_basic.shape) if modes.basic else model.to_basic
    moved = units.length * np.einsum("kab,pkb->pka", turn, modes.shapes)
    turned = np.einsum("kab,pkb->pka", turn, modes.rotations)
    shapes = moved[:, model.carrier] + np.cross(turned[:, model.carrier], model.offset)
    kind, notes = fitting(model, shapes)
    mass = model.masses[kind]
    normalised, masses = normalisation(modes, inner(mass, shapes, shapes), units.inertia)
    return ImportedModes(
        ids=model.ids,
        nodes=model.nodes,
        mass=mass,
        shapes=shapes,
        rotations=turned[:, model.carrier] if np.any(turned) else None,
        squares=modes.squares / units.time**2,
        modal_mass=masses,
        triangles=model.triangles,
        mass_kind=kind,
        normalised=normalised,
        source=f"Nastran, {name}, {units.name}",
        precision=SINGLE,
        own=weighed(modes, model, units),
        notes=notes,
    )


def fitting(model: BulkModel, shapes: Array) -> tuple[str, tuple[str, ...]]:
    """The mass matrix, lumped or consistent, in which the modes are most nearly orthogonal.

    A note where it is not the one that the bulk data ask for.
    """
    asked = next(iter(model.masses))
    apart = {kind: cosines(mass, shapes) for kind, mass in model.masses.items()}
    best = min(apart, key=lambda kind: apart[kind])
    if apart[asked] <= SINGLE or apart[best] > SINGLE:
        return asked, ()
    return best, (
        f"the bulk data ask for the {asked} mass matrix, but the modes are those of the {best} one "
        f"(orthogonal to {apart[best]:.0e} in it, to {apart[asked]:.0e} in the other), which is taken",
    )


def normalisation(modes: Op2Modes, gram: Array, one: float) -> tuple[str, Array | None]:
    """The normalisation of the modes and their modal masses, where the file lets one know them."""
    masses = np.diagonal(gram)
    if modes.modal_mass is not None:
        unit = np.all(np.abs(modes.modal_mass - 1) < 1e-3)
        return ("MASS" if unit else "MAX or POINT (the file says the modal masses)"), one * modes.modal_mass
    slowest = np.argsort(np.abs(modes.squares))[:6]
    if np.all(np.abs(masses[slowest] / one - 1) < LIKE_ONE):
        return "MASS", np.full(len(masses), one)
    largest = np.max(np.abs(np.concatenate([modes.shapes, modes.rotations], axis=2)), axis=(1, 2))
    if np.all(np.abs(largest - 1) < 1e-4):
        return "MAX (the file does not say the modal masses)", None
    if np.ptp(masses) < 1e-2 * np.min(masses):
        raise InputError(
            f"bulk has masses that make ΦᵀMΦ = {masses[0] / one:.4g} of every mode; the modes were computed "
            f"with other densities, thicknesses, or PARAM,WTMASS"
        )
    return "nothing known", None


def weighed(modes: Op2Modes, model: BulkModel, units: Units) -> RigidBody | None:
    """The rigid body of the grid point weight generator, about its reference point."""
    if modes.weights is None:
        return None
    scale = np.array([1.0] * 3 + [units.length] * 3)
    body = rigid_body_of(model.weight_to_mass * units.mass * np.outer(scale, scale) * modes.weights)
    return body._replace(com=body.com + model.reference)


IMPORTER = Importer("nastran", read_nastran, ("op2", "bulk"))
