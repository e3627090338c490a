"""Parts from STEP files that the tests draw with Open Cascade: a tube, and a rod with a notch."""

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

import parflex as pf

LENGTH, OUTER, INNER = 0.62, 0.032, 0.026  # m
STEEL = {"young": 205e9, "poisson": 0.29, "density": 7850.0}


def drawn(occ, shape, **mesh) -> pf.fe.FreeBody:
    """The solid of a shape in millimetres, by way of its STEP file."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "part.step"
        shape.WriteStep(str(file))
        return pf.fe.solid_body(pf.fe.step_mesh(file, **mesh), pf.fe.Material(**STEEL))


def tube_shape(occ):
    """A tube along z, mm."""
    outer, inner = (occ.Cylinder((0, 0, 0), occ.Z, r=500 * d, h=1000 * LENGTH) for d in (OUTER, INNER))
    return outer - inner


@cache
def tube() -> pf.fe.FreeBody:
    """The tube of steel, from its STEP file."""
    occ = pytest.importorskip("netgen.occ")
    return drawn(occ, tube_shape(occ), size=0.007)


@cache
def step_tube(negligible: float = 0.0) -> pf.FlexibleBody:
    """The tube as a link; 1e-3 of its compliance is more than that along it."""
    return pf.fe.link(tube(), (0, 0, 0), [(0, 0, LENGTH)], negligible=negligible)


@cache
def notch() -> pf.fe.FreeBody:
    """A bar of 10 × 10 × 40 mm with two round notches, which leave a neck of 1 mm."""
    occ = pytest.importorskip("netgen.occ")
    bar = occ.Box((-5, -5, 0), (5, 5, 40))
    for side in (-7.5, 7.5):
        bar = bar - occ.Cylinder((side, -6, 20), occ.Y, r=7, h=12)
    return drawn(occ, bar, size=0.005)
