"""Static equilibrium under gravity: the platform bends until all forces balance."""

from collections.abc import Callable

import numpy as np

from parflex.analysis.mobility import freed_twist, null_space, show, span
from parflex.base.array import Array, block_diagonal, join, transpose
from parflex.base.errors import InputError, NotConverged
from parflex.mechanics import system as assembly
from parflex.mechanics.system import System
from parflex.robot.robot import Robot


def equilibrium(robot: Robot, place: Callable[[Array], Array]) -> tuple[Array, Array]:
    """The flat state at rest, and the actuator forces (m,) that hold it.

    `place` gives the flat state for a bend q_e (N,). For a given bend, forces and moments balance
    linearly; the bend they cause is iterated on.

    Raises InputError for a mode without stiffness, NotConverged where no forces hold the platform or
    it is too soft for a small deflection.
    """
    from scipy.optimize import root

    modes = robot.platform.modes
    if modes and not np.all(robot.platform.stiffness > 0):
        raise InputError("a mode has zero frequency; without stiffness there is no equilibrium")

    def bend(q_e: Array) -> tuple[Array, Array]:
        flat = place(q_e)
        system = assembly.assembled(robot, flat)
        f, forces = balance(robot, system, flat)
        load = system.W_e @ f + robot.platform.tables.S.T @ (system.x.rotation.T @ robot.gravity)
        return load / robot.platform.stiffness, forces

    q_e = np.zeros(modes)
    if modes:
        found = root(lambda q: bend(q)[0] - q, q_e, options={"xtol": 1e-14})
        q_e = found.x
        scale = np.max(np.abs(q_e), initial=1e-12)
        if not np.all(np.abs(bend(q_e)[0] - q_e) <= 1e-9 * scale):
            raise NotConverged(
                "no equilibrium was found near the undeformed platform; it is too soft for its "
                "weight at this pose: raise its frequencies or move the pose"
            )
    return place(q_e), bend(q_e)[1]


def balance(robot: Robot, system: System, flat: Array) -> tuple[Array, Array]:
    """Contact forces (3k,) and Γ (m,) of least norm that hold the robot still.

    Legs: Jᵀ f − S Γ = −c; platform: W_p f = c_r.
    """
    Jt = assembly.diagonal([block_diagonal(transpose(leg.J)) for leg in system.legs])
    selections = [np.stack([assembly.selection(leg.group)] * len(leg.group.legs)) for leg in system.legs]
    S = assembly.diagonal([block_diagonal(part) for part in selections])[:, robot.force_order]
    c = join([np.zeros(0), *(leg.c.reshape(-1) for leg in system.legs)])
    A = np.block([[Jt, -S], [system.W_p, np.zeros((6, S.shape[1]))]])
    b = np.concatenate([-c, system.platform.c_r])
    solution = np.linalg.lstsq(A, b, rcond=None)[0]
    if not np.allclose(A @ solution, b, rtol=0, atol=1e-9 * max(1.0, np.max(np.abs(b)))):
        raise NotConverged(
            f"no actuator forces hold the platform in this pose; nothing carries its weight along the "
            f"twist (v, ω) = {show(freed_twist(robot, flat))}, nearest to a parallel singularity"
        )
    contacts = Jt.shape[1]
    spare = span(null_space(A)[contacts:])
    forces = solution[contacts:] - spare.T @ (spare @ solution[contacts:])
    return np.linalg.lstsq(A[:, :contacts], b - A[:, contacts:] @ forces, rcond=None)[0], forces
