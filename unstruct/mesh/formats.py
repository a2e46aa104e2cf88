"""Which kinds of cells and which options file formats have.

meshio converts other kinds, or leaves them out, with at most a message on the screen, or writes what it
cannot read; here it is an error. A test writes and reads each kind in every format that meshio knows.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import InputError
from ..base.files import suffix_of
from .fields import WITH_FIELDS

__all__ = [
    "MAY_BE_DOMAINS",
    "NEED_PACKAGE",
    "NOT_MESHES",
    "as_stored",
    "fits",
    "meshio_options",
    "positional",
    "refuse_options",
]

FLAT = ("triangle", "quad")
SOLID = ("tetra", "pyramid", "wedge", "hexahedron")
WRITABLE_KINDS: dict[str, tuple[str, ...]] = {
    ".stl": ("triangle",),
    ".off": ("triangle",),
    ".obj": (*FLAT, "polygon"),
    ".ply": (*FLAT, "polygon"),
    ".xml": ("triangle", "tetra"),
    ".wkt": ("triangle",),
    ".h5m": ("line", "triangle", "tetra"),
    ".cgns": ("tetra",),
    ".f3grid": ("tetra", "pyramid", "hexahedron"),  # meshio turns wedges inside out
    ".su2": (*FLAT, *SOLID),
    ".ugrid": (*FLAT, *SOLID),
    **dict.fromkeys([".tec", ".dat"], ("line", *FLAT, "tetra", "hexahedron")),
    **dict.fromkeys([".inp", ".mdpa"], ("line", *FLAT, "tetra", "wedge", "hexahedron")),
    **dict.fromkeys([".msh", ".avs", ".mesh", ".meshb", ".bdf", ".fem", ".nas"], ("line", *FLAT, *SOLID)),
    **dict.fromkeys([".post", ".dato", ".vol", ".exo", ".e", ".ex2"], ("line", *FLAT, *SOLID)),
    **dict.fromkeys([".post.gz", ".dato.gz", ".vol.gz"], ("line", *FLAT, *SOLID)),
    **dict.fromkeys([".med", ".xdmf", ".xmf", ".hmf"], ("line", *FLAT, *SOLID)),
}
NEED_PACKAGE = {
    **dict.fromkeys([".xdmf", ".xmf", ".h5m", ".med", ".cgns", ".hmf"], "h5py"),
    **dict.fromkeys([".exo", ".e", ".ex2"], "netCDF4"),
}
NASTRAN = (".bdf", ".fem", ".nas")
NASTRAN_WIDTH = 16  # characters of a number there
DOMAIN = "read it with Domain.read, and mesh the domain"
NOT_MESHES = {
    **dict.fromkeys([".poly", ".smesh", ".geojson", ".json", ".shp", ".shx", ".dbf"], DOMAIN),
    **dict.fromkeys([".geo", ".step", ".stp", ".igs", ".iges"], "Gmsh makes meshes of such files"),
    **dict.fromkeys([".png", ".jpg", ".svg", ".pdf"], "a picture has no cells"),
}
MAY_BE_DOMAINS = {
    ".dat": "(The coordinates of an airfoil are read by Domain.read.)",
    ".wkt": "(Polygons are read by Domain.read.)",
    **dict.fromkeys([".xdmf", ".xmf"], "(meshio reads none with single vertices beside other cells.)"),
}
# Keywords of meshio for files that are binary, and for those that are text.
BINARY_OPTIONS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    **dict.fromkeys([".vtk", ".vtu", ".stl", ".ply"], ({"binary": True}, {"binary": False})),
    **dict.fromkeys([".xdmf", ".xmf"], ({"data_format": "HDF"}, {"data_format": "XML"})),
}
ALONE = (".xml", ".tec", ".dat")  # these formats store cells of one kind only


def fits(kinds: Sequence[str], path: Path) -> None:
    """Check that a format can store cells of these kinds (those that have cells) unchanged.

    Raises
    ------
    InputError
        If it cannot; the message names the kinds.
    """
    suffix = suffix_of(path)
    if not kinds:
        raise InputError(
            f"a mesh without cells cannot be written as {suffix!r}; .node and .ele store one of simplices"
        )
    if suffix == ".ugrid" and len(path.suffixes) < 2:
        raise InputError(f"meshio cannot read .ugrid as text: call the file {path.stem}.lb8.ugrid")
    known = WRITABLE_KINDS.get(suffix, tuple(kinds))
    lost = [name for name in kinds if name not in known]
    why = ""
    if lost:
        why = f"it stores cells of kind {', '.join(known)}, not {', '.join(lost)}"
    elif suffix in ALONE and len(kinds) > 1:
        why = f"it stores cells of one kind only, not {', '.join(kinds)}"
    if why:
        raise InputError(f"cannot write this mesh as {suffix!r}: {why}; .vtu stores all")


def as_stored(points: np.ndarray, suffix: str) -> np.ndarray:
    """Coordinates as a format can hold them: in Nastran's they have 16 characters, 9 to 12 digits of them."""
    if suffix not in NASTRAN:
        return points
    flat = [_shortened(x) for x in points.ravel().tolist()]
    return np.array(flat, dtype=np.float64).reshape(points.shape)


def _shortened(x: float) -> float:
    digits = NASTRAN_WIDTH - 5 - (x < 0)  # all but a sign, a digit, the point, and an exponent of one digit
    text = f"{x:.{digits}e}"
    return float(f"{x:.{digits - len(str(abs(int(text.partition('e')[2])))) + 1}e}")


def positional(number: bytes) -> bytes:
    """A number of a text file without an exponent, as the same double."""
    return np.format_float_positional(float(number), trim="0").encode()


def meshio_options(suffix: str, binary: bool | None) -> dict[str, Any]:
    """The keywords of meshio for a format; by default those that meshio has."""
    if binary is None:
        return {}
    if suffix not in BINARY_OPTIONS:
        refuse_options(suffix, binary=binary)
    return BINARY_OPTIONS[suffix][0 if binary else 1]


def refuse_options(suffix: str, **options: Any) -> None:
    """An error for options that are given but that a format does not have."""
    takers = {
        "version": ".msh",
        "thickness": "a folder named polyMesh",
        "binary": ", ".join([".msh", *BINARY_OPTIONS]),
        **dict.fromkeys(["point_data", "cell_data"], ", ".join(WITH_FIELDS)),
    }
    for name, value in options.items():
        if value is not None:
            raise InputError(f"{suffix} has no option {name!r}; it is for {takers[name]}")
