"""Where the models do not exist: legs out of reach, states off the closure, singular poses."""

import warnings
from typing import TYPE_CHECKING

import numpy as np

from parflex.analysis.mobility import freed_twist
from parflex.base.array import Array, transpose
from parflex.base.check import index_of
from parflex.base.errors import NO_INERTIA, DynamicSingularity, InputError, OutOfReach, SingularPose
from parflex.kernels import models as kernels
from parflex.mechanics.closure import size_of
from parflex.mechanics.legs.base import MARGINS
from parflex.mechanics.output import Output
from parflex.robot.robot import Robot

if TYPE_CHECKING:
    from parflex.model.model import Model

SINGULAR = 1e-8  # smallest acceptable ratio of singular values, lengths scaled by the platform's
LOCKED = 1e-12  # of eigenvalues of the contact system, which go with the squares of the closure's
OFF = 1e-6  # m per metre of platform, and m/s: the largest gap between a tip and its attachment


def check_health(robot: Robot, health: Array) -> None:
    """Raise where a state is none: as `check_legs`, and where it is off the closure of the legs."""
    check_legs(robot, health)
    check_gaps(robot, health)


def check_gaps(robot: Robot, health: Array) -> None:
    """Raise InputError where a tip is not at its attachment, or leaves it."""
    gaps, start = health[..., MARGINS * len(robot.legs) :], 0
    if gaps.size == 0 or np.max(np.abs(gaps)) <= OFF * min(1.0, size_of(robot)):
        return
    for group in robot.groups:
        if group.closed:
            continue
        width = 3 * len(group.tip_frames)
        for what, unit in (("", "m"), (" velocity", "m/s")):
            part = gaps[..., start : start + width * len(group.legs)]
            start += width * len(group.legs)
            size = np.max(np.abs(part.reshape(part.shape[:-1] + (-1, width))), axis=-1)
            bad = size > OFF * min(1.0, size_of(robot))
            if np.any(bad):
                where = tuple(np.argwhere(bad)[0])
                raise off_closure(group.type.carries, group.legs[where[-1]], what, size[where], unit, bad)


def off_closure(carried: bool, leg: int, what: str, gap: float, unit: str, bad: Array) -> InputError:
    """The error of a state that the legs do not allow."""
    where = index_of(np.any(bad, axis=-1))
    if carried and not what:
        return OutOfReach(
            f"state{where}: no joints of leg {leg + 1} were found that reach its attachment, a gap of "
            f"{gap:.2g} m remains; move the pose, or give State.joints near the solution"
        )
    return InputError(
        f"state{where} is off the closure: a gap{what} of {gap:.2g} {unit} between leg {leg + 1} and its "
        f"attachment, since the legs leave the platform fewer than six freedoms; take the nearest state "
        f"that they allow, model.project(state)"
    )


def check_reach(robot: Robot, health: Array) -> None:
    """Raise OutOfReach where a leg cannot reach its tip; a singular leg is none of its business."""
    margins = health[..., : MARGINS * len(robot.legs)]
    if not np.all(split_margins(robot, margins)[0] >= 0):
        check_legs(robot, health)


def check_legs(robot: Robot, health: Array) -> None:
    """Raise where a leg cannot reach its tip (OutOfReach) or is singular there (SingularPose).

    health begins with the margins (…, 2 legs) of `assembly.health`.
    """
    margins = health[..., : MARGINS * len(robot.legs)]
    if margins.size == 0 or margins.min() > SINGULAR:
        return
    reach, regular, numbers = split_margins(robot, margins)
    for bad, error, what in (
        (~(reach > SINGULAR), OutOfReach, "cannot reach its attachment; move the pose or the base"),
        (~(regular > SINGULAR), SingularPose, "is singular (its passive joints lock); move the pose"),
    ):
        if np.any(bad):
            leg = numbers[int(np.argwhere(bad)[0][-1])]
            where = index_of(np.any(bad, axis=-1))
            raise error(f"pose{where}: leg {leg + 1} {what}")


