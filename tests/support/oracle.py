"""Dynamics of a parallel robot with a flexible platform from first principles, in world axes.

Written differently from the library, without its mechanics: the platform is a cloud of point masses, a leg a
set of links, each with the Jacobian of its own motion; nothing is eliminated from the system of all unknowns

    [ M   0  −Wᵀ ] [u̇]   [ w − c  ]     u̇ = (v̇, ω̇, q̈_e) of the platform, world axes
    [ 0   A   Jᵀ ] [q̈] = [ SΓ − b ]     q̈ of all joints
    [−W   J   0  ] [f]   [ h − J̇q̇ ]     f of the tips on the platform, world axes

A robot is anything with `legs` and `gravity`; states are single, not batches. Joint friction and springs are
part of b; where rows of the closure repeat each other the accelerations are still unique, the forces f not.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag

from parflex.fe.plate import mesh, plate

RANK = 1e-9  # below this part of the largest singular value a row is a repetition
STEP = 1e-30  # of a complex step, f(x + iεv) = f + iε f′v: no truncation, no cancellation


def cross(a, b):
    """a × b along the last axis; `np.cross` takes twice as long on small arrays."""
    return a[..., [1, 2, 0]] * b[..., [2, 0, 1]] - a[..., [2, 0, 1]] * b[..., [1, 2, 0]]


@dataclass(frozen=True, eq=False, repr=False)
class NodalPlatform:
    """Point masses in Σp, the diagonals of stiffness and damping, and the points that legs hold."""

    positions: np.ndarray  # (K, 3)
    masses: np.ndarray  # (K,)
    shapes: np.ndarray  # (N, K, 3)
    stiffness: np.ndarray  # (N,)
    damping: np.ndarray  # (N,)
    attachments: np.ndarray  # (k, 3)
    attachment_shapes: np.ndarray  # (k, 3, N)

    def point_motion(self, state, r, Phi):
        """World positions, velocities, Jacobians (K, 3, 6 + N) and velocity-product accelerations of points.

        x = p + Rρ, ρ = r + Φq:  ẋ = v + ω × Rρ + RΦq̇,  ẍ = J u̇ + ω × (ω × Rρ) + 2 ω × RΦq̇
        """
        R, still = np.asarray(state.rotation), np.zeros(len(self.stiffness))
        v, omega = np.reshape(state.twist, (2, 3)) @ R.T
        arm, sway = (r + Phi @ (state.elastic + still)) @ R.T, Phi @ (state.elastic_rate + still) @ R.T
        one = np.broadcast_to(np.eye(3), (*arm.shape, 3))
        spin = cross(arm[:, None], np.eye(3))  # rows a × e_i: the matrix of ω ↦ ω × a
        J = np.concatenate([one, spin, R @ Phi], axis=-1)
        turning = cross(omega, arm)
        return state.position + arm, v + turning + sway, J, cross(omega, turning + 2 * sway)

    def dynamics(self, state, gravity):
        """M = Σ m JᵀJ and c = Σ m Jᵀ(γ − g) + (0, 0, K q + D q̇): by d'Alembert, the forces m (ẍ − g) of all
        nodes and those of the springs do no work in any virtual motion."""
        _, _, J, drift = self.point_motion(state, self.positions, np.moveaxis(self.shapes, 0, -1))
        J = J.reshape(-1, J.shape[-1])
        weighted = np.repeat(self.masses, 3)[:, None] * J
        c = weighted.T @ (drift - gravity).ravel()
        c[6:] += self.stiffness * state.elastic + self.damping * state.elastic_rate
        return J.T @ weighted, c

    def node_force(self, state, node, force):
        """Generalised force (6 + N,) of a world force (3,) on a node, JᵀF."""
        r, Phi = self.positions[[node]], np.moveaxis(self.shapes[:, [node]], 0, -1)
        return self.point_motion(state, r, Phi)[2][0].T @ force


def nodal_platform(positions, masses, shapes, frequencies, damping_ratio, attachments):
    """A cloud held at some of its nodes: K_kk = ω² m_kk, D_kk = 2ζω m_kk, m_kk = Σ m |Φ_k|²."""
    modal_mass = np.einsum("p,npa,npa->n", masses, shapes, shapes)
    stiffness, damping = frequencies**2 * modal_mass, 2 * damping_ratio * frequencies * modal_mass
    held, moving = positions[list(attachments)], np.moveaxis(shapes[:, list(attachments)], 0, -1)
    return NodalPlatform(positions, masses, shapes, stiffness, damping, held, moving)


def plate_cloud(corners, thickness, n_modes, damping_ratio=0.4, **material):
    """The Kirchhoff plate of `parflex.fe.plate_modes`, held at its corners; damped as in the paper's Table 2.

    In the plane the nodes are the quadrature points, whose weights integrate products of the shapes exactly.
    Across it, two layers at z = ±h/√12 carry half the mass each: they have the ∫1, ∫z, ∫z² of the thickness,
    all that the field (−z w_x, −z w_y, w), linear in z, can ask for.
    """
    corners = plate.convex_polygon(corners)
    section = plate.plate_section(thickness, plate.chosen(**material))
    levels = range(plate.DEFAULT_REFINE, 9)
    refine = next(r for r in levels if mesh.unknowns(len(corners), r) > 12 * n_modes)
    modes = plate.plate_modes(corners, thickness, n_modes=n_modes, refine=refine, **material)
    basis = plate.argyris(corners, refine)
    inside, (xy, area) = plate.sampled(basis, modes.reduction.vectors), plate.plate_quadrature(basis)
    xy = xy + plate.centroid(corners)[:, None]
    (slope_x, slope_y), z = np.moveaxis(inside.slope, 1, 0), thickness / np.sqrt(12) * np.ones_like(area)
    positions = np.concatenate([np.column_stack([*xy, level]) for level in (-z, z)])
    shapes = [np.stack([-level * slope_x, -level * slope_y, inside.w], axis=-1) for level in (-z, z)]
    masses, shapes = np.tile(0.5 * section.a * area, 2), np.concatenate(shapes, axis=1)
    cloud = nodal_platform(positions, masses, shapes, modes.frequencies, damping_ratio, ())
    deflection = np.zeros((len(corners), 3, n_modes))
    deflection[:, 2] = modes.shapes[:, 1 : 1 + len(corners), 2].T
    return replace(cloud, attachments=np.pad(corners, ((0, 0), (0, 1))), attachment_shapes=deflection)


def screw(axis, angle, length):
    """Rot(axis, angle) Trans(axis, length), 4 × 4."""
    T, i, j = np.eye(4, dtype=np.result_type(angle, length)), (axis + 1) % 3, (axis + 2) % 3
    T[i, i] = T[j, j] = np.cos(angle)
    T[j, i], T[i, j], T[axis, 3] = np.sin(angle), -np.sin(angle), length
    return T


def tree(leg, q):
    """World axes: link rotations (n, 3, 3), tips (t, 3), Jacobians (n + t, 6, n) of link origins, then tips.

    T_j = T_a Rot(z,γ) Trans(z,b) Rot(x,α) Trans(x,d) Rot(z,θ) Trans(z,r). A joint on the path to a point x
    moves it by (z × (x − o), z) if it turns, by (z, 0) if it slides.
    """
    T, path = [np.eye(4)], [np.zeros(len(q))]
    T[0][:3, :3], T[0][:3, 3] = leg.rotation, leg.origin
    for number, joint in enumerate(leg.joints):
        theta, r = np.array([joint.theta, joint.r]) + np.eye(2)[joint.sigma] * q[number]
        row = screw(2, joint.gamma, joint.b) @ screw(0, joint.alpha, joint.d) @ screw(2, theta, r)
        T.append(T[joint.antecedent] @ row)
        path.append(path[joint.antecedent] + np.eye(len(q))[number])
    tips = np.array([T[tip.frame][:3] @ [*tip.offset, 1.0] for tip in leg.tips])
    path = np.array(path[1:] + [path[tip.frame] for tip in leg.tips])[..., None]
    R, o = np.array(T)[1:, :3, :3], np.array(T)[1:, :3, 3]
    z, slides = R[..., 2], np.array([joint.sigma for joint in leg.joints])[:, None]
    arms = np.concatenate([o, tips])[:, None] - o
    columns = [np.where(slides, z, cross(z, arms)), np.broadcast_to((1 - slides) * z, arms.shape)]
    return R, tips, np.swapaxes(path * np.concatenate(columns, axis=-1), 1, 2)


def tip_rows(leg, J):
    """The linear rows (3t, …) of the tips."""
    return J[len(leg.joints) :, :3].reshape(3 * len(leg.tips), *J.shape[2:])


def ups_start(leg, tips):
    """(q1, q2, q3) of a U-P-S leg: its slider's axis in Σ0i is (cos q1 sin q2, −cos q2, −sin q1 sin q2)."""
    x, y, z = np.asarray(leg.rotation).T @ (tips[0] - leg.origin)
    length = np.linalg.norm([x, y, z])
    return np.array([np.arctan2(-z, x), np.arccos(-y / length), length])


