"""Legs as the mechanics reads them: each by the first type that knows it, those alike side by side."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.mechanics.chain import Chain, chain_of, joined
from parflex.mechanics.flexures import Flexures, flexures_of
from parflex.mechanics.legs.base import LegGroup, LegType, regular, settled
from parflex.robot.leg import Leg


def alone(number: int, leg: Leg, leg_types: Sequence[LegType]) -> LegGroup:
    """A group of one leg, of the first type that knows it; its entries in Γ, q and the branches from 0."""
    n, chain = len(leg.joints), chain_of(leg)
    actuated = tuple(j for j, joint in enumerate(leg.joints) if joint.mu)
    none = np.zeros((1, 0), dtype=int)
    bare = LegGroup(
        type=leg_types[-1],
        legs=(number,),
        chain=chain,
        rotation=np.asarray(leg.rotation)[None],
        origin=np.asarray(leg.origin)[None],
        tip_frames=tuple(tip.frame - 1 for tip in leg.tips),
        tip_seats=leg.seats.tips,
        offsets=np.array([[tip.offset for tip in leg.tips]]),
        attachments=np.array([[tip.attachment for tip in leg.tips]]),
        actuated=actuated,
        S=selection(chain, actuated),
        forces=np.arange(len(actuated))[None],
        posture=np.zeros((1, n)) if leg.posture is None else np.asarray(leg.posture)[None],
        branch=np.ones(1),
        branched=none,
        kept=(),
        carried=none,
        flexures=flexures_of(leg),
        soft=tuple(tip.soft for tip in leg.tips),
    )
    anywhere = np.random.default_rng(0).uniform(-1, 1, (1, n))
    for known in leg_types:
        kept = range(0 if known.carries else n, leg.size)
        group = bare._replace(type=known, kept=tuple(kept), carried=np.arange(len(kept))[None])
        if any(group.soft) and not known.carries:
            continue
        if not known.recognises(leg) or not regular(group, anywhere if leg.posture is None else bare.posture):
            continue
        if known.carries:
            return group
        if leg.posture is None:
            return group._replace(branched=np.zeros((1, 1), dtype=int)) if known.two_branches else group
        if (on_branch := settled(group)) is not None:
            return on_branch
    raise AssertionError("the last leg type takes every leg")


def selection(chain: Chain, actuated: Sequence[int]) -> Array:
    """S (z, actuated): Γ_i = [0 0 Γ_3i]ᵀ for a leg that drives its third joint; a drive that gives takes the
    force of its motor with the opposite sign."""
    S = np.eye(chain.size)[:, list(actuated)]  # Eq. 8
    drives = chain.size - len(chain.drives)
    for place, j in enumerate(chain.drives):
        S[drives + place, list(actuated).index(j)] = -1.0
    return S


def side_by_side(groups: list[LegGroup]) -> LegGroup:
    """Groups of one type and equal structure as one."""
    first = groups[0]
    if len(groups) == 1:
        return first
    tables = {name: value for name, value in first._asdict().items() if name != "S"}
    arrays = [name for name, value in tables.items() if isinstance(value, np.ndarray)]
    together = {name: np.concatenate([getattr(group, name) for group in groups]) for name in arrays}
    chain = joined([group.chain for group in groups])
    legs = tuple(number for group in groups for number in group.legs)
    same: dict[str, Any] = {**together, "chain": chain, "legs": legs}
    held = [group.flexures for group in groups if group.flexures is not None]
    if held:
        same["flexures"] = Flexures(*(np.concatenate(tables) for tables in zip(*held, strict=True)))
    return first._replace(**same)
