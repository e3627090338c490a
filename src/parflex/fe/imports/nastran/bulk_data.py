"""Nodes and masses of a model in Nastran's bulk data."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy import sparse

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.fe.body.elements import ELEMENTS, mass_matrix
from parflex.fe.body.integrals import Sparse
from parflex.fe.body.surface import surface
from parflex.fe.imports.foreign import encoding_of, refusing
from parflex.fe.imports.nastran.bulk_cards import Bulk, cards_of
from parflex.fe.imports.nastran.bulk_masses import SHAPES, carried, elements
from parflex.fe.imports.nastran.pyyeti import nastran
from parflex.fe.imports.unit_systems import Units

MASSLESS = (
    "CORD", "CELAS", "CDAMP", "CBUSH", "CGAP", "CVISC", "CWELD", "CFAST", "CSEAM", "CEND", "CSET", "CPLSTN",
    "CPLSTS",
)  # fmt: skip
SUPERELEMENT_CARDS = ("SESET", "SECONCT", "CSUPER", "SEBULK", "SELABEL")


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
        """The arms (K, 3) m from the carrying grids."""
        return self.nodes - self.nodes[self.carrier]


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
    parts = list(elements(bulk, ids))
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


def check_whole(bulk: Bulk) -> None:
    """Raise InputError for part of a file, for superelements, and for elements of unknown mass."""
    if not bulk.of("ENDDATA"):
        raise InputError(
            f"bulk {bulk.name} has no ENDDATA; it is cut short, or not the main file: give all of it"
        )
    apart = sorted(set(SUPERELEMENT_CARDS) & set(bulk.cards))
    if apart or any(np.any(bulk.fields(card, 7, 1, "SEID of GRID")) for card in bulk.of("GRID")):
        raise InputError(
            f"bulk {bulk.name} divides the model into superelements ({', '.join(apart) or 'SEID of GRID'}); "
            f"solve the model in one piece"
        )
    if any(np.any(bulk.fields(card, 1, 5, "GRDSET")) for card in bulk.of("GRDSET")):
        raise InputError(
            f"bulk {bulk.name} has a GRDSET, which is not read here; write its fields in each GRID"
        )
    for name in bulk.cards:
        known = name in SHAPES or name == "CONM2" or name.startswith(MASSLESS)
        if name.startswith("C") and name.isalnum() and not known:
            raise InputError(
                f"bulk {bulk.name} has {name} cards, whose mass is not known here; export the stiffness and "
                f"mass matrices and read those, or leave these elements out"
            )


def grids(bulk: Bulk, path: Path) -> tuple[Array, Array, Array]:
    """The ids (K,), places (K, 3) m, and the turns (K, 3, 3) from output to basic components."""
    table = np.array([bulk.fields(card, 0, 6, "GRID") for card in bulk.of("GRID")])
    table = table[np.argsort(table[:, 0], kind="stable")]
    ids = table[:, 0].astype(int)
    if ids[0] <= 0:
        raise InputError(f"bulk {bulk.name} has GRID {ids[0]}; numbers of grids are positive")
    if np.any(np.diff(ids) == 0):
        raise InputError(f"bulk {bulk.name} has GRID {ids[:-1][np.diff(ids) == 0][0]} twice; keep one")
    if not np.any(table[:, [1, 5]]):
        return ids, bulk.units.length * table[:, 2:5], np.broadcast_to(np.eye(3), (len(ids), 3, 3))
    with refusing(
        f"bulk {bulk.name} places grids in a coordinate system that is not there or not CORD2; write the "
        f"grids in basic coordinates ({{}})",
        Exception,
    ):
        uset = nastran("bulk").bulk2uset(str(path), encoding=encoding_of(path))[0]
        blocks = nastran("n2p").rbgeom_uset(uset).reshape(-1, 6, 6)
        places = uset.loc[(slice(None), 1), ["x", "y", "z"]].to_numpy(dtype=float)
        if blocks.shape[0] != len(ids) or places.shape != (len(ids), 3):
            raise ValueError(f"{len(ids)} grids, {len(blocks)} of them placed")
    return ids, bulk.units.length * places, np.swapaxes(blocks[:, 3:, 3:], 1, 2)
