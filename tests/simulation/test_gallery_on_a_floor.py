"""Every robot of the gallery under every law, on a floor that shakes and with rests that move: the balance of
energy, and results that are stored."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import parflex as pf
from parflex.simulation.summary import balance

BALANCED = 1e-9  # of the largest change of an energy; 2e-10 is reached
ENTRIES = {entry.name: entry for entry in pf.robots.ALL_ROBOTS}
SMALL = {"nano-hexapod": 5e-3}  # of the motions of the others; by 1e-3 round-off of 1e-17 m · 700 N shows
T = np.linspace(0, 4e-3, 5)


def sprung(entry):
    """The robot; where it has no springs, with some on its motors, at rest at home."""
    robot = entry.build()
    if robot.springs:
        return robot
    legs, joints = [], pf.Model(robot, "numpy").joints(robot.home).q
    for leg, q in zip(robot.legs, joints, strict=True):
        pairs = zip(leg.joints, q, strict=True)
        own = [replace(j, k=2e3, q_0=float(at), Fv=10.0) if j.mu else j for j, at in pairs]
        legs.append(replace(leg, joints=tuple(own)))
    return replace(robot, legs=tuple(legs))


@pytest.mark.slow
@pytest.mark.parametrize("name", ENTRIES)
def test_every_law_keeps_the_balance(name, tmp_path):
    entry, size = ENTRIES[name], SMALL.get(name, 1.0)
    robot = sprung(entry)
    model, s = pf.Model(robot), len(robot.springs)
    own = np.array([joint.q_0 for leg in robot.legs for joint in leg.joints if joint.k])

    def rest(t):
        return own + 1e-3 * size * np.sin(60 * t + np.arange(s)), 0.06 * size * np.cos(60 * t + np.arange(s))

    def base(t):
        rate, axis = np.array([20.0, 13.0, 31.0]), np.array([0.6, 0.0, 0.8])
        p, v = 5e-3 * size * np.sin(rate * t), 5e-3 * size * rate * np.cos(rate * t)
        turn, spin, growth = 0.05 * size * np.array([np.sin(9 * t), 9 * np.cos(9 * t), -81 * np.sin(9 * t)])
        R = Rotation.from_rotvec(turn * axis).as_matrix()
        return pf.BaseMotion(p, R, np.append(v, spin * axis), np.append(-(rate**2) * p, growth * axis))

    state, forces = model.equilibrium(*robot.home_pose)
    way = pf.Trajectory.of(robot.home, [pf.MoveTo(robot.home.position + (0, 0, 2e-3 * size), duration=0.02)])
    output = pf.FrameOutput(entry.output) if entry.output else pf.FrameOutput()
    legs = "static" if any(leg.bends for leg in robot.legs) else "moving"
    laws = (
        forces,
        lambda t, _: forces * (1 + 0.1 * np.sin(50 * t)),
        pf.JointPD(model, state, 1e5, 1e3, forces),
        pf.Servo(model, way),
        pf.ComputedTorque(model, way, 400, 40, output=output, legs=legs),
    )
    for law in laws:
        start = base(0.0).carried(state)
        run = pf.simulate(model, law, start, T, base=base, rest=rest, rtol=1e-11, atol=1e-13)
        (found,) = balance(run.dataset)
        assert found.value <= BALANCED, type(law)
        again = pf.load_result(run.save(tmp_path / "run.nc"))
        assert again.dataset.identical(run.dataset)
        assert {"base_position", "relative_twist", "energy_base", "energy_rests", "spring_rest"} <= set(
            again.dataset
        )
