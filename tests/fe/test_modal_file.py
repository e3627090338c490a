"""The modal file: there and back to the bit, and what is refused."""

from dataclasses import fields

import h5py
import numpy as np
import pytest

import parflex as pf
from solid_plates import modes


@pytest.fixture
def file(tmp_path):
    return pf.fe.write_modes(modes(), tmp_path / "plate.h5", damping_ratio=0.03)


def test_there_and_back(file):
    """Every array to the bit, in the platform's frame, which is the modes' own here."""
    found, given = pf.fe.read_modes(file), modes()
    for field in fields(given):
        one, other = getattr(found, field.name), getattr(given, field.name)
        if field.name == "solid":
            assert np.array_equal(one.elements, other.elements)
            assert one.materials == other.materials
        elif field.name == "moments":
            assert all(np.allclose(a, b, atol=1e-15) for a, b in zip(one, other, strict=True))
        elif field.name == "nodes":
            assert np.allclose(one, other, atol=1e-15)
        elif field.name != "reduction":
            assert np.array_equal(one, other, equal_nan=isinstance(other, np.ndarray)), field.name
    assert found.reduction is None
    with pytest.raises(pf.InputError, match="the model of these modes is not at hand"):
        _ = found.error


def test_stresses_after_reading(file):
    q = 1e-3 / modes().frequencies
    assert np.allclose(pf.fe.recover(pf.fe.read_modes(file), q).mises, pf.fe.recover(modes(), q).mises)


def test_schema_is_as_documented(file):
    """Any HDF5 reader finds names, units and meanings."""
    with h5py.File(file) as opened:
        assert opened.attrs["format"] == "parflex-modes-1"
        assert opened["shapes"].attrs["units"] == "kg-0.5"
        assert opened["frequencies"].attrs["units"] == "rad s-1"
        assert opened["elements"].shape[1] == 10
        for name in (
            "m",
            "MS0",
            "P0",
            "S",
            "P1",
            "P2",
            "nodes",
            "damping",
            "attachments",
            "tool",
            "materials",
        ):
            assert name in opened


def truncated(file):
    file.write_bytes(file.read_bytes()[:5000])


def edited(file):
    with h5py.File(file, "r+") as opened:
        opened["frequencies"][0] *= 1.0001


def renamed(file):
    with h5py.File(file, "r+") as opened:
        opened.attrs["notes"] = "all is well"


def of_another_kind(file):
    with h5py.File(file, "r+") as opened:
        opened.attrs["format"] = "something-else"


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (truncated, "which is damaged or no modal file"),
        (edited, "which was altered after it was written"),
        (renamed, "which was altered after it was written"),
        (of_another_kind, "holds no platform of format"),
        (lambda file: file.unlink(), "does not exist"),
        (lambda file: file.write_text("hello"), "which is damaged or no modal file"),
    ],
)
def test_refused_in_one_sentence(file, spoil, words):
    spoil(file)
    with pytest.raises(pf.InputError, match=words):
        pf.fe.read_modes(file)
