"""The legs: their joints, and what a picture of them needs."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from parflex.base.array import Array
from parflex.kernels.moved_rests import REST
from parflex.mechanics.paths import deformation
from parflex.robot.leg import Leg
from parflex.simulation.variables.recorded import Recorded
from parflex.simulation.variables.variable import Variable


def side_by_side(values: Sequence[Array], count: int) -> Array:
    """One (T, n_i) per leg as (T, legs, n); not a number where a leg has fewer joints than others."""
    width = max((q.shape[-1] for q in values), default=0)
    padded = [np.pad(q, ((0, 0), (0, width - q.shape[-1])), constant_values=np.nan) for q in values]
    return np.stack(padded, axis=1) if padded else np.zeros((count, 0, 0))


def spring_rests(run: Recorded) -> Array | None:
    """(T, s); None where they do not move."""
    rest = run.replay.imposed.get(REST)
    return None if rest is None else rest[:, : rest.shape[1] // 2]


def of_flexible(values: Callable[[Recorded], Array]) -> Callable[[Recorded], Array | None]:
    """The function of a run that gives a function of the legs' bending, where links are flexible."""

    def of(run: Recorded) -> Array | None:
        return values(run) if any(run.mechanism.layout.elastic) else None

    return of


def links_of_modes(run: Recorded) -> Array:
    """(legs, N) the link of each elastic coordinate, or the joint whose drive gives, from 1."""
    of_links = [np.repeat(np.arange(1, len(leg.joints) + 1), leg.modes) for leg in run.robot.legs]
    drives = [np.array(leg.drives, dtype=int) + 1 for leg in run.robot.legs]
    return rows_of([np.concatenate(both) for both in zip(of_links, drives, strict=True)])


def drives(run: Recorded) -> Array:
    """(legs, N), 1 for the deflection of a drive and 0 for a mode of a link."""
    return rows_of([np.repeat([0, 1], [sum(leg.modes), len(leg.drives)]) for leg in run.robot.legs])


def frequencies(run: Recorded) -> Array:
    """(legs, N) rad/s."""
    return rows_of([np.array(list(frequencies_of(leg))) for leg in run.robot.legs])


def frequencies_of(leg: Leg) -> Iterator[float]:
    """rad/s: of links that are clamped at their joint and free, and of rotors on their drives alone."""
    for body in (joint.body for joint in leg.joints if joint.body is not None):
        yield from body.frequencies
    for joint in (leg.joints[j] for j in leg.drives):
        yield float(np.sqrt((joint.drive_stiffness or 0.0) / joint.IA))


def rows_of(legs: Sequence[Array]) -> Array:
    """One (N_i,) per leg as (legs, N); 0 where a leg has fewer."""
    width = max(len(row) for row in legs)
    return np.stack([np.pad(row, (0, width - len(row))) for row in legs])


def stations(run: Recorded) -> Array:
    """The kinds of the points of each leg (paths, stations)."""
    return np.array(run.paths.stations, dtype=str).reshape(run.paths.points.shape[-3:-1])


def numbers_from_one(values: Sequence[int]) -> Array:
    """Numbers from 0 as numbers from 1."""
    return np.array(values, dtype=int) + 1


LEG_VARIABLES = (
    Variable(
        "joint",
        ("time", "leg", "joint_number"),
        "m, rad",
        "joint positions",
        lambda run: side_by_side(run.joints.q, len(run.t)),
    ),
    Variable(
        "joint_rate",
        ("time", "leg", "joint_number"),
        "m s-1, rad s-1",
        "joint rates",
        lambda run: side_by_side(run.joints.qd, len(run.t)),
    ),
    Variable(
        "spring_rest",
        ("time", "spring"),
        "m, rad",
        "rests of the springs of joints, in the order of robot.springs",
        spring_rests,
    ),
    Variable(
        "leg_elastic",
        ("time", "leg", "leg_mode"),
        "kg0.5 m",
        "elastic coordinates of the legs, link by link, then deflections of drives, which are in m or rad",
        of_flexible(lambda run: side_by_side(run.leg_elastic[0], len(run.t))),
    ),
    Variable(
        "leg_elastic_rate",
        ("time", "leg", "leg_mode"),
        "kg0.5 m s-1",
        "elastic rates of the legs",
        of_flexible(lambda run: side_by_side(run.leg_elastic[1], len(run.t))),
    ),
    Variable(
        "leg_mode_link",
        ("leg", "leg_mode"),
        "1",
        "link of the elastic coordinate, or joint of the drive, from 1; 0 where a leg has fewer of them",
        of_flexible(links_of_modes),
    ),
    Variable(
        "leg_mode_drive",
        ("leg", "leg_mode"),
        "1",
        "1 where the coordinate is the deflection of a drive, 0 where it is a mode of a link",
        of_flexible(drives),
    ),
    Variable(
        "leg_frequency",
        ("leg", "leg_mode"),
        "rad s-1",
        "natural frequency of the link, clamped at its joint and free, or of a rotor on its drive alone; 0 "
        "where a leg has fewer",
        of_flexible(frequencies),
    ),
    Variable(
        "leg_path",
        ("time", "path", "station", "axis"),
        "m",
        "points of the legs in the world, from base through the joints, along bent links, to a tip",
        lambda run: run.paths.points,
        missed="the legs' points",
        pictured=True,
    ),
    Variable(
        "leg_deformation",
        ("time", "path", "station", "axis"),
        "m",
        "displacement of these points by the bending of links and platform, in the world",
        of_flexible(lambda run: deformation(run.system, run.paths)),
    ),
    Variable(
        "leg_axis",
        ("time", "path", "station", "axis"),
        "1",
        "axes of the joints in the world; zero at base and tip",
        lambda run: run.paths.axes,
        missed="the joints' axes",
    ),
    Variable(
        "leg_station",
        ("path", "station"),
        "1",
        "base, R or P for a joint, with a star where there is a motor, link between joints, or tip",
        stations,
        missed="the kinds of the joints",
        text=True,
    ),
    Variable(
        "path_leg",
        ("path",),
        "1",
        "leg of the path",
        lambda run: numbers_from_one(run.paths.legs),
        missed="whose the legs' points are",
        pictured=True,
        numbers=("leg", 1),
    ),
    Variable(
        "path_attachment",
        ("path",),
        "1",
        "attachment where the path ends",
        lambda run: numbers_from_one(run.paths.attachments),
        missed="what the legs hold",
        pictured=True,
        numbers=("attachment", 1),
    ),
    Variable(
        "motor_position",
        ("time", "motor", "axis"),
        "m",
        "actuated joints in the world, those of equal legs side by side",
        lambda run: run.paths.motors,
        pictured=True,
    ),
)
