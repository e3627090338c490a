"""Static equilibrium under gravity: the platform bends until all forces balance."""

import warnings
from collections.abc import Callable

import numpy as np

from parflex.analysis.health import check_health, on_closure, single
from parflex.analysis.leg_sag import sagging
from parflex.analysis.mobility import freed_twist, null_space, show, span
from parflex.base.array import Array, block_diagonal, join, transpose
from parflex.base.check import of_type
from parflex.base.errors import InputError, NotConverged
from parflex.compiled.functions import Functions
from parflex.mechanics import system as assembly
from parflex.mechanics.closure import closure_matrix
from parflex.mechanics.flat_state import projected, state_of
from parflex.mechanics.leg_terms import selection
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.system import System, examined
from parflex.robot.state import State

SETTLED = 1e-13  # of the first bend: a change that is round-off
TOO_SOFT = (
    "no equilibrium was found near the undeformed platform; it is too soft for its "
    "weight at this pose: raise its frequencies or move the pose"
)


def equilibrium(mechanism: Mechanism, place: Callable[[Array], Array]) -> tuple[Array, Array]:
    """The flat state at rest, and the actuator forces (m,) that hold it.

    `place` gives the flat state for a bend q_e (N,). For a given bend, forces and moments balance
    linearly; the bend they cause is iterated on, by Anderson's method and, where that does not settle, by
    Powell's.

    Raises InputError for a mode without stiffness, NotConverged where no forces hold the platform or
    it is too soft for a small deflection.
    """
    modes = mechanism.platform.modes
    if modes and not np.all(mechanism.platform.stiffness > 0):
        raise InputError("a mode has zero frequency; without stiffness there is no equilibrium")

    def bend(q_e: Array) -> tuple[Array, Array]:
        flat = place(q_e)
        system = assembly.assembled(mechanism, flat)
        f, forces = balance(mechanism, system, flat)
        load = system.W_e @ f + mechanism.platform.moments.S.T @ (system.x.rotation.T @ mechanism.gravity)
        return load / mechanism.platform.stiffness, forces

    q_e = fixed_point(lambda q: bend(q)[0], modes) if modes else np.zeros(0)
    found = place(q_e)
    kept = found[mechanism.layout.at.elastic]
    apart = np.max(np.abs(kept - q_e), initial=0.0) > 1e-6 * np.max(np.abs(q_e), initial=0.0)
    if apart and bends(mechanism, found):
        raise NotConverged(TOO_SOFT)
    return found, bend(q_e)[1]


def bends(mechanism: Mechanism, flat: Array) -> bool:
    """True where the legs let the platform bend further; where not, they keep its bend against any load."""
    motions = null_space(closure_matrix(assembly.assembled(mechanism, flat)))
    return bool(np.any(np.abs(motions[mechanism.layout.displacements.elastic]) > 1e-6))


def fixed_point(bend: Callable[[Array], Array], modes: int) -> Array:
    """The bend (N,) that causes itself; raises NotConverged where none is found near zero."""
    from scipy.linalg import LinAlgWarning
    from scipy.optimize import NoConvergence, anderson, root

    none = np.zeros(modes)
    nearly = SETTLED * float(np.max(np.abs(bend(none)), initial=1e-12))

    def excess(q: Array) -> Array:
        return bend(q) - q

    options = {"alpha": 1.0, "w0": 1e-6, "line_search": None, "f_tol": nearly, "maxiter": 40}
    try:
        with warnings.catch_warnings():  # the last steps are round-off, and depend on one another
            warnings.simplefilter("ignore", LinAlgWarning)
            return np.asarray(anderson(excess, none, **options))
    except (NoConvergence, ValueError, np.linalg.LinAlgError, NotConverged):
        found: Array = root(excess, none, options={"xtol": 1e-14}).x
    if not np.all(np.abs(excess(found)) <= 1e-9 * np.max(np.abs(found), initial=1e-12)):
        raise NotConverged(TOO_SOFT)
    return found


def at_rest(functions: Functions, name: str, state: State) -> tuple[Array, Array]:
    """The equilibrium at the pose of a state, as a flat state, and the forces (m,) that hold it.

    Joints that the state names are a start. Raises InputError for a batch, NotConverged where the
    platform is too soft, and as `Model.direct` where the pose is none.
    """
    mechanism = functions.mechanism
    of_type(name, state, State)
    still = State(state.position, state.rotation, joints=state.joints)
    start = single(name, on_closure(mechanism, still))
    check_health(mechanism, examined(mechanism, start)[1])
    if any(mechanism.layout.elastic):
        return sagging(functions, start)

    def held(q_e: Array) -> Array:
        return projected(mechanism, state_of(mechanism, bent(mechanism, start, q_e)))

    return equilibrium(mechanism, held)


def bent(mechanism: Mechanism, x: Array, q_e: Array) -> Array:
    """The flat state with another bend q_e (N,)."""
    other = np.array(x)
    other[mechanism.layout.at.elastic] = q_e
    return other


def balance(mechanism: Mechanism, system: System, flat: Array) -> tuple[Array, Array]:
    """Contact forces (3k,) and Γ (m,) of least norm that hold the robot still.

    Legs: Jᵀ f − S Γ = −c; platform: W_p f = c_r.
    """
    Jt = assembly.diagonal([block_diagonal(transpose(leg.J)) for leg in system.legs])
    selections = [np.stack([selection(leg.group)] * len(leg.group.legs)) for leg in system.legs]
    S = assembly.diagonal([block_diagonal(part) for part in selections])[:, mechanism.force_order]
    c = join([np.zeros(0), *(leg.c.reshape(-1) for leg in system.legs)])
    A = np.block([[Jt, -S], [system.W_p, np.zeros((6, S.shape[1]))]])
    b = np.concatenate([-c, system.platform.c_r])
    solution = np.linalg.lstsq(A, b, rcond=None)[0]
    if not np.allclose(A @ solution, b, rtol=0, atol=1e-9 * max(1.0, np.max(np.abs(b)))):
        raise NotConverged(
            f"no actuator forces hold the platform in this pose; nothing carries its weight along the "
            f"twist (v, ω) = {show(freed_twist(mechanism, flat))}, nearest to a parallel singularity"
        )
    contacts = Jt.shape[1]
    spare = span(null_space(A)[contacts:])
    forces = solution[contacts:] - spare.T @ (spare @ solution[contacts:])
    return np.linalg.lstsq(A[:, :contacts], b - A[:, contacts:] @ forces, rcond=None)[0], forces
