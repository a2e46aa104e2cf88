"""Planes in which layers end: those of facets beside walls, or of the loops of an open border."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...domain.domain import Domain
from ...domain.space.cutting import at
from ...geometry.inside_shell import side_mates
from ...mesh.topology import components
from .flat_sides import number_of
from .stars import unit_normals

__all__ = ["planes_beside", "planes_of_loops"]

Array = NDArray[np.float64]
Numbers = NDArray[np.int32]
SAME_PLANE = 1e-6  # of the extent: how far points of one plane may be from it; also between unit normals
LEAST_SLOPE = 0.5  # sine of the angle, on average, between walls and the plane in which they end
LEAST_AT_THREE = 0.85  # ... where the loop has three edges, which may be a triangle that is missing
STEEP_ENOUGH = 0.1  # ... and at each edge
MOST_PLANES = 2  # in which one ray can stay


def _normal_of(points: Array, ends: NDArray[np.int64]) -> Array:
    """The unit normal of a closed chain of edges; that of the axis where one coordinate is constant."""
    flat = np.flatnonzero(np.ptp(points[ends.ravel()], axis=0) == 0.0)
    normal = np.zeros(3)
    if len(flat):
        normal[flat[0]] = 1.0
        return normal
    low = points[ends.ravel()].min(axis=0)
    a, b = points[ends[:, 0]] - low, points[ends[:, 1]] - low
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        normal[k] = ((a[:, i] - b[:, i]) * (a[:, j] + b[:, j])).sum()
    most = float(np.abs(normal).max())
    if most == 0.0:
        return normal
    normal /= most
    return normal / np.sqrt((normal * normal).sum())


def _off_plane(points: Array, rows: NDArray, normal: Array) -> tuple[float, int]:
    """How far the farthest point is from the plane through the first one, by the extent, and which it is."""
    x = points[rows] - points[rows[0]]
    extent = float(np.ptp(x, axis=0).max())
    off = np.abs((x * normal).sum(axis=1))
    i = int(off.argmax())
    return (float(off[i]) / extent if extent > 0.0 else 0.0), int(rows[i])


def _borders(triangles: Numbers, mates: NDArray[np.int64]) -> NDArray[np.int64]:
    """The edges of the border, in the direction of their triangles: (e, 2)."""
    side = np.flatnonzero(mates < 0)
    t, k = side // 3, side % 3
    return np.column_stack([triangles[t, (k + 1) % 3], triangles[t, (k + 2) % 3]]).astype(np.int64)


def planes_of_loops(
    points: Array, vertex: NDArray, triangles: Numbers, mates: NDArray[np.int64]
) -> tuple[Numbers, Array]:
    """`Walls.planes` and `Walls.normals` of an open surface, each loop of whose border lies in a plane."""
    ends = _borders(triangles, mates)
    planes = np.full((len(vertex), MOST_PLANES), -1, dtype=np.int32)
    follow = np.full(len(vertex), -1, dtype=np.int64)
    follow[ends[:, 0]] = ends[:, 1]
    beside = np.zeros((len(vertex), 3))  # the normal of the triangle at the edge that begins at a vertex
    beside[ends[:, 0]] = unit_normals(points[vertex], triangles)[0][np.flatnonzero(mates < 0) // 3]
    left = dict.fromkeys(ends[:, 0].tolist())
    normals: list[Array] = []
    while left:
        v = next(iter(left))
        loop = []
        while v in left:
            del left[v]
            loop.append(v)
            v = int(follow[v])
        chain = vertex[np.array(loop)].astype(np.int64)
        normal = _normal_of(points, np.column_stack([chain, np.roll(chain, -1)]))
        off, worst = _off_plane(points, chain, normal)
        if off > SAME_PLANE or not normal.any():
            raise InputError(
                f"the surface is open along a loop of {len(loop)} edges that does not lie in a plane: "
                f"point {worst} is off by {off:.2g} of its extent, {at(points[worst])}; close it, or end it "
                "in planes (where it ends in several, give a closed Domain with walls=names)"
            )
        along = 1.0 - np.abs((beside[loop] * normal).sum(axis=1)) ** 2
        least = LEAST_SLOPE if len(loop) > 3 else LEAST_AT_THREE
        if along.mean() < least**2 or along.min() < STEEP_ENOUGH**2:
            raise InputError(
                f"the surface is open along a loop of {len(loop)} edges at point {worst}, "
                f"{at(points[worst])}, whose plane is nearly that of the facets there, so that layers could "
                "not end in it: facets may be missing; close the surface, or end it across a plane"
            )
        planes[loop, 0] = len(normals)
        normals.append(normal)
    return planes, np.array(normals).reshape(-1, 3)


def planes_beside(
    domain: Domain,
    vertex: NDArray,
    triangles: Numbers,
    mates: NDArray[np.int64],
    rows: Numbers,
    piece: Numbers,
) -> tuple[Numbers, Array, Numbers]:
    """Planes of the facets beside walls.

    Returns
    -------
    planes, normals
        Of `Walls`.
    plane : (o,) int32
        The plane of each triangle of a piece with an edge of a wall, -1 for others: layers slide on these
        pieces alone, not on others in their plane.
    """
    points, ends = domain.points, vertex[_borders(triangles, mates)]
    planes = np.full((len(vertex), MOST_PLANES), -1, dtype=np.int32)
    plane = np.full(len(rows), -1, dtype=np.int32)
    if not len(ends):
        return planes, np.empty((0, 3)), plane
    part = _flat_parts(points, rows)
    local = np.full(len(points), -1, dtype=np.int64)
    border = np.unique(ends)
    local[border] = np.searchsorted(vertex, border)
    beside = np.flatnonzero((local[rows] >= 0).any(axis=1))
    normals: list[Array] = []
    middles: list[Array] = []
    for p in np.unique(part[beside]).tolist():
        some = np.flatnonzero(part == p)
        normal, middle = _plane_of(domain, rows[some], int(piece[some[0]]))
        same = [i for i, n in enumerate(normals) if _parallel(n, normal) and _in_plane(middles[i], middle, n)]
        plane[some] = same[0] if same else len(normals)
        if not same:
            normals.append(normal)
            middles.append(middle)
    t, k = np.nonzero(local[rows] >= 0)
    for v, p in np.unique(np.column_stack([local[rows[t, k]], plane[t]]), axis=0).tolist():
        free = np.flatnonzero(planes[v] < 0)
        if any(q >= 0 and _parallel(normals[p], normals[q]) for q in planes[v].tolist()):
            continue
        if not len(free):
            where = f"the walls end at point {number_of(domain, int(vertex[v]))}, {at(points[vertex[v]])}"
            flat = _in_plane_of_walls(points, vertex, triangles, v, [normals[q] for q in (*planes[v], p)])
            if flat >= 0:
                q = (*planes[v].tolist(), p)[flat]
                own = piece[(plane == q) & (rows == vertex[v]).any(axis=1)]
                raise InputError(
                    f"{where}, within a flat side: {domain.name(int(own[0]))} lies beside them in its plane; "
                    "name it in walls, too, or end the walls at edges of the body"
                )
            raise InputError(
                f"{where}, in {MOST_PLANES + 1} planes: no ray can stay in all of them; make facets there "
                "walls, or plane"
            )
        planes[v, free[0]] = p
    plane[~np.isin(piece, _pieces_along(ends, rows, piece))] = -1
    return planes, np.array(normals).reshape(-1, 3), plane


def _in_plane_of_walls(
    points: Array, vertex: NDArray, triangles: Numbers, v: int, normals: list[Array]
) -> int:
    """Which of some normals is that of a wall at vertex v, -1 for none."""
    around = vertex[triangles[(triangles == v).any(axis=1)]]
    walls, _ = unit_normals(points, around.astype(np.int32))
    found = [k for k, n in enumerate(normals) if any(_parallel(n, wall) for wall in walls)]
    return found[0] if found else -1


def _pieces_along(ends: NDArray, rows: Numbers, piece: Numbers) -> NDArray:
    """The pieces of triangles with an edge among some."""
    keys = [
        np.sort(some.astype(np.int64).reshape(-1, 2), axis=1) for some in (ends, rows[:, [0, 1, 1, 2, 2, 0]])
    ]
    wanted, own = (key[:, 0] << 32 | key[:, 1] for key in keys)
    return np.unique(piece[np.isin(own, wanted).reshape(-1, 3).any(axis=1)])


def _plane_of(domain: Domain, rows: Numbers, piece: int) -> tuple[Array, Array]:
    """The unit normal of a flat part of the surface, and its middle."""
    outline = rows[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    normal = _normal_of(domain.points, outline)
    off, worst = _off_plane(domain.points, np.unique(outline), normal)
    if off > SAME_PLANE or not normal.any():
        raise InputError(
            f"{domain.name(piece)} stands beside walls, but is not plane: point {number_of(domain, worst)} "
            f"is off by {off:.2g} of its extent, {at(domain.points[worst])}; make it a wall, or plane"
        )
    return normal, domain.points[outline[:, 0]].mean(axis=0)


def _parallel(one: Array, two: Array) -> bool:
    x = one[[1, 2, 0]] * two[[2, 0, 1]] - one[[2, 0, 1]] * two[[1, 2, 0]]
    return bool(np.abs(x).max() < SAME_PLANE)


def _in_plane(one: Array, two: Array, normal: Array) -> bool:
    away = two - one
    return bool(abs((away * normal).sum()) <= SAME_PLANE * np.abs(away).max())


def _flat_parts(points: Array, rows: Numbers) -> NDArray[np.int64]:
    """The parts of triangles that hang together and are parallel across each edge."""
    mates = side_mates(rows)
    normals, _ = unit_normals(points, rows)
    side = np.flatnonzero(mates >= 0)
    one, two = normals[side // 3], normals[mates[side] // 3]
    cross = one[:, [1, 2, 0]] * two[:, [2, 0, 1]] - one[:, [2, 0, 1]] * two[:, [1, 2, 0]]
    neighbors = np.full(3 * len(rows), -1, dtype=np.int32)
    flat = np.abs(cross).max(axis=1, initial=0.0) < SAME_PLANE
    neighbors[side[flat]] = mates[side[flat]] // 3
    return components(neighbors.reshape(-1, 3))[1]
