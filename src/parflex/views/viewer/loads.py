"""A robot as it gives under a static load."""

import warnings
from collections.abc import Sequence

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import BeyondBasis, InputError
from parflex.linear.inputs import NodeWrench
from parflex.linear.outputs import NodeMotion
from parflex.linear.system import LinearModel, linear_model
from parflex.robot.wrench import Wrench
from parflex.simulation.holding import growth
from parflex.views.viewer.swings import Force, Swing, Swings

HELD = 1e-11  # of the largest stiffness per mass: less is none
NOTHING = 1e-7  # of the largest displacement or turn
HEADS = ("node", "along", "load", "displacement", "turn")


def load_as_swing(lin: LinearModel, wrenches: Sequence[Wrench]) -> Swings:
    """The robot as it gives under wrenches, by its stiffness about the equilibrium, with what their nodes do.

    Raises InputError for a node that there is not, where nothing holds the robot, and where it is unstable.
    """
    if not all(isinstance(each, Wrench) for each in wrenches):
        raise InputError("wrenches are to be a list of pf.Wrench")
    if any(np.ndim(part) > 1 for each in wrenches for part in (each.force, each.moment)):
        raise InputError("wrenches hold batches; give single ones")
    d, R = lin.point.T.shape[1], lin.point.system.x.rotation
    places = tuple(dict.fromkeys(each.node for each in wrenches))
    at_places, notes = at_nodes(lin, places)
    check_holds(lin)
    loads = np.zeros((len(places), 6))
    for each in wrenches:
        both = np.stack([each.force, each.moment])
        loads[places.index(each.node)] += (both @ R.T if each.frame == "platform" else both).ravel()
    u = loads.ravel()
    x = -np.linalg.solve(at_places.A, at_places.B @ u)
    moved = (at_places.C @ x + at_places.D @ u).reshape(-1, 6)
    moved = without_roundoff(moved)
    rows = [
        row
        for node, load, move in zip(places, loads, moved, strict=True)
        for row in load_rows(node, load, move)
    ]
    largest = max(range(len(places)), key=lambda k: float(np.linalg.norm(moved[k, :3])))
    size = float(np.linalg.norm(moved[largest, :3]))
    title = f"node {places[largest]} moves by {in_words(size, 'm')}"
    forces = [
        Force(NodeMotion(node).position(lin.point), load[:3], move[:3])
        for node, load, move in zip(places, loads, moved, strict=True)
        if np.any(load[:3])
    ]
    swing = Swing(title, (), lin.point.T @ x[:d])
    return Swings(lin, [swing], HEADS, rows, notes, forces=tuple(forces))


def at_nodes(lin: LinearModel, nodes: Sequence[int]) -> tuple[LinearModel, tuple[str, ...]]:
    """The system from wrenches at nodes to their displacements, and a sentence for each node at which the
    platform's modes lack static compliance."""
    inputs, outputs = tuple(map(NodeWrench, nodes)), tuple(map(NodeMotion, nodes))
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always", BeyondBasis)
        found = linear_model(lin.point, inputs, outputs, lin.feedback)
    words = dict.fromkeys(str(each.message) for each in said)
    return found, tuple(f"{each[:1].upper()}{each[1:]}." for each in words)


def check_holds(lin: LinearModel) -> None:
    """Raise InputError where a static load finds no equilibrium near the one that is there."""
    if growing := growth(lin.modes()):
        raise InputError(
            f"the robot is unstable, a motion grows e-fold in {1 / growing:.3g} s; no load has a deflection"
        )
    K = lin.point.K + (0.0 if lin.feedback is None else lin.feedback.K)
    values = np.abs(np.linalg.eigvals(K))
    if np.min(values, initial=np.inf) <= HELD * np.max(values, initial=0.0):
        raise InputError(
            "nothing holds the robot against all loads: a motion has no stiffness; lock the motors, "
            'model.linearise(…, controller="locked"), or give them a servo'
        )


def without_roundoff(moved: Array) -> Array:
    """Displacements and turns (n, 6) with zeros where one is round-off beside the largest of its kind."""
    parts = np.split(moved, 2, axis=1)
    sizes = [np.max(np.abs(part), initial=0.0) for part in parts]
    cleaned = [
        np.where(np.abs(part) > NOTHING * size, part, 0.0) for part, size in zip(parts, sizes, strict=True)
    ]
    return np.concatenate(cleaned, axis=1)


def load_rows(node: int, load: Array, moved: Array) -> list[tuple[str, ...]]:
    """A row for each axis of the world: force or moment, displacement and turn of a node."""
    rows: list[tuple[str, ...]] = []
    for k, axis in enumerate("xyz"):
        pushes = [f"{value:.4g} {unit}" for value, unit in ((load[k], "N"), (load[3 + k], "N m")) if value]
        name = str(node) if k == 0 else ""
        rows.append((name, axis, ", ".join(pushes), in_words(moved[k], "m"), in_words(moved[3 + k], "rad")))
    return rows


def in_words(value: float, unit: str) -> str:
    """A displacement or a turn with a unit in which it has few zeros."""
    size = abs(value)
    factor, prefix = (1e3, "m") if size >= 1e-3 else (1e6, "µ") if size >= 1e-7 else (1e9, "n")
    return f"{factor * value:.4g} {prefix}{unit}" if size else "0"
