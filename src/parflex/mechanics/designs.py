"""A robot with other numbers: as if it had been built with them, or for the mechanics alone.

The values are those of named parameters (`parameters.py`): numbers, or symbols that stand for them.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from parflex.base.array import Array, without_roundoff
from parflex.base.unroll import solve_definite
from parflex.mechanics.flexures import Flexures
from parflex.mechanics.legs import LegGroup
from parflex.mechanics.link import Link
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.platform import Platform
from parflex.robot.beam import BeamBody
from parflex.robot.beam_section import BeamTables, beam_tables, with_numbers
from parflex.robot.body import FlexibleBody
from parflex.robot.leg import Joint
from parflex.robot.modal import diagonals, modal_mass, modal_masses
from parflex.robot.moments import Moments, with_point
from parflex.robot.parameters import OF_BEAM, OF_FLEXURE, OF_MODES, Parameter, Parameters, modal_values
from parflex.robot.robot import Robot

Values = Sequence[tuple[Parameter, Array]]  # parameters with their values (*shape)


def rebuilt(parameters: Parameters, theta: Array) -> Robot:
    """The robot as if it had been built with θ (P,).

    Raises InputError where it cannot be.
    """
    robot, values = parameters.first, parameters.split(theta)
    legs = []
    for i, leg in enumerate(robot.legs):
        joints = [changed_joint(joint, of_part(values, i, j, "")) for j, joint in enumerate(leg.joints)]
        tips = list(leg.tips)
        for t, tip in enumerate(tips):
            if tip.flexure is not None and (found := of_part(values, i, t, OF_FLEXURE)):
                tips[t] = replace(tip, flexure=replace(tip.flexure, **found))
        legs.append(replace(leg, joints=tuple(joints), tips=tuple(tips)))
    body = replace(robot.platform, **modal_changes(robot.platform, values))
    for item, value in values:
        if item.field == "payload" and value > 0:
            body = body.with_payload(item.number, float(value))
    return replace(robot, legs=tuple(legs), platform=body, **gravity_in(values))


def of_part(values: Values, leg: int, number: int, way: str) -> dict[str, Any]:
    """The values of a joint or a tip of a leg, by their names behind the way to them; a joint's own and its
    beam's where the way is empty."""
    mine = [(item.field, value) for item, value in values if leg in item.legs and item.number == number]
    if not way:
        return {field: value for field, value in mine if not field.startswith(OF_FLEXURE)}
    return {field.removeprefix(way): value for field, value in mine if field.startswith(way)}


def changed_joint(joint: Joint, values: dict[str, Any]) -> Joint:
    """A joint with other numbers, of its beam too."""
    of_beam = {key.removeprefix(OF_BEAM): values.pop(key) for key in list(values) if key.startswith(OF_BEAM)}
    if of_beam and isinstance(joint.body, BeamBody):
        values["body"] = with_numbers(joint.body, {key: float(value) for key, value in of_beam.items()})
    return replace(joint, **values)


def placed(parameters: Parameters, mechanism: Mechanism, theta: Array) -> Mechanism:
    """The mechanism with θ (P,) in its tables; nothing is checked, and geometry does not change."""
    values = parameters.split(theta)
    groups = tuple(retabled(group, parameters.first, values) for group in mechanism.groups)
    platform = laden(mechanism.platform, values)
    return replace(mechanism, groups=groups, platform=platform, **gravity_in(values))


def gravity_in(values: Values) -> dict[str, Any]:
    """Gravity, where it is among the values."""
    return {item.field: value for item, value in values if item.field == "gravity"}


def retabled(group: LegGroup, robot: Robot, values: Values) -> LegGroup:
    """A group of a robot's legs with values in its tables."""
    tables: dict[str, Any] = {}
    held = {} if group.flexures is None else group.flexures._asdict()
    for item, value in values:
        for leg in set(item.legs) & set(group.legs):
            field = item.field.removeprefix(OF_FLEXURE)
            if item.field.startswith(OF_BEAM):
                continue
            place = held if field != item.field else tables
            old = place[field] if field in place else getattr(group.chain, field)
            place[field] = with_entry(old, (group.legs.index(leg), item.number), value[()])
    chain = replace(group.chain.with_tables(tables), links=tuple(beamed(group, robot, values)))
    return group._replace(chain=chain, flexures=group.flexures and Flexures(**held))


def with_entry(table: Array, place: tuple[int, ...], value: Any) -> Array:
    """A table with another entry."""
    other = table.astype(np.result_type(table, np.asarray(value)))
    other[place] = value
    return other


def beamed(group: LegGroup, robot: Robot, values: Values) -> Iterator[Link | None]:
    """The flexible links of a group with other numbers of their beams."""
    for j, link in enumerate(group.chain.links):
        for place, leg in enumerate(group.legs):
            body, found = robot.legs[leg].joints[j].body, of_part(values, leg, j, OF_BEAM)
            if link is not None and isinstance(body, BeamBody) and found:
                numbers = {name: value[()] for name, value in found.items()}
                link = with_beam(link, place, beam_tables(body, numbers))
        yield link


def with_beam(link: Link, leg: int, tables: BeamTables) -> Link:
    """A link whose tables of one leg are other ones."""
    moments = [
        with_entry(np.asarray(old), (leg,), new)
        for old, new in zip(link.moments, tables.moments, strict=True)
    ]
    return link._replace(
        moments=Moments._make(moments),
        stiffness=with_entry(link.stiffness, (leg,), tables.stiffness),
        damping=with_entry(link.damping, (leg,), tables.damping),
        m_ee=with_entry(link.m_ee, (leg,), modal_mass(tables.moments)),
    )


def modal_changes(body: FlexibleBody, values: Values) -> dict[str, Any]:
    """Stiffness and damping, where frequencies or damping ratios are among the values."""
    given = {item.field: value for item, value in values if item.field in OF_MODES}
    if not given:
        return {}
    modal = dict(zip(OF_MODES, modal_values(body), strict=True)) | given
    stiffness, damping = diagonals(modal_masses(body.moments), *modal.values())
    return {"stiffness": stiffness, "damping": damping}


def laden(platform: Platform, values: Values) -> Platform:
    """A platform with values in its tables, and payloads on its nodes."""
    found = replace(platform, **modal_changes(platform.body, values))
    for item, value in values:
        if item.field == "payload":
            found = carrying(found, value[()], item.number)
    return found


def carrying(platform: Platform, mass: Any, node: int) -> Platform:
    """A platform with a point mass m on a node, where the displacement is u = Φᵀ q_e, Φ (N, 3).

    (m_ee + m Φ Φᵀ)⁻¹ = m_ee⁻¹ − Z (1 + m Φᵀ Z)⁻¹ m Zᵀ with Z = m_ee⁻¹ Φ, which has no difficulty where
    m is zero.
    """
    Phi = without_roundoff(platform.body.shapes)[:, node]
    Z = platform.modal_solve(Phi)
    held = np.eye(3) + mass * (Phi.T @ Z).reshape(1, 3, 3)

    def modal_solve(loads: Array) -> Array:
        free = platform.modal_solve(loads)
        return free - Z @ solve_definite(held, mass * (Phi.T @ free))

    return replace(
        platform,
        moments=with_point(platform.moments, mass, without_roundoff(platform.body.nodes)[node], Phi),
        m_ee=platform.m_ee + mass * (Phi @ Phi.T),
        m_ee_inverse=modal_solve(np.eye(platform.modes))[0],
        modal_solve=modal_solve,
    )
