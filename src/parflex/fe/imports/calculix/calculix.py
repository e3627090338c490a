"""Modes from CalculiX: frd for mesh and modes, the deck for densities."""

from os import PathLike
from pathlib import Path

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.progress import waiting
from parflex.fe.body.basis import ComputedModes
from parflex.fe.body.elements import Elements, mass_matrix
from parflex.fe.body.surface import surface
from parflex.fe.imports.acceptance import accepted
from parflex.fe.imports.calculix.deck import Deck, DeckMaterial, read_deck
from parflex.fe.imports.calculix.frd import FrdModes, read_frd
from parflex.fe.imports.foreign import rows_of
from parflex.fe.imports.imported import ImportedModes, cosines
from parflex.fe.imports.importer import Importer
from parflex.fe.imports.unit_systems import Units, check_material, units_named

# degrees of the rules by which CalculiX 2 integrates masses, full and for types that end in R
FULL = {"tet4": 0, "tet10": 2, "wedge6": 3, "wedge15": 4, "hex8": 3, "hex20": 5}
REDUCED = FULL | {"hex8": 0, "hex20": 3}
RULES = {"full integration": FULL, "reduced integration": REDUCED}

SIX_DIGITS = 1e-5  # error that the numbers of an frd file leave in ΦᵀMΦ, with room to spare
UNKNOWN = "an element has node {}, which is not there; the files are damaged"
SAME_PLACE = 1e-5  # of the size: a node in the deck and in the results


def read_calculix(
    frd: str | PathLike[str],
    inp: str | PathLike[str],
    units: str = "",
) -> ComputedModes:
    """The elastic modes of a free platform of solids that CalculiX computed (*FREQUENCY).

    frd holds mesh and modes (*NODE FILE with U, in ASCII), inp densities and exact coordinates; units of
    both: "SI", "mm-tonne-s", "in-lbf" and others. Shells and beams come as the solids that CalculiX
    makes of them. The masses are consistent, integrated by the rules of CalculiX. The check report is
    `modes.report`.

    Raises InputError where a file is damaged or of another model, the model is held, a density is
    missing, or the units make a material that nothing has.
    """
    system = units_named(units)
    with waiting("reading the files of CalculiX"):
        modes, deck = read_frd(Path(frd)), read_deck(Path(inp))
        return accepted(on_mesh(f"{Path(frd).name} and {Path(inp).name}", modes, deck, system))


def on_mesh(name: str, modes: FrdModes, deck: Deck, units: Units) -> ImportedModes:
    """The modes on the mesh, in SI units."""
    nodes = units.length * exact_places(modes.ids, modes.nodes, deck)
    grouped: dict[tuple[str, int], list[tuple[int, ...]]] = {}
    for kind, material, corners in modes.elements:
        grouped.setdefault((kind, material), []).append(corners)
    parts = [
        Elements(
            kind,
            rows_of(modes.ids, np.array(corners), UNKNOWN),
            np.full(len(corners), density_of(modes, deck, material, units)),
        )
        for (kind, material), corners in grouped.items()
    ]
    shapes = units.length * modes.shapes
    masses = {kind: mass_matrix(nodes, parts, degrees=rule) for kind, rule in RULES.items()}
    rule = min(masses, key=lambda kind: cosines(masses[kind], shapes))
    return ImportedModes(
        ids=modes.ids,
        nodes=nodes,
        mass=masses[rule],
        shapes=shapes,
        rotations=None,
        squares=modes.squares / units.time**2,
        modal_mass=units.inertia * modes.modal_mass,
        triangles=surface(parts),
        mass_kind=f"consistent, CalculiX's {rule}",
        normalised="MASS",
        source=f"CalculiX, {name}, {units.name}",
        precision=SIX_DIGITS,
    )


def exact_places(ids: Array, places: Array, deck: Deck) -> Array:
    """The coordinates of the deck where it has the node, which the results agree with to six digits."""
    known = np.isin(ids, deck.ids)
    if not np.any(known) and deck.elements:  # of shells CalculiX makes solids with nodes of its own
        raise InputError("inp has none of the nodes of frd; give the files of one model")
    exact = places.copy()
    exact[known] = deck.nodes[rows_of(deck.ids, ids[known], UNKNOWN)]
    apart = np.max(np.abs(exact - places), axis=1)
    if not np.max(apart) <= SAME_PLACE * np.max(np.abs(places)) < np.inf:
        worst = int(np.argmax(apart))
        raise InputError(
            f"node {ids[worst]} is at {places[worst]} in frd and at {exact[worst]} in inp; give the files of "
            f"one model"
        )
    return exact


def density_of(modes: FrdModes, deck: Deck, material: int, units: Units) -> float:
    """The density kg/m³ of a material of the results, by its name in the deck."""
    name = modes.materials.get(material, "")
    rho, young = deck.materials.get(name, DeckMaterial())
    if rho is None or not rho > 0:
        raise InputError(f"inp gives no *DENSITY of the material {name or material}; a mode needs one")
    check_material(f"material {name} of inp", rho, young, units)
    return rho * units.density


IMPORTER = Importer("calculix", read_calculix, ("frd", "inp"))
