"""Bodies that a planar domain sweeps over: along a vector, or around an axis.

Straight pieces, and the chords of curves, become walls; inner pieces become inner walls; loose points become
inner segments. The ends of the body are polygons with holes, cut along inner pieces (see `caps`). What a
straight piece at right angles to the axis sweeps around it is flat, and one polygon.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET, as_count, finite, positive
from ...base.errors import InputError
from ...geometry.edge_vectors import lengths
from ...geometry.parity import left_parity
from ...geometry.polygons import Polygons
from ..plane.sample import Sampled
from ..plane.shapes import Parts
from .bodies import as_vector
from .caps import capped
from .rings import circle

__all__ = ["extruded", "revolved"]

FULL_TURN = 360.0
STEPS_A_TURN = 32  # without a size or a count
FEWEST_STEPS = 3  # a full turn


def _turned(chords: Sampled) -> NDArray[np.int32]:
    """The chords, those of facets turned so that the inside is on their left."""
    rows = chords.piece < len(chords.outline.facets)
    ends = chords.ends.copy()
    left = left_parity(chords.points, ends[rows])
    ends[rows] = np.where(left[:, None], ends[rows], ends[rows][:, ::-1])
    return ends


def _names(given: Any, taken: Iterable[str], default: tuple[str, str]) -> tuple[str, str]:
    """The names of the two ends."""
    if given is None:
        taken = set(taken)
        return default if not taken & set(default) else (f"{default[0]} end", f"{default[1]} end")
    names = tuple(given) if isinstance(given, list | tuple) else ()
    if len(names) != 2 or not all(isinstance(name, str) for name in names):
        raise InputError(f"ends must be two names, such as {default}, not {given!r:.60}")
    return names[0], names[1]


def _parts(
    points: np.ndarray,
    walls: list[list[list[tuple[int, ...]]]],
    chords: Sampled,
    ends: tuple[Polygons, Polygons, tuple[str, str]],
    lines: list[tuple[int, int]],
) -> Parts:
    """The arguments of a domain whose walls stand on the chords of a planar one.

    Facets are the walls on facets, then the two ends; inner pieces are the other walls, then lines.
    """
    outline = chords.outline
    bounding = chords.piece < len(outline.facets)
    of_facets = [wall for wall, bounds in zip(walls, bounding) if bounds]
    of_inner = [wall for wall, bounds in zip(walls, bounding) if not bounds]
    start, end, names = ends
    facets = Polygons.joined(Polygons.of_rings([rings for wall in of_facets for rings in wall]), start, end)
    inner = Polygons.of_rings([rings for wall in of_inner for rings in wall] + [[row] for row in lines])
    sizes = np.array([len(wall) for wall in [*of_facets, *of_inner]], dtype=np.int64)
    piece = np.repeat(np.concatenate([chords.piece[bounding], chords.piece[~bounding]]), sizes)
    many = int(sizes[: len(of_facets)].sum())
    number = np.arange(len(piece))
    number[many:] += len(start) + len(end)
    markers = {name: number[np.isin(piece, rows)] for name, rows in outline.markers.items()}
    markers = {name: rows for name, rows in markers.items() if len(rows)}  # pieces on an axis have no wall
    if len(start):
        for name, first, part in zip(names, (many, many + len(start)), (start, end)):
            markers[name] = np.union1d(markers.get(name, []), first + np.arange(len(part))).astype(int)
    return {"points": points, "facets": facets, "inner": inner, "markers": markers}


def extruded(planar: Any, height: Any, size: Any, layers: Any, ends: Any) -> Parts:
    """See `bodies.extruded`."""
    if np.ndim(height) == 0:
        along = np.array([0.0, 0.0, finite(height, "height")])
    else:
        along = as_vector(height, "height")
    if along[2] == 0.0:
        raise InputError(f"height = {along.tolist()} stays in the plane: give it a third coordinate")
    chords = planar.sampled(size)
    if layers is None:
        many = 1 if size is None or callable(size) else _steps(lengths(along), size)
    else:
        many = as_count(layers, "layers")
        if many == 0:
            raise InputError("layers = 0 leaves no body: give at least one")
    n = len(chords.points)
    _within_budget(n, many + 1)
    flat = np.column_stack([chords.points, np.zeros(n)])
    points = np.concatenate([flat + along * (k / many) for k in range(many + 1)])
    turned = _turned(chords)
    up = 1 if along[2] > 0 else -1  # quadrilaterals run the other way round below the plane
    walls = [
        [[(a + k * n, b + k * n, b + (k + 1) * n, a + (k + 1) * n)[::up]] for k in range(many)]
        for a, b in turned.tolist()
    ]
    cap = capped(chords, turned)
    under, over = _reversed(cap), cap.renumbered(np.arange(n, dtype=np.int32) + np.int32(many * n))
    if up < 0:
        under, over = cap, _reversed(over)
    names = _names(ends, planar.markers, ("bottom", "top"))
    lines = [(v + k * n, v + (k + 1) * n) for v in planar.loose.tolist() for k in range(many)]
    parts = _parts(points, walls, chords, (under, over, names if up > 0 else (names[1], names[0])), lines)
    middle = along / 2
    parts["regions"] = {
        name: np.column_stack([seeds, np.zeros(len(seeds))]) + middle
        for name, seeds in planar.regions.items()
    }
    return parts


def _steps(length: Any, size: Any) -> int:
    """The number of steps of a given size along a length."""
    return max(1, round(float(length) / positive(size, "size")))


def _within_budget(points: int, copies: int) -> None:
    if points * copies > DEFAULT_BUDGET:
        raise InputError(f"there would be {points * copies} points; give a larger size or fewer layers")


def _reversed(polygons: Polygons) -> Polygons:
    """The same polygons, seen from the other side."""
    sizes = np.diff(polygons.ring_start)
    mirror = np.repeat(polygons.ring_start[:-1] + polygons.ring_start[1:] - 1, sizes)
    turned = polygons.vertices[mirror - np.arange(len(polygons.vertices))]
    return Polygons(turned, polygons.ring_start, polygons.first_ring)


def revolved(planar: Any, angle: Any, size: Any, count: Any, ends: Any) -> Parts:
    """See `bodies.revolved`."""
    whole = finite(angle, "angle")
    if not 0.0 < whole <= FULL_TURN:
        raise InputError(f"angle = {whole:g} must be more than 0 and at most 360 degrees")
    chords = planar.sampled(size)
    x = chords.points[:, 0]
    if len(x) and x.min() < 0.0:
        v = int(np.argmin(x))
        raise InputError(
            f"the domain crosses the axis, at {chords.points[v].tolist()}: x is the distance from the axis, "
            "which is not negative"
        )
    many = _sectors(whole, float(x.max(initial=0.0)), size, count)
    closed = whole == FULL_TURN
    copies = many if closed else many + 1
    _within_budget(len(x), copies)
    turn = circle(np.arange(copies) / many * (whole / FULL_TURN))
    on_axis, turned = x == 0.0, _turned(chords)
    flat = _flat_ones(chords, turned, on_axis, closed)
    left_out = np.zeros(len(x), dtype=bool)  # middles of discs
    left_out[turned[flat]] = closed
    left_out &= on_axis
    number = np.empty((copies, len(x)), dtype=np.int64)  # of each copy of each point
    kept = on_axis & ~left_out
    many_on_axis, off = np.count_nonzero(kept), np.count_nonzero(~on_axis)
    number[:, kept] = np.arange(many_on_axis)
    number[:, left_out] = -1
    number[:, ~on_axis] = many_on_axis + np.arange(copies * off).reshape(copies, off)
    points = np.empty((many_on_axis + copies * off, 3))
    for k in range(copies):
        at = np.column_stack([x * turn[k, 0], x * turn[k, 1], chords.points[:, 1]])
        points[number[k][~left_out]] = at[~left_out]
    rows = number.tolist()
    pairs = [(rows[k], rows[(k + 1) % copies]) for k in range(many)]
    walls = [
        [] if on_axis[a] and on_axis[b]
        else [_flat(number, a, b, closed, bool(x[b] > x[a]))] if flat[i]
        else [[_sector(one, two, a, b)] for one, two in pairs]
        for i, (a, b) in enumerate(turned.tolist())
    ]  # fmt: skip
    if closed:
        start = end = Polygons.of_rows(np.empty((0, 3), dtype=np.int32))
    else:
        cap = capped(chords, turned)
        start = cap.renumbered(number[0].astype(np.int32))
        end = _reversed(cap.renumbered(number[-1].astype(np.int32)))
    names = _names(ends, planar.markers, ("start", "end"))
    lines = [(one[v], two[v]) for v in planar.loose.tolist() if not on_axis[v] for one, two in pairs]
    inner = chords.piece >= len(planar.facets)
    axis = inner & on_axis[turned].all(axis=1)
    lines += [(rows[0][a], rows[0][b]) for a, b in turned[axis].tolist()]
    parts = _parts(points, walls, chords, (start, end, names), lines)
    _without_vanished(parts, number[0][on_axis], number[0][planar.loose])
    parts["regions"] = {name: _middle_of_sector(seeds, turn) for name, seeds in planar.regions.items()}
    return parts


def _without_vanished(parts: Parts, on_axis: np.ndarray, asked: np.ndarray) -> None:
    """Drop points on the axis that only vanished pieces had; loose points that are asked for stay."""
    keep = np.ones(len(parts["points"]), dtype=bool)
    keep[on_axis] = False
    for name in ("facets", "inner"):
        keep[parts[name].vertices] = True
    keep[asked] = True
    if keep.all():
        return
    moved = (np.cumsum(keep) - 1).astype(np.int32)
    parts["points"] = parts["points"][keep]
    for name in ("facets", "inner"):
        parts[name] = parts[name].renumbered(moved)


def _sectors(angle: float, far: float, size: Any, count: Any) -> int:
    """How many steps there are around the axis."""
    least = max(1, int(np.ceil(FEWEST_STEPS * angle / FULL_TURN)))
    if count is not None:
        given = as_count(count, "count")
        if given < least:
            raise InputError(f"count = {given} is too few: {angle:g} degrees need at least {least}")
        return given
    if size is None or callable(size):
        return max(least, round(STEPS_A_TURN * angle / FULL_TURN))
    return max(least, _steps(2 * np.pi * far * angle / FULL_TURN, size))


def _flat_ones(
    chords: Sampled, ends: NDArray[np.int32], on_axis: NDArray[np.bool_], closed: bool
) -> NDArray[np.bool_]:
    """Which chords sweep a flat wall that is one polygon: at right angles to the axis.

    A whole disc has no corner at the axis. So nothing else may end there but what has no wall either.
    """
    height = chords.points[:, 1]
    flat = height[ends[:, 0]] == height[ends[:, 1]]
    if not closed:
        return flat
    at_axis = on_axis[ends]
    other = ~flat & ~at_axis.all(axis=1)  # walls that are fans about a point of the axis, or cones
    other |= at_axis.all(axis=1) & (chords.piece >= len(chords.outline.facets))
    taken = np.zeros(len(on_axis), dtype=bool)
    taken[ends[other][at_axis[other]]] = True
    count = np.bincount(ends[flat & ~at_axis.all(axis=1)].ravel(), minlength=len(on_axis))
    taken |= on_axis & (count > 1)
    return flat & ~(at_axis & taken[ends]).any(axis=1)


def _flat(number: NDArray[np.int64], a: int, b: int, closed: bool, outer: bool) -> list[tuple[int, ...]]:
    """The rings of the flat wall of a chord, seen as `_sector`: an annulus or disc, or a part of one."""
    one, two = number[:, a].tolist(), number[:, b].tolist()[::-1]
    if not closed:
        return [tuple(dict.fromkeys([*one, *two]))]
    rings = [tuple(ring) for ring in (one, two) if ring[0] != ring[-1]]  # at the axis there is but one point
    return rings[::-1] if outer else rings


def _sector(one: list[int], two: list[int], a: int, b: int) -> tuple[int, ...]:
    """The part of a wall between two copies, seen from the right of the chord a b; a triangle at the axis."""
    row = (one[a], two[a], two[b], one[b])
    return tuple(dict.fromkeys(row))


def _middle_of_sector(seeds: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Points between the first two copies of points: on the chord, not on the circle."""
    middle = (turn[0] + turn[1 % len(turn)]) / 2
    return np.column_stack([seeds[:, :1] * middle, seeds[:, 1]])
