"""Beams of another section or material in the shapes that they have: as parameters change them."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array, trace
from parflex.robot.beam import Beam, BeamBody, families, fields, modes_of, moments_by_section, weighed
from parflex.robot.beam_shapes import POINTS
from parflex.robot.moments import Moments

CHANGING = ("outer", "inner", "young", "density")  # numbers of a beam on which its shapes need not depend


class BeamTables(NamedTuple):
    """The integrals, stiffness (N,) and damping (N,) of a beam."""

    moments: Moments
    stiffness: Array
    damping: Array


def beam_tables(body: BeamBody, values: Mapping[str, Any]) -> BeamTables:
    """The tables of a beam with other `CHANGING` numbers, floats or symbols, in the shapes that it has.

    Bending and torsion are as stiff as E I, stretching as E A; the inertia is linear in ρ A and ρ I. Each
    shape keeps its damping ratio.
    """
    beam, basis = beams_of(body)
    now = {name: values.get(name, getattr(beam, name)) for name in CHANGING}
    area, second = round_section(now["outer"], now["inner"])
    phi, psi = fields(basis, modes_of(basis), POINTS)
    by_section = moments_by_section(basis, phi, psi)
    moments = weighed(*by_section, now["density"] * area, now["density"] * second)
    bend = now["young"] * second / (beam.young * beam.section[1])
    pull = now["young"] * area / (beam.young * beam.section[0])
    bending, axial, torsion = (len(family.value) for family in families(basis, np.zeros(1)))
    stiffness = body.stiffness * np.array([bend] * (2 * bending) + [pull] * axial + [bend] * torsion)
    modal = np.moveaxis(trace(moments.P2), 0, -1)[np.arange(body.modes), np.arange(body.modes)]
    return BeamTables(moments, stiffness, 2.0 * body.damping_ratios * np.sqrt(stiffness * modal))


def with_numbers(body: BeamBody, values: Mapping[str, Any]) -> BeamBody:
    """The beam's body with other `CHANGING` numbers, in the shapes that it has; raises as `Beam`."""
    beam, basis = beams_of(body)
    changed = replace(beam, **values)
    return replace(body, **beam_tables(body, values)._asdict(), beam=changed, basis=basis)


def beams_of(body: BeamBody) -> tuple[Beam, Beam]:
    """The beam of a body, and the one whose shapes it has."""
    assert body.beam is not None, "a beam's body has its beam"
    return body.beam, body.basis or body.beam


def round_section(outer: Any, inner: Any) -> tuple[Any, Any]:
    """The area (m²) of a round tube and its second moment (m⁴) about a diameter."""
    d, e = outer * outer, inner * inner
    return np.pi / 4 * (d - e), np.pi / 64 * (d - e) * (d + e)
