"""TetGen's ``.smesh`` and ``.poly``: facets, seeds of holes and of regions.

TetGen removes the outside, and holes from their seeds, as far as facets do not stop it. Here holes follow
from facets alone. So a polygon becomes a facet if it lies between a part that is removed and one that is
left, and an inner facet otherwise; as in ``plane/poly``.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ....base.errors import InputError
from ....base.files import suffix_of, text_of
from ....base.tables import Rows
from ....geometry.outline import Outline
from ....geometry.parity import even_odd
from ....geometry.polygons import Polygons
from ....geometry.triangle_pairs import points_on_triangles
from ....mesh.node_ele import read_points
from ...plane import faults
from ...plane.poly import hull_parts, region_name
from ..faults import find_faults, shell_of
from ..parts import UNBOUNDED, parts_in_space
from ..surfaces import Found

__all__ = ["in_space", "read_tetgen"]

Rings = list[list[int]]


def in_space(path: Path) -> bool:
    """Whether the points of a ``.poly`` have three coordinates; False if that cannot be found out."""
    rows = Rows(path, text_of(path))
    for _ in range(2):
        head = rows.lines[0][1] if rows.lines else []
        if head[:1] != ["0"]:
            return head[1:2] == ["3"]
        node = _node(path)
        if not node.exists():
            return False
        rows = Rows(node, text_of(node))
    return False


def _node(path: Path) -> Path:
    return path.with_suffix(".NODE" if path.suffix.isupper() else ".node")


def read_tetgen(path: Path, *, make: Callable[..., Any], resolve: bool) -> Found:
    """Read a file; ``make`` (`Domain`) checks its facets and, with ``resolve``, repairs them."""
    rows = Rows(path, text_of(path))
    points, first = _vertices(path, rows)
    many, *flags = rows.count("the number of facets")
    simple = suffix_of(path) == ".smesh"
    rings: list[Rings] = []
    piece_origin: list[int] = []
    markers: dict[str, list[int]] = {}
    for i in range(many):
        found, mark = (_simple if simple else _facet)(rows, points, first, bool(flags and flags[0]))
        if mark:
            markers.setdefault(str(mark), []).extend(range(len(rings), len(rings) + len(found)))
        rings += found
        piece_origin += [i] * len(found)
    seeds = [_seed(rows, "holes") for _ in range(_count(rows, "the number of holes"))]
    regions: dict[str, list[list[float]]] = {}
    volumes: dict[str, float] = {}
    for _ in range(_count(rows, "the number of regions")):
        _, x, y, z, value, *bound = (rows.number(w, "regions") for w in rows.next(5, "a region"))
        name = region_name(value)
        regions.setdefault(name, []).append([x, y, z])
        if bound and bound[0] > 0:
            volumes[name] = min(volumes.get(name, np.inf), bound[0])
    holes = np.array(seeds, dtype=float).reshape(-1, 3)
    polygons = Polygons.of_rings(rings)
    check = partial(make, points, (), inner=polygons, markers=markers, resolve=resolve)
    # whether pieces meet is not asked before the domain is made of them: what bounds hardly depends on it
    pieces = {name: np.array(some, dtype=np.int32) for name, some in markers.items()}
    walls: Any = Outline(points, polygons.select(np.empty(0, dtype=np.int64)), polygons, {}, pieces, {})
    single = not resolve and not find_faults(walls, meetings=False)
    if not single:
        walls = check()
    bounding = _bounding(path, walls, holes)
    order = np.argsort(~bounding, kind="stable")
    place = np.argsort(order, kind="stable")
    parts = {
        "points": walls.points,
        "facets": walls.inner.select(np.flatnonzero(bounding)),
        "inner": walls.inner.select(np.flatnonzero(~bounding)),
        "markers": {name: place[pieces] for name, pieces in walls.markers.items()},
        "regions": regions,
    }
    origin = np.array(piece_origin, dtype=np.int32)
    if single:
        return Found(parts, None, origin[order], (), volumes, holes, check)
    known = walls.piece_origin[order]
    of_file = np.where(known >= 0, origin[np.maximum(known, 0)], -1) if len(origin) else known
    return Found(parts, walls.origin, of_file.astype(np.int32), tuple(walls.repairs), volumes, holes)


def _count(rows: Rows, what: str) -> int:
    return 0 if rows.end() else rows.count(what)[0]


def _seed(rows: Rows, what: str) -> list[float]:
    return [rows.number(word, what) for word in rows.next(4, what)[1:4]]


def _vertices(path: Path, rows: Rows) -> tuple[np.ndarray, int]:
    """Coordinates, and the number of the first vertex (0 or 1)."""
    many, *rest = rows.count("the number of vertices")
    if rest and rest[0] != 3:
        raise InputError(f"{rows.place}: the file is in {rest[0]} dimensions, not 3")
    if many == 0:
        points, _, first = read_points(_node(path))
        if points.shape[1] != 3:
            raise InputError(f"{_node(path).name} has points of {points.shape[1]} coordinates, not 3")
        return points, first
    points, first = np.empty((many, 3)), 0
    for i in range(many):
        number, *x = rows.next(4, "a vertex")[:4]
        if i == 0:
            first = rows.whole(number, "the numbers of vertices")
        points[i] = [rows.number(word, "vertices") for word in x]
    return points, first


def _polygon(rows: Rows, first: int, count: int) -> tuple[list[int], list[str]]:
    """The vertices of one polygon, which may go on in the next lines, and what is left of the last line."""
    words = rows.next(1, "a polygon")
    size = rows.whole(words[0], "the numbers of corners")
    words = words[1:]
    while len(words) < size:
        words = words + rows.next(1, f"a polygon of {size} corners")
    try:
        row = [int(word) - first for word in words[:size]]
    except ValueError:
        row = [rows.whole(word, "corners") - first for word in words[:size]]
    for v in row:
        if not 0 <= v < count:
            raise InputError(
                f"{rows.place}: there is no vertex {v + first}; the file has {first} to {count - 1 + first}"
            )
    if size < 1:
        raise InputError(f"{rows.place}: a polygon has {size} corners")
    return row, words[size:]


def _simple(rows: Rows, points: np.ndarray, first: int, marked: bool) -> tuple[list[Rings], int]:
    """A facet of a .smesh: one polygon and its mark."""
    row, rest = _polygon(rows, first, len(points))
    return _alone(row), rows.whole(rest[0], "markers") if marked and rest else 0


def _alone(row: list[int]) -> list[Rings]:
    """A polygon, a segment, or a vertex, which is not kept: it is a point anyway."""
    return [[row]] if len(row) > 1 else []


def _facet(rows: Rows, points: np.ndarray, first: int, marked: bool) -> tuple[list[Rings], int]:
    """A facet of a .poly: several polygons and seeds of its holes, and its mark."""
    head = [rows.whole(word, "a facet") for word in rows.next(1, "a facet")]
    place = rows.place
    many, holes, mark = (*head, *[0] * 3)[:3]
    polygons = [_polygon(rows, first, len(points))[0] for _ in range(many)]
    seeds = np.array([_seed(rows, "holes of a facet") for _ in range(holes)]).reshape(-1, 3)
    if len(polygons) == 1 and not holes:
        return _alone(polygons[0]), mark if marked else 0
    if max(map(len, polygons), default=0) < 3:
        return [[row] for row in polygons if len(row) == 2], mark if marked else 0
    return _of_several(place, points, polygons, seeds), mark if marked else 0


def _of_several(place: str, points: np.ndarray, polygons: Rings, seeds: np.ndarray) -> list[Rings]:
    """The pieces of a facet of several polygons: an outline with holes if it is one, else triangles."""
    number, at = np.unique(np.concatenate(polygons), return_inverse=True)
    sides, start = [], 0
    for row in polygons:
        mine = at[start : start + len(row)]
        sides.append(np.column_stack([mine, np.roll(mine, -1)])[: len(row) if len(row) > 2 else len(row) - 1])
        start += len(row)
    i, j = _view(points[max(polygons, key=len)])
    flat = np.ascontiguousarray(points[number][:, [i, j]])
    ends = np.unique(np.sort(np.concatenate(sides), axis=1), axis=0).astype(np.int32)
    wrong = faults.find_faults(Outline(flat, ends[:0], ends, {}, {}, {}))
    if wrong:
        raise InputError(
            f"{place}: the polygons of this facet cross or overlap ({wrong[0].kind}); split them"
        )
    inside = seeds[:, [i, j]]
    if len(seeds) == len(polygons) - 1 and len(number) == sum(map(len, polygons)):
        held = [even_odd(flat, part, inside)[0] for part in sides]
        outline = int(np.argmax([mask.sum() for mask in held]))
        rest = [k for k in range(len(polygons)) if k != outline]
        alone = all(len(polygons[k]) > 2 and held[k].sum() == 1 for k in rest)
        if alone and held[outline].all() and np.all(sum(held[k] for k in rest) == 1):
            return [[polygons[outline], *(polygons[k] for k in rest)]]
    mesh, part, beyond = hull_parts(flat, ends)
    cells = mesh.find_simplex(inside) if len(inside) else np.empty(0, dtype=np.int64)
    left = ~np.isin(part, np.concatenate([part[cells[cells >= 0]], beyond]))
    return [[row] for row in number[mesh.origin[mesh.simplices[left]]].tolist()]


def _view(ring: np.ndarray) -> tuple[int, int]:
    """The two coordinates in which a ring appears largest."""
    a, b = ring - ring[0], np.roll(ring - ring[0], -1, axis=0)
    axis = int(np.abs(np.cross(a, b).sum(axis=0)).argmax())
    return (axis + 1) % 3, (axis + 2) % 3


def _bounding(path: Path, walls: Outline, holes: np.ndarray) -> np.ndarray:
    """Which pieces lie between a part that TetGen removes and one that is left."""
    shell = shell_of(walls)
    if len(holes) and len(shell.triangles):
        n = len(walls.points)
        rows = np.arange(n, n + len(holes))
        on, triangle, _ = points_on_triangles(np.vstack([walls.points, holes]), rows, shell.triangles)
        if len(on):
            seed = int(on[0]) - n
            raise InputError(
                f"{path.name}: hole {seed} at {holes[seed].tolist()} lies on facet "
                f"{shell.piece[triangle[0]]}; move it into the hole"
            )
    parts = parts_in_space(walls.points, shell.triangles)
    removed = np.unique(np.append(parts.locate(holes), UNBOUNDED))
    differs = np.isin(parts.front, removed) != np.isin(parts.back, removed)
    return np.bincount(shell.piece[differs], minlength=len(walls.inner)).astype(bool)
