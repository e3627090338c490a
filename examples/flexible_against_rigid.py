"""What bending costs: actuator forces along one trajectory, with a flexible and a rigid plate."""

import numpy as np
from matplotlib.figure import Figure

import parflex as pf

MOVES = [((0.08, -0.06, 0.05), (0.08, 0.04, -0.06)), ((-0.06, 0.08, 0.04), (-0.06, 0.08, 0.06))]


def flown(modes: int) -> pf.Result:
    """The trajectory under computed torque, from the static equilibrium."""
    robot = pf.robots.gough_stewart(modes)
    model = pf.Model(robot)
    way = pf.Trajectory.through(robot.home, MOVES, duration=0.4, rest=(0.1, 0.2))
    start, _ = model.equilibrium(*robot.home_pose)
    control = pf.ComputedTorque(model, way)
    return pf.simulate(model, control, start, np.linspace(0, way.duration, 301))


flexible, rigid = flown(9).dataset, flown(0).dataset

fig = Figure(figsize=(7, 5), layout="constrained")
upper, lower = fig.subplots(2, 1, sharex=True)
for leg in flexible.actuator.values:
    line = upper.plot(flexible.time, flexible.forces.sel(actuator=leg), label=f"leg {leg}")
    upper.plot(rigid.time, rigid.forces.sel(actuator=leg), ":", color=line[0].get_color())
    lower.plot(flexible.time, (flexible.forces - rigid.forces).sel(actuator=leg))
upper.set_ylabel("actuator force (N)")
upper.set_title("Flexible plate (lines) and rigid plate (dots)")
upper.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
lower.set_ylabel("difference (N)")
lower.set_xlabel("time (s)")
fig.savefig("flexible_against_rigid.png")
