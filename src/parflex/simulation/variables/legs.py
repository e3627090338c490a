"""The legs: their joints, and what a picture of them needs."""

from collections.abc import Sequence

import numpy as np

from parflex.base.array import Array
from parflex.simulation.variables.recorded import Recorded
from parflex.simulation.variables.variable import Variable


def side_by_side(values: Sequence[Array], count: int) -> Array:
    """One (T, n_i) per leg as (T, legs, n); not a number where a leg has fewer joints than others."""
    width = max((q.shape[-1] for q in values), default=0)
    padded = [np.pad(q, ((0, 0), (0, width - q.shape[-1])), constant_values=np.nan) for q in values]
    return np.stack(padded, axis=1) if padded else np.zeros((count, 0, 0))


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
        "leg_path",
        ("time", "path", "station", "axis"),
        "m",
        "points of the legs in the world, from base through the joints to a tip",
        lambda run: run.paths.points,
        missed="the legs' points",
        pictured=True,
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
        "base, R or P for a joint, with a star where there is a motor, or tip",
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
