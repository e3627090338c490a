"""A hexapod from what its builder knows: radii, a height, the spread of its pairs of joints, and a strut."""

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import of_type
from parflex.base.errors import InputError
from parflex.base.kinds import LENGTH
from parflex.base.plausible import derived, doubt
from parflex.base.spatial import rotation_about_z
from parflex.robot.bar import Bar
from parflex.robot.body import FlexibleBody
from parflex.robot.leg import Leg
from parflex.robot.materials import named
from parflex.robot.payload import Payload
from parflex.robot.robot import Robot
from parflex.robot.strut import Strut
from parflex.robot.words import listed
from parflex.robots.hexapod_geometry import HexapodGeometry, nearest_pair
from parflex.robots.legs import UPS
from parflex.robots.links import tube

NEAR = 0.02  # of the platform's radius: within it an attachment is the joint
TOUCH = 1e-6  # of a strut's length: axes that are nearer cross
STANDARD_GRAVITY = (0.0, 0.0, -9.81)


def hexapod(
    *,
    base_radius: float,
    platform_radius: float,
    height: float,
    base_spread: float,
    platform_spread: float,
    strut: Strut | None = None,
    platform: FlexibleBody | None = None,
    payload: Payload | None = None,
    base_offset: float = 0.0,
    platform_offset: float = 0.0,
) -> Robot:
    """A hexapod: six struts on universal joints, in pairs on two circles (`HexapodGeometry`); m and rad.

    Without `strut` each is an aluminium cylinder and a steel rod in proportion to its length; without
    `platform` it is a rigid aluminium disc. A platform of your own has an attachment at each joint, in any
    order, within a fiftieth of the radius; its frame is Σp.

    Raises InputError for joints that coincide or leave the platform a motion, struts that touch, a stroke
    that the length at home is not in, and a platform that has no attachment at a joint.

    >>> from math import radians
    >>> sizes = dict(base_radius=0.25, platform_radius=0.15, height=0.3)
    >>> robot = hexapod(**sizes, base_spread=radians(20), platform_spread=radians(20), payload=Payload(5))
    >>> robot.n_forces, robot.home_pose[0].tolist()
    (6, [0.0, 0.0, 0.3])
    """
    geometry = HexapodGeometry(
        base_radius=base_radius,
        platform_radius=platform_radius,
        height=height,
        base_spread=base_spread,
        platform_spread=platform_spread,
        base_offset=base_offset,
        platform_offset=platform_offset,
    )
    body = disc(geometry) if platform is None else of_type("platform", platform, FlexibleBody)
    if payload is not None:
        body = of_type("payload", payload, Payload).on(body)
    return assembled(geometry, strut, body)


def assembled(
    geometry: HexapodGeometry,
    strut: Strut | None,
    body: FlexibleBody,
    gravity: ArrayLike = STANDARD_GRAVITY,
) -> Robot:
    """The hexapod of a geometry, with these struts under this body; raises InputError as `hexapod`."""
    held = attachments_at(body, geometry.platform_joints, geometry.platform_radius)
    feet, heads = geometry.base_joints, geometry.home + body.attachment_points[held]
    lengths = np.linalg.norm(heads - feet, axis=1)
    if np.allclose(lengths, geometry.length, rtol=1e-12, atol=0):
        lengths = np.full(6, geometry.length)  # one number, so that the legs are alike to the bit
    if strut is not None:
        check_strut(of_type("strut", strut, Strut), lengths)
        check_apart(strut, feet, heads)
    with derived():
        used = usual_strut(geometry.length) if strut is None else strut
        legs = [
            leg(used, float(length), foot, head, number)
            for length, foot, head, number in zip(lengths, feet, heads, held, strict=True)
        ]
    return Robot(legs, body, gravity, (geometry.home, np.eye(3)))


def leg(strut: Strut, length: float, foot: Array, head: Array, attachment: int) -> Leg:
    """A strut from foot to head (3,) m; Σ0i stands at the foot, z up and x below the strut at home, so that
    the universal joint's axis on the base, its y, lies across the strut."""
    below = (head - foot)[:2] if np.linalg.norm((head - foot)[:2]) > 1e-9 * length else foot[:2]
    turn = rotation_about_z(np.asarray(np.arctan2(below[1], below[0])))
    rest = length if strut.rest is None else strut.rest
    return UPS(**vars(strut) | {"rest": rest if strut.stiffness else 0.0}).placed(turn, foot, (attachment,))


