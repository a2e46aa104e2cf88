"""What a body in space can be read from: STL, OFF, PLY, OBJ, TetGen's files, and meshes of surfaces."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import InputError
from ...base.files import as_path, suffix_of
from ...mesh.mesh import Mesh
from ...mesh.node_ele import read_points
from .formats.off import read_obj, read_off
from .formats.ply import read_ply
from .formats.stl import read_stl
from .formats.tetgen import in_space, read_tetgen
from .surfaces import Found, parts_of

__all__ = ["BODY_SUFFIXES", "body_path", "read_body"]

READERS: dict[str, Callable[[Path], Found]] = {
    ".stl": read_stl,
    ".off": read_off,
    ".ply": read_ply,
    ".obj": read_obj,
}
BODY_SUFFIXES = (*READERS, ".smesh")  # of files that are bodies in space whatever they contain
SURFACES = tuple(".msh .vtu .vtk .xdmf .mesh .meshb .inp .bdf .med .cgns .ele .su2".split())


def body_path(source: Any) -> Path | None:
    """The path of a file that may be a body in space; None for all else."""
    if isinstance(source, str) and ("\n" in source or source.lstrip("\ufeff \t")[:1] in ("{", "[")):
        return None
    path = as_path(source)
    suffix = suffix_of(path)
    if suffix in BODY_SUFFIXES or suffix in SURFACES:
        return path
    if suffix == ".poly" and path.is_file() and in_space(path):
        return path
    if suffix == ".node" and path.is_file() and read_points(path)[0].shape[1] == 3:
        return path
    return None


def read_body(path: Path, *, make: Callable[..., Any], resolve: bool) -> Found:
    """What a file has of a body; ``make`` (`Domain`) checks the facets of TetGen's files."""
    suffix = suffix_of(path)
    if suffix in READERS:
        return READERS[suffix](path)
    if suffix in (".smesh", ".poly"):
        return read_tetgen(path, make=make, resolve=resolve)
    if suffix == ".node":
        return Found({"points": read_points(path)[0], "facets": np.empty((0, 3), dtype=np.int32)})
    mesh = Mesh.read(path)
    if mesh.points.shape[1] == 2:
        raise InputError(f"{path.name} is a planar mesh, not a region: read it with Mesh.read")
    return parts_of(mesh, path.name)
