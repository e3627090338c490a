"""The static response of a free body to unit loads at its places, under inertia relief."""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.progress import waiting
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.joints import Holding


class Static(NamedTuple):
    """Unit loads F (n, p), their names, and the deformations K⁺ F (n, p) they cause."""

    columns: Array
    names: tuple[str, ...]
    flexed: Array

    @property
    def compliance(self) -> Array:
        """Fᵀ K⁺ F (p, p), m/N for forces, rad/(N m) for moments."""
        return np.asarray(self.columns.T @ self.flexed)

    def soft(self, compliance: Array, negligible: float) -> Array:
        """The ones (p,) bool of these compliances (p,) that are not negligible beside the largest of their
        kind at their place."""
        own = np.diagonal(self.compliance).reshape(-1, 3)
        return np.asarray(compliance > negligible * np.repeat(np.max(own, axis=1), 3))


def static_response(body: FreeBody, held: tuple[Holding, ...]) -> Static:
    """The response to three unit forces at each place, and three unit moments at the tool."""
    loads = [(place.name, place.displacement) for place in held]
    for place in held:
        if place.is_tool:
            loads.append((f"{place.name} moment", place.rotation))
    names = tuple(f"{name} along {axis}" for name, _ in loads for axis in "xyz")
    columns = np.hstack([np.zeros((body.unknowns, 0)), *(rows.toarray().T for _, rows in loads)])
    with waiting(f"computing the response to {len(names)} unit loads"):
        return Static(columns, names, body.flexed(columns))
