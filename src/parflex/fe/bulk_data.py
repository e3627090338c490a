"""Nodes and masses in Nastran's bulk data, whose cards pyYeti reads."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy import sparse

from parflex.array import Array
from parflex.errors import InputError
from parflex.fe.elements import ELEMENTS, Elements, mass_matrix, surface
from parflex.fe.free_body import Sparse
from parflex.fe.unit_systems import Units, check_material

Card = list[Any]

SHAPES = {  # card: kinds by their number of nodes, and where the first node is
    "CQUAD4": (("quad4",), 2),
    "CQUADR": (("quad4",), 2),
    "CQUAD8": (("quad8",), 2),
    "CTRIA3": (("tri3",), 2),
    "CTRIAR": (("tri3",), 2),
    "CTRIA6": (("tri6",), 2),
    "CTETRA": (("tet10", "tet4"), 2),
    "CPENTA": (("wedge15", "wedge6"), 2),
    "CHEXA": (("hex20", "hex8"), 2),
    "CROD": (("line2",), 2),
    "CBAR": (("line2",), 2),
    "CONROD": (("line2",), 1),
}
MASSLESS = (
    "CORD", "CELAS", "CDAMP", "CBUSH", "CGAP", "CVISC", "CWELD", "CFAST", "CSEAM", "CEND", "CSET", "CPLSTN",
    "CPLSTS",
)  # fmt: skip
SUPERELEMENTS = ("SESET", "SECONCT", "CSUPER", "SEBULK", "SELABEL")
DENSITY_FIELD = {"MAT1": 4, "MAT2": 7, "MAT8": 7, "MAT9": 22}
SECTIONS = {"PROD": (1, 2, 4), "PBAR": (1, 2, 7)}  # material, area, non-structural mass
CARDS = r"^(GRID|PARAM|CORD|CONM|MAT[0-9]|P[A-Z]|C[A-Z]|SE|ENDDATA)"


class BulkModel(NamedTuple):
    """Nodes and masses, SI; `to_basic` (K, 3, 3) turns output components into the basic system.

    Nodes without an id carry mass at a fixed `offset` (K, 3) from the grid `carrier` (K,). `masses` are
    lumped and consistent, the one that the file asks for first.
    """

    ids: Array
    nodes: Array
    to_basic: Array
    carrier: Array
    masses: dict[str, Sparse]
    triangles: Array
    weight_to_mass: float
    reference: Array  # (3,) m, of the grid point weight generator

    @property
    def offset(self) -> Array:
        """(K, 3) m from the carrying grid."""
        return self.nodes - self.nodes[self.carrier]


@dataclass(frozen=True)
class Bulk:
    """Cards by name, and the values of parameters."""

    name: str
    cards: dict[str, list[Card]]
    units: Units

    def of(self, name: str) -> list[Card]:
        """All cards of a name."""
        return self.cards.get(name, [])

    def parameter(self, name: str, default: float) -> float:
        """The last PARAM of a name."""
        values = [card[1] for card in self.of("PARAM") if str(card[0]).upper() == name and len(card) > 1]
        return self.number("PARAM " + name, values[-1]) if values else default

    def number(self, what: str, value: Any) -> float:
        """A field as a finite number; blank is 0."""
        if value == "":
            return 0.0
        if isinstance(value, (int, float)) and np.isfinite(value):
            return float(value)
        raise InputError(f"bulk {self.name} has {value!r} where {what} needs a number")

    def fields(self, card: Card, first: int, count: int, what: str) -> Array:
        """Fields as numbers; those that are not there are 0."""
        values = [*card, *[""] * (first + count)][first : first + count]
        return np.array([self.number(what, value) for value in values])

    def by_id(self, *names: str) -> dict[int, tuple[str, Card]]:
        """Cards by their first field."""
        return {
            int(self.fields(card, 0, 1, name)[0]): (name, card) for name in names for card in self.of(name)
        }


def read_bulk(path: Path, units: Units) -> BulkModel:
    """Nodes and masses of a bulk data file.

    Raises InputError where it is missing, damaged, or holds what has no mass that is known here.
    """
    bulk = Bulk(path.name, cards_of(path), units)
    if not bulk.of("GRID"):
        raise InputError(f"bulk {path.name} has no GRID cards; give the file that Nastran solved")
    check_whole(bulk)
    ids, nodes, to_basic = grids(bulk, path)
    number = {int(grid): k for k, grid in enumerate(ids)}
    parts = list(elements(bulk, number))
    kinds = ["lumped", "consistent"]
    if bulk.parameter("COUPMASS", -1) > 0:
        kinds.reverse()
    if any(ELEMENTS[part.kind].edges for part in parts):
        kinds = ["consistent"]  # Nastran's lumping of midside nodes is its own
    scale = bulk.parameter("WTMASS", 1.0)
    places, carrier, weights = carried(bulk, number, nodes)
    everywhere = np.vstack([nodes, places])
    points = sparse.diags_array(np.concatenate([np.zeros(len(nodes)), weights * units.mass]))
    zero = int(bulk.parameter("GRDPNT", 0))
    return BulkModel(
        ids=np.concatenate([ids, np.zeros(len(places), dtype=int)]),
        nodes=everywhere,
        to_basic=to_basic,
        carrier=np.concatenate([np.arange(len(ids)), carrier]),
        masses={kind: scale * (mass_matrix(everywhere, parts, kind == "lumped") + points) for kind in kinds},
        triangles=surface(parts),
        weight_to_mass=scale,
        reference=nodes[number[zero]] if zero in number else np.zeros(3),
    )


def cards_of(path: Path) -> dict[str, list[Card]]:
    """All cards of a file and of those it includes, by name."""
    try:
        from pyyeti.nastran.bulk import rdcards
    except ImportError:
        raise InputError('bulk data need pyYeti; install it with: pip install "parflex[nastran]"') from None
    options = {"regex": True, "return_var": "list", "blank": "", "encoding": "latin-1"}
    try:
        first = rdcards(str(path), CARDS, keep_name=True, **options) or []
        names = {str(card[0]).rstrip("*").strip().upper() for card in first}
        # names and fields apart: with both, pyYeti 1.4 misplaces the fields of continued free-format cards
        return {
            name: rdcards(str(path), rf"^{re.escape(name)}\s*([*,\s]|$)", **options) or [] for name in names
        }
    except OSError as error:
        raise InputError(f"bulk {error.filename or path} cannot be read: {error.strerror or error}") from None
    except Exception as error:  # pyYeti raises many kinds for a damaged file
        raise InputError(f"bulk {path.name} cannot be read ({error}); write it again") from None


def check_whole(bulk: Bulk) -> None:
    """No superelements, no elements of unknown mass, no grid twice."""
    if not bulk.of("ENDDATA"):
        raise InputError(
            f"bulk {bulk.name} has no ENDDATA; it is cut short, or not the main file: give all of it"
        )
    apart = sorted(set(SUPERELEMENTS) & set(bulk.cards))
    if apart or any(np.any(bulk.fields(card, 7, 1, "SEID of GRID")) for card in bulk.of("GRID")):
        raise InputError(
            f"bulk {bulk.name} divides the model into superelements ({', '.join(apart) or 'SEID of GRID'}); "
            f"solve the model in one piece"
        )
    for name in bulk.cards:
        known = name in SHAPES or name == "CONM2" or name.startswith(MASSLESS)
        if name.startswith("C") and name.isalnum() and not known:
            raise InputError(
                f"bulk {bulk.name} has {name} cards, whose mass is not known here; export the stiffness and "
                f"mass matrices and read those, or leave these elements out"
            )


def grids(bulk: Bulk, path: Path) -> tuple[Array, Array, Array]:
    """Ids (K,), places (K, 3) m, and the turns (K, 3, 3) from output to basic components."""
    table = np.array([bulk.fields(card, 0, 6, "GRID") for card in bulk.of("GRID")])
    table = table[np.argsort(table[:, 0], kind="stable")]
    ids = table[:, 0].astype(int)
    if np.any(np.diff(ids) == 0):
        raise InputError(f"bulk {bulk.name} has GRID {ids[:-1][np.diff(ids) == 0][0]} twice; keep one")
    if not np.any(table[:, [1, 5]]):
        return ids, bulk.units.length * table[:, 2:5], np.broadcast_to(np.eye(3), (len(ids), 3, 3))
    from pyyeti.nastran import bulk as reader
    from pyyeti.nastran.n2p import rbgeom_uset

    try:
        uset = reader.bulk2uset(str(path), encoding="latin-1")[0]
        blocks = rbgeom_uset(uset).reshape(-1, 6, 6)
        places = uset.loc[(slice(None), 1), ["x", "y", "z"]].to_numpy(dtype=float)
    except Exception as error:
        raise InputError(
            f"bulk {bulk.name} places grids in a coordinate system that is not there or not CORD2 ({error}); "
            f"write the grids in basic coordinates"
        ) from None
    return ids, bulk.units.length * places, np.swapaxes(blocks[:, 3:, 3:], 1, 2)


def elements(bulk: Bulk, number: dict[int, int]) -> Iterator[Elements]:
    """Elements that weigh, by kind, with their density per measure in SI."""
    properties = bulk.by_id("PSHELL", "PCOMP", "PSOLID", *SECTIONS)
    materials = bulk.by_id(*DENSITY_FIELD)
    made: dict[int, tuple[int, float]] = {}
    for name, (kinds, first) in SHAPES.items():
        found: dict[str, list[tuple[list[int], float]]] = {}
        for card in bulk.of(name):
            if name == "CONROD":
                material, area, extra = (bulk.fields(card, k, 1, name)[0] for k in (3, 4, 7))
                told = (1, area * density(bulk, int(material), materials) + extra)
            else:
                pid = int(bulk.fields(card, 1, 1, name)[0])
                if pid not in made:
                    made[pid] = per_measure(bulk, name, pid, properties, materials)
                told = made[pid]
            kind, nodes = nodes_of(bulk, name, card, kinds, first)
            check_flat(bulk, name, card)
            if len(ELEMENTS[kind].points[0]) != told[0]:
                raise InputError(
                    f"bulk {bulk.name}: {name} {card[0]} has the property of another kind of element"
                )
            found.setdefault(kind, []).append((nodes, told[1]))
        for kind, rows in found.items():
            try:
                table = np.array([[number[node] for node in nodes] for nodes, _ in rows])
            except KeyError as error:
                raise InputError(
                    f"bulk {bulk.name} has a {name} on grid {error}, which is not there"
                ) from None
            size = bulk.units.mass / bulk.units.length ** len(ELEMENTS[kind].points[0])
            yield Elements(kind, table, size * np.array([rho for _, rho in rows]))


def nodes_of(bulk: Bulk, name: str, card: Card, kinds: Sequence[str], first: int) -> tuple[str, list[int]]:
    """The kind of an element by how many nodes it has, and their numbers."""
    for kind in kinds:
        count = len(ELEMENTS[kind].points)
        given = bulk.fields(card, first, count, name).astype(int)
        if np.all(given > 0) and len(set(given)) == count:
            return kind, given.tolist()
    counts = " or ".join(str(len(ELEMENTS[kind].points)) for kind in kinds)
    raise InputError(
        f"bulk {bulk.name}: {name} {card[0]} has not the {counts} different nodes that are known here; "
        f"write all midside nodes, or none"
    )


def check_flat(bulk: Bulk, name: str, card: Card) -> None:
    """No shell is beside its nodes or of its own thickness."""
    at = {"CQUAD4": 7, "CQUADR": 7, "CTRIA3": 6, "CTRIAR": 6}.get(name)
    if at is not None and np.any(bulk.fields(card, at, 7, name)):
        raise InputError(
            f"bulk {bulk.name}: {name} {card[0]} has an offset or thicknesses of its own, which are not read "
            f"here; give them by PSHELL"
        )


def per_measure(
    bulk: Bulk, element: str, pid: int, properties: dict[int, Any], materials: dict[int, Any]
) -> tuple[int, float]:
    """Dimension, and density per volume, area or length, of a property."""
    if pid not in properties:
        raise InputError(
            f"bulk {bulk.name}: {element} uses property {pid}, which is not there or not known here"
        )
    name, card = properties[pid]
    if name == "PSOLID":
        return 3, density(bulk, int(bulk.fields(card, 1, 1, name)[0]), materials)
    if name == "PSHELL":
        material, thickness = bulk.fields(card, 1, 2, name)
        return 2, thickness * density(bulk, int(material), materials) + bulk.fields(card, 7, 1, name)[0]
    if name == "PCOMP":
        plies = [bulk.fields(card, at, 2, name) for at in range(8, len(card), 4)]
        sides = 2 if len(card) > 7 and str(card[7]).upper() in ("SYM", "SYMEM") else 1
        layers = sum(thickness * density(bulk, int(ply), materials) for ply, thickness in plies)
        return 2, sides * layers + bulk.fields(card, 2, 1, name)[0]
    material, area, extra = (bulk.fields(card, at, 1, name)[0] for at in SECTIONS[name])
    return 1, area * density(bulk, int(material), materials) + extra


def density(bulk: Bulk, mid: int, materials: dict[int, Any]) -> float:
    """Of a material, in the file's units; raises InputError where no material is like that."""
    if mid not in materials:
        raise InputError(f"bulk {bulk.name} uses material {mid}, which is not there or not known here")
    name, card = materials[mid]
    rho = float(bulk.fields(card, DENSITY_FIELD[name], 1, name)[0])
    young = float(bulk.fields(card, 1, 1, name)[0]) if name in ("MAT1", "MAT8") else 0.0
    scale = bulk.parameter("WTMASS", 1.0)
    check_material(f"material {mid} of bulk {bulk.name}", rho * scale, young or None, bulk.units)
    return rho