def joint_values(leg, tips, q):
    """Newton's iteration on the world positions (t, 3) of the tips, from q."""
    for _ in range(20):
        _, reached, J = tree(leg, q)
        step = np.linalg.lstsq(tip_rows(leg, J), (tips - reached).ravel(), rcond=None)[0]
        q = q + step
        if (
            np.max(np.abs(step), initial=0.0) < 1e-9
        ):  # the next step, of the size of its square, is below round-off
            return q
    raise ValueError("the leg does not reach its tips from this start")


def joint_rates(leg, q, tip_velocities, rates=0.0):
    """q̇ that moves the tips (t, 3) so, the nearest one to `rates` where the tips leave a choice."""
    J = tip_rows(leg, tree(leg, q)[2])
    rates = rates + np.zeros(len(q))
    return rates + np.linalg.lstsq(J, tip_velocities.ravel() - J @ rates, rcond=None)[0]


def joint_loads(leg, q, qd):
    """Friction Fv q̇ + Fs q̇/√(q̇² + v_s²) and springs k (q − q_0), against the motion of each joint; the
    springs of turning joints by the nearest way round."""
    loads = np.array([(j.Fv, j.Fs, j.v_s, j.k, j.q_0) for j in leg.joints])
    viscous, dry, v_s, k, q_0 = loads.reshape(-1, 5).T
    turns = np.array([1 - joint.sigma for joint in leg.joints])
    stretch = q - q_0 - turns * 2 * np.pi * np.round((q - q_0) / (2 * np.pi))
    return viscous * qd + dry * qd / np.hypot(qd, v_s) + k * stretch


