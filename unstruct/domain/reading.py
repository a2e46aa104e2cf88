"""`Domain.read`: from planar sources, or from files of bodies in space."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ..base.errors import InputError
from ..base.files import suffix_of
from .plane.sources import read_domain
from .space.sources import body_path, read_body
from .space.surfaces import account
from .space.welding import merging, welded

__all__ = ["read"]

TETGEN = (".smesh", ".poly", ".node")  # whose facets are checked while they are read


def read(
    cls: Any,
    make: Callable[[dict[str, Any], Mapping[str, Any]], Any],
    source: str | Path,
    *,
    shape: str,
    name: str | None,
    merge: float | None,
    options: Mapping[str, Any],
) -> Any:
    """The domain of a source; see `Domain.read`. ``make`` joins parts and options."""
    path = body_path(source)
    tolerance = merging(merge)
    if tolerance is not None and (path is None or suffix_of(path) in TETGEN):
        raise InputError("merge is for files of surfaces in space, such as .stl, .obj, .off, .ply and meshes")
    if path is None:
        return read_domain(cls, make, source, shape=shape, name=name, options=options)
    found = welded(read_body(path, make=cls, resolve=bool(options.get("resolve"))), tolerance)
    try:
        made = make(found.parts, options)
    except InputError:
        found.check()
        raise
    return account(made, found)
