"""The places of a hexapod's joints from two radii, a height and the spread of its pairs."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from parflex.base import kinds
from parflex.base.array import Array
from parflex.base.check import NOT_NEGATIVE, POSITIVE
from parflex.base.errors import InputError
from parflex.base.plausible import doubt
from parflex.robot.fields import check_fields, given
from parflex.robots.rings import THIRDS, ring

APART = 30.0  # times: radii and height that differ by more are hardly meant in one unit
SINGULAR, POOR = 1e-4, 0.02  # smallest over largest singular value of the struts' lines
ALIGNED = 15.0  # degrees from 120, within which the spreads are why
SHARED = 1e-9  # of a strut's length: joints that are nearer are one


@dataclass(frozen=True, eq=False, kw_only=True)
class HexapodGeometry:
    """Joints in pairs on two circles: of the base at 0, 120, 240°, of the platform at 60, 180, 300°; m, rad.

    `base_spread` and `platform_spread` are the angles between the joints of a pair, `height` is that of the
    platform's plane of joints over the base's at home. The base's joints are at z = `base_offset` in Σ0, the
    platform's at z = `platform_offset` in Σp. Leg 1 begins at the first joint of the base's pair at 0°, and
    on they go counter-clockwise, each to the nearest joint of the platform, so that none crosses another.

    Raises InputError for lengths that are not positive, joints that coincide, and joints whose struts leave
    the platform a motion.
    """

    base_radius: float = given(kinds.LENGTH, "the radius of the base's circle of joints", POSITIVE)
    platform_radius: float = given(kinds.LENGTH, "the radius of the platform's circle of joints", POSITIVE)
    height: float = given(
        kinds.LENGTH, "the height of the platform's joints over the base's, at home", POSITIVE
    )
    base_spread: float = given(kinds.ANGLE, "the angle between the base's joints of a pair", NOT_NEGATIVE)
    platform_spread: float = given(
        kinds.ANGLE, "the angle between the platform's joints of a pair", NOT_NEGATIVE
    )
    base_offset: float = given(
        kinds.LENGTH, "height of the base's joints over the world's origin", default=0.0
    )
    platform_offset: float = given(
        kinds.LENGTH, "height of the platform's joints over the origin of its frame", default=0.0
    )

    def __post_init__(self) -> None:
        check_fields(self)
        for name in ("base_spread", "platform_spread"):
            value = float(getattr(self, name))
            angle = np.degrees(value)
            if angle > 120 - 1e-6:
                slip = f'; did you mean "{value:.6g} deg"?' if value == round(value, 6) else ""
                raise InputError(
                    f"{name} is {angle:.4g} deg, so that joints of neighbouring pairs coincide or change "
                    f"places; give less than 120 deg{slip}"
                )
        self._check_proportions()
        self._check_stiffness()

    @property
    def base_joints(self) -> Array:
        """The centres (6, 3) m of the base's joints in Σ0, by leg."""
        half = np.degrees(self.base_spread) / 2
        angles = [pair + side * half for pair in THIRDS for side in (-1, 1)]
        return at_height(ring(self.base_radius, angles), self.base_offset)

    @property
    def platform_joints(self) -> Array:
        """The centres (6, 3) m of the platform's joints in Σp, by leg."""
        turn = 60 - np.degrees(self.platform_spread) / 2
        angles = [pair + side * turn for pair in THIRDS for side in (-1, 1)]
        return at_height(ring(self.platform_radius, angles), self.platform_offset)

    @property
    def home(self) -> Array:
        """The origin (3,) m of Σp at home."""
        return np.array([0.0, 0.0, self.base_offset + self.height - self.platform_offset])

    @property
    def length(self) -> float:
        """The length of a strut at home, m: ℓ² = h² + r_b² + r_p² − 2 r_b r_p cos δ."""
        a, b = self.base_radius, self.platform_radius
        aside = np.cos(np.pi / 3 - (self.base_spread + self.platform_spread) / 2)
        return float(np.sqrt(self.height**2 + a * a + b * b - 2 * a * b * aside))

    def _check_proportions(self) -> None:
        """Doubt radii and a height that are hardly in one unit."""
        names = ("base_radius", "platform_radius", "height")
        sizes = sorted((getattr(self, name), name) for name in names)
        (small, less), (large, more) = sizes[0], sizes[-1]
        if APART * small < large <= kinds.LENGTH.most:
            doubt(
                f"{more} is {large:.4g} m and {less} {small:.4g} m, {large / small:.0f} times less; give "
                f'both in the same unit, in files with it: "{1000 * small:.4g} mm"'
            )

    def _check_stiffness(self) -> None:
        """Raise InputError where the struts leave the platform a motion at home; doubt nearly such ones."""
        feet = self.base_joints
        along = (self.platform_joints + self.home - feet) / self.length
        arms = self.platform_joints - [0.0, 0.0, self.platform_offset]
        values = np.linalg.svd(np.hstack([along, np.cross(arms, along) / self.platform_radius]))[1]
        weakest = values[-1] / values[0]
        total = np.degrees(self.base_spread + self.platform_spread)
        if abs(total - 120) < ALIGNED and weakest < POOR:
            words = (
                f"base_spread and platform_spread are {total:.4g} deg together; at 120 deg all struts meet "
                f"the hexapod's axis, and nothing keeps the platform from turning about it: make one smaller"
            )
            if weakest < SINGULAR:
                raise InputError(words)
            doubt(words)
        elif weakest < SINGULAR:
            raise InputError(
                f"base_radius, platform_radius and height are {self.base_radius:.4g}, "
                f"{self.platform_radius:.4g} and {self.height:.4g} m: the struts nearly meet in a point, are "
                f"parallel or flat, and leave the platform a motion; bring the three nearer together"
            )


def at_height(points: Array, z: float) -> Array:
    """Points (n, 2) m as (n, 3)."""
    return np.pad(points, ((0, 0), (0, 1)), constant_values=z)


def nearest_pair(starts: Array, ends: Array) -> tuple[float, int, int]:
    """The least distance (m) between two of the segments from starts (n, 3) to ends (n, 3) that share no end,
    and which they are."""
    size = np.max(np.abs(ends - starts))
    pairs = [
        (i, j)
        for i, j in combinations(range(len(starts)), 2)
        if np.linalg.norm(starts[i] - starts[j]) > SHARED * size
        and np.linalg.norm(ends[i] - ends[j]) > SHARED * size
    ]
    return min((between(starts[i], ends[i], starts[j], ends[j]), i, j) for i, j in pairs)


def between(a: Array, b: Array, c: Array, d: Array) -> float:
    """The distance of the segments a–b and c–d: of the lines where they pass each other, else of an end."""
    u, v, w = b - a, d - c, a - c
    gram = np.array([[u @ u, -u @ v], [-u @ v, v @ v]])
    inside = np.linalg.lstsq(gram, np.array([-u @ w, v @ w]), rcond=1e-12)[0]
    if np.all((inside >= 0) & (inside <= 1)):
        return float(np.linalg.norm(w + inside[0] * u - inside[1] * v))
    return min(to_segment(a, c, d), to_segment(b, c, d), to_segment(c, a, b), to_segment(d, a, b))


def to_segment(point: Array, start: Array, end: Array) -> float:
    """The distance of a point from a segment."""
    along = end - start
    share = np.clip((point - start) @ along / (along @ along), 0.0, 1.0)
    return float(np.linalg.norm(point - start - share * along))
