"""The errors parflex raises: each names the field, the value that came, and the remedy."""


class InputError(ValueError):
    """Something given to parflex is wrong; nothing was computed or written."""


class OutOfReach(InputError):
    """A leg cannot reach the pose."""


class SingularPose(InputError):
    """The robot loses or gains a freedom in the pose, so that the wanted model does not exist."""


class NotConverged(InputError):
    """An iteration did not reach its tolerance."""


class ImplausibleValue(UserWarning):
    """A value is legal and hardly meant: a number in another unit, or out of all proportion to others."""


class DynamicSingularity(UserWarning):
    """The pose lies beyond a dynamic singularity: the platform bends so much that it accelerates
    against its actuators, and feedback of that output would be unstable."""


class NoForeshortening(UserWarning):
    """A flexible link does not know that it becomes shorter as it bends: compression stiffens it, where it
    should soften it."""


class BeyondBasis(UserWarning):
    """A response is asked for where the platform's modes do not carry it: at a node whose static shapes they
    lack, or at frequencies beyond half the highest free–free mode."""


class UnstableEquilibrium(UserWarning):
    """A response is asked for about an equilibrium that a small push ends: it is none that is ever seen."""


class PartialRun(UserWarning):
    """A simulation ended before its last output time; its result holds what was reached."""


NO_INERTIA = (
    "some link or the platform has no inertia against one of its motions, so that no acceleration is "
    "finite: give it mass, inertia or a rotor inertia IA"
)
