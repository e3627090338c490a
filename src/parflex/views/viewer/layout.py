"""What the variables of a result must be like to be shown."""

import numpy as np
import xarray as xr

MOVING = ("time", "axis")
ALONG = ("time", "path", "station", "axis")
HELD = ("time", "attachment", "axis")
SIX = ("time", "component")

LAYOUT = {
    "time": ("time",),
    "position": MOVING,
    "rotation": ("time", "axis", "platform_axis"),
    "twist": SIX,
    "elastic": ("time", "mode"),
    "elastic_rate": ("time", "mode"),
    "forces": ("time", "actuator"),
    "actuator_name": ("actuator",),
    "acceleration": SIX,
    "acceleration_error": SIX,
    "pose_error": SIX,
    "origin_deformation": SIX,
    "contact_forces": HELD,
    "attachment_position": HELD,
    "attachment_deformation": HELD,
    "motor_position": ("time", "motor", "axis"),
    "leg_path": ALONG,
    "leg_axis": ALONG,
    "leg_station": ("path", "station"),
    "path_leg": ("path",),
    "path_attachment": ("path",),
    "platform_node": ("node", "axis"),
    "platform_shape": ("mode", "node", "axis"),
    "platform_triangle": ("triangle", "corner"),
    "frequency": ("mode",),
    "damping_ratio": ("mode",),
} | {
    f"energy_{name}": ("time",)
    for name in (
        "kinetic", "gravity", "strain", "springs", "dissipated", "actuators", "wrenches", "residual",
    )
}  # fmt: skip
THREE = ("axis", "platform_axis", "corner")
WORDS = ("leg_station", "actuator_name")  # not numbers
POINTERS = {  # into what, and from which number on
    "platform_triangle": ("node", 0),
    "path_attachment": ("attachment", 1),
    "path_leg": ("leg", 1),
}


def misfits(data: xr.Dataset) -> list[str]:
    """The variables that are not what their names say: of other dimensions, no numbers, pointing nowhere."""
    return [name for name, dims in LAYOUT.items() if name in data and not fits(data, name, dims)]


def fits(data: xr.Dataset, name: str, dims: tuple[str, ...]) -> bool:
    """Whether a variable has its dimensions, three entries where it must, and numbers in its range."""
    variable = data[name]
    if variable.dims != dims or any(data.sizes[dim] != 3 for dim in dims if dim in THREE):
        return False
    if name in WORDS:
        return variable.dtype.kind not in "iufc"
    if name in POINTERS:
        target, first = POINTERS[name]
        if variable.dtype.kind not in "iu":
            return False
        return bool(np.all((variable >= first) & (variable < data.sizes.get(target, 0) + first)))
    changes = dims[0] == "time" and name != "time"  # holes are told, and those instants left out
    return variable.dtype.kind in "iuf" and (changes or bool(np.all(np.isfinite(variable))))
