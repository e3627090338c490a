"""Checks of a result by itself: identities that its variables must fulfil."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import xarray as xr

from parflex.base.array import Array
from parflex.simulation import summary


class Check(NamedTuple):
    """A measured number, the bound it must keep, and in words how it was measured."""

    what: str
    how: str
    found: float
    bound: float
    units: str = ""

    @property
    def passed(self) -> bool:
        """True where the bound is kept; NaN keeps no bound."""
        return bool(self.found <= self.bound)


def checks_of(data: xr.Dataset) -> list[Check]:
    """Every check that the result has the variables for."""
    known = {*data, *data.attrs}
    return [check(data) for check, needed in ALL_CHECKS.items() if known.issuperset(needed)]


def came_to_its_end(data: xr.Dataset) -> Check:
    """The run was not stopped before its last instant."""
    stopped = str(data.attrs.get("stopped", ""))
    how = f"it stopped {stopped}" if stopped else "1 where it stopped before its last instant"
    return Check("the run came to its end", how, float(bool(stopped)), 0)


def strokes_kept(data: xr.Dataset) -> Check:
    """The joints stay within their limits."""
    beyond = str(data.attrs["beyond_limits"]).splitlines()
    how = "joints that were beyond their limits" + "".join(f"; {line}" for line in beyond)
    return Check("strokes and joint limits are kept", how, len(beyond), 0)


def forces_plausible(data: xr.Dataset) -> Check:
    """The actuators' forces are not far from what a rigid platform needs."""
    needed = data["rigid_forces"].values
    largest = float(np.max(np.abs(needed[np.isfinite(needed)]), initial=0.0))
    found = float(np.max(np.abs(data["forces"].values), initial=0.0))
    how = "largest actuator force over the largest that a platform which cannot bend needs on the same way"
    return Check("forces are plausible", how, found / largest if largest else 0.0, 10.0)


def all_finite(data: xr.Dataset) -> Check:
    """The state has no hole."""
    state = [name for name in ("position", "rotation", "twist", "elastic", "elastic_rate") if name in data]
    holes = sum(int(np.sum(~np.isfinite(data[name].values))) for name in state)
    return Check("numbers that are not finite", "in position, rotation, twist, elastic coordinates", holes, 0)


def balanced(data: xr.Dataset) -> Check:
    """Energies and works, integrated beside the motion, add up."""
    [fact] = summary.balance(data)
    how = "stored energy + dissipation − work of actuators and wrenches, over the largest change of a term"
    return Check("energy balance", how, fact.value, 1e-6)


def rotations_orthonormal(data: xr.Dataset) -> Check:
    """Rotations are rotations_orthonormal: RᵀR = 1."""
    R = data["rotation"].values
    found = float(np.max(np.abs(np.swapaxes(R, -1, -2) @ R - np.eye(3))))
    return Check("rotation matrices", "largest entry of RᵀR − 1", found, 1e-9)


def legs_closed(data: xr.Dataset) -> Check:
    """The legs, by their joints, end where the platform, by its pose and its bending, is held."""
    ends = data["leg_path"].values[:, :, -1]
    held = data["attachment_position"].values[:, data["path_attachment"].values - 1]
    found = float(np.max(np.linalg.norm(ends - held, axis=-1), initial=0.0))
    how = "largest distance of a leg's tip, by its joints, from its attachment on the bent platform"
    return Check("legs hold the platform", how, found, 1e-6 * size(data), "m")


def body_fixed(data: xr.Dataset) -> Check:
    """Attachments less their deformation do not move in the platform."""
    away = data["attachment_position"].values - data["position"].values[:, None]
    inside = np.einsum("tij,tki->tkj", data["rotation"].values, away) - data["attachment_deformation"].values
    found = float(np.max(np.abs(inside - inside[0]), initial=0.0))
    how = "largest motion, in the platform's frame, of an attachment less its deformation"
    return Check("pose and deformation agree", how, found, 1e-9 * size(data), "m")


def bent_little(data: xr.Dataset) -> Check:
    """The deformation is small against the platform, as linear elasticity wants it."""
    bend = np.linalg.norm(data["attachment_deformation"].values, axis=-1)
    found = float(np.max(bend, initial=0.0)) / size(data)
    how = "largest deformation at an attachment over the platform's size; modes are of a linear platform"
    return Check("deformation is small", how, found, 0.1)


def size(data: xr.Dataset) -> float:
    """The longest side of the box about the platform's attachments, m."""
    places: Array = data["attachment_position"].values[0]
    return float(np.max(np.ptp(places, axis=0), initial=0.0)) or 1.0


ALL_CHECKS: dict[Callable[[xr.Dataset], Check], tuple[str, ...]] = {
    came_to_its_end: (),
    strokes_kept: ("beyond_limits",),
    all_finite: ("position",),
    rotations_orthonormal: ("rotation",),
    legs_closed: ("leg_path", "path_attachment", "attachment_position"),
    body_fixed: ("attachment_position", "attachment_deformation", "position", "rotation"),
    balanced: ("energy_residual",),
    forces_plausible: ("forces", "rigid_forces"),
    bent_little: ("attachment_deformation", "attachment_position"),
}
