"""The equilibrium of a robot whose legs bend: platform and legs sag until all forces balance."""

import numpy as np

from parflex.analysis.settling import settled
from parflex.analysis.static_legs import bent_legs, elastic_entries
from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.compiled.functions import Functions
from parflex.kernels import models


def sagging(functions: Functions, start: Array) -> tuple[Array, Array]:
    """The flat state (size,) at rest in the pose of one, and the actuator forces (m,) that hold it.

    Raises InputError for a mode without stiffness, NotConverged where no such bend is found.
    """
    mechanism, function = functions.mechanism, functions(models.sag)
    platform, bends = mechanism.platform, elastic_entries(mechanism)
    if not np.all(platform.stiffness > 0):
        raise InputError("a mode has zero frequency; without stiffness there is no equilibrium")
    modes, elastic = platform.modes, mechanism.layout.at.elastic
    own = np.concatenate([np.arange(modes), modes + bends])

    def place(y: Array) -> Array:
        x = np.array(np.broadcast_to(start, y.shape[:-1] + start.shape))
        x[..., elastic] = y[..., :modes]
        return bent_legs(mechanism, x, y[..., modes:])

    def excess(y: Array) -> Array:
        with np.errstate(invalid="ignore", divide="ignore"):
            return function(x=place(y))["excess"][..., own]

    roots = [np.full(modes, np.sqrt(platform.body.moments.m)), mechanism.roots[mechanism.kept][bends]]
    y = settled(excess, np.zeros(len(own)), mechanism.size * np.concatenate(roots))
    x = place(y)
    return x, function(x=x)["forces"]
