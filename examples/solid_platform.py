"""A ribbed platform as a solid: a basis made for its joints, its error, and where it is stressed most."""

import numpy as np

import parflex as pf
from parflex.robots.gough_stewart import corners
from parflex.views import plot

joints = np.column_stack([corners(), np.zeros(6)])
bar = [(-0.4, -0.02), (0.4, -0.02), (0.4, 0.02), (-0.4, 0.02)]
mesh = pf.fe.outline_mesh(corners(), 0.012, holes=[(0.0, 0.2, 0.1)], ribs=[pf.fe.Rib(bar, 0.03)], size=0.06)
body = pf.fe.solid_body(mesh, "aluminium")
modes = pf.fe.modes(body, joints, tool=(0.0, -0.25, 0.006), radius=0.045)
print("frequencies (Hz):", np.round(modes.frequencies / (2 * np.pi)))
print(f"static compliance at joints and tool is right to {100 * modes.error.compliance.max():.2g} %,")
print(f"pinned frequencies to {100 * modes.error.pinned_error.max():.2g} %")

platform = pf.FlexibleBody.from_modes(modes, damping_ratio=0.01).with_payload(modes.tool, mass=40.0)
robot = pf.robots.gough_stewart(platform=platform)
state, forces = pf.Model(robot, "numpy").equilibrium(*robot.home_pose)
fields = pf.fe.recover(modes, state.elastic)
print("forces that hold it (N):", np.round(forces))
print(f"largest von Mises stress under its weight and 40 kg: {1e-6 * fields.mises.max():.2f} MPa")

plot.stress(modes, fields, "40 kg beside the rib").savefig("solid_platform.png")
