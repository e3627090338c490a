"""The models as functions of flat vectors: what every backend runs.

A state is x (layout.size), forces u (m), external generalised forces w (6 + N). Every kernel that
assembles legs ends with their `health`, from which the doors tell a state that is none.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from parflex import assembly, chain, contact, dynamics
from parflex.array import Array, cross, dot, join, merged, mv, stack
from parflex.closure import flat_state
from parflex.output import Output
from parflex.robot import Robot
from parflex.spatial import quaternion_rate


@dataclass(frozen=True)
class Kernel:
    """A function of flat vectors (…, n_i), with the sizes of its inputs and outputs.

    It is determined by its name and its subject, a robot and what else was chosen; the first input
    is a flat state of the robot.
    """

    name: str
    function: Callable[..., tuple[Array, ...]]
    inputs: tuple[int, ...]
    outputs: tuple[int, ...]
    subject: tuple[Any, ...]

    def probe(self, count: int) -> list[Array]:
        """Inputs (count, n_i) near home, in motion, to try an implementation on."""
        rng, robot = np.random.default_rng(0), self.subject[0]
        home = flat_state(robot, robot.home)
        x = home + np.where(np.arange(len(home)) < 7, 0.0, 1e-3) * rng.normal(size=(count, len(home)))
        return [x, *(rng.normal(size=(count, n)) for n in self.inputs[1:])]


def direct(robot: Robot) -> Kernel:
    """(x, u, w) -> V̇_p, q̈_e, contact forces by tip, health."""
    n, N, m, k = sizes(robot)

    def function(x: Array, u: Array, w: Array) -> tuple[Array, ...]:
        system = assembly.assembled(robot, x)
        return (*dynamics.direct_of(robot, system, u, w), assembly.health(system))

    return Kernel("direct", function, (n, m, 6 + N), (6, N, k, assembly.health_size(robot)), (robot,))


def inverse(robot: Robot, output: Output) -> Kernel:
    """(x, target, w, preload) -> Γ, V̇_p, q̈_e, contact forces by tip, gain (by rows), health."""
    n, N, m, k = sizes(robot)

    def function(x: Array, target: Array, w: Array, preload: Array) -> tuple[Array, ...]:
        system = assembly.assembled(robot, x)
        found = dynamics.inverse_of(robot, system, target, w, output, preload)
        return (found.forces, *found.acceleration, merged(found.gain), assembly.health(system))

    return Kernel(
        "inverse",
        function,
        (n, output.size, 6 + N, m),
        (m, 6, N, k, output.size * m, assembly.health_size(robot)),
        (robot, output),
    )


def gains(robot: Robot, output: Output) -> Kernel:
    """x -> ∂output/∂Γ by rows, as it is and as it were for a platform that does not bend."""
    n, _, m, _ = sizes(robot)

    def function(x: Array) -> tuple[Array, ...]:
        flexible, rigid = dynamics.gains(robot, assembly.assembled(robot, x), output)
        return merged(flexible), merged(rigid)

    return Kernel("gains", function, (n,), (output.size * m, output.size * m), (robot, output))


def contact_matrix(robot: Robot) -> Kernel:
    """x -> the contact system's matrix, its independent rows: definite where the legs do not lock."""
    n, N, _, _ = sizes(robot)
    kept = robot.rows.kept

    def function(x: Array) -> tuple[Array, ...]:
        C = contact.contact_system(robot, assembly.assembled(robot, x), np.zeros(6 + N)).C
        return (merged(C[..., kept, :][..., kept]),)

    return Kernel("contact_matrix", function, (n,), (len(kept) ** 2,), (robot,))


def derivative(robot: Robot) -> Kernel:
    """(x, u, w) -> ẋ, powers, health, as in `motion_of`."""
    n, N, m, _ = sizes(robot)

    def function(x: Array, u: Array, w: Array) -> tuple[Array, ...]:
        system = assembly.assembled(robot, x)
        moved, powers = motion_of(robot, system, x, u, w, dynamics.direct_of(robot, system, u, w))
        return moved, powers, assembly.health(system)

    return Kernel("derivative", function, (n, m, 6 + N), (n, 3, assembly.health_size(robot)), (robot,))


def motion_of(
    robot: Robot, system: assembly.System, x: Array, u: Array, w: Array, found: dynamics.Acceleration
) -> tuple[Array, Array]:
    """ẋ of what the direct model found, and the powers of actuators, wrenches and damping (a loss)."""
    c = system.x
    v_p, omega = c.twist[..., :3], c.twist[..., 3:]
    rate = found.platform - join([cross(omega, v_p), np.zeros(3)])
    lost = dot(c.elastic_rate, robot.platform.damping * c.elastic_rate)
    for leg in system.legs:
        lost = lost + np.sum(dot(leg.qd, chain.friction(leg.group.chain, leg.qd)), axis=-1)
    powers = [
        dot(u, assembly.joint_rates(robot, system)),
        dot(w[..., :6], c.twist) + dot(w[..., 6:], c.elastic_rate),
        lost,
    ]
    turn = quaternion_rate(x[..., 3:7], omega)
    carried = [c.qd, assembly.carried_accelerations(robot, system, u, found.contact)]
    moved = join([mv(c.rotation, v_p), turn, rate, c.elastic_rate, found.elastic, *carried])
    return moved, join([power[..., None] for power in powers])


def projection(robot: Robot) -> Kernel:
    """x -> x nearer to the closure, in the metric of the robot's mass, and the health of x.

    One step of Newton's method for the gaps, and one for their rates: M⁻¹ Gᵀ C⁻¹ gap.
    """
    n, N, _, _ = sizes(robot)

    def function(x: Array) -> tuple[Array, ...]:
        system = assembly.assembled(robot, x)
        held = contact.contact_system(robot, system, np.zeros(6 + N))
        gap = join([np.zeros(0), *(merged(leg.gap) for leg in system.legs)])
        gap_rate = join([np.zeros(0), *(merged(leg.gap_rate) for leg in system.legs)])
        pulls = contact.contact_forces(robot, held.C, stack([gap, gap_rate]))
        (pose, bend), c = dynamics.acceleration_map(robot.platform, system, held, pulls), system.x
        q, qd = (assembly.carried_pull(robot, system, pulls[..., i]) for i in (0, 1))
        turned = x[..., 3:7] + quaternion_rate(x[..., 3:7], pose[..., 3:, 0])
        turned = turned / np.sqrt(dot(turned, turned))[..., None]
        place = c.position + mv(c.rotation, pose[..., :3, 0])
        rates = [c.elastic_rate + bend[..., 1], c.q - q, c.qd - qd]
        moved = [place, turned, c.twist + pose[..., 1], c.elastic + bend[..., 0], *rates]
        return join(moved), assembly.health(system)

    return Kernel("projection", function, (n,), (n, assembly.health_size(robot)), (robot,))


def actuators(robot: Robot) -> Kernel:
    """x -> q_a and q̇_a, positions and rates of the actuated joints."""
    n, _, m, _ = sizes(robot)

    def function(x: Array) -> tuple[Array, ...]:
        system = assembly.assembled(robot, x)
        return assembly.actuated_positions(robot, system), assembly.joint_rates(robot, system)

    return Kernel("actuators", function, (n,), (m, m), (robot,))


def sizes(robot: Robot) -> tuple[int, int, int, int]:
    """Lengths of the flat state, the elastic coordinates, the forces and the contact forces."""
    return robot.layout.size, robot.platform.modes, robot.n_forces, 3 * len(robot.tip_attachments)
