"""Direct and inverse models, and their Jacobians, of the gallery's robots, as they were before a redesign.

`gallery.npz` is what this file, run as a program, computed at the commit before the code was put in storeys,
with the backend "numpy". Each robot has its own legs, and as platform either its own rigid one or a nodal
body with three modes of no symmetry, which does not depend on a mesh.
"""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

import parflex as pf

STORED = Path(__file__).parent / "gallery.npz"
ENTRIES = {entry.name: entry for entry in pf.robots.ALL_ROBOTS if entry.output}
COUNT, MODES = 20, 3
STATE = ("position", "rotation", "twist", "elastic", "elastic_rate")


@cache
def robot_of(name: str, flexible: bool) -> pf.Robot:
    """A robot of the gallery, rigid or on the nodal body."""
    rigid = ENTRIES[name].build(modes=0)
    return replace(rigid, platform=bending(rigid.platform.attachment_points)) if flexible else rigid


def bending(held: np.ndarray) -> pf.FlexibleBody:
    """Twenty point masses about the attachments, with shapes that have no symmetry."""
    rng = np.random.default_rng(0)
    points = np.concatenate([held, rng.uniform(-0.3, 0.3, (20, 3))])
    masses = rng.uniform(1.0, 3.0, len(points))
    orthogonal = np.linalg.qr(rng.standard_normal((3 * len(masses), MODES)))[0]
    shapes = orthogonal.T.reshape(MODES, -1, 3) / np.sqrt(masses)[:, None]
    return pf.FlexibleBody.from_nodes(points, masses, shapes, [60.0, 90.0, 200.0], 0.02, range(len(held)))


def drawn(name: str, flexible: bool) -> dict[str, np.ndarray]:
    """States on the closure near home, moving and bent, forces and targets."""
    robot, rng = robot_of(name, flexible), np.random.default_rng(7)
    model, N = pf.Model(robot, "numpy"), robot.platform.modes
    small = rng.uniform(-0.02, 0.02, (COUNT, 6))
    position, rotation = robot.home_pose
    turn = np.eye(3) + np.cross(np.eye(3), small[:, None, 3:])
    turn = np.linalg.qr(turn)[0] * np.sign(np.einsum("...ii->...i", np.linalg.qr(turn)[1]))[:, None, :]
    given = pf.State(
        position + small[:, :3],
        rotation @ turn,
        rng.normal(0, 0.3, (COUNT, 6)),
        rng.normal(0, 1e-3, (COUNT, N)),
        rng.normal(0, 1e-2, (COUNT, N)),
    )
    found = model.project(given)
    return {
        **{field: np.array(getattr(found, field)) for field in STATE},
        "forces": rng.uniform(-100, 300, (COUNT, robot.n_forces)),
        "target": rng.normal(0, 2, (COUNT, len(ENTRIES[name].output))),
    }


def answers(name: str, model: pf.Model, given: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """What the models make of them."""
    state, rows = pf.State(*(given[field] for field in STATE)), ENTRIES[name].output
    direct = model.direct(state, given["forces"])
    inverse = model.inverse(state, given["target"], pf.FrameOutput(rows))
    by_state = model.direct_jacobian(state, given["forces"])
    found = {
        "direct": np.concatenate([direct.platform, direct.elastic], -1),
        "contact_forces": direct.contact_forces,
        "inverse": np.concatenate([inverse.forces, inverse.elastic], -1),
        "jacobian": by_state.state,
        "jacobian_forces": by_state.forces,
        "jacobian_load": by_state.load,
    }
    if len(rows) == model.robot.n_forces:
        back = model.inverse_jacobian(state, given["target"], pf.FrameOutput(rows))
        found |= {"inverse_jacobian": back.state, "inverse_jacobian_target": back.target}
    return found


def main() -> None:
    """Write the file."""
    stored = {}
    for name in ENTRIES:
        for flexible in (False, True):
            given = drawn(name, flexible)
            found = answers(name, pf.Model(robot_of(name, flexible), "numpy"), given)
            kind = "flexible" if flexible else "rigid"
            stored |= {f"{name}/{kind}/{key}": value for key, value in (given | found).items()}
    np.savez_compressed(STORED, **stored)


if __name__ == "__main__":
    main()
