"""Every public callable of finite elements that takes numbers, and what it must not take."""

from functools import partial

import numpy as np

import parflex as pf
from arguments import BAD, NONE, Door, array, number, other, positive, rotation, thing, things, whole
from blocks import box
from doors import RATIO
from solid_plates import MATERIAL

MESH = box((0.6, 0.4, 0.05), (3, 2, 1))
SOLID = pf.fe.solid_body(MESH, MATERIAL)
OUTLINE = [[0.0, 0], [1, 0], [1, 1], [0, 1]]
MODES = pf.fe.plate_modes(OUTLINE, 0.01, n_modes=2, refine=2, material=MATERIAL)
HELD = {"n": 1, "points": MESH.nodes[:1], "radius": 0.5}
LINKED = {"body": SOLID, "frame": (-0.3, 0, 0), "interfaces": [(0.3, 0, 0)], "n_modes": 1}
OF_SOLID = pf.fe.FreeFree(**HELD).modes(SOLID)

NUMBERS = {"young": 7e10, "poisson": 0.3, "density": 2700.0}
STUFF = other(MATERIAL, number=1.0, **BAD)
MADE_OF = {"young": positive(7e10, none=True, word="young|material")}
MADE_OF |= {"poisson": number(0.3, none=True, word="poisson|material")}
MADE_OF |= {"density": positive(2700.0, none=True, word="density|material")}
PLATE = {"polygon": array(OUTLINE), "thickness": positive(0.01)} | MADE_OF
SPOTS = {"points": array([[0.2, 0.2, 0.0]], none=True)}
TOOL = {"tool": array([0.1, 0.1, 0], none=True)}
JOINTS = SPOTS | TOOL | {"radius": positive(0.5, none=True)}
BASIS = {"n": whole(1), "negligible": number(1e-3)} | JOINTS
REACH = {"tolerance": positive(0.5), "up_to": positive(1e3, none=True)}
FINE = {"size": positive(0.5, none=True), "fine_at": array([[0.0, 0, 0]]), "fine": positive(0.5, none=True)}
MATRIX = array(np.eye(3))


def attached(modes, ids=None, points=None, radius=None):
    """At a point, or at nodes by their numbers."""
    return pf.fe.attached(modes, ids, MESH.nodes[:1] if points is None and ids is None else points, radius)


