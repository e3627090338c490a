"""Where the entries of `system.health` stand."""

from typing import NamedTuple

from parflex.base.array import Array


class Health(NamedTuple):
    """The places of the entries of `system.health`, all in the order of the legs.

    The orders give the place of each entry among those by group.
    """

    reach: slice
    regularity: slice
    open: slice  # of the flexures at tips
    gap: slice
    gap_rate: slice
    leg_order: Array
    open_order: Array
    gap_order: Array
    open_legs: Array  # the number of the leg that each flexure belongs to
    gap_legs: Array  # the number of the leg that each gap belongs to

    @property
    def margins(self) -> slice:
        """All that must be positive: reach, regularity, and flexures that are not turned about."""
        return slice(0, self.open.stop)

    @property
    def size(self) -> int:
        """The number of entries."""
        return self.gap_rate.stop
