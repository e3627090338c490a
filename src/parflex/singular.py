"""Where the models do not exist: legs out of reach, singular legs, singular and dynamic poses."""

import numpy as np

from parflex.array import Array, transpose
from parflex.check import index_of
from parflex.errors import OutOfReach, SingularPose
from parflex.output import FrameOutput
from parflex.robot import Robot

SINGULAR = 1e-8  # smallest acceptable ratio of singular values, lengths scaled by the platform's

NO_INERTIA = (
    "some link or the platform has no inertia against one of its motions, so that no acceleration is "
    "finite: give it mass, inertia or a rotor inertia IA"
)


def check_legs(robot: Robot, margins: Array) -> None:
    """Raise where a leg cannot reach its tip (OutOfReach) or is singular there (SingularPose).

    margins (…, 2 legs) from `assembly.leg_margins`.
    """
    if np.all(margins > SINGULAR):
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
    if not np.all(np.isfinite(answer)):
        where = index_of(~np.all(np.isfinite(answer), axis=-1))
        raise SingularPose(f"at the state{where}, {NO_INERTIA}")


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


def check_gain(robot: Robot, output: FrameOutput, gain: Array, Jp_invT: Array) -> None:
    """Raise SingularPose where no forces, or forces of the wrong sign, give the wanted output.

    gain (…, o m) = ∂output/∂Γ and J_p⁻ᵀ (…, 6 m), by rows.
    """
    m = robot.n_forces
    full = sorted(output.rows) == list(range(6)) and m == 6
    size = platform_size(robot)
    lengths = FrameOutput().lengths(size)
    rigid = Jp_invT.reshape(Jp_invT.shape[:-1] + (6, m)) / lengths[:, None]
    flexible = gain.reshape(gain.shape[:-1] + (output.size, m))
    flexible = flexible * output.lengths(size)[:, None]
    if m >= 6:
        report_parallel(rigid, lengths)
    bad = ratio(flexible) < SINGULAR
    reason = "no actuator forces give the wanted acceleration"
    if full and not np.any(bad):
        bad = np.linalg.det(flexible[..., np.argsort(output.rows), :]) * np.linalg.det(rigid) < 0
        reason = "the platform bends so much that it accelerates against its actuators"
    if np.any(bad):
        raise SingularPose(
            f"pose{index_of(bad)} is a dynamic singularity: {reason}, though J_p⁻¹ has full rank; "
            f"move the pose, stiffen the platform, or prescribe another output"
        )


class Watch:
    """A look at the gains during a motion, quick where the robot has six actuators.

    The determinants of ∂V̇_p/∂Γ and J_p⁻ᵀ keep equal signs, and J_p⁻ᵀ the one it started with, until
    a singularity is crossed.
    """

    def __init__(self, robot: Robot, output: FrameOutput) -> None:
        self._robot, self._output = robot, output
        self._start: tuple[Array, float, Array] | None = None  # gain, det J_p⁻ᵀ, J_p⁻ᵀ at first

    def look(self, gain: Array, Jp_invT: Array) -> None:
        """Raise SingularPose where the inverse model has ceased to exist."""
        if self._robot.n_forces != 6 or self._output.size != 6:
            check_gain(self._robot, self._output, gain, Jp_invT)
            return
        flexible, rigid = np.linalg.det(np.concatenate([gain, Jp_invT]).reshape(2, 6, 6))
        if self._start is None:
            self._start = gain.copy(), float(rigid), Jp_invT.copy()
        if rigid * self._start[1] < 0:
            raise SingularPose("the motion has crossed a parallel singularity: det J_p⁻¹ changed sign")
        if not flexible * rigid > 0:
            check_gain(self._robot, self._output, gain, Jp_invT)

    def explain(self, gain: Array, Jp_invT: Array) -> str:
        """Whether the motion has run into a singularity without crossing it."""
        if self._start is None:
            return ""
        scale = self._output.lengths(platform_size(self._robot))[:, None]
        now, start = (ratio(a.reshape(6, 6) / scale) for a in (Jp_invT, self._start[2]))
        kind = "parallel"
        if now > 0.05 * start:
            now, start = (ratio(scale * a.reshape(6, 6)) for a in (gain, self._start[0]))
            kind = "dynamic"
        if now > 0.05 * start:
            return ""
        return (
            f"a {kind} singularity is near: the weakest gain from forces to acceleration has fallen "
            f"to {now / start:.1e} of its value at the start"
        )


def report_parallel(rigid: Array, lengths: Array) -> None:
    """Raise where J_p⁻¹ is singular, with the twist that the locked actuators leave free."""
    bad = ratio(rigid) < SINGULAR
    if np.any(bad):
        which = tuple(np.argwhere(bad)[0]) if bad.ndim else ()
        free = np.linalg.svd(transpose(rigid[which]))[2][-1] / lengths
        twist = np.array2string(free / np.max(np.abs(free)), precision=3, suppress_small=True)
        raise SingularPose(
            f"pose{index_of(bad)} is a parallel singularity: J_p⁻¹ is singular, and with all "
            f"actuators locked the platform can still move along the twist (v, ω) = {twist}; "
            f"move the pose"
        )


def ratio(matrix: Array) -> Array:
    """Smallest over largest singular value; 0 where an entry is not finite."""
    good = np.all(np.isfinite(matrix), axis=(-2, -1))
    values = np.linalg.svd(np.where(good[..., None, None], matrix, 0.0), compute_uv=False)
    largest = values[..., 0]
    return np.where(largest > 0, values[..., -1] / np.where(largest > 0, largest, 1.0), 0.0)


def platform_size(robot: Robot) -> float:
    """Root mean square distance of the attachments from their centre, m."""
    points = robot.platform.attachment_points
    return float(np.sqrt(np.mean(np.sum((points - points.mean(axis=0)) ** 2, axis=-1)))) or 1.0
