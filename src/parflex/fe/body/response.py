"""The static response of a free body to unit loads at its places, under inertia relief."""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.progress import waiting
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.joints import Place


class Loads(NamedTuple):
    """Unit loads at places: columns (n, p) and their names."""

    columns: Array
    names: tuple[str, ...]


class Static(NamedTuple):
    """Loads, and the deformations K⁺ F (n, p) they cause."""

    loads: Loads
    flexed: Array

    @property
    def compliance(self) -> Array:
        """Fᵀ K⁺ F (p, p), m/N for forces, rad/(N m) for moments."""
        return np.asarray(self.loads.columns.T @ self.flexed)

    def soft(self, compliance: Array, negligible: float) -> Array:
        """The ones (p,) bool of these compliances (p,) that are not negligible beside the largest of their
        kind at their place."""
        own = np.diagonal(self.compliance).reshape(-1, 3)
        return np.asarray(compliance > negligible * np.repeat(np.max(own, axis=1), 3))


def static_response(body: FreeBody, held: tuple[Place, ...]) -> Static:
    """The response to the places' unit loads."""
    loads = loads_of(body, held)
    with waiting(f"computing the response to {len(loads.names)} unit loads"):
        return Static(loads, body.flexed(loads.columns))


def loads_of(body: FreeBody, held: tuple[Place, ...]) -> Loads:
    """Three forces at each place, and three moments at the tool."""
    columns, names = [np.zeros((body.unknowns, 0))], []
    for place in held:
        kinds = [(False, place.displacement)] + [(True, place.rotation)] * place.is_tool
        for moment, rows in kinds:
            columns.append(rows.toarray().T)
            names += [f"{place.name}{' moment' * moment} along {axis}" for axis in "xyz"]
    return Loads(np.hstack(columns), tuple(names))
