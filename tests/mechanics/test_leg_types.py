"""Which legs have a closed form: never one that is singular wherever the leg stands.

The rod of a slide along its own hinge says nothing of the slide: round-off was taken for a solution once.
"""

from dataclasses import replace

import numpy as np
import pytest

import chains
from parflex.mechanics.legs import ALL_LEG_TYPES
from parflex.mechanics.legs.base import regular, settled
from parflex.mechanics.legs.gathered import alone

SEEDS = range(5)


@pytest.mark.parametrize("kind", chains.kinds(), ids=str)
def test_closed_forms_hold_away_from_the_posture(kind):
    """By the leg's posture, or without one, the form that is chosen finds the joints at other places too."""
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        leg, _ = chains.leg(rng, kind, 0)
        for given in (leg, replace(leg, posture=None)):
            group = alone(0, given, ALL_LEG_TYPES)
            if not group.type.carries:
                q = rng.uniform(-0.5, 0.5, (1, len(leg.joints)))
                assert regular(group, q)
                assert settled(group._replace(posture=q)) is not None
