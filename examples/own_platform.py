"""A platform of one's own: a long aluminium hexagon with a payload, on the paper's legs."""

import numpy as np

import parflex as pf
from parflex.views import plot

side = np.radians([-120, -60, 0, 60, 120, 180])
outline = 0.5 * np.stack([1.2 * np.cos(side), np.sin(side)], axis=-1)
modes = pf.fe.plate_modes(outline, thickness=0.02, material="aluminium", n_modes=9)
body = pf.FlexibleBody.from_modes(modes, damping_ratio=0.02).with_payload(node=0, mass=25.0)
robot = pf.robots.gough_stewart(platform=body)
model = pf.Model(robot)

state, forces = model.equilibrium(*robot.home_pose)
print("frequencies of the free plate (Hz):", np.round(modes.frequencies / (2 * np.pi), 1))
print("forces that hold it (N):", np.round(forces))
print(
    "deflection of its centre against Σp (mm):", round(1e3 * float(state.elastic @ body.shapes[:, 0, 2]), 3)
)

plot.mode_shapes(modes, columns=3).savefig("own_platform.png")
