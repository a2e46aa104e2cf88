"""Geographic features, named polygons, lines and points, as the arguments of a `Domain`.

The meaning is that of the OGC's simple features, which GeoJSON and shapely share: a polygon is its outer ring
minus its holes, and several polygons cover what each of them covers. A common border of two polygons is an
inner line, so that each can be a region with a name.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple, cast

import numpy as np

from ...base.arrays import as_points
from ...base.errors import InputError
from ..arguments import around
from .account import Repair
from .covering import Covered, Rings, covered

__all__ = ["Features", "features_of", "from_features"]

USUAL_NAMES = ("name", "NAME", "id")  # properties that name a feature, unless another one is asked for
NO_AREA = "the polygons cover no area: correct their rings"

Feature = tuple[str | None, Any]  # name, geometry


class Features(NamedTuple):
    """Features as arguments of a `Domain`, and the account of what was changed."""

    parts: dict[str, Any]
    repairs: list[Repair]


# ---------------------------------------------------------------------- names


def features_of(geometry: Any, name: str | None = None) -> list[Feature]:
    """Pairs (name, geometry) of what GeoJSON calls a geometry, a feature or a collection of features.

    Parameters
    ----------
    geometry : mapping, object with ``__geo_interface__``, or iterable of these
    name : str, optional
        The property that names features. By default "name", "NAME" or "id", whichever comes first; a feature
        without any has its "id" or, in a collection, its number as name.

    Raises
    ------
    InputError
        If no feature has the property ``name``; the message lists those that there are.
    """
    found: list[Feature] = []
    seen: dict[str, None] = {}
    for number, one in _features(geometry):
        properties = one.get("properties") or {}
        if not isinstance(properties, Mapping):
            raise InputError(f"the properties of feature {number} must be a mapping, not {properties!r}")
        seen |= dict.fromkeys(properties)
        keys = USUAL_NAMES if name is None else (name,)
        values = [properties[key] for key in keys if properties.get(key) is not None]
        if name is None or values:
            values += [one[key] for key in ("id",) if one.get(key) is not None]
        called = str(values[0]) if values else None if number is None else str(number)
        found.append((called, one.get("geometry") if one.get("type") == "Feature" else one))
    if name is not None and name not in seen:
        raise InputError(
            f"no feature has the property {name!r}; there are {', '.join(map(repr, seen)) or 'none'}"
        )
    return found


def _features(geometry: Any) -> Iterator[tuple[int | None, Mapping[str, Any]]]:
    """Features with their numbers, or one geometry without a number."""
    geometry = getattr(geometry, "__geo_interface__", geometry)
    if isinstance(geometry, Mapping):
        if geometry.get("type") == "FeatureCollection":
            yield from _features(_member(geometry, "features"))
        else:
            yield None, geometry
    elif isinstance(geometry, Iterable) and not isinstance(geometry, str | bytes):
        for number, part in enumerate(geometry):
            yield number, _mapping(part)
    else:
        _mapping(geometry)


def _mapping(geometry: Any) -> Mapping[str, Any]:
    geometry = getattr(geometry, "__geo_interface__", geometry)
    if not isinstance(geometry, Mapping):
        raise InputError(
            "a geometry must be a mapping with a 'type', or an object with __geo_interface__ such as "
            f"shapely's, not {type(geometry).__name__}"
        )
    return geometry


def _member(geometry: Mapping[str, Any], name: str) -> Sequence[Any]:
    if not isinstance(geometry.get(name), list | tuple):
        raise InputError(f"a {geometry['type']} must have a list of {name!r}")
    return cast("Sequence[Any]", geometry[name])


# ---------------------------------------------------------------------- rings, lines, points


def _shapes(geometry: Any) -> Iterator[tuple[str, Any]]:
    """("polygon", rings), ("line", positions) and ("point", positions), empty ones too."""
    if geometry is None:  # null stands for a feature without a place
        return
    geometry = _mapping(geometry)
    kind, coordinates = geometry.get("type"), geometry.get("coordinates")
    if kind in ("FeatureCollection", "GeometryCollection"):
        for part in _member(geometry, "features" if kind == "FeatureCollection" else "geometries"):
            yield from _shapes(part)
    elif kind == "Feature":
        yield from _shapes(geometry.get("geometry"))
    elif kind in ("Polygon", "MultiPolygon"):
        for polygon in [coordinates] if kind == "Polygon" else coordinates or ():
            yield "polygon", polygon or ()
    elif kind == "LinearRing":
        yield "polygon", [coordinates or ()]
    elif kind in ("LineString", "MultiLineString"):
        for line in [coordinates] if kind == "LineString" else coordinates or ():
            yield "line", line or ()
    elif kind in ("Point", "MultiPoint"):
        yield "point", ([coordinates] if kind == "Point" and coordinates else coordinates) or ()
    else:
        raise InputError(f"the type {kind!r} of a geometry is unknown; use those of GeoJSON or LinearRing")


def _planar(coordinates: Any, name: str) -> np.ndarray:
    """Positions as points of the plane; heights are ignored, whether all positions have one or only some."""
    try:
        try:
            rows = np.asarray(coordinates)
        except ValueError:  # positions of different lengths
            rows = np.asarray([position[:2] for position in coordinates])
    except (TypeError, IndexError, KeyError, ValueError):
        raise InputError(f"{name} must be a list of positions (x, y), not {coordinates!r}") from None
    if rows.ndim != 2 or rows.shape[1] < 2:
        raise InputError(f"{name} must be a list of positions (x, y), not {coordinates!r}")
    return as_points(rows[:, :2], name)


class _Collected:
    """Points, segments, rings and polygons of features, in their order."""

    def __init__(self, features: Iterable[Feature], resolve: bool):
        self.resolve = resolve
        self.names: list[str | None] = []
        self.points: list[np.ndarray] = []
        self.segments: list[np.ndarray] = []
        self.owner: list[tuple[int, int]] = []  # for each block of segments its ring (or -1) and feature
        self.polygon: list[int] = []  # of each ring
        self.hole: list[int] = []  # of each ring: its number among the holes, -1 for a shell
        self.of: list[tuple[int, int]] = []  # of each polygon: its feature and its number there
        self.repairs: list[Repair] = []
        self.count = 0
        for feature, (name, geometry) in enumerate(features):
            self.names.append(None if name is None else str(name))
            number = 0
            for kind, coordinates in _shapes(geometry):
                if kind == "polygon":
                    number += self._polygon(coordinates, feature, number)
                elif len(coordinates):
                    self._line(_planar(coordinates, f"a {kind}"), feature, kind == "line")

    def _add(self, rows: np.ndarray) -> int:
        self.points.append(rows)
        self.count += len(rows)
        return self.count - len(rows)

    def _line(self, rows: np.ndarray, feature: int, joined: bool) -> None:
        first = self._add(rows)
        if joined and len(rows) > 1:
            steps = first + np.arange(len(rows) - 1)
            self.segments.append(np.column_stack([steps, steps + 1]))
            self.owner.append((-1, feature))

    def _polygon(self, rings: Any, feature: int, number: int) -> int:
        """Add a polygon; return 1, or 0 for an empty one."""
        added = 0
        for i, ring in enumerate(rings):
            if len(ring) == 0:
                if i == 0:
                    return 0
                continue
            rows = _planar(ring, "a ring")
            if len(rows) > 1 and (rows[0] == rows[-1]).all():
                rows = rows[:-1]
            if i == 0:
                self.of.append((feature, number))
            self.polygon.append(len(self.of) - 1)
            self.hole.append(i - 1)
            label = self.ring_name(len(self.polygon) - 1)
            if len(rows) < 3:
                text = f"{label} has {len(rows)} corners; a ring needs three"
                if not self.resolve:
                    raise InputError(text)
                x, y = rows[0].tolist()
                self.repairs.append(Repair("degenerate ring", f"{text}; it was dropped", (x, y)))
                self.polygon.pop(), self.hole.pop()
                if i == 0:
                    self.of.pop()
                    return 0
                continue
            self.segments.append(around(self._add(rows), len(rows)))
            self.owner.append((len(self.polygon) - 1, feature))
            added = 1
        return added

    def feature_name(self, feature: int) -> str:
        """What messages call a feature."""
        name = self.names[feature]
        if name is None and len(self.names) == 1:
            return "the geometry"
        return f"feature {feature}" if name in (None, str(feature)) else f"feature {name!r}"

    def ring_name(self, ring: int) -> str:
        """What messages call a ring."""
        feature, number = self.of[self.polygon[ring]]
        what = f"polygon {number} of {self.feature_name(feature)}"
        return what if self.hole[ring] < 0 else f"hole {self.hole[ring]} of {what}"

    def line_name(self, segment: int) -> str:
        """What messages call a segment of a line."""
        block = np.searchsorted(np.cumsum([len(s) for s in self.segments]), segment, side="right")
        return f"a line of {self.feature_name(self.owner[int(block)][1])}"

    def rings(self) -> Rings:
        """All as rows."""
        times = [len(rows) for rows in self.segments]
        ring = np.array([ring for ring, _ in self.owner], dtype=np.int64)
        return Rings(
            np.concatenate(self.points),
            np.concatenate([*self.segments, np.empty((0, 2), dtype=np.int64)]),
            np.repeat(ring, times),
            np.array(self.polygon, dtype=np.int64),
            np.array(self.hole, dtype=np.int64) >= 0,
        )


def from_features(features: Iterable[Feature], *, resolve: bool = False) -> Features:
    """The arguments of a `Domain` for named geometries.

    Parameters
    ----------
    features : iterable of (name or None, geometry)
        Geometries are mappings as in GeoJSON, or objects with ``__geo_interface__``. The name of polygons
        becomes that of a region, and the name of lines becomes a marker. A geometry of None is left out.
    resolve : bool
        Whether lines are split where they cross, and faults are mended: the first polygon owns what it shares
        with others, and holes are removed wherever they lie.

    Returns
    -------
    Features
        Facets lie between polygons and the outside, inner segments between polygons; lines are inner
        segments, too, and points are loose vertices. Equal coordinates are one vertex, and segments are split
        at vertices that lie exactly on them.

    Raises
    ------
    InputError
        For crossings, overlapping polygons, holes outside of their polygon or overlapping, and rings along
        themselves, unless ``resolve``; the message names the rings, the place and the remedy.

    Notes
    -----
    O(n log n).
    """
    found = _Collected(features, resolve)
    if not found.points and not found.repairs:
        raise InputError("the geometry is empty: give at least one polygon, line or point")
    if not found.points:
        raise InputError(NO_AREA)
    rings = found.rings()
    result = covered(rings, found.ring_name, found.line_name, resolve=resolve)
    repairs = found.repairs + result.repairs
    if len(result.facets) == 0 and (found.of or found.repairs):
        raise InputError(NO_AREA)
    parts: dict[str, Any] = {
        "points": result.points,
        "facets": result.facets,
        "inner": result.inner if len(result.inner) else None,
        "regions": _regions(found, result, resolve, repairs),
        "markers": _markers(found, result),
    }
    return Features({key: value for key, value in parts.items() if key != "markers" or value}, repairs)


def _regions(
    found: _Collected, result: Covered, resolve: bool, repairs: list[Repair]
) -> dict[str, np.ndarray]:
    """Seeds by name, in the order of the features."""
    feature = np.array([f for f, _ in found.of], dtype=np.int64)[result.polygon]
    order = np.argsort(feature, kind="stable")
    seeds: dict[str, list[list[float]]] = {}
    for f, x, sound in zip(feature[order].tolist(), result.seeds[order].tolist(), result.sound[order]):
        name = found.names[f]
        if name is None:
            continue
        if sound:
            seeds.setdefault(name, []).append(x)
            continue
        text = f"{found.feature_name(f)} has a part near ({x[0]:.6g}, {x[1]:.6g}) that is narrower than "
        if not resolve:
            raise InputError(
                text + "rounding errors: correct its rings, or let resolve=True leave it unnamed"
            )
        repairs.append(Repair("narrow part", text + "rounding errors; it has no name", (x[0], x[1])))
    return {name: np.array(rows) for name, rows in seeds.items()}


def _markers(found: _Collected, result: Covered) -> dict[str, np.ndarray]:
    """The pieces along named lines."""
    many = [len(rows) for rows in found.segments]
    of = np.repeat(np.array([-1 if ring >= 0 else feature for ring, feature in found.owner], dtype=int), many)
    feature, piece = of[result.parts[:, 0]], result.parts[:, 1]
    order = np.argsort(feature, kind="stable")
    called, first = np.unique(feature[order], return_index=True)
    markers: dict[str, list[np.ndarray]] = {}
    for f, pieces in zip(called.tolist(), np.split(piece[order], first[1:])):
        if f >= 0 and (name := found.names[f]) is not None:
            markers.setdefault(name, []).append(pieces)
    return {name: np.unique(np.concatenate(pieces)) for name, pieces in markers.items()}
