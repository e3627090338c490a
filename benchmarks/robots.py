"""The robots that all programs are given: the paper's, with links that every program accepts.

Table 3's grouped parameters are refused where a link must be a body by itself; `zoo.physical` has links that
move the same.
"""

from dataclasses import replace
from functools import cache

import numpy as np

import oracle
import parflex as pf
import zoo
from parflex.robots.gough_stewart import PLATE, corners, gough_stewart
from sample import Sample

GRAVITY = (0.0, 0.0, -9.81)
MODES = 11  # that of the paper, 10, cuts a degenerate pair in two; 9 and 11 do not


@cache
def moving(modes: int) -> Sample:
    """The paper's robot at random states of motion, with random forces and targets."""
    robot = gough_stewart(modes)
    legs = [replace(leg, joints=zoo.physical(leg.joints)) for leg in robot.legs]
    place, axes = robot.home_pose
    q = [
        oracle.ups_start(leg, place + robot.platform.attachment_points[None, i]) for i, leg in enumerate(legs)
    ]
    cloud = oracle.plate_cloud(corners(), **PLATE, n_modes=modes)
    rng = np.random.default_rng(6)
    return zoo.sample_of(rng, legs, robot.platform, cloud, (np.array(place), axes), q, gravity=GRAVITY)


@cache
def at_rest(modes: int) -> Sample:
    """The same at home, undeformed and at rest, under the forces that hold the robot's weight in equilibrium.

    With a flexible plate it is not in equilibrium, which asks for a bend: it is released.
    """
    sample = moving(modes)
    model = pf.Model(sample.robot, "numpy")
    _, forces = model.equilibrium(*sample.home_pose)
    home = sample.robot.home
    platform = pf.State(
        *(np.array([value]) for value in (home.position, home.rotation, home.twist)),
        np.zeros((1, modes)),
        np.zeros((1, modes)),
    )
    q = [np.array([leg]) for leg in model.joints(home).q]
    return Sample(
        legs=sample.legs,
        body=sample.body,
        cloud=sample.cloud,
        gravity=sample.gravity,
        home_pose=sample.home_pose,
        platform=platform,
        q=q,
        qd=[np.zeros_like(leg) for leg in q],
        forces=forces[None],
        target=np.array([[0.5, -0.3, 0.8, 0.4, -0.2, 0.3]]),
    )