def leg_dynamics(leg, q, qd, gravity):
    """A, b, J and J̇q̇ of A q̈ + b = SΓ − Jᵀf: A = Σ JᵀMJ + IA, b = Σ Jᵀ(M (J̇q̇ − g) + quadratic terms)
    + friction and springs.

    Newton and Euler about the origins of the link frames: M, MS and I enter linearly, so that grouped
    parameters, which no real link has, are welcome.
    """
    R, _, J = tree(leg, q)
    drift = tree(leg, q + 1j * STEP * qd)[2].imag / STEP @ qd
    J_o, drift_o, omega = J[: len(q)], drift[: len(q)], (J @ qd)[: len(q), None, 3:]
    mass = np.array([joint.M for joint in leg.joints])[:, None, None] * np.eye(3)
    MS = np.swapaxes(R @ np.array([joint.MS for joint in leg.joints]).reshape(-1, 3, 1), 1, 2)
    inertia = R @ np.array([joint.I for joint in leg.joints]).reshape(-1, 3, 3) @ np.swapaxes(R, 1, 2)
    hat = cross(np.eye(3), MS)  # rows e_i × MS
    M = np.block([[mass, -hat], [hat, inertia]])
    quadratic = cross(omega, np.concatenate([cross(omega, MS), omega @ inertia], axis=1)).reshape(-1, 6)
    A = np.einsum("jai,jab,jbk->ik", J_o, M, J_o) + np.diag([joint.IA for joint in leg.joints])
    force = np.einsum("jab,jb->ja", M, drift_o - np.pad(gravity, (0, 3))) + quadratic
    b = np.einsum("jai,ja->i", J_o, force) + joint_loads(leg, q, qd)
    return A, b, tip_rows(leg, J), tip_rows(leg, drift)


class System(NamedTuple):
    """K (u̇, q̈, f) = rhs + SΓ, and what it takes to read the unknowns."""

    K: np.ndarray
    rhs: np.ndarray
    S: np.ndarray
    R: np.ndarray  # (3, 3), Σp in the world
    sizes: list  # of v̇, ω̇ together, q̈_e, q̈ of each leg, f
    held: np.ndarray  # (k, tips), 1 where an attachment is held by a tip
    repeats: bool  # whether rows of the closure depend on each other: K is singular, f not unique


class Motion(NamedTuple):
    """V̇_p (6,), q̈_e (N,), contact forces by attachment (k, 3), all in Σp; q̈ per leg; Γ (m,)."""

    platform: np.ndarray
    elastic: np.ndarray
    contact_forces: np.ndarray
    qdd: list
    forces: np.ndarray


