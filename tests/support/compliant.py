"""Robots whose motors drive through a compliance."""

from dataclasses import replace


def compliant(robot, legs=None, **drive):
    """The robot whose motors drive through a compliance, in all legs or some, with friction and springs."""
    drive = {"drive_stiffness": 3e4, "drive_damping": 20.0, "k": 500.0, "q_0": 0.1, "Fv": 3.0} | drive
    drive |= {"Fs": 2.0, "v_s": 0.1}
    found = []
    for i, leg in enumerate(robot.legs):
        mine = legs is None or i in legs
        joints = [replace(j, IA=max(j.IA, 2.0), **drive) if j.mu and mine else j for j in leg.joints]
        found.append(replace(leg, joints=tuple(joints)))
    return replace(robot, legs=tuple(found))
