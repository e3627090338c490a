"""The masses in Nastran's bulk data: elements by their properties and materials, and CONM2 cards."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.fe.body.elements import ELEMENTS, Elements
from parflex.fe.imports.foreign import rows_of
from parflex.fe.imports.nastran.bulk_cards import Bulk, Card
from parflex.fe.imports.unit_systems import check_material

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
DENSITY_FIELD = {"MAT1": 4, "MAT2": 7, "MAT8": 7, "MAT9": 22}
SECTIONS = {"PROD": (1, 2, 5), "PBAR": (1, 2, 6), "CONROD": (3, 4, 7)}  # material, area, non-structural mass


def elements(bulk: Bulk, ids: Array) -> Iterator[Elements]:
    """The elements that weigh, by kind, with their density per measure in SI."""
    properties = bulk.by_id("PSHELL", "PCOMP", "PSOLID", "PROD", "PBAR")
    materials = bulk.by_id(*DENSITY_FIELD)
    made: dict[int, tuple[int, float]] = {}
    for name, (kinds, first) in SHAPES.items():
        found: dict[str, list[tuple[list[int], float]]] = {}
        for card in bulk.of(name):
            pid = int(bulk.fields(card, 1, 1, name)[0])
            if name == "CONROD":  # it is its own property
                told = per_measure(bulk, name, card, materials)
            elif pid not in properties:
                raise InputError(
                    f"bulk {bulk.name}: {name} uses property {pid}, which is not there or not known here"
                )
            else:
                told = made[pid] = made.get(pid) or per_measure(bulk, *properties[pid], materials)
            kind, nodes = nodes_of(bulk, name, card, kinds, first)
            check_flat(bulk, name, card)
            if len(ELEMENTS[kind].points[0]) != told[0]:
                raise InputError(
                    f"bulk {bulk.name}: {name} {card[0]} has the property of another kind of element"
                )
            found.setdefault(kind, []).append((nodes, told[1]))
        for kind, rows in found.items():
            missing = f"bulk {bulk.name} has a {name} on grid {{}}, which is not there"
            table = rows_of(ids, np.array([nodes for nodes, _ in rows]), missing)
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
    """Raise InputError where a shell is beside its nodes or of its own thickness."""
    at = {"CQUAD4": 7, "CQUADR": 7, "CTRIA3": 6, "CTRIAR": 6}.get(name)
    if at is not None and np.any(bulk.fields(card, at, 7, name)):
        raise InputError(
            f"bulk {bulk.name}: {name} {card[0]} has an offset or thicknesses of its own, which are not read "
            f"here; give them by PSHELL"
        )


def per_measure(bulk: Bulk, name: str, card: Card, materials: dict[int, Any]) -> tuple[int, float]:
    """The dimension of a property, and its density per volume, area or length."""
    if name == "PSOLID":
        return 3, density(bulk, int(bulk.fields(card, 1, 1, name)[0]), materials)
    if name == "PSHELL":
        material, thickness = bulk.fields(card, 1, 2, name)
        return 2, thickness * density(bulk, int(material), materials) + bulk.fields(card, 7, 1, name)[0]
    if name == "PCOMP":
        sides = 2 if len(card) > 7 and str(card[7]).upper() in ("SYM", "SYMEM") else 1
        layers = sum(thickness * density(bulk, int(ply), materials) for ply, thickness in plies(bulk, card))
        return 2, sides * layers + bulk.fields(card, 2, 1, name)[0]
    material, area, extra = (bulk.fields(card, at, 1, name)[0] for at in SECTIONS[name])
    return 1, area * density(bulk, int(material), materials) + extra


def plies(bulk: Bulk, card: Card) -> Iterator[tuple[float, float]]:
    """The material and thickness of each ply of a PCOMP; blank ones are those of the ply before."""
    material = thickness = 0.0
    for at in range(8, len(card), 4):
        if all(field == "" for field in card[at : at + 3]):
            continue
        given = bulk.fields(card, at, 2, "PCOMP")
        material, thickness = given[0] or material, given[1] or thickness
        yield material, thickness


def density(bulk: Bulk, mid: int, materials: dict[int, Any]) -> float:
    """The density of a material, in the file's units; raises InputError where no material is like that."""
    if mid not in materials:
        raise InputError(f"bulk {bulk.name} uses material {mid}, which is not there or not known here")
    name, card = materials[mid]
    rho = float(bulk.fields(card, DENSITY_FIELD[name], 1, name)[0])
    young = float(bulk.fields(card, 1, 1, name)[0]) if name in ("MAT1", "MAT8") else 0.0
    mass = rho * bulk.parameter("WTMASS", 1.0)
    check_material(f"material {mid} of bulk {bulk.name}", mass, young or None, bulk.units)
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
