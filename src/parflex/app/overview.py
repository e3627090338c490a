"""A robot as it was understood, in words for a table."""

from typing import TYPE_CHECKING

import numpy as np

from parflex.base.spatial import vector_from_rotation
from parflex.mechanics.mechanism import mechanism_of
from parflex.robot.joint_words import joint_value
from parflex.robot.modal import free_vibration
from parflex.robot.robot import Robot
from parflex.robot.words import frequencies, listed, modal

if TYPE_CHECKING:
    from parflex.files.robot_file import RobotFile
    from parflex.model.model import Model
    from parflex.simulation.laws.choice import Choice
    from parflex.simulation.laws.verdict import Verdict

LEG_HEADS = ("leg", "chain", "joints", "inverse geometry", "base (m)", "holds attachments", "mass (kg)")
JOINT_HEADS = ("leg", "joint values at home", "limits")

LOWEST = 6  # frequencies that are told

Rows = list[tuple[str, ...]]


def leg_rows(file: "RobotFile") -> Rows:
    """The legs: chain, joints with a star where there is a motor, leg type, place, attachments, mass."""
    groups = mechanism_of(file.robot).groups
    kinds = {n: group.type.name if group.chain.n else "none" for group in groups for n in group.legs}
    rows: Rows = []
    for number, (leg, chain) in enumerate(zip(file.robot.legs, file.table.chains, strict=True)):
        held = ", ".join(str(tip.attachment) for tip in leg.tips)
        mass = sum(joint.mass for joint in leg.joints)
        rows.append(
            (str(number + 1), chain, leg.word, kinds[number], listed(leg.origin), held, f"{mass:.4g}")
        )
    return rows


def joint_rows(model: "Model") -> Rows:
    """The joints' values at home, and which of them are outside their limits.

    Raises OutOfReach and SingularPose where the home pose has none.
    """
    found = model.joints(model.robot.home).q
    rows: Rows = []
    for number, (leg, q) in enumerate(zip(model.robot.legs, found, strict=True)):
        values = ", ".join(joint_value(joint, value) for joint, value in zip(leg.joints, q, strict=True))
        beyond = [
            f"joint {j} at {joint_value(joint, value)} is beyond {joint_value(joint, joint.q_min)} … "
            f"{joint_value(joint, joint.q_max)}"
            for j, (joint, value) in enumerate(zip(leg.joints, q, strict=True), start=1)
            if not joint.q_min <= value <= joint.q_max
        ]
        rows.append((str(number + 1), values, "; ".join(beyond) or "kept"))
    return rows


def facts(file: "RobotFile") -> list[str]:
    """Platform, home pose and gravity, a line each."""
    robot, payload = file.robot, file.table.payload
    body, (position, rotation) = robot.platform, robot.home_pose
    carried = "" if payload is None else f" with its payload of {payload.mass:.4g} kg"
    mass, com = body.moments.m, body.moments.MS0 / body.moments.m
    turned = np.degrees(vector_from_rotation(np.asarray(rotation)))
    return [
        f"platform: {mass:.4g} kg{carried}, centre of mass {listed(com)} m, "
        f"{len(body.attachments)} attachments",
        f"modes: {frequencies(*free_vibration(body.moments, body.stiffness, body.damping))}",
        f"home: {listed(position)} m, turned by {listed(turned)} deg; gravity {listed(robot.gravity)} m/s²",
        f"motors: {robot.n_forces}",
        *bending_links(robot),
    ]


def bending_links(robot: Robot) -> list[str]:
    """A line on the links that bend, where there are any."""
    bodies = [joint.body for leg in robot.legs for joint in leg.joints if joint.body is not None]
    if not bodies:
        return []
    omega = np.concatenate([body.frequencies for body in bodies])
    return [f"links that bend: {len(bodies)}, {modal(omega)}, clamped at their joints"]


def swings(model: "Model") -> list[str]:
    """A line on the lowest frequencies about the equilibrium at home, none where nothing swings or it falls.

    They are those of the robot on its motors' springs, or, where motors have none, on locked motors.
    """
    from parflex.model.core import core_of
    from parflex.simulation.laws.verdict import decisive, grows

    motions = core_of(model).at_home
    sprung = all(joint.k for leg in model.robot.legs for joint in leg.joints if joint.mu)
    poles = motions.free_poles() if sprung else motions.locked_poles()
    hertz = np.sort(np.abs(poles[poles.imag > 1e-3 * np.abs(poles)])) / (2 * np.pi)
    if grows(decisive(poles)) or not len(hertz):
        return []
    how = "on its springs" if sprung else "on locked motors"
    return [f"swings at home, {how}: {', '.join(f'{each:.4g}' for each in hertz[:LOWEST])} Hz"]


def controls(model: "Model") -> "list[tuple[Choice, Verdict | None]]":
    """The default control of a robot and computed torque, each with the verdict on it at home."""
    from parflex.simulation.laws.choice import Choice, default_control, held_frame
    from parflex.simulation.moves import Hold
    from parflex.simulation.trajectory import Trajectory

    still = Trajectory.of(model.robot.home, [Hold(1.0)])
    found = default_control(model, still)
    others = [Choice(held_frame(model, still))] if not found.why else []
    return [(each, each.controller.verdict()) for each in (found, *others)]
