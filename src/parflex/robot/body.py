"""The flexible body (Sec. 4.4): three moment tensors hold every inertia integral.

P0 = ∫ r rᵀ dm, P1_k = ∫ Φ_k rᵀ dm, P2_kj = ∫ Φ_k Φ_jᵀ dm, with m, MS0 = ∫ r dm, S = ∫ Φ dm; with
them the body's inertia is exact in all orders of the elastic coordinates.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from parflex.base import kinds
from parflex.base.array import Array, outer, without_roundoff
from parflex.base.check import exactly, integer, of_type, positive, whole_numbers
from parflex.base.errors import InputError
from parflex.base.plausible import usual
from parflex.robot.attachments import attachment_nodes
from parflex.robot.modal import modal_diagonals, modal_mass, modal_masses, natural_frequencies
from parflex.robot.modes import Modes
from parflex.robot.moments import Moments, lumped_moments, shifted, with_point, with_shapes
from parflex.robot.words import counted, modal


@dataclass(frozen=True, eq=False)
class FlexibleBody:
    """A platform or a link: moment tensors, modal stiffness and damping, nodes, and those that others hold.

    `nodes` (K, 3) m, `shapes` (N, K, 3) and `rotation_shapes` (N, K, 3) or None are in Σp, those of a link
    in its joint's frame; `attachments` are node numbers; `stiffness` and `damping` are the diagonals of K_ee
    and D_ee; `triangles` (T, 3) is a surface to draw. `foreshortening` (attachments, 3, N, N) is H of a
    link's attachments, which move by Φ_d e + ½ eᵀ H e. `band` and `missed` are those of `Modes`. Built by
    `from_nodes`, `from_modes`, `rigid` or `beam`.
    """

    moments: Moments
    nodes: Array
    shapes: Array
    rotation_shapes: Array | None
    stiffness: Array
    damping: Array
    attachments: tuple[int, ...]
    triangles: Array | None = None
    foreshortening: Array | None = None
    band: float | None = None
    missed: Array | None = None

    def __post_init__(self) -> None:
        count = len(self.nodes)
        for number, node in enumerate(self.attachments):
            if integer(f"attachments[{number}]", node) >= count:
                raise InputError(f"attachments[{number}] is node {node}; this body has nodes 0 … {count - 1}")

    @staticmethod
    def from_nodes(
        positions: ArrayLike,
        masses: ArrayLike,
        shapes: ArrayLike,
        frequencies: ArrayLike,
        damping_ratio: ArrayLike = 0.0,
        attachments: Sequence[int] | ArrayLike = (),
        rotation_shapes: ArrayLike | None = None,
        *,
        foreshortening: ArrayLike | None = None,
    ) -> "FlexibleBody":
        """A body of lumped nodal masses.

        positions (K, 3) m in Σp, masses (K,) kg, mass-normalised shapes (N, K, 3) kg^-½, natural
        frequencies (N,) rad/s, damping ratios scalar or (N,), attachments as node numbers or points,
        rotation_shapes (N, K, 3) rad m⁻¹ kg^-½ where moments are to be applied; of a flexible link
        foreshortening (attachments, 3, N, N), symmetric in its shapes.

        Raises InputError for wrong shapes, negative masses or frequencies, and where ΦᵀMΦ differs
        from 1 by more than 1e-3.
        """
        r = exactly("positions", positions, (None, 3))
        if len(r) == 0:
            raise InputError("positions is empty; a body needs at least one node")
        dm = exactly("masses", masses, (len(r),))
        if np.any(dm < 0) or not np.sum(dm) > 0:
            worst = int(np.argmin(dm))
            raise InputError(f"masses[{worst}] is {dm[worst]}; masses must be ≥ 0, their sum > 0")
        Phi = exactly("shapes", shapes, (None, len(r), 3))
        turned = None if rotation_shapes is None else exactly("rotation_shapes", rotation_shapes, Phi.shape)
        moments = lumped_moments(r, dm, Phi)
        error = np.max(np.abs(modal_mass(moments) - np.eye(len(Phi))), initial=0.0)
        if error > 1e-3:
            raise InputError(
                f"shapes: ΦᵀMΦ differs from 1 by {error:.2e}; normalise the modes to unit modal "
                f"mass with the same masses, and give free–free or at least M-orthogonal shapes"
            )
        omega = natural_frequencies("frequencies", frequencies, len(Phi))
        stiffness, damping = modal_diagonals(moments, omega, damping_ratio)
        nodes = attachment_nodes(r, attachments)
        H = None if foreshortening is None else shortening(foreshortening, len(nodes), len(Phi))
        return FlexibleBody(moments, r, Phi, turned, stiffness, damping, nodes, foreshortening=H)

    @staticmethod
    def from_modes(
        modes: Modes,
        attachments: Sequence[int] | ArrayLike | None = None,
        origin: ArrayLike | None = None,
        *,
        damping_ratio: ArrayLike = 0.0,
    ) -> "FlexibleBody":
        """A body from computed modes, with the FE model's own (consistent) integrals.

        attachments are node numbers or points (k, 3) m, by default the polygon's corners; origin
        is the point (3,) m of the modes' coordinates that becomes the origin of Σp, by default the
        centre of mass.

        Raises InputError where a point is on no node.
        """
        of_type("modes", modes, Modes)
        mass, MS0 = modes.moments.m, modes.moments.MS0
        o = MS0 / mass if origin is None else exactly("origin", origin, (3,))
        nodes = without_roundoff(modes.nodes - o)
        chosen = attachment_nodes(modes.nodes, modes.corners if attachments is None else attachments)
        moments = shifted(modes.moments, o)
        stiffness, damping = modal_diagonals(moments, modes.frequencies, damping_ratio)
        held = (stiffness, damping, chosen, modes.triangles, None, modes.band, modes.missed)
        return FlexibleBody(moments, nodes, modes.shapes, modes.rotations, *held)

    @staticmethod
    def rigid(
        mass: float, com: ArrayLike, inertia_at_com: ArrayLike, attachments: ArrayLike
    ) -> "FlexibleBody":
        """A rigid body: mass kg, centre of mass (3,) m, inertia about it (3, 3) kg m², attachment
        points (k, 3) m, all in Σp.

        Raises InputError for a mass that is not positive or an inertia no body can have.

        >>> disc = FlexibleBody.rigid(5.0, (0, 0, 0), np.diag([0.1, 0.1, 0.2]), [(0.3, 0, 0), (-0.3, 0, 0)])
        >>> disc.modes, disc.moments.m
        (0, 5.0)
        """
        m, c = positive("mass", mass), exactly("com", com, (3,))
        inertia = exactly("inertia_at_com", inertia_at_com, (3, 3))
        points = exactly("attachments", attachments, (None, 3))
        for name, value, kind in (
            ("mass", m, kinds.MASS),
            ("com", c, kinds.LENGTH),
            ("inertia_at_com", inertia, kinds.INERTIA),
            ("attachments", points, kinds.LENGTH),
        ):
            usual(name, value, kind)
        second = 0.5 * np.trace(inertia) * np.eye(3) - inertia
        lowest = np.linalg.eigvalsh(second)[0]
        symmetric = np.allclose(inertia, inertia.T, rtol=0, atol=1e-9 * np.trace(inertia))
        if not symmetric or lowest < -1e-9 * np.trace(inertia):
            raise InputError(
                "inertia_at_com is not the inertia of a body: it must be symmetric, with principal "
                "values that are positive and none larger than the sum of the other two"
            )
        moments = Moments(m, m * c, second + m * outer(c, c), *(np.zeros(s) for s in rigid_shapes))
        empty = np.zeros((0, len(points), 3))
        return FlexibleBody(
            moments, points, empty, empty, np.zeros(0), np.zeros(0), tuple(range(len(points)))
        )

    def with_payload(self, node: int, mass: float) -> "FlexibleBody":
        """The body with a point mass (kg) on a node: the tensors grow by m Φ Φᵀ.

        Stiffness and damping stay those of the bare body. Raises InputError for an unknown node or
        a mass that is not positive.
        """
        m, node = positive("mass", mass), self._known(node)
        moments = with_point(self.moments, m, self.nodes[node], self.shapes[:, node])
        return replace(self, moments=moments)

    def with_modes(self, modes: Sequence[int]) -> "FlexibleBody":
        """The body with some of its modes (from 0), in this order; the others are as if they were rigid.

        Raises InputError for a mode that it does not have, or that is named twice.
        """
        kept = whole_numbers("modes", modes).tolist()
        if len(set(kept)) < len(kept) or max(kept, default=-1) >= self.modes:
            raise InputError(f"modes is {kept}; name some of 0 … {self.modes - 1}, each once")
        turned = None if self.rotation_shapes is None else self.rotation_shapes[kept]
        return replace(
            self,
            moments=with_shapes(self.moments, kept),
            shapes=self.shapes[kept],
            rotation_shapes=turned,
            stiffness=self.stiffness[kept],
            damping=self.damping[kept],
            band=None,
            missed=None,
            foreshortening=None
            if self.foreshortening is None
            else self.foreshortening[..., kept, :][..., kept],
        )

    def shapes_at(self, node: int, offset: ArrayLike = (0.0, 0.0, 0.0)) -> tuple[Array, Array]:
        """Φ_d and Φ_r (3, N) of a node, or of a point (3,) m away from it that is fixed to it.

        Rotations are zero where the body has no rotation shapes. Raises InputError for an unknown node or an
        offset that is no point.
        """
        node, arm = self._known(node), exactly("offset", offset, (3,))
        Phi_d = self.shapes[:, node].T
        Phi_r = np.zeros_like(Phi_d) if self.rotation_shapes is None else self.rotation_shapes[:, node].T
        return Phi_d + np.cross(Phi_r.T, arm).T, Phi_r

    def _known(self, node: int) -> int:
        """The number of a node; raises InputError where the body has none of it."""
        if integer("node", node) >= len(self.nodes):
            raise InputError(f"node is {node}; this body has nodes 0 … {len(self.nodes) - 1}")
        return node

    def __repr__(self) -> str:
        held = counted(len(self.attachments), "attachment")
        return f"FlexibleBody: {self.moments.m:.4g} kg, {modal(self.frequencies)}, {held}"

    @property
    def modes(self) -> int:
        """N, the number of modes; 0 for a rigid body."""
        return len(self.stiffness)

    @property
    def frequencies(self) -> Array:
        """Natural frequencies ω (N,) rad/s of the free body."""
        return np.sqrt(self.stiffness / modal_masses(self.moments))

    @property
    def damping_ratios(self) -> Array:
        """Damping ratios ζ (N,); zero of modes without a frequency."""
        critical = 2.0 * self.frequencies * modal_masses(self.moments)
        return np.divide(self.damping, critical, out=np.zeros(self.modes), where=critical > 0)

    @cached_property
    def m_ee(self) -> Array:
        """Modal mass tr P2 (N, N), exactly 1 where the modes are normalised to round-off."""
        modal, one = modal_mass(self.moments), np.eye(self.modes)
        return np.where(np.abs(modal - one) < 1e-12, one, modal)  # Eq. 34

    @cached_property
    def attachment_points(self) -> Array:
        """r_i(0) (k, 3) m of the undeformed body."""
        return without_roundoff(self.nodes[list(self.attachments)])

    @cached_property
    def attachment_shapes(self) -> Array:
        """Φ_d(i) (k, 3, N)."""
        return without_roundoff(np.moveaxis(self.shapes[:, list(self.attachments)], 0, -1))

    @cached_property
    def attachment_turns(self) -> Array:
        """Φ_r(i) (k, 3, N); zero where the body has no rotation shapes."""
        if self.rotation_shapes is None:
            return np.zeros((len(self.attachments), 3, self.modes))
        return without_roundoff(np.moveaxis(self.rotation_shapes[:, list(self.attachments)], 0, -1))

    @cached_property
    def attachment_shortening(self) -> Array:
        """H (k, 3, N, N) of the attachments; zero where the body has none."""
        H = self.foreshortening
        return np.zeros((len(self.attachments), 3, self.modes, self.modes)) if H is None else H

    @cached_property
    def size(self) -> float:
        """Root mean square distance of the attachments from their centre, m; 1 where that is zero."""
        points = self.attachment_points
        return float(np.sqrt(np.mean(np.sum((points - points.mean(axis=0)) ** 2, axis=-1)))) or 1.0

    @cached_property
    def origin_node(self) -> int | None:
        """The node at the origin of Σp, where there is one."""
        if len(self.nodes) == 0:
            return None
        distance = np.linalg.norm(self.nodes, axis=1)
        nearest = int(np.argmin(distance))
        return nearest if distance[nearest] <= 1e-9 * np.max(distance) else None


def shortening(given: ArrayLike, attachments: int, modes: int) -> Array:
    """H (attachments, 3, N, N); raises InputError for another shape, or where it is not symmetric."""
    H = exactly("foreshortening", given, (attachments, 3, modes, modes))
    off = float(np.max(np.abs(H - np.swapaxes(H, -1, -2)), initial=0.0))
    if off > 1e-9 * float(np.max(np.abs(H), initial=0.0)):
        raise InputError(
            f"foreshortening differs from its transpose in the shapes by {off:.2e}; give H with "
            f"H[a, i, k, l] = H[a, i, l, k]"
        )
    return without_roundoff(0.5 * (H + np.swapaxes(H, -1, -2)))


rigid_shapes = ((3, 0), (0, 3, 3), (0, 0, 3, 3))
