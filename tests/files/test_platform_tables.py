"""Platforms that a robot file names in a line: those made in Python."""

import numpy as np
import pytest

import parflex as pf
from parflex.files.platform_schema import ModalTable, SolidTable
from parflex.files.platform_tables import platform
from solid_plates import JOINTS, modes


def test_robot_file_names_modes_in_one_line(tmp_path):
    """The platform of a robot file is that of the modes."""
    file = pf.fe.write_modes(modes(), tmp_path / "plate.h5", damping_ratio=0.03)
    body = platform(ModalTable(kind="modal", file=file.name), file.parent)
    expected = pf.FlexibleBody.from_modes(modes(), damping_ratio=0.03)
    assert np.array_equal(body.stiffness, expected.stiffness)
    assert np.array_equal(body.damping, expected.damping)
    assert np.allclose(body.attachment_points, JOINTS, atol=1e-12)


def test_robot_file_names_a_step_file(tmp_path):
    """A solid platform in one line of a robot file is the one made in Python."""
    occ = pytest.importorskip("netgen.occ")
    occ.Box((0, 0, 0), (600, 400, 30)).WriteStep(str(tmp_path / "plate.step"))
    points = [(0.05, 0.05, 0.0), (0.55, 0.05, 0.0), (0.3, 0.35, 0.0)]
    line = {"file": "plate.step", "size": "120 mm", "young": "70 GPa", "poisson": 0.3, "density": 2700.0}
    table = SolidTable(kind="solid", attachments=points, radius=0.06, modes=3, **line)
    body = platform(table, tmp_path)
    mesh = pf.fe.step_mesh(tmp_path / "plate.step", size=0.12)
    solid = pf.fe.solid_body(mesh, pf.fe.Material(7e10, 0.3, 2700.0))
    expected = pf.fe.FreeFreeWithAttachment(3, points, radius=0.06).modes(solid)
    assert np.allclose(body.stiffness, expected.frequencies**2)
    assert np.allclose(body.attachment_points, np.array(points) - [0.3, 0.2, 0.015], atol=1e-9)
