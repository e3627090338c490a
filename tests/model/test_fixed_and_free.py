"""The two ends of mobility: a platform that posts hold firmly, and one that nothing holds."""

import numpy as np
import pytest

import chains
import parflex as pf
from parflex.compiled import ALL_BACKENDS

EXACT = 1e-12
CORNERS = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]
BODY = pf.FlexibleBody.rigid(10.0, (0.3, 0.3, 0.1), np.eye(3), CORNERS)


def fixed() -> pf.Robot:
    posts = [pf.Leg(np.eye(3), p, (), (pf.Tip(0, attachment=i),)) for i, p in enumerate(CORNERS)]
    return pf.Robot(posts, BODY)


@pytest.mark.parametrize("backend", ALL_BACKENDS)
def test_fixed(backend):
    """Nothing moves; three posts carry the weight: nine rows of rank six."""
    model = pf.Model(fixed(), backend)
    found = model.direct(model.robot.home, [])
    assert np.max(np.abs(found.platform)) <= EXACT
    total = np.sum(found.contact_forces, axis=0)
    assert np.allclose(total, (0, 0, 98.1), rtol=0, atol=1e-10)
    moment = np.sum(np.cross(CORNERS, found.contact_forces), axis=0)
    assert np.allclose(moment, np.cross((0.3, 0.3, 0.1), total), rtol=0, atol=1e-10)
    mobility = model.mobility(model.robot.home)
    assert (mobility.freedoms, mobility.rank) == (0, 6)
    assert model.equilibrium(*model.robot.home_pose)[1].shape == (0,)
    assert [each.shape for each in model.reactions(model.robot.home, []).force] == [(0, 3)] * 3


@pytest.mark.parametrize("backend", ALL_BACKENDS)
def test_free(backend):
    """It falls; of the derivatives of its acceleration those by gravity are one."""
    model = pf.Model(pf.Robot((), BODY), backend, parameters=["gravity"])
    home = model.robot.home
    assert np.allclose(model.direct(home, []).platform, (0, 0, -9.81, 0, 0, 0), rtol=0, atol=EXACT)
    found = model.direct_jacobian(home, [])
    assert np.allclose(found.parameters, np.eye(6, 3), rtol=0, atol=EXACT)
    assert found.state.shape == (6, 12)
    assert model.reactions(home, []) == ((), ())
    with pytest.raises(pf.NotConverged, match="no actuator forces hold the platform"):
        model.equilibrium(*model.robot.home_pose)


def test_a_bend_that_the_legs_do_not_allow():
    """The platform would sag farther than the legs let it: nothing near home is at rest, nor said to be."""
    sample = chains.sample(chains.Kind("PPR", "crossed", (1, 3)), 2, 1)
    with pytest.raises(pf.InputError, match="too soft for its weight"):
        pf.Model(sample.robot, "numpy").equilibrium(*sample.robot.home_pose)