def carried(bulk: Bulk, number: dict[int, int], nodes: Array) -> tuple[Array, Array, Array]:
    """Points (C, 3) m that move with a grid (C,) as one body, and their masses (C,) in file units.

    A CONM2 with an inertia is six points on its principal axes, of the same six integrals.
    """
    points, carriers, masses = [np.zeros((0, 3))], [np.zeros(0, dtype=int)], [np.zeros(0)]
    for card in bulk.of("CONM2"):
        eid, grid, system, mass, *rest = bulk.fields(card, 0, 14, "CONM2")
        if int(grid) not in number or system not in (0, -1) or mass < 0 or (mass == 0 and any(rest[4:])):
            raise InputError(
                f"bulk {bulk.name}: CONM2 {int(eid)} is on no grid, in a local coordinate system, or has an "
                f"inertia without a mass; write it in basic coordinates"
            )
        k, offset = number[int(grid)], bulk.units.length * np.array(rest[:3])
        centre = offset if system == -1 else nodes[k] + offset
        i11, i21, i22, i31, i32, i33 = rest[4:10]
        # products enter a Nastran inertia matrix with their signs changed
        inertia = np.array([[i11, -i21, -i31], [-i21, i22, -i32], [-i31, -i32, i33]])
        spread = bulk.units.length**2 * (0.5 * np.trace(inertia) * np.eye(3) - inertia) / max(mass, 1e-300)
        values, axes = np.linalg.eigh(spread)
        if values[0] < -1e-6 * max(values[-1], 1e-300):
            raise InputError(
                f"bulk {bulk.name}: CONM2 {int(eid)} has an inertia that no body has; correct it"
            )
        arms = axes.T * np.sqrt(3 * np.maximum(values, 0.0))[:, None]
        cloud = np.vstack([centre + arms, centre - arms]) if np.any(arms) else centre[None]
        points.append(cloud)
        carriers.append(np.full(len(cloud), k))
        masses.append(np.full(len(cloud), mass / len(cloud)))
    return np.concatenate(points), np.concatenate(carriers), np.concatenate(masses)