DOORS: dict[str, Door] = {
    "FlexibleBody.from_modes": Door(
        pf.FlexibleBody.from_modes,
        {
            "modes": thing(MODES),
            "attachments": array(MODES.nodes[1:3], none=True),
            "origin": array(np.zeros(3), none=True),
        }
        | RATIO,
    ),
    "fe.FreeFree": Door(lambda **given: pf.fe.FreeFree(**(HELD | given)).modes(SOLID), BASIS),
    "fe.FreeFreeWithAttachment": Door(
        lambda **given: pf.fe.FreeFreeWithAttachment(**(HELD | given)).modes(SOLID), BASIS
    ),
    "fe.FreeFree.modes": Door(pf.fe.FreeFree(1).modes, {"body": thing(SOLID)}),
    "fe.ComputedModes.converged": Door(OF_SOLID.converged, REACH),
    "fe.Material": Door(
        pf.fe.Material,
        {"young": positive(7e10), "poisson": number(0.3), "density": positive(2700.0)},
        "name source",
    ),
    "fe.Rib": Door(
        lambda **rib: pf.fe.outline_mesh(OUTLINE, 0.05, ribs=[pf.fe.Rib(**rib)], size=0.5),
        {"outline": array([0.5, 0.5, 0.1]), "height": number(0.1), "part": whole()},
    ),
    "fe.Step": Door(
        lambda **step: pf.fe.outline_mesh(OUTLINE, 0.05, steps=[pf.fe.Step(**step)], size=0.5),
        {"outline": array([0.5, 0.5, 0.1]), "thickness": positive(0.1), "part": whole()},
    ),
    "fe.attached": Door(
        attached,
        {
            "modes": thing(OF_SOLID),
            "ids": other(None, text="abc", number=1.0, halves=[0.5], far=[99], object=object()),
            "points": array(MESH.nodes[:1], none=True),
            "radius": positive(0.5, none=True),
        },
    ),
    "fe.basis_error": Door(pf.fe.basis_error, {"modes": thing(OF_SOLID), "up_to": positive(1e3, none=True)}),
    "fe.body_of_matrices": Door(
        pf.fe.body_of_matrices,
        {
            "nodes": array(SOLID.nodes),
            "stiffness": MATRIX._replace(good=SOLID.stiffness),
            "mass": MATRIX._replace(good=SOLID.mass),
            "unknowns": array(np.zeros((3, 2)), none=True),
            "triangles": array(np.zeros((1, 3)), none=True),
            "corners": other([0], text="abc", number=1.0, halves=[0.5], nothing=None, negative=[-1]),
        },
        "source notes",
    ),
    "fe.check_rows": Door(pf.fe.check_rows, {"modes": thing(OF_SOLID)}),
    "fe.circle": Door(pf.fe.circle, {"radius": positive(), "corners": whole(6)}),
    "fe.converged": Door(pf.fe.converged, {"modes": thing(OF_SOLID)} | REACH),
    "fe.material": Door(pf.fe.material, {"name": other("steel", word="material", number=1.0, **BAD, **NONE)}),
    "fe.link": Door(
        lambda **given: pf.fe.link(**(LINKED | given)),
        {
            "body": thing(SOLID),
            "frame": array([-0.3, 0, 0]),
            "interfaces": array([[0.3, 0, 0]]),
            "rotation": rotation(none=True),
            "ids": other(None, text="abc", number=1.0, halves=[[0.5], [0.5]], far=[[99999], [0]]),
            "radius": positive(0.5, none=True, word="radius|frame"),
            "n_modes": whole(1, none=True),
            "negligible": number(0.0),
            "foreshortening": array(np.zeros((1, 3, 7, 7)), none=True),
        }
        | RATIO,
    ),
    "fe.modes": Door(
        partial(pf.fe.modes, points=HELD["points"], radius=0.5),
        {"body": thing(SOLID), **JOINTS, "n": whole(1, none=True)} | REACH,
    ),
    "fe.outline_mesh": Door(
        partial(pf.fe.outline_mesh, size=0.5, fine=0.5),
        {
            "outline": array(OUTLINE),
            "thickness": positive(0.1),
            "holes": other(
                [],
                word="holes.*",
                text="abc",
                number=1.0,
                nothing=None,
                object=object(),
                numbers=[1.0],
                nothings=[None],
            ),
            "ribs": things([]),
            "steps": things([]),
        }
        | FINE,
    ),
    "fe.plate_body": Door(
        partial(pf.fe.plate_body, **NUMBERS),
        PLATE | SPOTS | {"tool": array([0.1, 0.1, 0], none=True), "refine": whole(2)} | {"material": STUFF},
    ),
    "fe.plate_modes": Door(
        partial(pf.fe.plate_modes, **NUMBERS, n_modes=1, refine=2),
        PLATE | SPOTS | {"n_modes": whole(1), "refine": whole(2, none=True), "material": STUFF},
    ),
    "fe.recover": Door(
        pf.fe.recover,
        {"modes": thing(OF_SOLID), "elastic": array([0.0]), "points": array(MESH.nodes[:1], none=True)},
    ),
    "fe.solid_body": Door(
        pf.fe.solid_body,
        {"mesh": thing(MESH), "material": other(MATERIAL, number=1.0, **BAD, **NONE)},
        "any_size",
    ),
    "fe.solid_mesh": Door(
        pf.fe.solid_mesh,
        {"nodes": array(MESH.nodes), "elements": array(MESH.elements), "parts": array(MESH.parts, none=True)},
        "notes",
    ),
    "fe.with_mesh_error": Door(pf.fe.with_mesh_error, {"modes": thing(OF_SOLID), "coarse": thing(SOLID)}),
    "fe.write_modes": Door(
        partial(pf.fe.write_modes, path="nowhere.nc"),
        {
            "modes": thing(MODES),
            "attachments": array(MODES.nodes[1:3], none=True),
            "origin": array(np.zeros(3), none=True),
        }
        | RATIO,
        "path",
    ),
}