def check_finite(answer: Array) -> None:
    """Raise where the mechanics itself has no answer, though every leg is regular."""
    if not np.isfinite(answer).all():
        where = index_of(~np.all(np.isfinite(answer), axis=-1))
        raise SingularPose(f"at the state{where}, {NO_INERTIA}")


def check_locking(robot: Robot, C: Array) -> None:
    """Raise SingularPose where the closure loses a row: C (…, r r), the contact system by rows.

    There the legs let the platform go along some twist, or press against each other without end.
    """
    rows = len(robot.rows.kept)
    matrix = C.reshape(C.shape[:-1] + (rows, rows))
    scale = 1.0 / np.sqrt(np.einsum("...ii->...i", matrix))
    values = np.linalg.eigvalsh(scale[..., :, None] * matrix * scale[..., None, :])
    bad = ~(values[..., 0] > LOCKED * values[..., -1])
    if np.any(bad):
        raise SingularPose(
            f"pose{index_of(bad)} is a constraint singularity: the legs no longer hold the platform against "
            f"some motion that they hold elsewhere (model.mobility names it); move the pose"
        )


def split_margins(robot: Robot, margins: Array) -> tuple[Array, Array, list[int]]:
    """Reach, regularity (…, legs) and the legs' numbers, in the order of the groups."""
    reach: list[Array] = []
    regular: list[Array] = []
    numbers: list[int] = []
    start = 0
    for group in robot.groups:
        count = len(group.legs)
        reach.append(margins[..., start : start + count])
        regular.append(margins[..., start + count : start + 2 * count])
        numbers += group.legs
        start += 2 * count
    empty = margins[..., :0]
    return np.concatenate([empty, *reach], axis=-1), np.concatenate([empty, *regular], -1), numbers


def by_rows(robot: Robot, output: Output, gain: Array) -> Array:
    """∂output/∂Γ (…, o, m), angular rows in metres."""
    matrix = gain.reshape(gain.shape[:-1] + (output.size, robot.n_forces))
    return matrix * output.lengths(size_of(robot))[:, None]


def gain_ratio(flexible: Array, rigid: Array) -> Array:
    """G_f G_r⁺ (…, o, o): what the bending platform makes of the accelerations of a rigid one."""
    square = rigid @ transpose(rigid)
    return flexible @ transpose(rigid) @ np.linalg.inv(square)


def check_gain(robot: Robot, output: Output, x: Array, flexible: Array, rigid: Array) -> Array:
    """Raise SingularPose where no forces give the wanted output; tell where they have a wrong sign.

    flexible and rigid (…, o m) are ∂output/∂Γ as it is and for a platform that does not bend. True
    in the result (…,) marks poses beyond a dynamic singularity: the two have opposite signs.
    """
    flexible, rigid = gains = by_rows(robot, output, np.stack([flexible, rigid]))
    mass = robot.platform.moments.m + sum(joint.M for leg in robot.legs for joint in leg.joints)
    sizes = np.sqrt(np.sum(gains * gains, axis=(-2, -1)))
    idle = mass * sizes[1] < SINGULAR
    if output.size == robot.n_forces and not np.any(idle):
        flexible_det, rigid_det = det = np.linalg.det(gains)
        if np.all(smallest_ratio(det, sizes, output.size) > SINGULAR):
            return flexible_det * rigid_det < 0
    if np.any(idle):
        raise SingularPose(
            f"pose{index_of(idle)}: no actuator moves the output at all, the legs hold the platform against "
            f"it; name rows that they leave free (model.mobility tells how many)"
        )
    lost = ratio(rigid) < SINGULAR
    if np.any(lost):
        which = tuple(np.argwhere(lost)[0]) if lost.ndim else ()
        twist = np.array2string(freed_twist(robot, x[which]), precision=3, suppress_small=True)
        raise SingularPose(
            f"pose{index_of(lost)} is a parallel singularity: J_p⁻¹ is singular, and with all actuators "
            f"locked the platform can still move along the twist (v, ω) = {twist}; move the pose"
        )
    bad = ratio(flexible) < SINGULAR
    if np.any(bad):
        raise SingularPose(
            f"pose{index_of(bad)} is a dynamic singularity: no actuator forces give the wanted "
            f"acceleration, though J_p⁻¹ has full rank; move the pose, stiffen the platform, or prescribe "
            f"another output"
        )
    every = output.size == min(6, robot.n_forces)
    return every & (np.linalg.det(gain_ratio(flexible, rigid)) < 0)


