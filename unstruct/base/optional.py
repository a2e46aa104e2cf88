"""Packages that only some functions need: imported when they are needed, or an error says what to install."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from .errors import MissingPackageError

__all__ = ["optional"]

EXTRAS = {  # module -> (the package that has it, the extra of this library that installs it, if any)
    "anywidget": ("anywidget", "plot"),
    "contourpy": ("matplotlib", "plot"),
    "h5py": ("h5py", "hdf"),
    "ipywidgets": ("ipywidgets", "plot"),
    "matplotlib": ("matplotlib", "plot"),
    "meshio": ("meshio", "io"),
    "netCDF4": ("netCDF4", ""),
    "shapefile": ("pyshp", "io"),
    "skfem": ("scikit-fem", "fem"),
}


def optional(module: str, purpose: str) -> Any:
    """Import a package that the library itself does not require.

    Parameters
    ----------
    module : str
        One of `EXTRAS`, or a module of one, such as "matplotlib.textpath".
    purpose : str
        What needs it; this begins the message.

    Raises
    ------
    MissingPackageError
        If it is not installed; the message says how to install it.
    """
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        package, extra = EXTRAS[module.partition(".")[0]]
        ways = [f"pip install 'unstruct[{extra}]'"] if extra else []
        raise MissingPackageError(
            f"{purpose} needs {package}, and {error.name} is not installed: "
            + ", or ".join([*ways, f"pip install {package}"])
        ) from None
