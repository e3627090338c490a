"""Robots to files: every number to the last bit, legs of one kind told once."""

import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from parflex.base.writing import replacing
from parflex.fe.modal_file import save_body
from parflex.files.leg_schema import Prismatic, Revolute
from parflex.files.leg_tables import NUMBERS
from parflex.files.platform_tables import rigid_table
from parflex.files.robot_schema import FORMAT
from parflex.robot.body import FlexibleBody
from parflex.robot.leg import Joint, Leg
from parflex.robot.robot import Robot

ALL_TYPES = {table.sigma: table for table in (Revolute, Prismatic)}
# arrays without strings and tables, which fit on a line
SPREAD = re.compile(r"\[\s+([-+.\w\s,\[\]]*?),\s+\](?=\n)")
PADDING = re.compile(r"(?<=\[) |,(?= ?\])| (?=\])")

Tables = dict[str, Any]


def save_robot(robot: Robot, path: str | os.PathLike[str]) -> Path:
    """Write a robot as TOML; a platform that is not rigid goes to a NetCDF-4 file beside it.

    Raises InputError where a file cannot be written.
    """
    target = Path(path)
    text = robot_text(robot, platform_of(robot.platform, target))
    with replacing(target) as part:
        part.write_text(text, encoding="utf-8")
    return target


def robot_text(robot: Robot, platform: Tables) -> str:
    """The TOML of a robot with this table for its platform."""
    chains, legs = legs_of(robot.legs)
    position, rotation = (np.asarray(part, dtype=float).tolist() for part in robot.home_pose)
    tables = {
        "format": FORMAT,
        "gravity": np.asarray(robot.gravity).tolist(),
        "home": {"position": position, "rotation": rotation},
        "platform": platform,
        "chain": chains,
        "leg": legs,
    }
    return on_lines(tomli_w.dumps(tables))


def platform_of(body: FlexibleBody, target: Path) -> Tables:
    """The platform's table; its file is written where it needs one."""
    table = rigid_table(body)
    if table is None:
        file = target.with_name(f"{target.stem}.platform.nc")
        save_body(body, file)
        table = modal_table(file.name)
    return table


def modal_table(file: str) -> Tables:
    """The table of a platform whose body is in a file beside."""
    return {"kind": "modal", "file": file}


def legs_of(legs: Sequence[Leg]) -> tuple[Tables, list[Tables]]:
    """Chains by name, and the legs that use them; what is written alike is one chain."""
    chains: dict[str, Tables] = {}
    names: dict[str, str] = {}
    rows = []
    for leg in legs:
        chain = chain_of(leg)
        name = names.setdefault(repr(chain), f"{leg.word.replace('*', '').lower()}-{len(names) + 1}")
        chains[name] = chain
        rows.append(leg_of(leg, name))
    return chains, rows


def chain_of(leg: Leg) -> Tables:
    """Joints and tips; repr tells all floats apart, -0.0 from 0.0 too."""
    tips = [{"frame": tip.frame, "offset": np.asarray(tip.offset).tolist()} for tip in leg.tips]
    return {"joints": [joint_of(joint, before) for before, joint in enumerate(leg.joints)], "tips": tips}


def leg_of(leg: Leg, chain: str) -> Tables:
    """Where a chain stands, and what it holds."""
    row: Tables = {"chain": chain, "attachments": [tip.attachment for tip in leg.tips]}
    row |= {"origin": np.asarray(leg.origin).tolist(), "rotation": np.asarray(leg.rotation).tolist()}
    return row if leg.posture is None else row | {"posture": np.asarray(leg.posture).tolist()}


def joint_of(joint: Joint, before: int) -> Tables:
    """A joint without what is as the file format has it by default."""
    kind = ALL_TYPES[joint.sigma]
    limits = {"min": float(joint.q_min), "max": float(joint.q_max)}
    values = {
        "actuated": bool(joint.mu),
        **{field: getattr(joint, symbol) for field, symbol in NUMBERS.items()},
        "first_moment": np.asarray(joint.MS).tolist(),
        "inertia": inertia_of(np.asarray(joint.I)),
        **{name: limit for name, limit in limits.items() if np.isfinite(limit)},
    }
    usual = {name: field.default for name, field in kind.model_fields.items()}
    usual |= {"first_moment": [0.0, 0.0, 0.0]}
    own = {name: value for name, value in values.items() if repr(value) != repr(usual[name])}
    name = {0: "revolute", 1: "prismatic"}[joint.sigma]
    far = {} if joint.antecedent == before else {"antecedent": joint.antecedent}
    return {"type": name, **far, **own}


def inertia_of(matrix: Any) -> list[Any]:
    """Six numbers, or the matrix where it is symmetric to round-off only."""
    if repr(matrix.tolist()) != repr(matrix.T.tolist()):
        return list(matrix.tolist())
    return [float(matrix[at]) for at in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]


def on_lines(text: str) -> str:
    """Each array of numbers on a line of its own."""
    return SPREAD.sub(lambda found: PADDING.sub("", " ".join(found[0].split())), text)
