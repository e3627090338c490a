"""The lowest frequencies of many equilibria, against the linear system of each."""

from dataclasses import replace

import numpy as np
import pytest

import flexlegs
import parflex as pf
from compliant import compliant
from published_hexapods import cubic

ROBOTS = {
    "paper's": lambda: pf.robots.gough_stewart(modes=3),
    "cubic": lambda: replace(cubic(1e-2, 1e5, 0.4, 10.0, (0.1, 0.1, 0.2), 20.0)[0], gravity=(0, 0, -9.81)),
    "bent legs": lambda: flexlegs.robot("gs_flexlegs"),
    "drives": lambda: compliant(pf.robots.gough_stewart(2), k=1e5),
    "nano-hexapod": lambda: pf.robots.nano_hexapod(modes=3),
    "Delta": lambda: pf.robots.delta(modes=3),
}


def equilibria(model):
    """Three poses near home, and what holds them."""
    home, found = model.robot.home, []
    steps = 1e-5 if model.robot.legs[0].tips[0].soft else 1e-3
    for shift in (0.0, steps, -2 * steps):
        found.append(model.equilibrium(home.position + np.array([0, 0, shift]), home.rotation))
    return found


@pytest.mark.parametrize("holding", ["free", "servo", "locked"])
@pytest.mark.parametrize("name", ROBOTS)
def test_they_are_those_of_each(name, holding):
    model = pf.Model(ROBOTS[name](), "numpy")
    found = equilibria(model)
    controller = {"free": None, "locked": "locked"}.get(holding)
    if holding == "servo":
        controller = pf.JointPD(model, found[0][0], 1e6, 1e3, found[0][1])
    singles = []
    for state, forces in found:
        modes = model.linearise(state, forces, controller=controller).modes()
        swings = modes.pole_imag.values > 1e-6 * 2 * np.pi * modes.frequency.values
        singles.append((modes.frequency.values[swings][:4], modes.damping.values[swings][:4]))
    pairs = min(4, *(len(single[0]) for single in singles))  # of the cubic one on locked motors none
    states = stacked([state for state, _ in found])
    forces = np.stack([forces for _, forces in found])
    many = pf.natural_frequencies(model, states, forces, count=max(pairs, 1), controller=controller)
    for row, (hertz, damping) in enumerate(singles):
        assert np.isnan(many.hertz[row, 0]) == (pairs == 0)
        assert np.allclose(many.hertz[row, :pairs], hertz[:pairs], rtol=1e-7)
        assert np.allclose(many.damping[row, :pairs], damping[:pairs], rtol=1e-5, atol=1e-9)


def stacked(states):
    """One state of many."""
    names = ("position", "rotation", "twist", "elastic", "elastic_rate")
    parts = {name: np.stack([getattr(state, name) for state in states]) for name in names}
    for name in ("joints", "joint_rates", "leg_elastic", "leg_elastic_rate"):
        rows = [getattr(state, name) for state in states]
        if rows[0] is not None:
            parts[name] = tuple(
                None if legs[0] is None else np.stack(legs) for legs in zip(*rows, strict=True)
            )
    return pf.State(**parts)


def test_without_damping():
    """Of a damped robot the frequencies of one without: c = 0."""
    damped, bare = (cubic(1e-2, 1e5, 0.4, 10.0, (0.1, 0.1, 0.2), c)[0] for c in (500.0, 0.0))
    model, other = pf.Model(damped, "numpy"), pf.Model(bare, "numpy")
    state, forces = model.equilibrium(*damped.home_pose)
    found = pf.natural_frequencies(model, state, forces, damped=False)
    assert np.allclose(found.hertz, other.linearise(state, forces).modes().frequency.values, rtol=1e-7)
    assert np.allclose(found.damping, 0.0, atol=1e-7)


def test_growth_and_too_few_pairs():
    """The paper's robot falls over; a rigid one on locked motors has nothing that swings."""
    model = pf.Model(pf.robots.gough_stewart(modes=2), "numpy")
    state, forces = model.equilibrium(*model.robot.home_pose)
    found = pf.natural_frequencies(model, state, forces)
    assert found.growth == pytest.approx(np.max(model.linearise(state, forces).poles.real), rel=1e-6)
    rigid = pf.Model(pf.robots.gough_stewart(modes=0), "numpy")
    state, forces = rigid.equilibrium(*rigid.robot.home_pose)
    assert np.all(np.isnan(pf.natural_frequencies(rigid, state, forces, controller="locked").hertz))
    with pytest.raises(pf.InputError, match="count is 0"):
        pf.natural_frequencies(rigid, state, forces, count=0)
