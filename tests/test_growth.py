"""What comes new is a file of its own, named in one tuple: here a leg type and an importer.

A joint field is added in `robot/test_joint_fields.py`, a control law in `simulation/test_laws.py`, a result
variable in `simulation/test_variables.py`.
"""

import json

import numpy as np
import pytest

import parflex as pf
from blocks import STEEL, box
from measures import random_forces, random_states, relative
from parflex.base.array import dot, mtv, stack
from parflex.compiled import choose
from parflex.fe.imports.importer import Importer
from parflex.kernels import jacobians, models
from parflex.mechanics.chain import Joints, placement
from parflex.mechanics.legs import ALL_LEG_TYPES, LegType
from parflex.mechanics.mechanism import mechanism_of
from parflex.mechanics.redundancy import with_rows

SAME = 1e-12  # the same geometry by another formula


class Telescope(LegType):
    """The paper's leg in spherical coordinates (azimuth, angle from below, radius) of its tip."""

    name = "telescope"

    def recognises(self, leg):
        return leg.pattern == "RRP"

    def joints(self, group, tips, q):
        (x, y, z), level, far = self._tip(group, tips)
        cos, sin = stack([x / level, -z / far, np.ones(())]), stack([y / level, level / far, np.zeros(())])
        slide = far - group.chain.r[:, 2] - group.offsets[:, 0, 2]
        return Joints(cos, sin, stack([np.zeros(()), np.zeros(()), slide]))

    def rates(self, group, frames, joints, tips, v, qd):
        (x, y, z), level, far = self._tip(group, tips)
        to_first = placement(group.chain, 0)[0]
        vx, vy, vz = np.moveaxis(mtv(to_first, v[..., 0, :]), -1, 0)
        outward = (x * vx + y * vy + z * vz) / far
        turning = (x * vy - y * vx) / (level * level)
        return stack([turning, (vz * far - z * outward) / (far * level), outward])

    def margins(self, group, joints, tips):
        _, level, far = self._tip(group, tips)
        return far, level / far

    def _tip(self, group, tips):
        R, p = placement(group.chain, 0)
        u = mtv(R, tips[..., 0, :] - p)
        x, y, z = np.moveaxis(u, -1, 0)
        return (x, y, z), np.sqrt(x * x + y * y), np.sqrt(dot(u, u))


@pytest.mark.parametrize("backend", ["numpy", "vm"])
def test_a_leg_type(model_of, backend):
    """Its legs move as those of the type that the library has: accelerations, and their derivatives."""
    model = model_of(1)
    mechanism = with_rows(mechanism_of(model.robot, (Telescope(), *ALL_LEG_TYPES)))
    assert {group.type.name for group in mechanism.groups} == {"telescope"}
    states, forces = random_states(model.robot, 20, 1), random_forces(model, 20, 2)
    x = model.compiled().pack(states[0])
    direct = choose(backend).compile(models.direct(mechanism)).run(x=x, forces=forces[0])
    assert relative(direct["platform"], model.direct(states[0], forces[0]).platform) <= SAME
    jacobian = choose(backend).compile(jacobians.direct_jacobian(mechanism, ())).run(x=x, forces=forces[0])
    expected = model.direct_jacobian(states[0], forces[0])
    assert relative(jacobian["by_state"].reshape(expected.state.shape), expected.state) <= SAME


def read_bricks(brick, units):
    """A body of steel from the sides that a JSON file gives, the file of a program nobody has."""
    return pf.fe.solid_body(box(json.loads(brick.read_text())["sides"], (3, 2, 1)), STEEL)


BRICKS = Importer("bricks", read_bricks, ("brick",))


def test_an_importer(tmp_path):
    """Its modes are those of its body; where it is asked for wrongly, the words are everybody's."""
    path = tmp_path / "brick.json"
    path.write_text(json.dumps({"sides": [0.3, 0.2, 0.1]}))
    points, known = [(-0.15, -0.1, 0.0), (0.15, 0.1, 0.0)], (*pf.fe.IMPORTERS, BRICKS)
    given = {"units": "SI", "modes": 3, "points": points, "radius": 0.06, "importers": known}
    found = pf.fe.import_modes("bricks", {"brick": path}, **given)
    own = pf.fe.FreeFreeWithAttachment(3, points, radius=0.06).modes(read_bricks(path, "SI"))
    assert np.allclose(found.frequencies, own.frequencies, rtol=1e-9)
    with pytest.raises(pf.InputError, match="brick is not given; bricks takes brick"):
        pf.fe.import_modes("bricks", {}, **given)
    with pytest.raises(pf.InputError, match="program is 'bricks'"):
        pf.fe.import_modes("bricks", {"brick": path}, **(given | {"importers": pf.fe.IMPORTERS}))
