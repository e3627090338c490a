"""The motion of the base from samples: displacements, velocities or accelerations over time."""

import os
from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base import kinds
from parflex.base.array import Array
from parflex.base.check import finite
from parflex.base.errors import InputError
from parflex.base.held import Given
from parflex.files.sample_file import read_samples
from parflex.robot.base_motion import BaseMotion
from parflex.robot.fields import check_fields, exact, held, optional
from parflex.robot.words import counted
from parflex.simulation.surroundings.jumps import first_jump
from parflex.simulation.surroundings.piecewise import FEWEST, Piecewise, through
from parflex.simulation.surroundings.turning import GAUSS, angular, rotations, turned

PLACES = ("position", "velocity", "acceleration")  # by the order of the derivative that is sampled
TURNS = ("rotation", "angular_velocity", "angular_acceleration")
HEADS = {  # of a file's columns: the field, and what is measured
    "": ("position", kinds.LENGTH),
    "r": ("rotation", kinds.ANGLE),
    "v": ("velocity", kinds.SPEED),
    "omega": ("angular_velocity", kinds.TURN_RATE),
    "a": ("acceleration", kinds.ACCELERATION),
    "alpha": ("angular_acceleration", kinds.ANGULAR_ACCELERATION),
}
COLUMNS = {
    f"{head}{axis}": (field, k, kind) for head, (field, kind) in HEADS.items() for k, axis in enumerate("xyz")
}
BESIDE = 1e-9  # of the time that is sampled: a time outside by so little is round-off
STRIDE = 5  # samples between two times at which a simulation must look


