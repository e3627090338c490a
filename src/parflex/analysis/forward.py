"""Forward geometry: the poses to which given actuated joints lead."""

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import NotConverged
from parflex.base.progress import Progress
from parflex.base.spatial import within_half_a_turn
from parflex.mechanics.closure import CLOSED, POSE, displaced, posed, size_of, units
from parflex.robot.layout import coordinates
from parflex.robot.robot import Robot

CLOSE_ENOUGH = 1e3 * CLOSED  # of the platform's size
SAME = 1e-6  # of the platform's size and a radian: poses that are one
SPREAD = (3.0, np.pi)  # random starts: of the platform's size, rad


def pose(robot: Robot, wanted: Array, start: Array) -> Array:
    """The flat state whose actuated joints are as wanted (m,), from a flat state near it."""
    found, gap = posed(robot, start, wanted)
    if not gap <= CLOSE_ENOUGH * max(1.0, size_of(robot)):
        raise NotConverged(
            f"no pose with these actuated joints was found from the guess, a gap of {gap:.2g} m or rad "
            f"remains; give a guess nearer to it, or look for all poses with model.forward_all"
        )
    return found


def every_pose(robot: Robot, wanted: Array, start: Array, starts: int, seed: int) -> list[Array]:
    """All poses found from random starts about a flat state, the nearest to it first."""
    rng, found = np.random.default_rng(seed), [np.empty((0, len(start)))]
    size = size_of(robot)
    spread = units(robot, POSE) * np.concatenate(
        [np.full(3, SPREAD[0] * size), np.full(len(units(robot, POSE)) - 3, SPREAD[1] * size)]
    )
    with Progress("poses", starts) as bar:
        for done in range(starts):
            step = spread * rng.uniform(-1, 1, len(spread)) * (done > 0)
            x, gap = posed(robot, displaced(robot, start, step), wanted)
            if gap <= CLOSE_ENOUGH * max(1.0, size) and not any(same(robot, x, y) for y in found[1:]):
                found.append(x)
            bar.to(done + 1)
    return sorted(found[1:], key=lambda x: distance(x, start, size))


def same(robot: Robot, a: Array, b: Array) -> bool:
    """Whether two flat states are one pose, with the same joints but for full turns."""
    slides = [
        j.sigma for leg, n in zip(robot.legs, robot.layout.joints, strict=True) if n for j in leg.joints
    ]
    apart = coordinates(a, robot.layout).q - coordinates(b, robot.layout).q
    apart = np.where(np.array(slides, dtype=bool), apart, within_half_a_turn(apart))
    size = size_of(robot)
    return max(distance(a, b, size), np.max(np.abs(apart), initial=0.0)) < SAME * max(1.0, size)


def distance(a: Array, b: Array, size: float) -> float:
    """Between two poses, m, with the angle on the platform's size."""
    angle = 2 * np.arccos(np.minimum(1.0, np.abs(np.dot(a[3:7], b[3:7]))))
    return float(np.linalg.norm(a[:3] - b[:3]) + size * angle)