def system(robot, platform, state, generalised_wrench=None, start=None, rates=None):
    """All nodes, all links, closure at all tips. `start`: joint values near the solution, per leg (U-P-S legs
    need none); `rates`: q̇ per leg, where the tips alone do not give it; `generalised_wrench` (6 + N,): a sum
    of `node_force`."""
    M, c = platform.dynamics(state, robot.gravity)
    held = [tip.attachment for leg in robot.legs for tip in leg.tips]
    points = platform.attachments[held], platform.attachment_shapes[held]
    places, velocities, W, h = platform.point_motion(state, *points)
    models, first = [], 0
    for number, leg in enumerate(robot.legs):
        mine = slice(first, first := first + len(leg.tips))
        q = joint_values(leg, places[mine], ups_start(leg, places[mine]) if start is None else start[number])
        qd = joint_rates(leg, q, velocities[mine], 0.0 if rates is None else rates[number])
        models.append(leg_dynamics(leg, q, qd, robot.gravity))
    A, b, J, drift = zip(*models, strict=True)
    closure = np.hstack([-W.reshape(-1, len(M)), block_diag(*J)])
    K = np.block([[block_diag(M, *A), closure.T], [closure, np.zeros((len(closure), len(closure)))]])
    load = -c if generalised_wrench is None else generalised_wrench - c
    rhs = np.concatenate([load, -np.hstack(b), h.ravel() - np.hstack(drift)])
    actuated = np.flatnonzero([joint.mu for leg in robot.legs for joint in leg.joints])
    S, by_tip = np.eye(len(K))[:, len(M) + actuated], np.eye(len(platform.attachments))[:, held]
    sizes = [6, len(M) - 6, *map(len, b), len(closure)]
    repeats = bool(np.linalg.matrix_rank(closure, rtol=RANK) < len(closure))
    return System(K, rhs, S, np.asarray(state.rotation), sizes, by_tip, repeats)


def balanced_solve(K, rhs, singular=False):
    """K⁻¹ rhs, after rows and columns of different units (kg, m, kg m²) were brought to one size; where K is
    singular by its repeated rows, by its pseudo-inverse: of all solutions, which share their accelerations,
    the shortest in the balanced units."""
    rows, columns = np.ones(len(K)), np.ones(len(K))
    for _ in range(5):
        scaled = np.abs(rows[:, None] * K * columns)
        rows, columns = rows / np.sqrt(scaled.max(axis=1)), columns / np.sqrt(scaled.max(axis=0))
    balanced, rhs = rows[:, None] * K * columns, rows * rhs
    if singular:
        return columns * np.linalg.lstsq(balanced, rhs, rcond=RANK)[0]
    return columns * np.linalg.solve(balanced, rhs)


def motion(at, x):
    """The unknowns (u̇, q̈, f, Γ) by name."""
    rigid, elastic, *qdd, f, forces = np.split(x, np.cumsum(at.sizes))
    contact_forces = at.held @ f.reshape(-1, 3) @ at.R
    return Motion((rigid.reshape(2, 3) @ at.R).ravel(), elastic, contact_forces, qdd, forces)


def direct_of(at, forces):
    """The direct model of a system."""
    x = balanced_solve(at.K, at.rhs + at.S @ forces, at.repeats)
    return motion(at, np.concatenate([x, forces]))


def inverse_of(at, target, rows=range(6)):
    """The inverse model: Γ joins the unknowns y, the wanted rows of V̇_p = diag(Rᵀ, Rᵀ)(v̇, ω̇) the equations
    B y = d. More actuators than rows leave a choice, of which Γ is the shortest: min ½ |Γ|², B y = d, by its
    multipliers λ."""
    wanted = np.pad(np.kron(np.eye(2), at.R.T), ((0, 0), (0, len(at.K) - 6)))[list(rows)]
    B = np.block([[at.K, -at.S], [wanted, np.zeros((len(wanted), at.S.shape[1]))]])
    d = np.concatenate([at.rhs, target])
    if B.shape[0] < B.shape[1]:
        shortest = np.diag(np.repeat([0.0, 1.0], [len(at.K), at.S.shape[1]]))
        B = np.block([[shortest, B.T], [B, np.zeros((len(B), len(B)))]])
        d = np.concatenate([np.zeros(len(shortest)), d])
    y = balanced_solve(B, d, at.repeats)
    return motion(at, y[: len(at.K) + at.S.shape[1]])


def direct(robot, platform, state, forces, **options):
    """V̇_p (6,), q̈_e (N,), contact forces (k, 3), all in Σp, and q̈ per leg for given Γ (m,); the options are
    those of `system`."""
    return direct_of(system(robot, platform, state, **options), forces)[:4]


def inverse(robot, platform, state, target, rows=range(6), **options):
    """Γ (m,) that gives these rows of V̇_p the values `target`, and q̈_e (N,); the options are those of
    `system`."""
    found = inverse_of(system(robot, platform, state, **options), target, rows)
    return found.forces, found.elastic


def stacked(motions):
    """One Motion whose fields are arrays with the states in front."""
    fields = [list(field) for field in zip(*motions, strict=True)]
    qdd = [np.array(leg) for leg in zip(*fields[3], strict=True)]
    return Motion(*(np.array(field) for field in fields[:3]), qdd, np.array(fields[4]))
