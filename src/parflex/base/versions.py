"""Versions of the packages that parflex stands on."""

from importlib.metadata import PackageNotFoundError, version
from platform import platform, python_version

PACKAGES = (
    *("numpy", "scipy", "casadi", "scikit-fem", "xarray", "h5netcdf", "matplotlib", "llvmlite"),
    *("netgen-mesher", "meshio"),
)


def versions() -> dict[str, str]:
    """Versions of Python, the platform, and the packages that parflex stands on."""
    found = {"python": python_version(), "platform": platform()}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found
