"""The robot of the paper's Section 6: six UPS legs that hold a hexagonal plate by its corners."""

from dataclasses import replace
from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.base.check import integer
from parflex.base.errors import InputError
from parflex.base.spatial import rotation_about_z
from parflex.robot.body import FlexibleBody
from parflex.robot.leg import Joint, Leg, Tip
from parflex.robot.modes import Modes
from parflex.robot.robot import Robot
from parflex.robots.entry import Entry
from parflex.robots.rings import ring

# Table 1: sigma, mu, alpha (rad) of joints 1, 2, 3; b = theta = r = 0 and gamma = d = 0 but for
# joint 1, whose gamma_i and d_i place Σ0i and are derived from Table 4 in `base_frames`.
TABLE_1 = (
    (0, 0, -np.pi / 2),
    (0, 0, np.pi / 2),
    (1, 1, np.pi / 2),
)

# Table 2: natural frequencies (rad/s) of modes 7 … 16, by MSC Nastran, and their damping ratio.
TABLE_2 = (
    188.7473,
    188.7475,
    315.7169,
    401.0187,
    474.7468,
    709.5586,
    709.5814,
    828.2868,
    828.3062,
    1310.581,
)
DAMPING_RATIO = 0.4

# Table 3: base inertial parameters of links 1, 2, 3, identical for all legs; about the origins of
# the link frames, SI units. IA of joint 3 is a mass (kg), since the joint slides.
TABLE_3 = {
    "XX": (0, 4.823, 1.068),
    "YY": (0, 0.945, 1.068),
    "ZZ": (5.11, 5.11, 0.0234),
    "XY": (0, 0.215, 0),
    "XZ": (0, 0, 0),
    "YZ": (0, 0, 0),
    "MX": (0, 4.29, 0),
    "MY": (0, -12.628, 0),
    "MZ": (0, 0, -3.018),
    "M": (3.176, 30.176, 5.390),
    "IA": (0, 0, 45.89),
}

# Table 4: base points b_i (m, z = 0) and initial joint values q_1 (rad), q_2 (rad), q_3 (m).
TABLE_4 = {
    "b_x": (0.1, 0.3, 1.3, 1.0, -0.2, -0.7),
    "b_y": (-0.2, -0.2, 0.4, 1.0, 0.9, 0.5),
    "q_1": (-1.671, -1.373, -2.016, -1.958, -1.656, -1.936),
    "q_2": (1.767, 1.764, 1.814, 1.859, 1.389, 1.345),
    "q_3": (1.025, 1.039, 1.142, 1.126, 1.0203, 1.099),
}

# Sec. 6.1: a regular hexagon in a circle of 0.5 m. Poisson's ratio is not printed; 0.3 reproduces
# the first seven elastic modes of Table 2 within 1.5 %.
SIDE = 0.5
PLATE: dict[str, Any] = {"thickness": 15e-3, "young": 2e10, "poisson": 0.3, "density": 7.5e3}

HOME = (0.25, 0.25 * np.sqrt(3.0), 1.0)

SOURCE = "the paper, Tables 1 to 4"

OUTPUT = (0, 1, 2, 3, 4, 5)
# The paper prints no motion. In mixed directions, so that every actuator and every mode has work to do.
MOVES = (
    ((0.10, -0.08, 0.06), (0.10, 0.05, -0.08)),
    ((-0.10, 0.10, 0.08), (-0.10, 0.10, 0.10)),
    ((0.08, 0.10, -0.10), (0.08, -0.10, 0.10)),
)


def corners() -> Array:
    """p_1 … p_6 (6, 2) m in Σp, at −120°, −60°, 0°, 60°, 120°, 180°."""
    return ring(SIDE, range(-120, 181, 60))


def base_frames() -> list[tuple[Array, Array]]:
    """Axes and origin of Σ0i: at b_i, turned about z by γ_i, the direction of b_i − b_1.

    This is the convention of the paper's reference [23] (Khalil and Guegan 2004); γ_1 = γ_2 = 0.
    """
    b = np.stack([TABLE_4["b_x"], TABLE_4["b_y"], np.zeros(6)], axis=-1)
    along = b - b[0]
    gamma = np.arctan2(along[:, 1], along[:, 0])
    return [(rotation_about_z(angle), origin) for angle, origin in zip(gamma, b, strict=True)]


def links() -> tuple[Joint, ...]:
    """The three rows of Tables 1 and 3."""
    t = TABLE_3
    joints = []
    for j, (sigma, mu, alpha) in enumerate(TABLE_1):
        inertia = [
            [t["XX"][j], t["XY"][j], t["XZ"][j]],
            [t["XY"][j], t["YY"][j], t["YZ"][j]],
            [t["XZ"][j], t["YZ"][j], t["ZZ"][j]],
        ]
        MS = (t["MX"][j], t["MY"][j], t["MZ"][j])
        joints.append(Joint(j, sigma, mu, alpha=alpha, M=t["M"][j], MS=MS, I=inertia, IA=t["IA"][j]))
    return tuple(joints)


def plate(modes: int, frequencies: str = "converged") -> Modes:
    """The first modes of the free hexagonal plate, with computed or published frequencies.

    Raises InputError for a negative number of modes or an unknown choice of frequencies.
    """
    from parflex.fe import plate_modes

    check_choice(modes, frequencies)
    computed = plate_modes(corners(), n_modes=modes, **PLATE)
    if frequencies == "published":
        computed = replace(computed, frequencies=np.array(TABLE_2[:modes]))
    return computed


def check_choice(modes: int, frequencies: str) -> None:
    """Raise InputError for a number of modes or a choice of frequencies that there is not."""
    if frequencies not in ("converged", "published"):
        raise InputError(f'frequencies is {frequencies!r}; choose "converged" or "published"')
    integer("modes", modes)
    if frequencies == "published" and modes > len(TABLE_2):
        raise InputError(
            f'modes is {modes}, but frequencies="published" has the {len(TABLE_2)} of Table 2; '
            f'ask for at most {len(TABLE_2)}, or use frequencies="converged"'
        )


def held(modes: Modes, damping_ratio: float = DAMPING_RATIO) -> FlexibleBody:
    """The plate as the robot's platform: held at its corners, Σp at its centre."""
    return FlexibleBody.from_modes(modes, origin=(0.0, 0.0, 0.0), damping_ratio=damping_ratio)


def gough_stewart(
    modes: int = 10,
    *,
    platform: FlexibleBody | None = None,
    frequencies: str = "converged",
    damping_ratio: float = DAMPING_RATIO,
) -> Robot:
    """The Gough–Stewart robot of the paper's Section 6.

    modes is the number of elastic modes of the plate, 0 for a rigid one; the default, the paper's
    ten, cuts a degenerate pair in two and warns of it. frequencies is "converged" (computed) or
    "published" (ω_1 … ω_10 of Table 2 with the computed shapes). A platform of your own replaces
    the plate; it needs six attachments.

    Raises InputError for a negative number of modes or an unknown choice of frequencies.
    """
    check_choice(modes, frequencies)
    body = held(plate(modes, frequencies), damping_ratio) if platform is None else platform
    legs = tuple(
        Leg(rotation, origin, links(), (Tip(3, attachment=i),))
        for i, (rotation, origin) in enumerate(base_frames())
    )
    return Robot(legs, body, home_pose=(HOME, np.eye(3)))


ENTRY = Entry("Gough-Stewart", gough_stewart, OUTPUT, MOVES, SOURCE)
