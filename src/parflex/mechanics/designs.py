"""A robot with other numbers: as if it had been built with them, or for the mechanics alone.

The values are those of named parameters (`parameters.py`): numbers, or symbols that stand for them.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from parflex.base.array import Array, without_roundoff
from parflex.base.unroll import solve_definite
from parflex.mechanics.legs import LegGroup
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.platform import Platform
from parflex.robot.body import FlexibleBody
from parflex.robot.modal import diagonals, modal_masses
from parflex.robot.moments import with_point
from parflex.robot.parameters import OF_MODES, Parameter, Parameters, modal_values
from parflex.robot.robot import Robot

Values = Sequence[tuple[Parameter, Array]]  # parameters with their values (*shape)


def rebuilt(parameters: Parameters, theta: Array) -> Robot:
    """The robot as if it had been built with θ (P,).

    Raises InputError where it cannot be.
    """
    robot, values = parameters.first, parameters.split(theta)
    changes: dict[tuple[int, int], dict[str, Any]] = {}
    for item, value in values:
        for i in item.legs:
            changes.setdefault((i, item.number), {})[item.field] = value
    legs = []
    for i, leg in enumerate(robot.legs):
        joints = (replace(joint, **changes.get((i, j), {})) for j, joint in enumerate(leg.joints))
        legs.append(replace(leg, joints=tuple(joints)))
    body = replace(robot.platform, **modal_changes(robot.platform, values))
    for item, value in values:
        if item.field == "payload" and value > 0:
            body = body.with_payload(item.number, float(value))
    return replace(robot, legs=tuple(legs), platform=body, **gravity_in(values))


def placed(parameters: Parameters, mechanism: Mechanism, theta: Array) -> Mechanism:
    """The mechanism with θ (P,) in its tables; nothing is checked, and geometry does not change."""
    values = parameters.split(theta)
    groups = tuple(retabled(group, values) for group in mechanism.groups)
    platform = laden(mechanism.platform, values)
    return replace(mechanism, groups=groups, platform=platform, **gravity_in(values))


def gravity_in(values: Values) -> dict[str, Any]:
    """Gravity, where it is among the values."""
    return {item.field: value for item, value in values if item.field == "gravity"}


def retabled(group: LegGroup, values: Values) -> LegGroup:
    """A group with values in its tables."""
    tables: dict[str, Any] = {}
    for item, value in values:
        for leg in set(item.legs) & set(group.legs):
            old = tables.get(item.field, getattr(group.chain, item.field))
            table = old.astype(np.result_type(old, value))
            table[group.legs.index(leg), item.number] = value[()]
            tables[item.field] = table
    return group._replace(chain=group.chain.with_tables(tables))


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
