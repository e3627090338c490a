"""Legs of a group one by one: what is traced for one of them serves all that are alike."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from parflex.base.array import Array, split
from parflex.base.unroll import each, recorder
from parflex.mechanics.couplings import of_first
from parflex.mechanics.flexures import Flexures
from parflex.mechanics.legs.base import LegGroup
from parflex.mechanics.link import tables_of, with_tables

STANDS = ("rotation", "origin")
FORM = ("offsets", "branch", "posture")


def alike(group: LegGroup) -> bool:
    """True where the legs differ in nothing but inertia, friction, springs and where they stand."""
    chain = group.chain
    tables = [chain.tables[name] for name, column in chain.columns.items() if column.alike]
    tables += [group.offsets, group.branch, *(group.flexures or ())]
    tables += [table for link in group.chain.links if link is not None for table in tables_of(link)]
    tables += [table for coupling in chain.couplings for table in coupling[1:]]
    return all(np.all(table == table[:1]) for table in tables)


def each_leg(
    group: LegGroup, function: Callable[..., Any], rows: Sequence[Array], shared: Sequence[Array] = ()
) -> Any:
    """function(group, *rows, *shared), a tree of arrays (…, L, *shape), for rows (…, L, n_i).

    It may be traced once, for one leg, where the legs are alike.
    """
    if recorder(*rows, *shared) is None or not alike(group):
        return function(group, *rows, *shared)
    count = len(group.legs)
    tables = [alone(group, name) for name in own(group)] + [getattr(group, name) for name in STANDS]
    inner = [table.shape[1:] for table in tables]

    def one(table: Array, *given: Array) -> Any:
        return function(holding(group, split(table, inner)), *given)

    flat = np.concatenate([table.reshape(count, -1) for table in tables], axis=-1)
    return each(one, [flat, *rows], shared)


def own(group: LegGroup) -> list[str]:
    """The tables of the chain that each leg has for itself: inertia, friction and springs."""
    return [name for name, column in group.chain.columns.items() if not column.alike]


def alone(group: LegGroup, name: str) -> Array:
    """A table (L, n, *shape) of the chain, of one robot: rests that move are an input with leading axes."""
    table, column = group.chain.tables[name], group.chain.columns[name]
    return table.reshape(table.shape[-2 - len(column.shape) :])


def holding(group: LegGroup, tables: Sequence[Array]) -> LegGroup:
    """The group with as many legs as there are rows in the tables, which become theirs."""
    count, names = len(tables[0]), own(group)
    same = {name: table[:count] for name, table in group.chain.tables.items()}
    chain = group.chain.with_tables(same | dict(zip(names, tables, strict=False)))
    links = (link and with_tables(link, [table[:count] for table in tables_of(link)]) for link in chain.links)
    couplings = tuple(of_first(coupling, count) for coupling in chain.couplings)
    chain = replace(chain, links=tuple(links), couplings=couplings)
    form: dict[str, Any] = {name: getattr(group, name)[:count] for name in FORM}
    form["flexures"] = group.flexures and Flexures(*(table[:count] for table in group.flexures))
    form |= dict(zip(STANDS, tables[len(names) :], strict=True))
    return group._replace(legs=group.legs[:count], chain=chain, **form)
