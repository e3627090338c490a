"""Inverse models that mean nothing: what legs that bend, and soft tips, make of the gains from forces to an
output.

Where a compliance lies between motor and platform, the platform does not accelerate with the motor but
after it. Through a drive that gives, or through soft tips alone, the instantaneous gain is zero, and there
is no inverse. Of links with mass it is an accident of the chosen shapes: it alternates in sign, and tends
to 0, with their number.
"""

import numpy as np

from parflex.analysis.gains import gain_matrix, gain_ratio
from parflex.analysis.health import check_finite, check_health
from parflex.base.array import Array
from parflex.base.check import index_of
from parflex.base.errors import InputError
from parflex.compiled.functions import Functions
from parflex.kernels import models
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import THROUGH_DRIVES, THROUGH_SOFT_TIPS, Output, PlatformOutput
from parflex.mechanics.system import examined

# of the gain with legs that do not bend. Shapes that bend a strut leave 1.0 and more. Those that
# stretch a rod between motor and platform leave less than nothing, or little: two of them a half at
# most, where the motor has no mass and the rod is as heavy as its share of the platform
LEAST = 0.5
NONE = 1e-8  # of that gain: round-off, through a drive that gives


def least_share(mechanism: Mechanism, output: Output, flexible: Array, stiff: Array) -> Array:
    """The least eigenvalue (…,) of G_f G_r⁺, its real part: what legs that bend leave of the gains.

    flexible and stiff (…, o m) are ∂output/∂Γ as it is, and for legs that do not bend.
    """
    G_f, G_r = gain_matrix(mechanism, output, np.stack([flexible, stiff]))
    found: Array = np.min(np.linalg.eigvals(gain_ratio(G_f, G_r)).real, axis=-1)
    return found


def well_posed(functions: Functions, output: Output, x: Array) -> bool:
    """True where the inverse model means something at a flat state (size,)."""
    mechanism = functions.mechanism
    if not mechanism.gives:
        return True
    gains = (functions(build, output)(x=x)["flexible"] for build in (models.gains, models.platform_gains))
    return bool(least_share(mechanism, output, *gains) >= LEAST)


def check_reached(functions: Functions, output: Output, x: Array) -> None:
    """Raise InputError where forces accelerate an output of the platform not at once, but through drives that
    give or soft tips, at flat states (…, size); raises as `check_health` where these are no states."""
    mechanism = functions.mechanism
    softly = mechanism.soft or any(leg.drives for leg in mechanism.robot.legs)
    if softly and isinstance(output, PlatformOutput):
        check_health(mechanism, examined(mechanism, x)[1])
        builds = (models.gains, models.platform_gains)
        gains = [functions(build, output).run(x=x)["flexible"] for build in builds]
        for gain in gains:
            check_finite(gain)
        check_posed(mechanism, output, *gains, allowed=True)


def check_posed(
    mechanism: Mechanism, output: Output, flexible: Array, stiff: Array, *, allowed: bool = False
) -> None:
    """Raise InputError where legs that bend leave too little of the gains, or turn them round, unless that is
    allowed; and in any case where they leave nothing.

    flexible and stiff (…, o m) are as in `least_share`.
    """
    least = least_share(mechanism, output, flexible, stiff)
    bad = ~(np.abs(least) >= NONE)
    if np.any(bad):
        raise InputError(f"pose{index_of(bad)}: {THROUGH_SOFT_TIPS if mechanism.soft else THROUGH_DRIVES}")
    bad = ~(least >= LEAST)
    if np.any(bad) and not allowed:
        worst = float(np.min(least))
        raise InputError(
            f"pose{index_of(bad)}: the legs bend between motors and platform, and what forces give at once "
            f"is {worst:.2g} of what they would by legs that cannot bend, by the choice of shapes "
            f"alone: take output=JointOutput(), the accelerations of the actuated joints, or "
            f'legs="static", legs that bend with the load and do not swing, or allow_ill_posed=True'
        )
