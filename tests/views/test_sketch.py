"""Points and lines of a picture: where the geometry says they are."""

import numpy as np

import flexlegs
import parflex as pf
from measures import random_states, relative
from parflex.views.sketch import sketch


def test_lines_are_as_long_as_the_legs(model_of):
    """A UPS leg is a straight line from its base, as long as its slide, in any state."""
    model = model_of(10)
    state = random_states(model.robot, 1, seed=2)[0]
    drawn = sketch(model, state, scale=1.0)
    slides = [q[2] for q in model.joints(state).q]
    ends = [np.linalg.norm(line[-1] - line[0]) for line in drawn.lines]
    assert relative(ends, slides) < 1e-12
    starts = [line[0] for line in drawn.lines]
    assert relative(starts, [leg.origin for leg in model.robot.legs]) < 1e-15
    middles = [(line[0] + line[-1]) / 2 for line in drawn.lines]
    assert relative(drawn.motors, middles) < 1e-12
    assert list(drawn.legs) == [1, 2, 3, 4, 5, 6]


def test_legs_end_on_the_platform_that_is_drawn(model_of):
    """However much the deformation is exaggerated."""
    model = model_of(10)
    state = random_states(model.robot, 1, seed=3)[0]
    drawn = sketch(model, state)
    assert drawn.scale != 1.0
    assert relative([line[-1] for line in drawn.lines], drawn.attachments) < 1e-12
    size = np.max(np.ptp(model.robot.platform.nodes, axis=0))
    assert np.isclose(drawn.scale * np.max(np.linalg.norm(drawn.bend, axis=1)), 0.08 * size)


def test_pictures_of_bent_and_rigid_robots(model_of, tmp_path):
    for modes in (0, 1):
        model = model_of(modes)
        state = random_states(model.robot, 1, seed=4)[0]
        pf.plot.robot_at(sketch(model, state), "title").savefig(tmp_path / f"{modes}.png")
        assert (tmp_path / f"{modes}.png").stat().st_size > 10_000


def test_bent_legs_are_scaled_from_straight_ones():
    """Each point of a line by the same factor as the platform, against the robot of which nothing is bent."""
    robot, state = flexlegs.robot("gs_flexlegs"), flexlegs.states("gs_flexlegs")[0]
    model = pf.Model(robot, "numpy")
    straight = sketch(model, pf.State(state.position, state.rotation), scale=1.0)
    once, thrice = (sketch(model, state, scale=scale) for scale in (1.0, 3.0))
    assert relative(thrice.lines - straight.lines, 3.0 * (once.lines - straight.lines)) < 1e-12
    assert (
        relative(
            thrice.lines[:, -1],
            thrice.attachments[[tip.attachment for leg in robot.legs for tip in leg.tips]],
        )
        < 1e-12
    )
    assert len(once.joints) == 6 * 4  # two hinges, a slide and a tip
    assert len(once.motors) == 6
