"""Stresses of the modes at the platform's nodes, from a modal file that has elements."""

from pathlib import Path

import numpy as np
import xarray as xr

from parflex.base.errors import InputError

ALIKE = 1e-6  # of the largest value: the same shapes, written once more
SIX = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))  # xx, yy, zz, xy, yz, xz


def with_stress(data: xr.Dataset, path: Path) -> xr.Dataset:
    """The result with the stress of each mode, Pa per unit of its coordinate, at the platform's nodes.

    Raises InputError where the file holds no modes with elements, or those of another platform.
    """
    from parflex.fe import read_modes, recover

    modes = read_modes(path)
    shapes = data["platform_shape"].values if "platform_shape" in data else np.zeros((0, 0, 3))
    largest = float(np.max(np.abs(shapes), initial=0.0))
    if (
        modes.shapes.shape != shapes.shape
        or np.max(np.abs(modes.shapes - shapes), initial=0.0) > ALIKE * largest
    ):
        raise InputError(
            f"--modes {path} has {len(modes.shapes)} modes at {len(modes.nodes)} nodes, which are not those "
            f"of the result ({shapes.shape[0]} at {shapes.shape[1]}); give the modal file of its platform"
        )
    stress = recover(modes, np.eye(len(shapes))).stress
    six = np.stack([stress[..., a, b] for a, b in SIX], axis=-1)
    about = {"units": "Pa kg-0.5 m-1", "long_name": "stresses of the modes: xx, yy, zz, xy, yz, xz"}
    return data.assign(platform_stress=(("mode", "node", "stress_component"), six, about))
