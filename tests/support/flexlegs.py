"""The reference robots with flexible legs of `data/`: states, and answers of a program that shares nothing
with this library (`data/README.md`)."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
from scipy.spatial.transform import Rotation

import parflex as pf
from places import DATA

NAMES = ("gs_flexlegs", "delta_flexarms_foreshortening")


@cache
def arrays(name: str) -> Mapping[str, np.ndarray]:
    """The stored arrays of a case."""
    with np.load(DATA / f"{name}.npz") as file:
        return {key: file[key] for key in file.files}


def links(name: str) -> int:
    """The number of links of each leg."""
    return sum(key.endswith("_mdh") for key in arrays(name))


def body(name: str, j: int) -> pf.FlexibleBody | None:
    """The flexible link j, from 1; None where it is rigid."""
    a = arrays(name)
    if f"link{j}_shapes" not in a:
        return None
    part = {key: a[f"link{j}_{key}"] for key in ("node_positions", "node_masses", "shapes", "frequencies")}
    return pf.FlexibleBody.from_nodes(
        *part.values(),
        a[f"link{j}_damping_ratio"],
        [int(node) for node in a[f"link{j}_interface_nodes"]],
        a[f"link{j}_rotation_shapes"],
        foreshortening=a.get(f"link{j}_foreshortening"),
    )


def joint(name: str, j: int, bends: bool = True) -> pf.Joint:
    """Joint j of every leg, from 1, with its link, which may be as rigid as if it could not bend."""
    a = arrays(name)
    antecedent, sigma, mu, *rest = a[f"link{j}_mdh"]
    given = dict(zip(("gamma", "b", "alpha", "d", "theta", "r", "IA", "k", "q_0"), rest, strict=True))
    link = body(name, j) if bends else None
    if link is not None:
        given["body"] = link
    else:
        r, dm = a[f"link{j}_node_positions"], a[f"link{j}_node_masses"]
        second = np.einsum("k,ka,kb->ab", dm, r, r)
        given |= {"M": dm.sum(), "MS": dm @ r, "I": np.trace(second) * np.eye(3) - second}
    return pf.Joint(int(antecedent), int(sigma), int(mu), **given)


@cache
def robot(name: str) -> pf.Robot:
    """The robot."""
    a = arrays(name)
    joints = tuple(joint(name, j) for j in range(1, links(name) + 1))
    legs = []
    for i, attachments in enumerate(a["attachments_of_leg"]):
        flexure = None
        if "tip_K" in a:
            flexure = pf.Flexure(a["tip_K"][i], a["tip_D"][i], rest=a["tip_rest"][i])
        tips = [
            pf.Tip(int(frame), a[f"link{int(frame)}_node_positions"][node], int(attachment), flexure)
            for (frame, node), attachment in zip(a["tips"], attachments, strict=True)
        ]
        posture = a["home_joints"][i] if "home_joints" in a else None
        legs.append(pf.Leg(a["base_rotation"][i], a["base_origin"][i], joints, tips, posture))
    names = ("node_positions", "node_masses", "shapes", "frequencies", "damping_ratio", "attachment_nodes")
    platform = pf.FlexibleBody.from_nodes(
        *(a[f"platform_{name}"] for name in names), a["platform_rotation_shapes"]
    )
    home = (
        ("static_position", "static_rotation")
        if "static_position" in a
        else ("home_position", "home_rotation")
    )
    return pf.Robot(legs, platform, a["gravity"], tuple(a[key] for key in home))


@cache
def mixed(name: str) -> pf.Robot:
    """The robot with a leg as it is, next a rigid one, and last a flexible one that carries its joints, as
    its last link is turned about its axis; other legs as they are. Flexures with friction hold the first and
    the last leg, and of more than three legs the last but one."""
    whole, a = robot(name), arrays(name)
    *first, last = whole.legs[-1].joints
    carried = (*first, replace(last, theta=last.theta + 0.3))
    posture = np.array(a["home_joints" if "home_joints" in a else "static_joints"])[-1]
    if not last.sigma:
        posture[-1] -= 0.3
    K = np.array([[0.9, 0.1, 0.0], [0.1, 0.7, 0.02], [0.0, 0.02, 0.1]])
    flexure = pf.Flexure(
        K, 0.02 * K, 0.02, 3.0, rest=Rotation.from_euler("xyz", [0.3, -0.2, 0.5]).as_matrix()
    )
    rigid = tuple(joint(name, j, bends=False) for j in range(1, links(name) + 1))
    legs = list(whole.legs)
    legs[1] = replace(legs[1], joints=rigid)
    legs[-1] = replace(legs[-1], joints=carried, posture=posture)
    held = {0, len(legs) - 1} | ({len(legs) - 2} if len(legs) > 3 else set())
    for i, leg in enumerate(legs):
        tips = tuple(replace(tip, flexure=flexure if i in held else None) for tip in leg.tips)
        legs[i] = replace(leg, tips=tips)
    return replace(whole, legs=tuple(legs))


def moving(robot: pf.Robot, seed: int) -> pf.State:
    """A state on the closure of a robot near home, bent and in motion."""
    rng, home = np.random.default_rng(seed), robot.home
    model = pf.Model(robot, "numpy")
    bodies = [[j.body for j in leg.joints if j.body is not None] for leg in robot.legs]
    drives = [np.full(len(leg.drives), 0.02) for leg in robot.legs]
    soft = [
        np.concatenate([*(1 / body.frequencies for body in leg), own])
        for leg, own in zip(bodies, drives, strict=True)
    ]
    (elastic, *bend), (elastic_rate, *rates) = (
        [
            scale * part**power * rng.normal(size=part.shape)
            for part in (1 / robot.platform.frequencies, *soft)
        ]
        for scale, power in ((20.0, 2), (1.0, 1))
    )
    near = pf.State(
        home.position + 0.02 * rng.normal(size=3),
        home.rotation @ Rotation.from_rotvec(0.05 * rng.normal(size=3)).as_matrix(),
        0.3 * rng.normal(size=6),
        elastic,
        elastic_rate,
        leg_elastic=tuple(bend),
        leg_elastic_rate=tuple(rates),
    )
    return model.project(near)


def states(name: str) -> pf.State:
    """The states, with all joints."""
    a = arrays(name)
    legs = (
        tuple(np.moveaxis(a[key], 1, 0))
        for key in ("joints", "joint_rates", "leg_elastic", "leg_elastic_rate")
    )
    return pf.State(*(a[key] for key in ("position", "rotation", "twist", "elastic", "elastic_rate")), *legs)
