"""Legs from their tables: chains of joints, tips on attachments, postures."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.kinds import POSITION
from parflex.base.nearest import nearest
from parflex.files.coupling_tables import CouplingTable, coupling_of
from parflex.files.described import built
from parflex.files.flexure_tables import flexure_of, needs_direction, strut_direction
from parflex.files.joint_table import JointTable, joint_of
from parflex.files.leg_schema import AnyChainTable, ChainTable, KindTable, LegTable, TipTable
from parflex.files.lines import Where
from parflex.files.link_tables import link_fields
from parflex.files.quantity import convert
from parflex.files.reading import Reader
from parflex.files.tables import rotation_of
from parflex.robot.coupling import Coupling, check_row, numbers
from parflex.robot.flexure import Flexure
from parflex.robot.leg import Joint, Leg, Tip
from parflex.robots.legs import ALL_LEG_KINDS


class Parts(NamedTuple):
    """The joints and tips that the legs of a chain have in common."""

    name: str
    table: AnyChainTable
    joints: tuple[Joint, ...]
    tips: tuple[Tip, ...]
    couplings: tuple[Coupling, ...] = ()


def chain_parts(reader: Reader, name: str, table: AnyChainTable) -> Parts | None:
    """Joints and tips of a chain; None where there are complaints about its joints."""
    if isinstance(table, KindTable):
        return kind_parts(reader, name, table)
    assert isinstance(table, ChainTable)
    joints: tuple[Joint, ...] = ()
    for number, row in enumerate(table.joints):
        where = ("chain", name, "joints", number)
        link = link_fields(reader, where, row)
        more = None if link is None else reader.attempt(where, grown, joints, row, link)
        if more is None:
            return None
        joints = more
    tips = [tip_of(reader, ("chain", name, "tips", i), joints, row) for i, row in enumerate(table.tips)]
    couplings = [
        reader.attempt(("chain", name, "couplings", i), coupling_on, joints, row)
        for i, row in enumerate(table.couplings)
    ]
    held = tuple(found for found in tips if found is not None)
    return Parts(name, table, joints, held, tuple(found for found in couplings if found is not None))


def coupling_on(joints: tuple[Joint, ...], row: CouplingTable) -> Coupling:
    """A coupling of joints, checked as a leg's."""
    numbered = numbers("joints", row.joints)
    check_row("joints", numbered, [joint.antecedent for joint in joints])
    return coupling_of(row, [joints[j - 1].sigma for j in numbered])


def tip_of(reader: Reader, where: Where, joints: tuple[Joint, ...], row: TipTable) -> Tip | None:
    """A tip of a chain, its flexure one that does nothing until the robot stands at home (`at_home`); None
    where there are complaints."""
    found = reader.attempt(where, tip, joints, row)
    if found is not None and row.flexure is not None:
        reader.attempt((*where, "flexure"), flexure_of, row.flexure)
        if needs_direction(row.flexure):
            reader.attempt((*where, "flexure"), strut_direction, joints, found)
    return found


def kind_parts(reader: Reader, name: str, table: KindTable) -> Parts | None:
    """Joints and tips of a chain that is given by its kind."""
    [kind] = [each for each in ALL_LEG_KINDS if each.word == table.type]
    leg = built(reader, ("chain", name), kind, table)
    both = leg and reader.attempt(("chain", name), lambda: (leg.joints, leg.tips))
    return both and Parts(name, table, *both)


def grown(joints: tuple[Joint, ...], row: JointTable, link: dict[str, Any]) -> tuple[Joint, ...]:
    """A tree with one joint more, checked as a leg."""
    more = (*joints, joint_of(row, len(joints), link))
    body = more[-1].body
    end = np.zeros(3) if body is None else body.attachment_points[0]
    Leg(np.eye(3), np.zeros(3), more, (Tip(len(more), end),))
    return more


def tip(joints: tuple[Joint, ...], row: TipTable) -> Tip:
    """A tip on one of the links, checked as a leg's."""
    found = Tip(row.frame, row.offset, flexure=None if row.flexure is None else Flexure())
    Leg(np.eye(3), np.zeros(3), joints, (found,))
    return found


def placed_leg(reader: Reader, number: int, row: LegTable, parts: Mapping[str, Parts | None]) -> Leg | None:
    """A chain placed on the base; None where there are complaints about it."""
    where = ("leg", number)
    known = reader.attempt(where, chain_named, parts, row.chain)
    if known is None:
        return None
    tips = reader.attempt(where, tips_on, known, row.attachments)
    posture = reader.attempt(("chain", known.name), posture_of, known, known.table.posture)
    if row.posture is not None:
        posture = reader.attempt(where, posture_of, known, row.posture)
    rotation = reader.attempt(where, rotation_of, row.rotation)
    if tips is None or rotation is None:
        return None
    placed = (rotation, row.origin, known.joints, tips, posture, known.couplings)
    return reader.attempt(where, Leg, *placed)


def chain_named(parts: Mapping[str, Parts | None], name: str) -> Parts:
    """The chain of that name."""
    found = parts.get(name)
    if found is None:
        close = nearest(name, parts)
        hint = f'did you mean "{close}"?' if close else f"there is {', '.join(parts) or 'none'}"
        raise InputError(f'chain is "{name}", but there is no [chain.{name}]; {hint}')
    return found


def tips_on(known: Parts, attachments: Sequence[int]) -> tuple[Tip, ...]:
    """The tips of a leg, each on its attachment."""
    if len(attachments) != len(known.tips):
        raise InputError(
            f"attachments has {len(attachments)} entries, but chain {known.name} has {len(known.tips)} "
            f"tips; give one attachment for each"
        )
    return tuple(replace(t, attachment=a) for t, a in zip(known.tips, attachments, strict=True))


def posture_of(known: Parts, given: Sequence[Any] | None) -> Array | None:
    """Joint values (n,) in rad and m, by the joints' types."""
    if given is None:
        return None
    joints = known.joints
    if len(given) != len(joints):
        raise InputError(f"posture has {len(given)} entries; give one for each of the {len(joints)} joints")
    return np.array(
        [posture_value(j, value, joint) for j, (value, joint) in enumerate(zip(given, joints, strict=True))]
    )


def posture_value(number: int, value: Any, joint: Joint) -> float:
    """One joint value of a posture."""
    try:
        return convert(value, POSITION.of(joint.sigma))
    except InputError as error:
        raise InputError(f"posture[{number}] {error}") from None
