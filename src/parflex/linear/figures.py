"""Figures of merit of a point of the platform: how much it gives, how stiff it is, and what of the floor
arrives there."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.check import of_type
from parflex.linear.inputs import BaseAcceleration, NodeWrench
from parflex.linear.outputs import FramePose, NodeMotion
from parflex.linear.point import moved_with
from parflex.linear.resolved import check_meant
from parflex.linear.response import frequencies, labelled, loss, parted
from parflex.linear.system import LinearModel, linear_model

if TYPE_CHECKING:
    import xarray as xr

Offset = tuple[float, float, float]
OfFrequency = Callable[..., "xr.DataArray"]


def compliance(lin: LinearModel, node: int, offset: Offset = (0.0, 0.0, 0.0)) -> OfFrequency:
    """The compliance of a node, or of a point fixed to it at `offset` (3,) m in Σp: a function of omega (w,).

    omega is in rad/s; the function gives a DataArray (output 6, input 6, omega), complex, m/N, rad/N, m/(N m)
    and rad/(N m), in the axes of the world, and takes `structural=` as `LinearModel.frf` does. It does not
    matter which inputs and outputs `lin` has; its controller counts. At omega = 0 it is the static one.

    Raises InputError for a node that there is not.
    """
    of_type("lin", lin, LinearModel)
    inputs, outputs = (NodeWrench(node, offset),), (NodeMotion(node, offset),)
    given = linear_model(lin.point, inputs, outputs, lin.feedback).frf
    return lambda omega, structural=0.0: given(omega, structural).rename("compliance")


def dynamic_stiffness(lin: LinearModel, node: int, offset: Offset = (0.0, 0.0, 0.0)) -> OfFrequency:
    """The dynamic stiffness of a point, the inverse of its `compliance` (6, 6), likewise a function of omega:
    N/m, N/rad, N m/m and N m/rad, wrench by displacement.

    Raises InputError for a node that there is not.
    """
    given = compliance(lin, node, offset)

    def stiffness(omega: ArrayLike, structural: float = 0.0) -> Any:
        found = given(omega, structural)
        inverse = np.moveaxis(np.linalg.inv(np.moveaxis(found.values, -1, 0)), 0, -1)
        labels = (
            found.input.values,
            found.output.values,
            found.input_units.values,
            found.output_units.values,
        )
        return labelled(inverse, found.omega.values, "dynamic_stiffness", *labels)

    return stiffness


def transmissibility(lin: LinearModel, node: int, offset: Offset = (0.0, 0.0, 0.0)) -> OfFrequency:
    """The part of the floor's motion that arrives at a point of the platform, as `compliance` names it: a
    function of omega (w,) rad/s.

    The function gives a DataArray (output 6, input 6, omega), complex: displacement and turn of the point in
    the world, by those of the base at Σ0's origin, both in the axes of the world; it takes `structural=`. Its
    controller holds the joints, which are relative to the base. At omega = 0 the robot goes with the base as
    gravity lets it, which leans as the base turns.

    Raises InputError for a node that there is not.
    """
    of_type("lin", lin, LinearModel)
    seen = NodeMotion(node, offset)
    system = linear_model(lin.point, (BaseAcceleration(),), (seen,), lin.feedback)
    carried = moved_with(seen.position(lin.point))

    def arrived(omega: ArrayLike, structural: float = 0.0) -> Any:
        w, eta = frequencies(omega), loss(structural)
        check_meant(system, w)
        by_value, by_turn, turns = parted(system, w, eta)
        found = carried[..., None] - w**2 * by_value + np.einsum("obw,br->orw", by_turn, turns)
        units = FramePose().units(lin.point.mechanism.robot)
        return labelled(found, w, "transmissibility", system.outputs, system.inputs, units, units)

    return arrived
