"""Pictures of results and modes. They compute nothing: labels and units come from the data."""

from parflex.views.plot.canvas import drawn, figure, save
from parflex.views.plot.cutting import lobes
from parflex.views.plot.loci import nyquist
from parflex.views.plot.pole_map import poles
from parflex.views.plot.responses import bode
from parflex.views.plot.robot import robot_at
from parflex.views.plot.runs import (
    accelerations,
    actuator_forces,
    attachment_deformation,
    base_motion,
    energy,
    leg_deformation,
    origin_deformation,
    over_time,
)
from parflex.views.plot.sagging import sag
from parflex.views.plot.shapes import frequency_table, mode_shapes, shapes_of, stress
from parflex.views.plot.spectra import power_spectrum

__all__ = [
    "accelerations",
    "actuator_forces",
    "attachment_deformation",
    "base_motion",
    "bode",
    "drawn",
    "energy",
    "figure",
    "frequency_table",
    "leg_deformation",
    "lobes",
    "mode_shapes",
    "nyquist",
    "origin_deformation",
    "over_time",
    "poles",
    "power_spectrum",
    "robot_at",
    "sag",
    "save",
    "shapes_of",
    "stress",
]
