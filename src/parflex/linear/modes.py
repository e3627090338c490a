"""The modes of a linear system: frequencies, damping, shapes, and where their energy is."""

from typing import Any

import numpy as np

from parflex.analysis.statics import firmness
from parflex.base.array import Array
from parflex.linear.matrices import Matrices
from parflex.linear.point import Point
from parflex.linear.signal import AXES
from parflex.mechanics.closure import actuated_rows

SAME = 1e-9  # of poles that differ by round-off
HELD = 1e-6  # of the energies of the parts: the sum of a motion that springs hold
PARTS = ("platform", "legs", "drives", "other")


def modes_of(lin: Matrices) -> Any:
    """The modes as a Dataset, the lowest first: of each pair of conjugate poles one, and each real pole.

    frequency (mode) Hz is |λ| / 2π, damping −Re λ / |λ|, growth Re λ 1/s; pole_real and pole_imag (mode) 1/s
    are λ; share (mode, part) of the energy of deformation in the platform, the links of legs, the drives
    (their compliance in series, springs beside motors, servos), and all else (flexures, other springs,
    gravity, which may soften); participation (mode, direction) kg and kg m² is the effective mass that swings
    when the base moves along, or turns about, an axis of Σ0; shape and shape_imag (mode, coordinate) displace
    Σp in Σp, the platform's modes and all coordinates of the legs, scaled to a largest displacement of Σp of
    one metre or one radian, which is real.
    """
    import xarray as xr

    d, point = lin.point.T.shape[1], lin.point
    values, vectors = np.linalg.eig(lin.own)
    upper = np.flatnonzero(values.imag >= 0)
    order = upper[np.lexsort((values[upper].imag, np.abs(values[upper])))]
    values, zeta = values[order], apart(values[order], vectors[:d, order]).T
    shapes = turned_real(zeta @ point.T.T)
    size = np.abs(values)
    share = shares(point, zeta, np.zeros((d, d)) if lin.feedback is None else lin.feedback.K)
    words = {
        "frequency": (("mode",), size / (2 * np.pi), "Hz", "undamped frequency, |pole| / 2π"),
        "damping": (("mode",), -values.real / np.where(size > 0, size, 1.0), "1", "damping ratio"),
        "growth": (("mode",), values.real, "1/s", "real part of the pole"),
        "pole_real": (("mode",), values.real, "1/s", "real part of the pole"),
        "pole_imag": (("mode",), values.imag, "1/s", "imaginary part of the pole"),
        "share": (("mode", "part"), share, "1", "share of the energy of deformation"),
        "participation": (
            ("mode", "direction"),
            participation(point, zeta),
            "kg, kg m2",
            "effective mass of motions of the base",
        ),
        "shape": (("mode", "coordinate"), shapes.real, "m, rad", "displacements, real part"),
        "shape_imag": (("mode", "coordinate"), shapes.imag, "m, rad", "displacements, imaginary part"),
    }
    data = {
        name: (dims, values, {"units": units, "long_name": text})
        for name, (dims, values, units, text) in words.items()
    }
    coords = {
        "mode": np.arange(1, len(order) + 1),
        "part": list(PARTS),
        "direction": list(AXES),
        "coordinate": list(coordinate_names(point)),
    }
    return xr.Dataset(data, coords)


def apart(values: Array, zeta: Array) -> Array:
    """Motions ζ (d, n) of poles (n,) in order, those of one and the same pole at right angles to each other:
    any directions of theirs are modes."""
    found, first = zeta.astype(complex), 0
    for last in range(1, len(values) + 1):
        if last == len(values) or abs(values[last] - values[first]) > SAME * abs(values[first]):
            if last - first > 1:
                found[:, first:last] = np.linalg.qr(found[:, first:last])[0]
            first = last
    return found


def turned_real(shapes: Array) -> Array:
    """Shapes (n, c) whose largest displacement of Σp is one and real, or largest entry if it rests."""
    pose = np.abs(shapes[:, :6])
    rest = np.abs(shapes)
    stands = np.max(pose, axis=1) < 1e-9 * np.max(rest, axis=1)
    which = np.where(stands, np.argmax(rest, axis=1), np.argmax(pose, axis=1))
    largest = np.take_along_axis(shapes, which[:, None], axis=1)
    found: Array = shapes / np.where(largest == 0, 1.0, largest)
    return found


def participation(point: Point, zeta: Array) -> Array:
    """(n, 6), the effective masses |ζᴴ b|² of motions ζ (n, d), complex and taken of length one; a base that
    accelerates drives them by b."""
    lengths = np.sqrt(np.sum(np.abs(zeta) ** 2, axis=1))[:, None]
    found: Array = np.abs(zeta.conj() @ point.by_base / np.where(lengths > 0, lengths, 1.0)) ** 2
    return found


def shares(point: Point, zeta: Array, feedback: Array) -> Array:
    """(n, parts) of the energy of deformation of motions ζ (n, d), complex, in each part; NaN of motions that
    nothing holds. The feedback (d, d) 1/s² is a drive."""
    servos, total = (np.sum(zeta.conj() * (zeta @ -K.T), axis=1).real for K in (feedback, point.K + feedback))
    moved = zeta @ point.T.T
    platform, links, compliances = (
        np.abs(moved) ** 2 @ stiff for stiff in parted(point, firmness(point.mechanism))
    )
    k = np.array([joint.k for joint in point.mechanism.robot.actuated])
    drives = servos + compliances + np.abs(moved @ actuated_rows(point.mechanism).T) ** 2 @ k
    parts = np.stack([platform, links, drives, total - platform - links - drives], axis=1)
    held = total > HELD * np.sum(np.abs(parts), axis=1)
    found: Array = np.where(held[:, None], parts, np.nan) / np.where(held, total, 1.0)[:, None]
    return found


def parted(point: Point, stiff: Array) -> tuple[Array, ...]:
    """Stiffnesses (6 + N + z,) by themselves: of the platform, of links, of drives; zero elsewhere."""
    owners = ["platform"] * (6 + point.mechanism.platform.modes)
    for number in point.mechanism.legs:
        leg = point.mechanism.robot.legs[number]
        owners += ["links"] * (leg.size - len(leg.drives)) + ["drives"] * len(leg.drives)
    which = np.array(owners)
    return tuple(np.where(which == owner, stiff, 0.0) for owner in ("platform", "links", "drives"))


def coordinate_names(point: Point) -> list[str]:
    """The names of the rows of shapes."""
    names = ["x", "y", "z", "rx", "ry", "rz"]
    names += [f"mode {k}" for k in range(1, point.mechanism.platform.modes + 1)]
    for number in point.mechanism.legs:
        leg = point.mechanism.robot.legs[number]
        names += [f"leg {number + 1} joint {j}" for j in range(1, len(leg.joints) + 1)]
        names += [f"leg {number + 1} bend {e}" for e in range(1, sum(leg.modes) + 1)]
        names += [f"leg {number + 1} drive {j + 1}" for j in leg.drives]
    return names
