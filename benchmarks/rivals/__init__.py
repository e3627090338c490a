"""The programs that are compared, one per file; parflex comes first, ratios are to it."""

from benchmarks.rivals.base import Rival
from benchmarks.rivals.exudyn import Exudyn
from benchmarks.rivals.mujoco import Mujoco
from benchmarks.rivals.parflex import Parflex
from benchmarks.rivals.pinocchio import Pinocchio


def rigid_rivals() -> tuple[type[Rival], ...]:
    """Those for a rigid platform."""
    return Parflex, Pinocchio, Mujoco, Exudyn


def flexible_rivals() -> tuple[type[Rival], ...]:
    """Those that know a platform's modes."""
    return Parflex, Exudyn
