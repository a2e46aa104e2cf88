"""Where a point goes that leaves the surface: into a sector of its star, where all walls see it.

The old point saw all walls but those in whose planes it was, the triangles that it had split. Next to
vertices that are in a plane up to rounding there are cells as flat as that, whose walls a point off the plane
does not see. They are taken into the cavity, as in an insertion, until all walls see the point or one must
stay.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel, lean
from ...geometry.edge_vectors import cross, lengths
from ..insertion.engine import STAMP
from .arrays import CellArrays
from .cavity import corner
from .leaving import NEAR_WALLS, put_back, ways_off
from .signs import side

__all__ = [
    "POSITIVE",
    "Cell",
    "Face",
    "cancelled",
    "growing",
    "link_of",
    "moved",
    "steps_off",
    "turned",
    "widened",
]

Cell = tuple[int, int, int, int]
Face = tuple[int, int, int]
WIDE_STEPS = 10  # how often a point is moved by quarters back to the surface, where the cavity may grow
GROWING_STEPS = 4  # steps in which a sector may grow
FLAT_WALL = 1e-9  # how far off a wall a point is in its plane; unit: the mean distance
TURNED_AWAY = -0.99  # inner products of unit normals below are those of opposite ones
MOST_TAKEN = 200  # cells that are taken into a cavity
NO_WALL = -2  # for the place of what is no wall


# The corners of face k, as `corner` gives them. (A kernel that is called here is compiled by the import.)
POSITIVE = ((1, 3, 2), (0, 2, 3), (0, 3, 1), (0, 1, 2))


def turned(face: list[int]) -> Face:
    """The same oriented face, its lowest vertex first."""
    k = face.index(min(face))
    return face[k], face[(k + 1) % 3], face[(k + 2) % 3]


def cancelled(link: list[Face], whole: list[Face]) -> tuple[list[Face], list[Face]]:
    """The walls without those that bound nothing, because they are there in both orientations."""
    both = {(x, z, y) for x, y, z in link} & set(whole)
    return [(x, y, z) for x, y, z in link if (x, z, y) not in both], [
        face for face in whole if face not in both
    ]


def link_of(cells: CellArrays, sector: list[int], p: int) -> dict[Face, int]:
    """The faces of a sector opposite p, seen from within, and where they are in the complex."""
    walls = {}
    for t, v in zip(sector, cells.rows(cells.vertex, sector).tolist(), strict=True):
        k = v.index(p)
        walls[turned([v[i] for i in POSITIVE[k]])] = 4 * t + k
    return walls


def steps_off(cells: CellArrays, walls: NDArray[np.int32], around: int, p: int) -> NDArray[np.float64]:
    """See `ways_off`."""
    ways = np.empty((len(NEAR_WALLS) + 1, 3))
    return ways[: ways_off(cells.xyz, walls, around, p, ways)]


def _looking_away(cells: CellArrays, walls: NDArray[np.int32], around: int, p: int) -> NDArray[np.bool_]:
    """Which of the first ``around`` walls are nearly in the plane of a whole triangle, and turned away."""
    corners = cells.xyz[walls]
    first = corners[:, 0]
    normals = cross(corners[:, 1] - first, corners[:, 2] - first)
    normals /= np.maximum(lengths(normals), 1e-300)[:, None]
    scale = float(lengths(corners.reshape(-1, 3) - cells.xyz[p]).mean())
    height = np.abs(((cells.xyz[p] - first) * normals).sum(axis=1))
    against = (normals[:around, None] * normals[None, around:]).sum(axis=2).min(axis=1, initial=1.0)
    return (height[:around] <= FLAT_WALL * scale) & (against < TURNED_AWAY)


def growing(
    cells: CellArrays, sector: list[int], whole: list[Face], p: int, claimed: set[int]
) -> Iterator[tuple[list[Face], list[int]]]:
    """The walls of a sector with more and more cells beyond them, and these cells.

    First those beyond walls that look away, where flat cells turn the sector inside out; then, vertex by
    vertex, those whose vertex is there already, or that is beyond most walls. Claimed cells must stay.
    """
    walls = link_of(cells, sector, p)
    rows = np.array([*walls, *whole], dtype=np.int32)
    away = _looking_away(cells, rows, len(walls), p)
    places = [place for place, is_away in zip(walls.values(), away, strict=True) if is_away]
    for x, y, z in whole:
        if walls.pop((x, z, y), None) is None:
            walls[x, y, z] = NO_WALL
    more: list[int] = []
    for _ in range(GROWING_STEPS):
        for place in places:
            over = int(cells.across[place])
            if cells.mark[place] >= 0 or over < 0 or over >> 2 in claimed or over >> 2 in more:
                continue
            more.append(over >> 2)
            if not _take_in(cells, walls, over >> 2):
                return
        if more:
            yield list(walls), more
        places = _beyond_most(cells, walls, claimed)
        if not places:
            return


def _take_in(cells: CellArrays, walls: dict[Face, int], u: int) -> bool:
    """Add a cell to those within the walls; False if a face must stay."""
    vertices = cells.vertex[4 * u : 4 * u + 4].tolist()
    for k in range(4):
        x, y, z = turned([vertices[i] for i in POSITIVE[k]])
        before = walls.pop((x, z, y), None)
        if before is None:
            walls[x, y, z] = 4 * u + k
        elif before < 0 or cells.mark[before] >= 0:
            return False
    return True


def _beyond_most(cells: CellArrays, walls: dict[Face, int], claimed: set[int]) -> list[int]:
    """The walls that have the same vertex beyond: one of theirs if there is such a one, or else most."""
    there = set().union(*walls)
    votes: dict[tuple[bool, int], list[int]] = {}
    for place in walls.values():
        over = int(cells.across[place]) if place >= 0 and cells.mark[place] < 0 else -1
        if over >= 0 and over >> 2 not in claimed:
            apex = int(cells.vertex[over])
            votes.setdefault((apex in there, apex), []).append(place)
    return max(votes.items(), key=lambda item: (item[0][0], len(item[1])))[1] if votes else []


def moved(cells: CellArrays, link: list[Face], whole: list[Face], p: int) -> list[Cell] | None:
    """The star of the next vertex, close to p, that sees all walls, those around p and whole triangles."""
    walls, q = link + whole, cells.size
    rows = np.array(walls, dtype=np.int32)
    if not put_back(cells.xyz, rows, p, q, steps_off(cells, rows, len(link), p)):
        return None
    cells.size += 1
    return [(*face, q) for face in walls]


def widened(
    cells: CellArrays, sector: list[int], whole: list[Face], p: int, claimed: set[int]
) -> tuple[list[Cell], list[int]] | None:
    """As `moved`, in a cavity that grows by further cells, which are the second result.

    Cells that are claimed must stay. There may be nothing to fill; then no vertex is used.
    """
    link = link_of(cells, sector, p)
    q = cells.size
    rows = np.array([*link, *whole], dtype=np.int32)
    start = np.column_stack([rows, np.full(len(rows), -1, dtype=np.int32)])
    start[: len(link), 3] = list(link.values())
    solid, ways = cells.solid(), steps_off(cells, rows, len(link), p)
    walls = np.empty((len(rows) + 4 * MOST_TAKEN, 4), dtype=np.int32)
    taken = np.empty(MOST_TAKEN, dtype=np.int32)
    stay = np.array(sorted(claimed), dtype=np.int32)
    here = cells.xyz[p].copy()
    for i, step in product(range(1, WIDE_STEPS), ways):
        cells.xyz[q] = here + step / 4.0**i
        count, more = _cavity(solid, start, len(link), stay, q, walls, taken)
        if count >= 0:
            cells.size += count > 0
            return [(x, y, z, q) for x, y, z in walls[:count, :3].tolist()], taken[:more].tolist()
    return None


@lean
def _add_wall(solid, walls, count, x, y, z, place):
    """List a wall, or take its reverse away; how many walls are listed, -1 if that must not be.

    The lowest vertex is first. Those that were taken away begin with -1.
    """
    for i in range(count):
        if walls[i, 0] != x:
            continue
        if walls[i, 1] == z and walls[i, 2] == y:
            place = max(place, walls[i, 3])  # inside now, or there already, so it must carry no mark
            walls[i, 0] = -1
            return count if place >= 0 and solid.mark[place] < 0 else -1
    for i in range(count):
        if walls[i, 0] == x and walls[i, 1] == y and walls[i, 2] == z:
            walls[i, 3] = place
            return count
    walls[count, 0], walls[count, 1], walls[count, 2], walls[count, 3] = x, y, z, place
    return count + 1


@kernel
def _cavity(solid, start, link, claimed, q, walls, taken):
    """List the walls that vertex q sees, and the cells taken for that; -1 walls if something must stay.

    ``start`` has the walls to begin with and the place of each in the complex; after the first ``link``, -1
    for whole triangles, which are not there yet. Cells that are claimed are not taken.
    """
    solid.state[STAMP] += 1
    stamp, count, more, top = 2 * solid.state[STAMP], link, 0, 0
    for i in range(claimed.shape[0]):
        solid.stamp[claimed[i]] = stamp
    walls[:link] = start[:link]
    for i in range(link, start.shape[0]):
        count = _add_wall(solid, walls, count, start[i, 0], start[i, 1], start[i, 2], -1)
        if count < 0:
            return -1, 0
    waiting = np.empty((count + 4 * taken.shape[0], 3), dtype=np.int32)
    for i in range(count):
        if walls[i, 0] >= 0:
            waiting[top] = walls[i, :3]
            top += 1
    while top > 0:
        top -= 1
        x, y, z = waiting[top, 0], waiting[top, 1], waiting[top, 2]
        place = NO_WALL
        for i in range(count):
            if walls[i, 0] == x and walls[i, 1] == y and walls[i, 2] == z:
                place = walls[i, 3]
        if place == NO_WALL or side(solid.xyz, x, y, z, q) > 0:
            continue
        if place < 0 or solid.mark[place] >= 0 or solid.across[place] < 0 or more == taken.shape[0]:
            return -1, 0
        u = solid.across[place] >> 2
        if solid.stamp[u] == stamp:
            return -1, 0
        solid.stamp[u] = stamp
        taken[more] = u
        more += 1
        for k in range(4):
            x, y, z = (
                solid.vertex[4 * u + corner(k, 0)],
                solid.vertex[4 * u + corner(k, 1)],
                solid.vertex[4 * u + corner(k, 2)],
            )
            while y < x or z < x:
                x, y, z = y, z, x
            count = _add_wall(solid, walls, count, x, y, z, 4 * u + k)
            if count < 0:
                return -1, 0
            waiting[top, 0], waiting[top, 1], waiting[top, 2] = x, y, z
            top += 1
    kept = 0
    for i in range(count):
        if walls[i, 0] >= 0:
            walls[kept] = walls[i]
            kept += 1
    return kept, more
