"""The reference cases of `data/`: a 6-RUS, a 3-RPS and a Delta, rigid, flexible, and without stiffness.

`data/README.md` describes the files. 'nostiff' has the states and forces of 'flex' with K = D = 0, so that
inertial and velocity terms are not hidden by the stiffness.
"""

import json
from collections.abc import Mapping
from functools import cache

import numpy as np

import oracle
import parflex as pf
from places import DATA
from sample import FIELDS, Sample

NAMES = ("rus6", "rps3", "delta3")
KINDS = ("rigid", "flex", "nostiff")

JOINT = ("antecedent", "sigma", "mu", "gamma", "b", "alpha", "d", "theta", "r", "IA", "Fv", "Fs")


@cache
def table(name: str) -> dict:
    """The robot as JSON."""
    return json.loads((DATA / f"{name}.json").read_text())


@cache
def arrays(name: str, kind: str) -> Mapping[str, np.ndarray]:
    """The stored arrays of a case; what 'nostiff' has of its own bears the names of 'flex'.

    `nostiff_platform` answers as `direct_platform`, `nostiff_inverse_forces` as `inverse_forces`, …
    """
    found = dict(np.load(DATA / f"{name}_{'rigid' if kind == 'rigid' else 'flex'}.npz"))
    own = {key.removeprefix("nostiff_"): found.pop(key) for key in list(found) if key.startswith("nostiff_")}
    if kind != "nostiff":
        return found
    answers = ("direct_", "inverse_", "static_", "platform_c", "potential_")
    kept = {k: v for k, v in found.items() if not k.startswith(answers) or k == "inverse_target"}
    return kept | {k if k.startswith("inverse_") else f"direct_{k}": v for k, v in own.items()}


@cache
def trajectory(name: str, kind: str) -> Mapping[str, np.ndarray]:
    """The stored run of half a second."""
    return dict(np.load(DATA / f"{name}_{kind}_trajectory.npz"))


@cache
def case(name: str, kind: str) -> Sample:
    """A case as a sample; `arrays` has what to expect."""
    data, stored = table(name), arrays(name, kind)
    body, cloud = platform(name, kind)
    return Sample(
        legs=tuple(leg(row, q) for row, q in zip(data["legs"], data["home"]["q"], strict=True)),
        body=body,
        cloud=cloud,
        gravity=np.array(data["gravity"]),
        home_pose=(np.array(data["home"]["position"]), np.array(data["home"]["rotation"])),
        platform=pf.State(*(stored[field] for field in FIELDS)),
        q=list(np.moveaxis(stored["q"], 1, 0)),
        qd=list(np.moveaxis(stored["qd"], 1, 0)),
        forces=stored["forces"],
        target=stored["inverse_target"],
        rows=tuple(int(row) for row in np.argmax(stored["S_o"], axis=1)),
    )


def leg(row: dict, posture: list[float]) -> pf.Leg:
    """A leg from its JSON table."""
    joints = [pf.Joint(**{field: j[field] for field in JOINT}, **j["link"]) for j in row["joints"]]
    tips = [pf.Tip(**tip) for tip in row["tips"]]
    return pf.Leg(row["base"]["rotation"], row["base"]["origin"], joints, tips, posture=posture)


def platform(name: str, kind: str) -> tuple[pf.FlexibleBody, oracle.NodalPlatform]:
    """The platform for the library and for the oracle, which takes its nodes where it is rigid, too."""
    nodes = arrays(name, "flex")
    modes = 0 if kind == "rigid" else len(nodes["frequencies"])
    given = (
        nodes["node_positions"],
        nodes["node_masses"],
        nodes["shapes"][:modes],
        nodes["frequencies"][:modes] * (kind != "nostiff"),
        nodes["damping_ratio"],
        nodes["attachment_nodes"],
    )
    cloud = oracle.nodal_platform(*given)
    if kind == "rigid":
        rigid = table(name)["platform"]["rigid"]
        fields = ("mass", "com", "inertia_com", "attachments")
        return pf.FlexibleBody.rigid(*(rigid[field] for field in fields)), cloud
    return pf.FlexibleBody.from_nodes(*given), cloud
