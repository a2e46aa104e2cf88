"""What a file or a mesh has of a body (`Found`), and a body from the cells of a mesh."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar

import numpy as np

from ...base.arrays import frozen
from ...base.errors import InputError
from ...geometry.outline import Outline
from ...geometry.polygons import Polygons
from ...mesh.complex import CellComplex
from ...mesh.marked import marked_facets
from ...mesh.naming import names_by_number
from ..arguments import RESERVED, composed
from ..plane.account import Repair
from ..plane.shapes import Parts
from .faults import first_copies

__all__ = ["Found", "account", "free_name", "groups", "merged", "must_be_a_plane", "parts_of"]

Body = TypeVar("Body")


class Found(NamedTuple):
    """A body as a file has it.

    Attributes
    ----------
    parts : dict
        The arguments of a `Domain`.
    origin : ndarray of int, optional
        The number of each point in the file; by default they are counted.
    piece_origin : ndarray of int, optional
        The same of each piece.
    repairs : tuple of Repair
        What was done to read it.
    volumes : dict of str to float
        Bounds of regions by name.
    hole_seeds : (h, 3) float64, optional
    check : callable
        Raises what is wrong with the file by itself, in its numbers; called if no domain can be made of it.
    """

    parts: Parts
    origin: np.ndarray | None = None
    piece_origin: np.ndarray | None = None
    repairs: tuple[Repair, ...] = ()
    volumes: Mapping[str, float] = MappingProxyType({})
    hole_seeds: np.ndarray | None = None
    check: Callable[[], Any] = lambda: None


def account(domain: Body, found: Found) -> Body:
    """The domain that was made of what was found; it now accounts for the file."""
    body: Any = domain
    if found.origin is not None:
        body.origin = composed(found.origin, body.origin)
    if found.piece_origin is not None:
        body.piece_origin = composed(found.piece_origin, body.piece_origin)
    if found.hole_seeds is not None:
        body.hole_seeds = frozen(found.hole_seeds)
    body.repairs[:0] = found.repairs
    body.max_areas.update(found.volumes)
    return domain


def free_name(name: str) -> str:
    """A name for a marker: those that meshes have themselves are extended."""
    return f"{name} (file)" if name in RESERVED else name


def groups(names: Iterable[str], sizes: Iterable[int]) -> dict[str, np.ndarray]:
    """Markers of runs of pieces: a name each, or none; runs of equal names are joined."""
    found: dict[str, list[np.ndarray]] = {}
    start = 0
    for name, size in zip(names, sizes):
        if name and size:
            found.setdefault(free_name(name), []).append(np.arange(start, start + size))
        start += size
    return {name: np.concatenate(runs) for name, runs in found.items()}


def merged(corners: np.ndarray, what: str) -> tuple[np.ndarray, np.ndarray, np.ndarray, tuple[Repair, ...]]:
    """Equal points as one.

    Parameters
    ----------
    corners : (k, 3) float64
    what : str
        What repeats them, for the account.

    Returns
    -------
    points : (n, 3) float64
        In the order in which they come first.
    number : (k,) int32
        The point of each corner.
    origin : (n,) int32
        The first corner of each point.
    repairs : tuple of Repair
        Empty if nothing was merged.
    """
    first = first_copies(corners)
    origin, number = np.unique(first, return_inverse=True)
    repairs: tuple[Repair, ...] = ()
    if len(origin) < len(corners):
        text = f"merged {len(corners)} corners of {what} into {len(origin)} points: equal ones are the same"
        copy = int(np.flatnonzero(first != np.arange(len(first)))[0])
        where: Any = tuple(map(float, corners[copy]))
        repairs = (Repair("duplicate points", text, where),)
    return corners[origin], number.astype(np.int32), origin.astype(np.int32), repairs


def must_be_a_plane(domain: Any, what: str) -> None:
    """Raise if this is no planar domain."""
    if isinstance(domain, Outline) and hasattr(domain, "sampled"):
        if domain.points.shape[1] == 2:
            return
        raise InputError(f"a body in space cannot be {what}; this is for planar domains")
    raise InputError(f"a planar Domain can be {what}, not a {type(domain).__name__}")


# ---------------------------------------------------------------------- meshes


def parts_of(mesh: Any, name: str = "the mesh") -> Found:
    """The cells of a mesh of a surface as facets; ``name`` begins messages."""
    if not isinstance(mesh, CellComplex):
        raise InputError(f"surface takes a Mesh of triangles in space, not a {type(mesh).__name__}")
    if mesh.points.shape[1] != 3 or mesh.dimension != 2:
        if mesh.dimension == 3:
            hint = "its boundary is one: Mesh(mesh.points, mesh.boundary)"
        elif mesh.points.shape[1] == 2:
            hint = "it is planar: read it with Mesh.read, or give the points a third coordinate"
        else:
            hint = "triangles, quadrilaterals or polygons are needed"
        raise InputError(
            f"{name} is no surface in space: cells have dimension {mesh.dimension}, points "
            f"{mesh.points.shape[1]} coordinates; {hint}"
        )
    blocks = []
    for rows in mesh.cells.values():
        if len(rows):
            same = isinstance(rows, np.ndarray)
            blocks.append(Polygons.of_rows(rows) if same else Polygons.of_rings([[row] for row in rows]))
    polygons = Polygons.joined(*blocks)
    used = np.unique(polygons.vertices)
    number = np.zeros(len(mesh.points), dtype=np.int32)
    number[used] = np.arange(len(used))
    parts = {
        "points": mesh.points[used],
        "facets": polygons.renumbered(number),
        "markers": _markers(mesh),
    }
    return Found(parts, origin=used.astype(np.int32))


def _markers(mesh: CellComplex) -> dict[str, np.ndarray]:
    """The cells by the markers of the mesh."""
    found: dict[str, np.ndarray] = {}
    for name, values in mesh.markers.items():
        if values.ndim != 1:
            if values.shape[1] == 3 and list(mesh.cells) == ["triangle"]:  # triangles by their vertices
                rows = marked_facets(mesh.simplices, values, len(mesh.points))
                found[free_name(name)] = np.flatnonzero(rows)
            continue
        if values.dtype == bool:
            found[free_name(name)] = np.flatnonzero(values)
        elif values.dtype.kind in "iu":
            called = names_by_number(mesh.regions) if name == "region" else {}
            for value in np.unique(values).tolist():
                if value or value in called:
                    found[free_name(called.get(value, f"{name} {value}"))] = np.flatnonzero(values == value)
    return found