def smallest_ratio(det: Array, size: Array, n: int) -> Array:
    """What the `ratio` of n × n matrices is at least, by their determinants and Frobenius norms: the
    product of the other singular values is at most (‖A‖²/(n − 1))^((n − 1)/2)."""
    others = (size / np.sqrt(max(n - 1, 1))) ** (n - 1)
    return np.abs(det) / (others * size)


def spread(x: Array, *gains: Array) -> tuple[Array, ...]:
    """Arrays (…, n_i) with their leading axes broadcast together."""
    batch = np.broadcast_shapes(*(a.shape[:-1] for a in (x, *gains)))
    return tuple(np.broadcast_to(a, batch + a.shape[-1:]) for a in (x, *gains))


def beyond_words(beyond: Array) -> str:
    """What is to be said of poses beyond a dynamic singularity (…,)."""
    return (
        f"pose{index_of(beyond)} lies beyond a dynamic singularity: the platform bends so much that it "
        f"accelerates against its actuators, and control of this output is unstable; see "
        f"model.output_report, stiffen the platform, or prescribe another output"
    )


class Watch:
    """A look at the gains of an output during a motion.

    The determinants of ∂output/∂Γ, as it is and for a rigid platform, keep the signs they started
    with until a singularity is crossed.
    """

    def __init__(self, model: "Model", output: Output) -> None:
        self._robot, self._output = model.robot, output
        self._function = model.function(kernels.gains, output)
        self._start: Array | None = None
        self._last = np.zeros(0)  # gains, flexible and rigid, (2, o, m)

    def look(self, x: Array) -> tuple[int, str]:
        """How many of the flat states (T, size) of a motion come before it crosses a singularity, seen
        from the first look; and which it crosses, empty for none."""
        shape = (2, len(x), self._output.size, self._robot.n_forces)
        gains = np.array(self._function.each(x)).reshape(shape)
        if self._start is None:
            self._start = gains[:, 0]
            if check_gain(self._robot, self._output, x[0], *(gain.reshape(-1) for gain in self._start)):
                warnings.warn(beyond_words(np.array(True)), DynamicSingularity, stacklevel=5)  # of simulate
        flexible, rigid = np.linalg.det(gains @ transpose(self._start)[:, None])
        crossed = (flexible < 0) | (rigid < 0)
        before = int(np.argmax(crossed)) if np.any(crossed) else len(x)
        self._last = gains[:, max(before, 1) - 1]
        if before == len(x):
            return before, ""
        if rigid[before] < 0:
            return before, "the motion has crossed a parallel singularity: det J_p⁻¹ changed sign"
        words = "the motion has crossed a dynamic singularity: the determinant of ∂V̇_p/∂Γ changed sign"
        return before, words

    def explain(self) -> str:
        """Whether the motion has run into a singularity without crossing it."""
        if self._start is None:
            return ""
        scale = self._output.lengths(size_of(self._robot))[:, None]
        (flexible, rigid), (flexible_0, rigid_0) = scale * self._last, scale * self._start
        now, start, kind = ratio(rigid), ratio(rigid_0), "parallel"
        if now > 0.05 * start:
            now, start, kind = ratio(flexible), ratio(flexible_0), "dynamic"
        if now > 0.05 * start:
            return ""
        return (
            f"a {kind} singularity is near: the weakest gain from forces to acceleration has fallen "
            f"to {now / start:.1e} of its value at the start"
        )


def ratio(matrix: Array) -> Array:
    """Smallest over largest singular value; 0 where an entry is not finite."""
    good = np.all(np.isfinite(matrix), axis=(-2, -1))
    values = np.linalg.svd(np.where(good[..., None, None], matrix, 0.0), compute_uv=False)
    largest = values[..., 0]
    return np.where(largest > 0, values[..., -1] / np.where(largest > 0, largest, 1.0), 0.0)
