"""Gains from actuator forces to an output: where they vanish, and what bending makes of them."""

import numpy as np

from parflex.analysis.health import SINGULAR
from parflex.analysis.mobility import freed_twist
from parflex.base.array import Array, transpose
from parflex.base.check import index_of
from parflex.base.errors import SingularPose
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import JointOutput, Output


def gain_matrix(mechanism: Mechanism, output: Output, gain: Array) -> Array:
    """∂output/∂Γ (…, o, m) of a gain by rows (…, o m), angular rows in metres."""
    matrix = gain.reshape(gain.shape[:-1] + (output.size, mechanism.n_forces))
    return matrix * output.lengths(mechanism)[:, None]


def gain_ratio(flexible: Array, rigid: Array) -> Array:
    """G_f G_r⁺ (…, o, o): the accelerations of the bending platform by those of a rigid one."""
    square = rigid @ transpose(rigid)
    return flexible @ transpose(rigid) @ np.linalg.inv(square)


def check_gain(mechanism: Mechanism, output: Output, x: Array, flexible: Array, rigid: Array) -> Array:
    """Raise SingularPose where no forces give the wanted output; tell where they have a wrong sign.

    flexible and rigid (…, o m) are ∂output/∂Γ as it is and for a platform that does not bend. True
    in the result (…,) marks poses beyond a dynamic singularity: the two have opposite signs.
    """
    flexible, rigid = gains = gain_matrix(mechanism, output, np.stack([flexible, rigid]))
    robot = mechanism.robot
    mass = robot.platform.moments.m + sum(joint.mass for leg in robot.legs for joint in leg.joints)
    sizes = np.sqrt(np.sum(gains * gains, axis=(-2, -1)))
    idle = mass * sizes[1] < SINGULAR
    if output.size == mechanism.n_forces and not np.any(idle):
        flexible_det, rigid_det = det = np.linalg.det(gains)
        if np.all(smallest_ratio(det, sizes, output.size) > SINGULAR):
            return flexible_det * rigid_det < 0
    if np.any(idle):
        raise SingularPose(
            f"pose{index_of(idle)}: no actuator moves the output at all, the legs hold the platform against "
            f"it; name rows that they leave free (model.mobility tells how many)"
        )
    lost = ratio(rigid) < SINGULAR
    if np.any(lost) and isinstance(output, JointOutput):
        raise SingularPose(
            f"pose{index_of(lost)}: {output.size} actuated joints do not accelerate each for itself, as "
            f"the platform ties them to one another; name fewer, or others, with JointOutput(rows=…)"
        )
    if np.any(lost):
        which = tuple(np.argwhere(lost)[0]) if lost.ndim else ()
        twist = np.array2string(freed_twist(mechanism, x[which]), precision=3, suppress_small=True)
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
    every = output.size == min(6, mechanism.n_forces)
    return every & (np.linalg.det(gain_ratio(flexible, rigid)) < 0)


def smallest_ratio(det: Array, size: Array, n: int) -> Array:
    """A lower bound of the `ratio` of n × n matrices, by their determinants and Frobenius norms: the
    product of the other singular values is at most (‖A‖²/(n − 1))^((n − 1)/2)."""
    others = (size / np.sqrt(max(n - 1, 1))) ** (n - 1)
    return np.abs(det) / (others * size)


def spread(x: Array, *gains: Array) -> tuple[Array, ...]:
    """Arrays (…, n_i) with their leading axes broadcast together."""
    batch = np.broadcast_shapes(*(a.shape[:-1] for a in (x, *gains)))
    return tuple(np.broadcast_to(a, batch + a.shape[-1:]) for a in (x, *gains))


def beyond_words(beyond: Array) -> str:
    """The warning about poses beyond a dynamic singularity (…,)."""
    return (
        f"pose{index_of(beyond)} lies beyond a dynamic singularity: the platform bends so much that it "
        f"accelerates against its actuators, and control of this output is unstable; see "
        f"model.output_report, stiffen the platform, or prescribe another output"
    )


def ratio(matrix: Array) -> Array:
    """Smallest over largest singular value; 0 where an entry is not finite."""
    good = np.all(np.isfinite(matrix), axis=(-2, -1))
    values = np.linalg.svd(np.where(good[..., None, None], matrix, 0.0), compute_uv=False)
    largest = values[..., 0]
    return np.where(largest > 0, values[..., -1] / np.where(largest > 0, largest, 1.0), 0.0)
