"""Legs of a group one by one: what is traced for one of them serves all that are alike."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from parflex.base.array import Array, split
from parflex.base.unroll import for_each, recorder
from parflex.mechanics.legs.base import LegGroup

STANDS = ("rotation", "origin")
FORM = ("offsets", "branch", "posture")


def alike(group: LegGroup) -> bool:
    """Whether the legs differ in nothing but inertia, friction, springs and where they stand."""
    chain = group.chain
    tables = [chain.tables[name] for name, column in chain.columns.items() if column.alike]
    tables += [group.offsets, group.branch]
    return all(np.all(table == table[:1]) for table in tables)


def leg_by_leg(
    group: LegGroup,
    function: Callable[..., Sequence[Array]],
    rows: Sequence[Array],
    shared: Sequence[Array],
    shapes: Sequence[tuple[int, ...]],
) -> list[Array]:
    """function(group, *rows, *shared) for rows (…, L, n_i): its parts (…, L, *shape)."""
    if recorder(*rows, *shared) is None or not alike(group):
        return list(function(group, *rows, *shared))
    count = len(group.legs)
    tables = [group.chain.tables[name] for name in own(group)] + [getattr(group, name) for name in STANDS]
    inner = [table.shape[1:] for table in tables]

    def one(table: Array, *given: Array) -> Array:
        found = function(holding(group, split(table, inner)), *given)
        flat = [
            np.broadcast_to(part, (1, len(table), *shape)).reshape(1, len(table), math.prod(shape))
            for part, shape in zip(found, shapes, strict=True)
        ]
        return np.concatenate(flat, axis=-1)

    flat = np.concatenate([table.reshape(count, -1) for table in tables], axis=-1)
    return split(for_each(one, [flat, *rows], shared), shapes)


def own(group: LegGroup) -> list[str]:
    """The tables of the chain that each leg has for itself: inertia, friction and springs."""
    return [name for name, column in group.chain.columns.items() if not column.alike]


def holding(group: LegGroup, tables: Sequence[Array]) -> LegGroup:
    """As many legs of the group as there are rows in the tables, which are theirs."""
    count, names = len(tables[0]), own(group)
    same = {name: table[:count] for name, table in group.chain.tables.items()}
    chain = group.chain.with_tables(same | dict(zip(names, tables, strict=False)))
    form: dict[str, Any] = {name: getattr(group, name)[:count] for name in FORM}
    form |= dict(zip(STANDS, tables[len(names) :], strict=True))
    return group._replace(legs=group.legs[:count], chain=chain, **form)
