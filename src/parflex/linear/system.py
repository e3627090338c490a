"""The linear system of a robot about an equilibrium."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.linear.closed import Feedback
from parflex.linear.handed_on import to_control, to_matlab
from parflex.linear.matrices import Matrices
from parflex.linear.modes import modes_of
from parflex.linear.point import Point
from parflex.linear.resolved import check_places
from parflex.linear.response import response
from parflex.linear.signal import Input, Output, Push, Rows, push_lengths, row_lengths
from parflex.robot.words import counted


@dataclass(frozen=True, eq=False)
class LinearModel(Matrices):
    """ẋ = A x + B u, y = C x + D u: small motions of a robot about an equilibrium, in minimal coordinates.

    A (2d, 2d), B (2d, r), C (o, 2d) and D (o, r); `inputs` and `outputs` are the labels of u and y, whose
    units are `input_units` and `output_units`. x are d coordinates of unit mass and their rates; of inputs
    that act by their rate, too, it holds the rates less that part. With a controller that integrates, its
    integrals stand behind them; last come turns and rates of a base, by which gravity leans.

    Source: Khalil and Dombre for the equations that are differentiated; the derivatives are exact.
    """

    def __repr__(self) -> str:
        return (
            f"LinearModel: {counted(len(self.A), 'state')}, {counted(len(self.inputs), 'input')} and "
            f"{counted(len(self.outputs), 'output')}, of {counted(self.point.T.shape[1], 'freedom')}"
        )

    @cached_property
    def poles(self) -> Array:
        """(2d,) the eigenvalues of A, 1/s, in the order of their size; without those of the base."""
        found = np.linalg.eigvals(self.own)
        order: Array = found[np.lexsort((found.imag, np.abs(found)))]
        return order

    def modes(self) -> Any:
        """The modes as a Dataset; see `modes.modes_of`."""
        return modes_of(self)

    def frf(self, omega: ArrayLike, structural: float = 0.0) -> Any:
        """Frequency responses as a DataArray (output, input, omega), complex, at omega (w,) rad/s.

        structural is a loss factor η: all stiffness about the equilibrium becomes K (1 + i η).

        Raises InputError for frequencies that are negative or not finite, or a negative loss factor.
        """
        return response(self, omega, structural)

    def to_control(self, omega: ArrayLike | None = None) -> Any:
        """The system as python-control has it: a StateSpace, or with omega (w,) rad/s an FRD; with labels.

        Raises InputError where python-control is missing: `pip install parflex[control]`.
        """
        return to_control(self, omega)

    def to_matlab(self, path: str | PathLike[str]) -> Path:
        """Write A, B, C, D and the labels to a MATLAB file: `load`, then `ss(A, B, C, D)`.

        Raises InputError where the file cannot be written.
        """
        return to_matlab(self, path)


def linear_model(
    point: Point, inputs: Sequence[Input], outputs: Sequence[Output], feedback: Feedback | None
) -> LinearModel:
    """The system with these inputs and outputs about a point.

    Raises InputError for a signal that the robot does not have or that stands twice, and for outputs that
    jump with the rate of an input.
    """
    robot = point.mechanism.robot
    names = []
    for signals, what in ((inputs, "inputs"), (outputs, "outputs")):
        for signal in signals:
            signal.check(robot)
        labels = [label for signal in signals for label in signal.labels(robot)]
        if len(set(labels)) < len(labels):
            twice = next(label for label in labels if labels.count(label) > 1)
            raise InputError(f"{what} name {twice} twice; name each once")
        names.append((tuple(labels), tuple(unit for signal in signals for unit in signal.units(robot))))
    check_places(robot.platform, (*inputs, *outputs))
    pushes = Push(*side_by_side([signal.push(point) for signal in inputs], push_lengths(point), axis=1))
    rows = Rows(*side_by_side([signal.rows(point) for signal in outputs], row_lengths(point), axis=0))
    A, B, C, D, base = state_space(point, pushes, rows, feedback)
    (of_inputs, input_units), (of_outputs, output_units) = names
    words = (of_inputs, of_outputs, input_units, output_units)
    return LinearModel(A, B, C, D, *words, rows.acceleration, point, feedback, base)


def side_by_side(parts: Sequence[tuple[Array, ...]], lengths: Sequence[int], axis: int) -> list[Array]:
    """The parts of all signals along an axis, whose other axis has these lengths."""
    empty = [np.zeros((n, 0)) if axis else np.zeros((0, n)) for n in lengths]
    return [np.concatenate(each, axis=axis) for each in zip(empty, *parts, strict=True)]


def state_space(
    point: Point, pushes: Push, rows: Rows, feedback: Feedback | None
) -> tuple[Array, Array, Array, Array, int]:
    """A, B, C and D with x = (ζ, ζ̇ − B_t u[, ∫ q dt][, ∬u, ∫u]), and the number of the last, of the base."""
    K, C, d = point.K, point.C, point.T.shape[1]
    one, none = np.eye(d), np.zeros((d, d))
    B, B_t = pushes.by_value, pushes.by_rate
    integrals = np.zeros((0, d))
    if feedback is not None:
        K, C, integrals = K + feedback.K, C + feedback.C, feedback.integrals
    A = np.block([[none, one], [K, C]])
    into = np.concatenate([B_t, B + C @ B_t])
    by_place, by_rate, forces = rows.place, rows.rate, rows.forces
    jumps = rows.acceleration @ B_t + forces @ pushes.forces_by_rate
    if np.max(np.abs(jumps), initial=0.0) > 0:
        raise InputError(
            "an output jumps with the rate of a reference, whose spring has a damper beside it; observe "
            "displacements or velocities, or leave the damper out"
        )
    by_place, by_rate = by_place + rows.acceleration @ K, by_rate + rows.acceleration @ C
    if feedback is not None:
        by_place = by_place + forces @ feedback.forces_by_place
        by_rate = by_rate + forces @ feedback.forces_by_rate
    through = by_rate @ B_t + rows.acceleration @ B + forces @ pushes.forces
    through = through + rows.felt @ pushes.felt + rows.load @ pushes.load
    out = np.concatenate([by_place, by_rate], axis=1)
    if len(integrals):
        A, into, out = feedback_states(A, into, out, rows, feedback)
    return base_states(A, into, out, through, pushes, rows)


def base_states(
    A: Array, into: Array, out: Array, through: Array, pushes: Push, rows: Rows
) -> tuple[Array, Array, Array, Array, int]:
    """A, B, C, D and the number of states behind the others: integrals of inputs by which gravity leans."""
    some = np.flatnonzero(np.any(pushes.felt_by_integral, axis=0))
    n, d, f = len(A), len(pushes.by_integral), len(some)
    if not f:
        return A, into, out, through, 0
    leaning = np.zeros((n, 2 * f))
    leaning[d : 2 * d, :f] = pushes.by_integral[:, some]
    chain = np.block([[np.zeros((f, f)), np.eye(f)], [np.zeros((f, 2 * f))]])
    driven = np.concatenate([np.zeros((f, into.shape[1])), np.eye(into.shape[1])[some]])
    seen = rows.acceleration @ pushes.by_integral + rows.felt @ pushes.felt_by_integral
    A = np.block([[A, leaning], [np.zeros((2 * f, n)), chain]])
    out = np.concatenate([out, seen[:, some], np.zeros((len(out), f))], axis=1)
    return A, np.concatenate([into, driven]), out, through, 2 * f


def feedback_states(
    A: Array, into: Array, out: Array, rows: Rows, feedback: Feedback | None
) -> tuple[Array, Array, Array]:
    """A, B and C with the integrals of the joints as more states."""
    assert feedback is not None, "only feedback has integrals"
    d, i = feedback.integrals.shape[1], len(feedback.integrals)
    back = np.concatenate([np.zeros((d, i)), feedback.by_integrals])
    A = np.block([[A, back], [feedback.integrals, np.zeros((i, d + i))]])
    seen = rows.acceleration @ feedback.by_integrals + rows.forces @ feedback.forces_by_integrals
    return A, np.concatenate([into, np.zeros((i, into.shape[1]))]), np.concatenate([out, seen], axis=1)
