"""Derivatives of the models as functions of flat vectors; matrices by rows.

Small motions of the state are those of `tangent.py`, 12 + 2 N + 2 n of them.
"""

from parflex import assembly, sensitivity
from parflex.array import Array, merged
from parflex.compiled.kernels import Kernel, sizes
from parflex.robot import Robot
from parflex.state import Coordinates
from parflex.wrench import Place, pushed


def direct_jacobian(robot: Robot, places: tuple[Place, ...]) -> Kernel:
    """(x, u, w, pushes) -> ∂(V̇_p, q̈_e)/∂ state, forces, generalised force; health.

    pushes are wrenches (F, N) at places of the platform, side by side.
    """
    n, N, m, _ = sizes(robot)

    def function(x: Array, u: Array, w: Array, pushes: Array) -> tuple[Array, ...]:
        system = assembly.assembled(robot, x)

        def load(c: Coordinates) -> Array:
            return w + pushed(robot.platform, places, pushes, c.rotation, c.elastic)

        found = sensitivity.direct_sensitivity(robot, system, u, load)
        return (*(merged(part) for part in found), assembly.health(system))

    rows, motions = 6 + N, n - 1
    outputs = (rows * motions, rows * m, rows * rows, assembly.health_size(robot))
    return Kernel("direct_jacobian", function, (n, m, 6 + N, 6 * len(places)), outputs, (robot, places))
