"""The arguments of a `Domain`: they are checked and converted, or an error says which one is wrong."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

from ..base.arguments import as_mapping
from ..base.arrays import INT32, as_points, frozen
from ..base.checked import CheckedDict
from ..base.errors import InputError
from ..geometry.curves import Arc, Bezier, Curve, CurveLike
from ..geometry.outline import Outline
from ..geometry.polygons import Polygons

__all__ = [
    "DomainOptions",
    "around",
    "as_curves",
    "as_ring",
    "as_segments",
    "joined",
    "named_parts",
    "refuse_tiny",
]


class DomainOptions(TypedDict, total=False):
    """The arguments of a `Domain` that all functions take which make one of something else."""

    inner: Any
    curves: Mapping[int, CurveLike] | None
    markers: Mapping[str, Any] | None
    regions: Mapping[str, Any] | None
    resolve: bool


LEAST_SCALE = 2.0**-1000  # of the largest coordinate, where new vertices are made
RESERVED = ("facets", "inner", "region")  # markers that every mesh of a domain has


def as_segments(rows: Any, name: str) -> np.ndarray:
    """Pairs of vertices as int32, shape (s, 2)."""
    if type(rows) is np.ndarray and rows.dtype is INT32 and rows.ndim == 2 and rows.shape[1] == 2:
        return frozen(rows.copy())
    if np.ma.isMaskedArray(rows) and np.ma.getmaskarray(rows).any():
        row = int(np.argwhere(np.ma.getmaskarray(rows))[0][0])
        raise InputError(f"{name}[{row}] is masked; drop masked rows first")
    try:
        array = np.asarray(rows)
    except ValueError:
        raise InputError(f"{name} must be an array of shape (s, 2): pairs of vertices") from None
    if array.size == 0:
        return frozen(np.empty((0, 2), dtype=np.int32))
    if array.ndim != 2 or array.shape[1] != 2:
        raise InputError(f"{name} must have shape (s, 2): pairs of vertices, not {array.shape}")
    if array.dtype.kind not in "iu":
        raise InputError(f"{name} must be integers, not {array.dtype}")
    if array.dtype.itemsize > 2 and not (-(2**31) <= array.min() <= array.max() < 2**31):
        raise InputError(f"{name} has entries beyond 32 bits: there are no such vertices")
    return frozen(np.array(array, dtype=np.int32))


def refuse_tiny(points: np.ndarray) -> None:
    """Raise if new vertices among these points would be numbers for which doubles have too few digits."""
    largest = float(np.abs(points).max(initial=0.0))
    if largest < LEAST_SCALE:
        raise InputError(
            f"the largest coordinate is {largest}, and doubles below {LEAST_SCALE:.0e} have too few digits "
            "for new vertices: scale the domain and the size"
        )


def as_curves(curves: Mapping[int, CurveLike], many: int) -> dict[int, CurveLike]:
    """Curves by piece number, in order."""
    as_mapping(curves, "curves")
    result = {}
    wrong = [piece for piece in curves if isinstance(piece, bool) or not isinstance(piece, int | np.integer)]
    if wrong:
        raise InputError(f"curves has the key {wrong[0]!r}; keys must be piece numbers")
    for piece in sorted(curves):
        if not 0 <= piece < many:
            raise InputError(f"curves[{piece}] names no piece: there are pieces 0..{many - 1}")
        if not isinstance(curves[piece], Arc | Bezier | Curve | CurveLike):  # the last test is slow
            raise InputError(f"curves[{piece}] must have a method point(t), but it is {curves[piece]!r}")
        result[int(piece)] = curves[piece]
    return result


def as_marker_of_pieces(name: str, pieces: Any, _: Mapping[str, np.ndarray], many: int) -> np.ndarray:
    """Unique piece numbers of one name, checked."""
    if name in RESERVED:
        raise InputError(f"markers[{name!r}]: meshes use this name themselves; take another name")
    try:
        array = np.asarray(pieces)
    except ValueError:  # ragged
        raise InputError(f"markers[{name!r}] must be a list of piece numbers") from None
    if array.ndim != 1 or (array.size and array.dtype.kind not in "iu"):
        raise InputError(f"markers[{name!r}] must be a list of piece numbers")
    if array.size and not 0 <= array.min() <= array.max() < many:
        wrong = int(array[(array < 0) | (array >= many)][0])
        raise InputError(f"markers[{name!r}] names pieces outside 0..{many - 1}, such as {wrong}")
    return frozen(np.unique(array).astype(np.int32))


def as_seeds_of_region(
    name: str, seeds: Any, _: Mapping[str, np.ndarray], dimension: int
) -> NDArray[np.float64]:
    """Seeds (r, d) of one name; a single point is one seed."""
    try:
        single = np.ndim(seeds) == 1
    except ValueError:  # ragged: the rows are judged below
        single = False
    rows = as_points([seeds] if single else seeds, f"regions[{name!r}]")
    if rows.shape[1] != dimension:
        raise InputError(f"regions[{name!r}] must have shape (r, {dimension}), not {rows.shape}")
    return frozen(rows)


def named_parts(
    markers: Any, regions: Any, many: int, dimension: int
) -> tuple[CheckedDict[np.ndarray], CheckedDict[np.ndarray]]:
    """Pieces by name, and seeds by name, checked; what is put in later is checked, too."""
    pieces: CheckedDict[np.ndarray] = CheckedDict({}, "markers", partial(as_marker_of_pieces, many=many))
    seeds: CheckedDict[np.ndarray] = CheckedDict(
        {}, "regions", partial(as_seeds_of_region, dimension=dimension)
    )
    if markers is not None:
        pieces.update(as_mapping(markers, "markers"))
    if regions is not None:
        seeds.update(as_mapping(regions, "regions"))
    return pieces, seeds


def as_ring(ring: Any, name: str, least: int = 3) -> np.ndarray:
    """The corners of a ring, (k, 2), without a repeated last one; at least ``least`` of them."""
    if isinstance(ring, Mapping) or hasattr(ring, "__geo_interface__"):
        raise InputError(
            f"{name} is a geometry and not an array of corners: use Domain.from_geojson(geometry), which "
            "reads polygons with their holes"
        )
    rows = as_points(ring, name)
    if rows.shape[1] != 2:
        raise InputError(f"{name} must have shape (k, 2), not {rows.shape}")
    if len(rows) > 1 and (rows[0] == rows[-1]).all():
        rows = rows[:-1]
    if len(rows) < least:
        raise InputError(f"{name} has {len(rows)} corners; a ring needs three")
    return rows


def around(first: int, count: int) -> np.ndarray:
    """The segments of a ring of ``count`` vertices from ``first`` on."""
    index = np.arange(count)
    return np.column_stack([index, np.roll(index, -1)]) + first


def joined(domains: Sequence[Outline]) -> dict[str, Any]:
    """The arguments of one domain with the pieces of several: all facets, then all inner pieces."""
    facets, inner, points = [], [], []
    curves: dict[int, CurveLike] = {}
    markers: dict[str, list[int]] = {}
    regions: dict[str, list[np.ndarray]] = {}
    many = sum(len(d.facets) for d in domains)
    start, first, last = 0, 0, many
    for d in domains:
        f = len(d.facets)
        number = np.concatenate([first + np.arange(f), last + np.arange(len(d.inner))])
        facets.append(_moved(d.facets, start, d.points.shape[1]))
        inner.append(_moved(d.inner, start, d.points.shape[1]))
        points.append(d.points)
        curves |= {int(number[piece]): curve for piece, curve in d.curves.items()}
        for name, pieces in d.markers.items():
            markers.setdefault(name, []).extend(number[pieces].tolist())
        for name, seeds in d.regions.items():
            regions.setdefault(name, []).extend(seeds)
        start, first, last = start + len(d.points), first + f, last + len(d.inner)
    return {
        "points": np.concatenate(points),
        "facets": _stacked(facets),
        "inner": _stacked(inner),
        "curves": curves,
        "markers": markers,
        "regions": regions,
    }


def _moved(pieces: Any, start: int, dimension: int) -> Any:
    """Pieces whose vertices have numbers larger by ``start``; polygons in space."""
    if dimension == 2:
        return pieces + start
    rows = Polygons.of(pieces)
    return Polygons(rows.vertices + np.int32(start), rows.ring_start, rows.first_ring)


def _stacked(parts: list[Any]) -> Any:
    """Pieces of several domains as those of one."""
    return Polygons.joined(*parts) if isinstance(parts[0], Polygons) else np.concatenate(parts)


def composed(first: np.ndarray, then: np.ndarray) -> np.ndarray:
    """``first[then]``, -1 where ``then`` names no entry of ``first``."""
    known = (then >= 0) & (then < len(first))
    return frozen(
        np.where(known, first[np.where(known, then, 0)], -1).astype(np.int32) if len(first) else then
    )