@dataclass(frozen=True, eq=False)
class BaseSamples:
    """The motion of the base through samples at times t (T,) s: what `pf.simulate(…, base=…)` takes.

    position (T, 3) m and rotation (T, 3) rad, rotation vectors, place Σ0 in the world. Instead, velocity
    (T, 3) m/s, angular_velocity (T, 3) rad/s, acceleration (T, 3) m/s² and angular_acceleration (T, 3) rad/s²
    may be given, in world axes; their motion begins at the origin, that of accelerations at rest. What is not
    given is zero. Each component of the place is given once, and turning in one way.

    Splines lead through displacements and velocities (fifth degree) and through accelerations (third), so
    that the acceleration is continuous. It is a function: `samples(t)` is the BaseMotion at times t (…,).

    Raises InputError for wrong shapes, fewer than six samples, times that do not increase, components that
    are given twice, turning about several axes beyond 3 rad by its rates, and jumps: steps that the samples
    beside them do not explain, and which have no derivative. Called at times outside the samples it raises
    InputError.

    >>> t = np.linspace(0.0, 1.0, 101)
    >>> shaken = BaseSamples(t, np.outer(1e-3 * np.sin(20 * t), [1, 0, 0]))
    >>> shaken(0.5).acceleration.round(3)[:3]  # −400 · 1e-3 sin 10
    array([0.218, 0.   , 0.   ])
    """

    t: Given = held(exact((None,)))
    position: Given = held(optional(exact((None, 3))), default=None)
    rotation: Given = held(optional(exact((None, 3))), default=None)
    _: KW_ONLY
    velocity: Given = held(optional(exact((None, 3))), default=None)
    angular_velocity: Given = held(optional(exact((None, 3))), default=None)
    acceleration: Given = held(optional(exact((None, 3))), default=None)
    angular_acceleration: Given = held(optional(exact((None, 3))), default=None)

    def __post_init__(self) -> None:
        check_fields(self)
        times = np.asarray(self.t)
        if len(times) < FEWEST:
            raise InputError(f"BaseSamples have {counted(len(times), 'sample')}; give {FEWEST} or more")
        if np.any(np.diff(times) <= 0):
            late = times[1:][np.diff(times) <= 0][0]
            raise InputError(
                f"BaseSamples.t does not increase at t = {late:.10g} s; give each time once, in order"
            )
        for name in (*PLACES, *TURNS):
            given = getattr(self, name)
            if given is not None and len(given) != len(times):
                raise InputError(
                    f"BaseSamples.{name} has {len(given)} rows for {len(times)} times; give one for each"
                )
        self._check_given_once()
        self._check_jumps()
        _ = self._motion

    @staticmethod
    def from_file(path: str | os.PathLike[str]) -> "BaseSamples":
        """The samples of a file of comma-separated values, whose header names columns with their units:

        `t [s], x [mm], y [um], rz [mrad]`: displacements x, y, z and the rotation vector rx, ry, rz; or
        velocities vx, omegax and so on, or accelerations `ax [m/s^2]` or `ax [g]`, `alphax [rad/s^2]`.
        Columns that are missing are zero.

        Raises InputError, with the line or the time, as `BaseSamples`, and for units that are missing or of
        another kind, unknown columns and cells that are no finite numbers.
        """
        t, columns = read_samples(path, {name: kind for name, (_, _, kind) in COLUMNS.items()})
        arrays: dict[str, Array] = {}
        for name, values in columns.items():
            field, axis, _ = COLUMNS[name]
            arrays.setdefault(field, np.zeros((len(t), 3)))[:, axis] = values
        try:
            return BaseSamples(t, **arrays)
        except InputError as error:
            raise InputError(f"{os.fspath(path)}: {error}") from None

    def __call__(self, t: ArrayLike) -> BaseMotion:
        """The motion at times t (…,) s; raises InputError for times outside the samples."""
        times, own = finite("t", t), np.asarray(self.t)
        beside = BESIDE * (own[-1] - own[0])
        outside = (times < own[0] - beside) | (times > own[-1] + beside)
        if np.any(outside):
            raise InputError(
                f"base samples go from t = {own[0]:.6g} to {own[-1]:.6g} s, and t = "
                f"{times[outside][0]:.6g} s is asked for; give samples for all of the time that is simulated"
            )
        value, slope, curve = np.moveaxis(self._motion.at(times), -2, 0)
        omega, growth = angular(value[..., 3:], slope[..., 3:], curve[..., 3:])
        twist, acceleration = (
            np.concatenate(each, -1) for each in ((slope[..., :3], omega), (curve[..., :3], growth))
        )
        return BaseMotion(value[..., :3], rotations(value[..., 3:]), twist, acceleration)

    def __repr__(self) -> str:
        t, moved = np.asarray(self.t), ", ".join(name for name in COLUMNS if self._moves(name))
        return (
            f"BaseSamples: {len(t)} samples from {t[0]:.6g} to {t[-1]:.6g} s of {moved or 'a base at rest'}"
        )

    @property
    def longest(self) -> float:
        """The longest step (s) of an integrator that does not step over what the samples tell."""
        return STRIDE * float(np.median(np.diff(np.asarray(self.t))))

    @cached_property
    def _motion(self) -> Piecewise:
        """The place and the rotation vector."""
        t = np.asarray(self.t)
        places = [through(t, self._of(name), order) for order, name in enumerate(PLACES)]
        return (places[0] + places[1] + places[2]).beside(self._turning())

    def _turning(self) -> Piecewise:
        """The rotation vector; turning about several axes is integrated from sample to sample."""
        t = np.asarray(self.t)
        order, name = next(
            ((k, name) for k, name in enumerate(TURNS) if np.any(self._of(name))), (0, TURNS[0])
        )
        samples = self._of(name)
        if order == 0 or np.count_nonzero(np.any(samples, axis=0)) < 2:
            return through(t, samples, order)
        omega = through(t, samples, order - 1)
        first, second = (omega.at(t[:-1] + share * np.diff(t))[:, 0] for share in GAUSS)
        return through(t, turned(t, first, second))

    def _of(self, name: str) -> Array:
        """Samples (T, 3), zero where they are not given."""
        given: Any = getattr(self, name)
        return np.zeros((len(self.t), 3)) if given is None else np.asarray(given)

    def _moves(self, column: str) -> bool:
        """True where a column of a file would have something to tell."""
        field, axis, _ = COLUMNS[column]
        return bool(np.any(self._of(field)[:, axis]))

    def _check_given_once(self) -> None:
        """Raise InputError where a component is given in two ways."""
        for axis, letter in enumerate("xyz"):
            found = [name for name in PLACES if np.any(self._of(name)[:, axis])]
            if len(found) > 1:
                raise InputError(f"BaseSamples give {' and '.join(found)} along {letter}; keep one of them")
        found = [name for name in TURNS if np.any(self._of(name))]
        if len(found) > 1:
            raise InputError(f"BaseSamples give {' and '.join(found)}; keep one of them for all axes")

    def _check_jumps(self) -> None:
        """Raise InputError where samples jump."""
        t = np.asarray(self.t)
        for column, (name, axis, kind) in COLUMNS.items():
            values = self._of(name)[:, axis]
            at = first_jump(t, values)
            if at is not None:
                before, after = (f"{values[k]:.4g}" for k in (at - 1, at))
                raise InputError(
                    f"BaseSamples.{name} jumps at t = {t[at]:.6g} s: {column} goes from {before} to {after} "
                    f"{kind.unit} there, which the samples beside it do not explain, so that it has no "
                    f"derivative; give more samples of this step, or smooth it"
                )
