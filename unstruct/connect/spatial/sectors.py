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

from ...geometry.edge_vectors import cross, lengths
from .arrays import CellArrays
from .signs import side
from .steiner import sees

__all__ = ["POSITIVE", "Cell", "Face", "cancelled", "link_of", "moved", "turned", "widened"]

Cell = tuple[int, int, int, int]
Face = tuple[int, int, int]
STEPS_BACK = 50  # how often a point is moved half of the way back to the surface
WIDE_STEPS = 10  # the same, by quarters, where the cavity may grow
NEAR_WALLS = (
    0.0,
    1e-9,
    1e-4,
    1e-2,
)  # heights over walls from which a point moves away; unit: the mean distance
MOST_TAKEN = 200  # cells that are taken into a cavity


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
    for t in sector:
        v = cells.vertex[4 * t : 4 * t + 4].tolist()
        k = v.index(p)
        walls[turned([v[i] for i in POSITIVE[k]])] = 4 * t + k
    return walls


def _inward(normals: NDArray[np.float64]) -> NDArray[np.float64]:
    """A direction with a positive product with all normals, if that is found soon."""
    step = normals.sum(axis=0)
    for _ in range(50):
        products = (normals * step).sum(axis=1)  # by BLAS, it would depend on the processor
        if products.min() > 0:
            break
        step = step + normals[int(products.argmin())]
    return step / max(float(lengths(step)), 1e-300)


def _steps(cells: CellArrays, link: list[Face], whole: list[Face], p: int) -> Iterator[NDArray[np.float64]]:
    """Ways from p into its sector: away from the triangles and from walls nearly at p; to the middle."""
    corners = cells.xyz[np.array(link + whole, dtype=np.int32)]
    normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(lengths(normals), 1e-300)[:, None]
    away = corners.reshape(-1, 3) - cells.xyz[p]
    scale = float(lengths(away).mean())
    height = np.abs(((cells.xyz[p] - corners[:, 0]) * normals).sum(axis=1))
    height[len(link) :] = 0.0
    counts = []
    for near in NEAR_WALLS:
        flat = height <= near * scale
        if flat.any() and int(flat.sum()) not in counts:
            counts.append(int(flat.sum()))
            yield _inward(normals[flat]) * scale
    yield away.mean(axis=0)


def moved(cells: CellArrays, link: list[Face], whole: list[Face], p: int) -> list[Cell] | None:
    """The star of the next vertex, close to p, that sees all walls, those around p and whole triangles."""
    walls = link + whole
    rows = np.array(walls, dtype=np.int32)
    here, q = cells.xyz[p].copy(), cells.size
    for step in _steps(cells, link, whole, p):
        length = 1.0
        for _ in range(STEPS_BACK):
            cells.xyz[q] = here + length * step
            if sees(cells.xyz, rows, len(rows), q):
                cells.size += 1
                return [(*face, q) for face in walls]
            length /= 2
    return None


def widened(
    cells: CellArrays, sector: list[int], whole: list[Face], p: int, claimed: set[int]
) -> tuple[list[Cell], list[int]] | None:
    """As `moved`, in a cavity that grows by further cells, which are the second result.

    Cells that are claimed must stay. There may be nothing to fill; then no vertex is used.
    """
    link = link_of(cells, sector, p)
    here, q = cells.xyz[p].copy(), cells.size
    steps = list(_steps(cells, list(link), whole, p))
    for i, step in product(range(1, WIDE_STEPS), steps):
        cells.xyz[q] = here + step / 4.0**i
        found = _cavity(cells, dict(link), whole, claimed)
        if found is not None:
            walls, taken = found
            cells.size += len(walls) > 0
            return [(*face, q) for face in walls], taken
    return None


def _cavity(
    cells: CellArrays, walls: dict[Face, int], whole: list[Face], claimed: set[int]
) -> tuple[list[Face], list[int]] | None:
    """Walls that the next vertex sees, and the cells taken for that; None if what must stay is in the way.

    ``walls`` has the place of each wall in the complex, -1 for whole triangles, which are not there yet.
    """

    def add(face: Face, place: int) -> bool:
        x, y, z = face
        other = walls.pop((x, z, y), None)
        if other is None:
            walls[face] = place
            return True
        place = max(place, other)  # it is inside now, or there already, so it must carry no mark
        return place >= 0 and cells.mark[place] < 0

    if not all([add(face, -1) for face in whole]):
        return None
    taken: list[int] = []
    waiting = list(walls)
    while waiting:
        face = waiting.pop()
        if face not in walls or side(cells.xyz, *face, cells.size) > 0:
            continue
        place = walls[face]
        if place < 0 or cells.mark[place] >= 0 or cells.across[place] < 0 or len(taken) == MOST_TAKEN:
            return None
        u = int(cells.across[place]) >> 2
        if u in claimed or u in taken:
            return None
        taken.append(u)
        v = cells.vertex[4 * u : 4 * u + 4].tolist()
        for k in range(4):
            new = turned([v[i] for i in POSITIVE[k]])
            if not add(new, 4 * u + k):
                return None
            waiting.append(new)
    return list(walls), taken
