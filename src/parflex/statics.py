"""Static equilibrium under gravity: the platform bends until all forces balance."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import root

from parflex import assembly
from parflex.array import Array, block_diagonal, join, transpose
from parflex.errors import InputError, NotConverged
from parflex.state import State, coordinates, pack

if TYPE_CHECKING:
    from parflex.model import Model


def equilibrium(model: "Model", pose: State) -> tuple[State, Array]:
    """The state at rest in a pose (single), and the actuator forces (m,) that hold it.

    For a given bend, forces and moments balance linearly; the bend they cause is iterated on.
    """
    robot, modes = model.robot, model.robot.platform.modes
    if pose.batch:
        raise InputError(f"position and rotation are a batch {pose.batch}; give one pose")
    if modes and not np.all(robot.platform.stiffness > 0):
        raise InputError("a mode has zero frequency; without stiffness there is no equilibrium")

    def bend(q_e: Array) -> tuple[Array, Array]:
        x = coordinates(pack(replace(pose, elastic=q_e), modes), modes)
        system = assembly.assemble(robot, x)
        f, forces = balance(model, system)
        load = system.W_e @ f + robot.platform.tables.S.T @ (x.rotation.T @ robot.gravity)
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
    state = State(pose.position, pose.rotation, np.zeros(6), q_e, np.zeros(modes))
    return state, bend(q_e)[1]


def balance(model: "Model", system: assembly.System) -> tuple[Array, Array]:
    """Contact forces (3k,) and Γ (m,) of least norm that hold the robot still.

    Legs: Jᵀ f − S Γ = −c; platform: W_p f = c_r.
    """
    robot = model.robot
    Jt = assembly.diagonal([block_diagonal(transpose(leg.J)) for leg in system.legs])
    S = assembly.diagonal(
        [
            block_diagonal(np.stack([assembly.selection(leg.group)] * len(leg.group.legs)))
            for leg in system.legs
        ]
    )[:, robot.force_order]
    c = join([np.zeros(0), *(leg.c.reshape(-1) for leg in system.legs)])
    A = np.block([[Jt, -S], [system.W_p, np.zeros((6, S.shape[1]))]])
    b = np.concatenate([-c, system.platform.c_r])
    solution = np.linalg.lstsq(A, b, rcond=None)[0]
    if not np.allclose(A @ solution, b, rtol=0, atol=1e-9 * max(1.0, np.max(np.abs(b)))):
        raise NotConverged("no actuator forces hold the platform in this pose; it is not in balance")
    return solution[: Jt.shape[1]], solution[Jt.shape[1] :]