def disc(geometry: HexapodGeometry) -> FlexibleBody:
    """A rigid aluminium disc about Σp, an eighth of the joints' radius thick, and so far beyond them."""
    thick = geometry.platform_radius / 8
    radius = geometry.platform_radius + thick
    link = tube(named("aluminium").density, radius, (0, 0, -thick / 2), (0, 0, thick / 2))
    with derived():
        return FlexibleBody.rigid(link["M"], (0, 0, 0), link["I"], geometry.platform_joints)


def usual_strut(length: float) -> Strut:
    """An aluminium cylinder, a tenth of the strut's length thick, and a steel rod."""
    cylinder = Bar(
        outer=length / 10, inner=length / 12.5, length=0.6 * length, density=named("aluminium").density
    )
    return Strut(cylinder, Bar(outer=length / 25, length=0.6 * length, density=named("steel").density))


def attachments_at(body: FlexibleBody, joints: Array, radius: float) -> list[int]:
    """The attachment at each of the joints (6, 3) m of Σp, each held once; raises InputError where a body has
    none."""
    points = body.attachment_points
    if len(points) < 6:
        raise InputError(
            f"platform has {len(points)} attachments; a hexapod holds six, one at each joint: where two "
            f"joints coincide, list the node twice among the body's attachments"
        )
    found: list[int] = []
    for number, joint in enumerate(joints):
        distance = np.linalg.norm(points - joint, axis=1)
        distance[found] = np.inf
        nearest = int(np.argmin(distance))
        if distance[nearest] > NEAR * radius:
            lift = points[nearest][2] - joint[2]
            level = abs(abs(lift) - distance[nearest]) < NEAR * radius
            remedy = f"give platform_offset = {points[nearest][2]:.4g}" if level else "move one of them"
            raise InputError(
                f"platform has no attachment at the joint of leg {number + 1}, {listed(joint)} m; the "
                f"nearest that no leg holds, {nearest}, is {distance[nearest]:.4g} m away at "
                f"{listed(points[nearest])} m; {remedy}"
            )
        found.append(nearest)
    return found


def check_strut(strut: Strut, lengths: Array) -> None:
    """Raise InputError where a length (6,) m at home is beyond the stroke; doubt bars out of proportion."""
    if strut.stroke is not None:
        low, high = np.asarray(strut.stroke)
        worst = float(lengths[np.argmax(np.maximum(low - lengths, lengths - high))])
        if not low <= worst <= high:
            raise InputError(
                f"strut.stroke is {low:.4g} … {high:.4g} m, but at home a strut is {worst:.4g} m long "
                f"between its joints; give limits on both sides of that, or another height"
            )
    for name, bar in (("cylinder", strut.cylinder), ("rod", strut.rod)):
        for size, value in (("length", bar.length), ("outer", bar.outer), ("com", bar.com)):
            if value is not None and 2 * np.max(lengths) < abs(value) <= LENGTH.most:
                doubt(
                    f"strut.{name}.{size} is {value:.4g} m, of a strut that is {np.max(lengths):.4g} m long "
                    f'at home; if it is in mm, give {value / 1000:.4g} m, in files "{value:.4g} mm"'
                )


def check_apart(strut: Strut, feet: Array, heads: Array) -> None:
    """Raise InputError where struts with feet and heads (6, 3) m run through each other at home; two that
    share a joint meet there."""
    thick = min(strut.cylinder.diameters[0], strut.rod.diameters[0])
    distance, i, j = nearest_pair(feet, heads)
    if distance < max(thick, TOUCH * np.max(np.abs(heads - feet))):
        raise InputError(
            f"strut: at home the axes of legs {i + 1} and {j + 1} pass within {1000 * distance:.3g} mm of "
            f"each other, and the struts are {1000 * thick:.3g} mm thick; give larger radii, other spreads, "
            f"or thinner struts"
        )
