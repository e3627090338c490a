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
from parflex.files.coupling_tables import coupling_entries
from parflex.files.flexure_tables import flexure_entries
from parflex.files.joint_table import joint_entries
from parflex.files.link_writing import LinkFiles
from parflex.files.platform_tables import rigid_table
from parflex.files.robot_schema import FORMAT
from parflex.robot.body import FlexibleBody
from parflex.robot.leg import Leg, Tip
from parflex.robot.robot import Robot

# arrays without strings and tables, which fit on a line
SPREAD = re.compile(r"\[\s+([-+.\w\s,\[\]]*?),\s+\](?=\n)")
PADDING = re.compile(r"(?<=\[) |,(?= ?\])| (?=\])")

Tables = dict[str, Any]


def save_robot(robot: Robot, path: str | os.PathLike[str]) -> Path:
    """Write a robot as TOML; a platform that is not rigid, and flexible links that are no beams, go to
    NetCDF-4 files beside it.

    Raises InputError where a file cannot be written.
    """
    target = Path(path)
    links = LinkFiles(target.stem)
    text = robot_text(robot, platform_entries(robot.platform, target), links)
    links.save(target.parent)
    with replacing(target) as part:
        part.write(text.encode())
    return target


def robot_text(robot: Robot, platform: Tables, links: LinkFiles | None = None) -> str:
    """The TOML of a robot with this table for its platform, and files of flexible links."""
    chains, legs = leg_tables(robot.legs, LinkFiles("robot") if links is None else links)
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


def platform_entries(body: FlexibleBody, target: Path) -> Tables:
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


def leg_tables(legs: Sequence[Leg], links: LinkFiles) -> tuple[Tables, list[Tables]]:
    """Chains by name, and the legs that use them; what is written alike is one chain."""
    chains: dict[str, Tables] = {}
    names: dict[str, str] = {}
    rows = []
    for leg in legs:
        chain = chain_entries(leg, links)
        name = names.setdefault(repr(chain), f"{leg.word.replace('*', '').lower()}-{len(names) + 1}")
        chains[name] = chain
        rows.append(leg_entries(leg, name))
    return chains, rows


def chain_entries(leg: Leg, links: LinkFiles) -> Tables:
    """Joints and tips; repr tells all floats apart, -0.0 from 0.0 too."""
    joints = [
        joint_entries(joint, before) | links.entries(joint.body) for before, joint in enumerate(leg.joints)
    ]
    row = {"joints": joints, "tips": [tip_entries(tip) for tip in leg.tips]}
    couplings = [coupling_entries(coupling) for coupling in leg.couplings]
    return row | {"couplings": couplings} if couplings else row


def tip_entries(tip: Tip) -> Tables:
    """The table of a tip."""
    row: Tables = {"frame": tip.frame, "offset": np.asarray(tip.offset).tolist()}
    return row if tip.flexure is None else row | {"flexure": flexure_entries(tip.flexure)}


def leg_entries(leg: Leg, chain: str) -> Tables:
    """The table of a leg: the name of its chain, its place and what it holds."""
    row: Tables = {"chain": chain, "attachments": [tip.attachment for tip in leg.tips]}
    row |= {"origin": np.asarray(leg.origin).tolist(), "rotation": np.asarray(leg.rotation).tolist()}
    return row if leg.posture is None else row | {"posture": np.asarray(leg.posture).tolist()}


def on_lines(text: str) -> str:
    """Each array of numbers on a line of its own."""
    return SPREAD.sub(lambda found: PADDING.sub("", " ".join(found[0].split())), text)
