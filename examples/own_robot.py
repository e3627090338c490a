"""A robot of one's own: a symmetric hexapod, pushed while computed torque holds it."""

import numpy as np
from scipy.spatial.transform import Rotation

import parflex as pf
from parflex.views import plot

CYLINDER = {"alpha": np.pi / 2, "M": 6.0, "MS": (0, -1.2, 0), "I": np.diag([0.4, 0.01, 0.4])}
ROD = {"alpha": np.pi / 2, "M": 3.0, "MS": (0, 0, -0.9), "I": np.diag([0.35, 0.35, 0.003]), "IA": 20.0}


def ups(origin: np.ndarray, turn: float, attachment: int) -> pf.Leg:
    """Universal joint at the base, actuated slider, spherical joint at the tip."""
    joints = (
        pf.Joint(0, sigma=0, alpha=-np.pi / 2),
        pf.Joint(1, sigma=0, **CYLINDER),
        pf.Joint(2, sigma=1, mu=1, **ROD),
    )
    rotation = Rotation.from_euler("z", turn).as_matrix()
    return pf.Leg(rotation, origin, joints, (pf.Tip(3, attachment=attachment),))


def ring(radius: float, degrees: list[float]) -> np.ndarray:
    """Points on a circle in the xy-plane."""
    angle = np.radians(degrees)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


platform_points = ring(0.3, [50, 70, 170, 190, 290, 310])
base_points = ring(0.5, [10, 110, 130, 230, 250, 350])
modes = pf.fe.plate_modes(platform_points, 0.012, 70e9, 0.33, 2700, n_modes=9)
body = pf.FlexibleBody.from_modes(modes, origin=(0, 0, 0), damping_ratio=0.01)
legs = [ups(np.append(b, 0.0), np.arctan2(b[1], b[0]), i) for i, b in enumerate(base_points)]
robot = pf.Robot(tuple(legs), body, home_pose=((0, 0, 0.6), np.eye(3)))
model = pf.Model(robot)

start, _ = model.equilibrium(*robot.home_pose)
stay = pf.Trajectory([robot.home.position] * 2, [np.eye(3)] * 2, [1.0], rest=(0, 0))
control = pf.ComputedTorque(model, stay, kp=15.0**2, kd=2 * 15.0)


def push(t: float) -> list[pf.Wrench]:
    """Half a sine of 80 N on the plate's first corner, 50 ms long; the controller does not know."""
    return [pf.Wrench(1, (0, 0, -80 * np.sin(np.pi * t / 0.05)))] if t < 0.05 else []


run = pf.simulate(model, control, start, np.linspace(0, 0.5, 501), wrenches=push)
print("largest pose error (m, rad):", float(abs(run.dataset.pose_error).max()))
plot.attachment_deformation(run).savefig("own_robot.png")
