"""Triangle's ``.poly``: regions by segments, holes by seeds.

Triangle eats holes and the outside from seeds and from beyond, as far as segments do not stop it: a ring
without a hole's seed is a wall, not a hole. Here holes follow from facets alone. So a segment becomes a facet
if it stands between what is eaten and what is left, and an inner segment otherwise.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import InputError

if TYPE_CHECKING:
    from .domain import Domain
    from .mesh import Mesh

__all__ = ["read_poly", "write_poly"]


# ---------------------------------------------------------------------- reading


class _Rows:
    """The rows of a file that hold more than a comment."""

    def __init__(self, path: Path):
        self.path = path
        if not path.exists():
            raise InputError(f"there is no file {path.name}")
        lines = path.read_text(encoding="utf-8").splitlines()
        self.rows = [words for line in lines if (words := line.split("#")[0].split())]
        self.at = 0

    def next(self, least: int, what: str) -> list[str]:
        """The next row, of at least so many entries."""
        if self.at >= len(self.rows):
            raise InputError(f"{self.path.name} ends where {what} should stand")
        row = self.rows[self.at]
        self.at += 1
        if len(row) < least:
            raise InputError(f"{self.path.name}: {what} needs {least} entries, not {' '.join(row)!r}")
        return row

    def count(self, what: str) -> list[int]:
        """A row of whole numbers that begins a section."""
        return [int(_number(word, what, self.path)) for word in self.next(1, what)]

    def end(self) -> bool:
        """Whether nothing follows."""
        return self.at >= len(self.rows)


def _number(word: str, what: str, path: Path) -> float:
    try:
        return float(word)
    except ValueError:
        raise InputError(f"{path.name}: {word!r} among {what} is no number") from None


def _vertices(path: Path, rows: _Rows) -> tuple[np.ndarray, int]:
    """Coordinates, and the number of the first vertex (0 or 1)."""
    count, *rest = rows.count("the number of vertices")
    if count == 0:
        return _vertices(path, _Rows(path.with_suffix(".node")))
    if rest and rest[0] != 2:
        raise InputError(f"{rows.path.name} is in {rest[0]} dimensions, not 2")
    table = [rows.next(3, "a vertex") for _ in range(count)]
    points = np.array([[_number(w, "vertices", rows.path) for w in row[1:3]] for row in table])
    return points, int(_number(table[0][0], "vertices", rows.path))


def read_poly(path: Path, *, resolve: bool) -> tuple[dict[str, Any], dict[str, float]]:
    """The arguments of a `Domain`, and the area bounds of its regions by name."""
    rows = _Rows(path)
    points, first = _vertices(path, rows)
    count, *flags = rows.count("the number of segments")
    segments = np.empty((count, 2), dtype=np.int64)
    markers: dict[str, list[int]] = {}
    for i in range(count):
        row = rows.next(3, "a segment")
        segments[i] = [_number(w, "segments", path) - first for w in row[1:3]]
        if flags and flags[0] and len(row) > 3 and row[3] != "0":
            markers.setdefault(row[3], []).append(i)
    seeds = np.array(list(_seeds(rows, "holes", path)), dtype=float).reshape(-1, 2)
    regions: dict[str, list[list[float]]] = {}
    areas: dict[str, float] = {}
    for _ in range(0 if rows.end() else rows.count("the number of regions")[0]):
        _, x, y, value, *bound = (_number(w, "regions", path) for w in rows.next(4, "a region"))
        regions.setdefault(f"{value:g}", []).append([x, y])
        if bound and bound[0] > 0:
            areas[f"{value:g}"] = min(areas.get(f"{value:g}", np.inf), bound[0])
    from .domain import Domain

    walls = Domain(points, (), inner=segments, markers=markers, resolve=resolve)
    facets = _eaten_sides(walls, seeds)
    order = np.concatenate([np.nonzero(facets)[0], np.nonzero(~facets)[0]])
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))
    return {
        "points": walls.points,
        "facets": walls.inner[facets],
        "inner": walls.inner[~facets],
        "markers": {name: place[pieces] for name, pieces in walls.markers.items()},
        "regions": regions,
    }, areas


def _seeds(rows: _Rows, what: str, path: Path) -> Iterator[list[float]]:
    for _ in range(0 if rows.end() else rows.count(f"the number of {what}")[0]):
        yield [_number(w, what, path) for w in rows.next(3, what)[1:3]]


def _eaten_sides(walls: Domain, seeds: np.ndarray) -> np.ndarray:
    """Which segments have what is eaten on one side, and what is left on the other."""
    mesh, part, beyond = _hull_parts(walls)
    cells = mesh.find_simplex(seeds) if len(seeds) else np.empty(0, dtype=np.int64)
    eaten = np.isin(part, np.concatenate([part[cells[cells >= 0]], beyond]))
    cells, corner = np.nonzero(np.ones_like(mesh.neighbors, dtype=bool))
    from .topology import oriented_facet

    sides = np.sort(oriented_facet(mesh.simplices, cells, corner), axis=1)
    other = mesh.neighbors[cells, corner]
    differs = eaten[cells] != np.where(other < 0, True, eaten[other])
    n = len(mesh.points)
    between = np.unique(sides[differs, 0].astype(np.int64) * n + sides[differs, 1])
    number = np.full(len(walls.points), -1, dtype=np.int64)
    number[mesh.origin] = np.arange(n)
    low, high = np.sort(number[walls.inner], axis=1).T
    return np.isin(low * n + high, between)


def _hull_parts(walls: Domain) -> tuple[Mesh, np.ndarray, np.ndarray]:
    """The convex hull in triangles, the part of each between walls, and the parts open to the outside."""
    from .check_domain import parts
    from .delaunay.constrained import constrained_delaunay
    from .topology import oriented_facet

    mesh = constrained_delaunay(walls, hull=True)
    marked = np.concatenate([mesh.markers["facets"], mesh.markers["inner"]])
    part = parts(mesh, marked)
    cells, corner = np.nonzero(mesh.neighbors < 0)
    sides = np.sort(oriented_facet(mesh.simplices, cells, corner), axis=1).astype(np.int64)
    walled = np.sort(marked, axis=1).astype(np.int64)
    n = len(mesh.points)
    free = ~np.isin(sides[:, 0] * n + sides[:, 1], walled[:, 0] * n + walled[:, 1])
    return mesh, part, np.unique(part[cells[free]])


# ---------------------------------------------------------------------- writing


def write_poly(domain: Domain, path: Path) -> None:
    """Vertices, segments, a seed for each hole, regions; every number in full precision."""
    from .domain import Domain

    if path.suffix != ".poly":
        raise InputError(f"a region is written as .poly, not {path.suffix!r}")
    sampled = domain.sampled()
    names = {name: i + 1 for i, name in enumerate(domain.markers)}
    mark = np.zeros(len(domain.pieces), dtype=int)
    for name, pieces in domain.markers.items():
        mark[pieces] = int(name) if name.lstrip("-").isdigit() else names[name]
    lines = [f"{len(sampled.points)} 2 0 0"]
    lines += [f"{i} {x!r} {y!r}" for i, (x, y) in enumerate(sampled.points.tolist())]
    lines += [f"{len(sampled.ends)} 1"]
    lines += [
        f"{i} {a} {b} {mark[piece]}"
        for i, ((a, b), piece) in enumerate(zip(sampled.ends.tolist(), sampled.piece))
    ]
    walls = Domain(sampled.points, (), inner=sampled.ends)
    mesh, part, beyond = _hull_parts(walls)
    holes = []
    for p in np.setdiff1d(part, beyond):
        cells = np.nonzero(part == p)[0]
        seed = mesh.points[mesh.simplices[cells[np.argmax(mesh.volumes[cells])]]].mean(axis=0)
        if not _inside(sampled, len(domain.facets), seed):
            holes.append(seed.tolist())
    lines += [str(len(holes))] + [f"{i} {x!r} {y!r}" for i, (x, y) in enumerate(holes)]
    seeds = [(i, name, x) for i, name in enumerate(domain.regions) for x in domain.regions[name].tolist()]
    lines += [str(len(seeds))]
    for row, (i, name, (x, y)) in enumerate(seeds):
        value = name if _is_number(name) else str(i + 1)
        lines.append(f"{row} {x!r} {y!r} {value} {domain.max_areas.get(name, -1.0)!r}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _inside(sampled: Any, facets: int, x: np.ndarray) -> bool:
    from .domain_inside import even_odd

    return bool(even_odd(sampled.points, sampled.ends[sampled.piece < facets], x[None])[0][0])


def _is_number(name: str) -> bool:
    try:
        float(name)
    except ValueError:
        return False
    return True
