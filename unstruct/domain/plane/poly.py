"""Triangle's format ``.poly``: regions are given by segments, holes by seeds.

Triangle removes the outside, and holes from their seeds, as far as segments do not stop it. A ring without
the seed of a hole is a wall, not a hole. Here holes follow from facets alone. So a segment becomes a facet if
it lies between a part that is removed and a part that is left, and an inner segment otherwise.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import count
from pathlib import Path
from re import fullmatch
from typing import Any, NamedTuple

import numpy as np

from ...base.arrays import frozen
from ...base.errors import InputError
from ...base.files import replacing, suffix_of, text_of
from ...base.tables import Rows
from ...base.telling import tell, tell_renamed
from ...connect.planar.complex import PlanarComplex
from ...connect.planar.flood import mark_regions
from ...connect.planar.inserting import insert_all
from ...geometry.outline import Outline
from ...geometry.parity import even_odd
from ...mesh.marked import parts
from ...mesh.mesh import Mesh
from ...mesh.topology import oriented_facet
from ..arguments import composed
from .sample import Sampled
from .seeds import first_on_piece

__all__ = [
    "account",
    "hull_parts",
    "is_marker",
    "is_value",
    "numbers_for",
    "read_poly",
    "region_name",
    "tell_numbers",
    "write_poly",
]


# ---------------------------------------------------------------------- reading


def _vertices(path: Path, rows: Rows) -> tuple[np.ndarray, int]:
    """Coordinates, and the number of the first vertex (0 or 1)."""
    many, *rest = rows.count("the number of vertices")
    if many == 0:
        node = path.with_suffix(".NODE" if path.suffix.isupper() else ".node")
        if rows.path == node:
            raise InputError(f"{rows.place}: there are no vertices")
        return _vertices(path, Rows(node, text_of(node)))
    if rest and rest[0] != 2:
        raise InputError(f"{rows.place}: the file is in {rest[0]} dimensions, not 2")
    points, first = np.empty((many, 2)), 0
    for i in range(many):
        number, *x = rows.next(3, "a vertex")[:3]
        if i == 0:
            first = rows.whole(number, "the numbers of vertices")
        points[i] = [rows.number(w, "vertices") for w in x]
    return points, first


class Poly(NamedTuple):
    """What a file contains.

    Attributes
    ----------
    parts : dict
        The arguments of a `Domain`.
    areas : dict of str to float
        Area bounds of regions by name.
    walls : Domain
        All segments as inner segments; repaired if this was asked for.
    piece_origin : (s,) int32
        The segment of the file of which each piece is a part.
    holes : (h, 2) float64
        The seeds of holes.
    """

    parts: dict[str, Any]
    areas: dict[str, float]
    walls: Any
    piece_origin: np.ndarray
    holes: np.ndarray


def read_poly(path: Path, *, make: Callable[..., Any], resolve: bool) -> Poly:
    """Read a file; ``make`` (`Domain`) checks its segments and, with ``resolve``, repairs them."""
    rows = Rows(path, text_of(path))
    points, first = _vertices(path, rows)
    many, *flags = rows.count("the number of segments")
    segments = np.empty((many, 2), dtype=np.int64)
    markers: dict[str, list[int]] = {}
    for i in range(many):
        row = rows.next(3, "a segment")
        segments[i] = [rows.whole(w, "segments") - first for w in row[1:3]]
        if flags and flags[0] and len(row) > 3 and (mark := rows.whole(row[3], "markers")):
            markers.setdefault(str(mark), []).append(i)
    seeds = np.array(list(_seeds(rows, "holes")), dtype=float).reshape(-1, 2)
    regions: dict[str, list[list[float]]] = {}
    areas: dict[str, float] = {}
    for _ in range(0 if rows.end() else rows.count("the number of regions")[0]):
        _, x, y, value, *bound = (rows.number(w, "regions") for w in rows.next(4, "a region"))
        name = region_name(value)
        regions.setdefault(name, []).append([x, y])
        if bound and bound[0] > 0:
            areas[name] = min(areas.get(name, np.inf), bound[0])
    walls = make(points, (), inner=segments, markers=markers, resolve=resolve)
    on_piece = first_on_piece(walls, seeds) if len(seeds) else None
    if on_piece is not None:
        hole, where = on_piece
        where = where.replace("inner segment", "segment")
        raise InputError(
            f"{path.name}: hole {hole} at {seeds[hole].tolist()} lies on {where}; move it into the hole"
        )
    facets = _bounding(walls, seeds)
    order = np.concatenate([np.nonzero(facets)[0], np.nonzero(~facets)[0]])
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))
    parts = {
        "points": walls.points,
        "facets": walls.inner[facets],
        "inner": walls.inner[~facets],
        "markers": {name: place[pieces] for name, pieces in walls.markers.items()},
        "regions": regions,
    }
    return Poly(parts, areas, walls, walls.piece_origin[order], seeds)


def region_name(value: float) -> str:
    """The name of a region by its value, with all digits: seeds with equal names are one region."""
    return str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)


def _seeds(rows: Rows, what: str) -> Iterator[list[float]]:
    for _ in range(0 if rows.end() else rows.count(f"the number of {what}")[0]):
        yield [rows.number(w, what) for w in rows.next(3, what)[1:3]]


def _bounding(walls: Outline, seeds: np.ndarray) -> np.ndarray:
    """Which segments lie between a part that Triangle removes and a part that is left."""
    mesh, part, beyond = hull_parts(walls.points, walls.inner)
    cells = mesh.find_simplex(seeds) if len(seeds) else np.empty(0, dtype=np.int64)
    removed = np.isin(part, np.concatenate([part[cells[cells >= 0]], beyond]))
    cells, corner = np.nonzero(np.ones_like(mesh.neighbors, dtype=bool))
    sides = np.sort(oriented_facet(mesh.simplices, cells, corner), axis=1)
    other = mesh.neighbors[cells, corner]
    differs = removed[cells] != np.where(other < 0, True, removed[other])
    n = len(mesh.points)
    between = np.unique(sides[differs, 0].astype(np.int64) * n + sides[differs, 1])
    number = np.full(len(walls.points), -1, dtype=np.int64)
    number[mesh.origin] = np.arange(n)
    low, high = np.sort(number[walls.inner], axis=1).T
    return np.isin(low * n + high, between)


def hull_parts(points: np.ndarray, walls: np.ndarray) -> tuple[Mesh, np.ndarray, np.ndarray]:
    """Triangles of the convex hull, the part of each between segments, and the parts open to the outside."""
    complex_ = PlanarComplex(points)
    many = len(walls)
    span = np.tile([0.0, 1.0], (many, 1))
    insert_all(complex_, walls, np.arange(many, dtype=np.int32), span, facets=0)
    mark_regions(complex_, 0, {}, True)
    mesh = complex_.mesh(facets=0, origin=np.arange(len(points), dtype=np.int32), markers={}, points=points)
    marked = np.concatenate([mesh.markers["facets"], mesh.markers["inner"]])
    part = parts(mesh, marked)
    cells, corner = np.nonzero(mesh.neighbors < 0)
    sides = np.sort(oriented_facet(mesh.simplices, cells, corner), axis=1).astype(np.int64)
    walled = np.sort(marked, axis=1).astype(np.int64)
    n = len(mesh.points)
    free = ~np.isin(sides[:, 0] * n + sides[:, 1], walled[:, 0] * n + walled[:, 1])
    return mesh, part, np.unique(part[cells[free]])


def account(domain: Any, found: Poly) -> None:
    """Let a domain made of what was found account for the vertices and segments of the file."""
    domain.max_areas.update(found.areas)
    domain.hole_seeds = frozen(found.holes)
    domain.repairs[:0] = found.walls.repairs
    domain.origin = composed(found.walls.origin, domain.origin)
    domain.piece_origin = composed(found.piece_origin, domain.piece_origin)


# ---------------------------------------------------------------------- writing


def write_poly(
    domain: Outline, sampled: Sampled, areas: Mapping[str, float], seeds_of_holes: np.ndarray, path: Path
) -> None:
    """Write vertices, segments, a seed for each hole, and regions; every number has full precision."""
    if suffix_of(path) != ".poly":
        raise InputError(f"a region is written as .poly, not as {path.suffix!r}: change the file's name")
    marks = numbers_for(domain.markers, is_marker)
    mark = np.full(len(domain.pieces), "0", dtype=object)
    for name, pieces in domain.markers.items():
        mark[pieces] = marks[name]
    values = numbers_for(domain.regions, is_value)
    lines = [f"# marker {number}: {name!r}" for name, number in marks.items() if name != number]
    lines += [f"# region {number}: {name!r}" for name, number in values.items() if name != number]
    lines += [f"{len(sampled.points)} 2 0 0"]
    lines += [f"{i} {x!r} {y!r}" for i, (x, y) in enumerate(sampled.points.tolist())]
    lines += [f"{len(sampled.ends)} 1"]
    lines += [
        f"{i} {a} {b} {mark[piece]}"
        for i, ((a, b), piece) in enumerate(zip(sampled.ends.tolist(), sampled.piece))
    ]
    mesh, part, beyond = hull_parts(sampled.points, sampled.ends)
    order = np.lexsort((-mesh.volumes, part))
    largest = order[np.unique(part[order], return_index=True)[1]]  # the triangle of each part
    middle = mesh.points[mesh.simplices[largest[~np.isin(part[largest], beyond)]]].mean(axis=1)
    inside = even_odd(sampled.points, sampled.ends[sampled.piece < len(domain.facets)], middle)[0]
    holes = middle[~inside].tolist() if len(domain.facets) else seeds_of_holes.tolist()
    lines += [str(len(holes))] + [f"{i} {x!r} {y!r}" for i, (x, y) in enumerate(holes)]
    seeds = [(name, x) for name in domain.regions for x in domain.regions[name].tolist()]
    lines += [str(len(seeds))]
    for row, (name, (x, y)) in enumerate(seeds):
        lines.append(f"{row} {x!r} {y!r} {values[name]} {areas.get(name, -1.0)!r}")
    with replacing(path) as beside:
        beside.write_text("\n".join(lines) + "\n", encoding="utf-8")
    tell_numbers(domain.markers, marks, values, ".poly")


def tell_numbers(
    markers: Mapping[str, np.ndarray], marks: Mapping[str, str], values: Mapping[str, str], suffix: str
) -> None:
    """Warn of names that are numbers in a file, and of markers that are not the last of all their pieces."""
    tell_renamed(marks, f"markers are numbers in {suffix}")
    tell_renamed(values, f"regions are numbers in {suffix}")
    owner: dict[int, str] = {}
    for name, pieces in markers.items():
        owner |= dict.fromkeys(pieces.tolist(), name)
    lost = [repr(name) for name, pieces in markers.items() if any(owner[i] != name for i in pieces.tolist())]
    if lost:
        tell(f"not written completely: {', '.join(lost)}; {suffix} stores for each piece its last marker")


def numbers_for(names: Iterable[str], is_one: Callable[[str], bool]) -> dict[str, str]:
    """The number for each name in a file: the name itself if it is a number, or else a free number."""
    taken = {name for name in names if is_one(name)}
    free = (str(i) for i in count(1) if str(i) not in taken)
    return {name: name if name in taken else next(free) for name in names}


def is_marker(name: str) -> bool:
    """Whether `read_poly` can give this name to a marker; 0 stands for no marker."""
    return fullmatch("-?[1-9][0-9]*", name) is not None


def is_value(name: str) -> bool:
    """Whether `read_poly` can give this name to a region."""
    try:
        return region_name(float(name)) == name
    except ValueError:
        return False
