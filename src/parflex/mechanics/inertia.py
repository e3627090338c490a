"""The inertia matrix of the legs by composite links: each coordinate moves all that hangs on it."""

import numpy as np

from parflex.base.array import Array, block, cross, mv, outer, skew, trace, transpose
from parflex.mechanics.chain import Chain, Frames, first_moment, mass
from parflex.mechanics.link import twist_map

Columns = tuple[Array, Array]  # forces and moments (…, L, 3, c) about the origin of a frame, in its axes
E_Z = np.array([0.0, 0.0, 1.0])


def inertia_matrix(chain: Chain, frame: Frames) -> Array:
    """A (…, L, z, z) by composite links: each joint moves all that hangs on it as one body, and each shape
    what hangs on the seats of its link; the drives that give let the rotors move by themselves."""
    n, flexible = chain.n, [j for j, link in enumerate(chain.links) if link is not None]
    row_of = {j: n + i for i, j in enumerate(flexible)}
    drive_of = {j: n + len(flexible) + i for i, j in enumerate(chain.drives)}
    M = [mass(chain, j) for j in range(n)]
    MS = [first_moment(chain, frame, j) for j in range(n)]
    bodies = [chain.I[:, j] if body is None else body.inertia for j, body in enumerate(frame.bodies)]
    inertia = list(bodies)
    modal = {j: modal_columns(chain, frame, j) for j in flexible}
    entry: dict[tuple[int, int], Array] = {}

    def climb(row: int, j: int, columns: Columns) -> None:
        """Enter the rows of all that carries link j, for wrenches at its frame that belong to `row`."""
        force, moment = columns
        while j >= 0:
            part = force if chain.sigma[j] else moment
            entry[j, row] = part[..., 2:3, :]
            entry[row, j] = transpose(entry[j, row])
            seat, a = frame.seats[j], chain.antecedent[j]
            force, moment = frame.R_aj[j] @ force, frame.R_aj[j] @ moment
            moment = moment + skew(frame.p_aj[j]) @ force
            if seat is not None:
                shift, tilt = twist_map(seat)
                entry[row_of[a], row] = transpose(shift) @ force + transpose(tilt) @ moment
                entry[row, row_of[a]] = transpose(entry[row_of[a], row])
            j = a

    for j in reversed(range(n)):
        slide, turn = chain.sigma[j], 1 - chain.sigma[j]
        force = slide * M[j][..., None] * E_Z + turn * cross(E_Z, MS[j])
        moment = slide * cross(MS[j], E_Z) + turn * inertia[j][..., :, 2]
        if j in row_of:
            (shapes, turns), own = modal[j]
            entry[row_of[j], row_of[j]] = own
            climb(row_of[j], j, (shapes, turns))
        climb(j, j, (force[..., None], moment[..., None]))
        rotor = chain.IA[:, j, None, None]
        entry[j, j] = entry[j, j] + rotor
        if j in drive_of:
            entry[j, drive_of[j]] = entry[drive_of[j], j] = -rotor
            entry[drive_of[j], drive_of[j]] = rotor
        a, seat = chain.antecedent[j], frame.seats[j]
        if a < 0:
            continue
        M_a, MS_a, I_a = in_antecedent(frame.R_aj[j], frame.p_aj[j], M[j], MS[j], inertia[j])
        M[a], MS[a], inertia[a] = M[a] + M_a, MS[a] + MS_a, inertia[a] + I_a
        if seat is not None:
            (shapes, turns), own = modal[a]
            shift, tilt = twist_map(seat)
            force = M_a[..., None, None] * shift - skew(MS_a) @ tilt
            moment = skew(MS_a) @ shift + I_a @ tilt
            own = own + transpose(shift) @ force + transpose(tilt) @ moment
            modal[a] = (shapes + force, turns + moment), own
    widths = [1] * n + [chain.modes[j] for j in flexible] + [1] * len(chain.drives)
    rows = range(len(widths))
    every = [[entry.get((i, k), np.zeros((widths[i], widths[k]))) for k in rows] for i in rows]
    return block(every) if every else np.zeros((0, 0))


def modal_columns(chain: Chain, frame: Frames, j: int) -> tuple[Columns, Array]:
    """The wrenches (…, L, 3, N) that accelerations ë of link j alone take, and its modal mass."""
    link, body = chain.links[j], frame.bodies[j]
    assert link is not None, "a rigid link has no modes"
    assert body is not None, "a flexible link has its integrals"
    return (body.S, body.MS_re), link.m_ee


def in_antecedent(R: Array, p: Array, M: Array, MS: Array, inertia: Array) -> tuple[Array, Array, Array]:
    """Mass, first moment and inertia of a body, taken to the frame that sees it at (R, p)."""
    MS_a = mv(R, MS)
    both = outer(p, MS_a) + outer(MS_a, p) + M[..., None, None] * outer(p, p)
    return (
        M,
        MS_a + M[..., None] * p,
        R @ inertia @ transpose(R) + trace(both)[..., None, None] * np.eye(3) - both,
    )
