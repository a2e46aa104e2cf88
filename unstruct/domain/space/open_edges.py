"""Edges at which a body is open: an odd number of facets meets there. Loops of them, and flat sheets."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.boxes import BoxTree, bounding_boxes
from ...geometry.inside_shell import triangle_components
from ...geometry.outline import Outline
from ...geometry.polygons import Polygons
from ...geometry.triangle_pairs import side, unit_points
from ..plane.faults import Fault
from .cutting import Shell, at, place

__all__ = ["flat_sheets", "open_edges", "seams"]

SEAM = 1e-6  # a vertex is on an open edge if it is nearer; unit: the extent of the points


def open_edges(outline: Outline, _: Any = None) -> list[Fault]:
    """Faults for edges at which an odd number of facets meets, with the loops that they form."""
    if isinstance(outline.facets, np.ndarray) and _closed(outline.facets):
        return []
    ends, owner = Polygons.of(outline.facets).sides
    key, at_key, count = _edges(ends)
    odd = np.flatnonzero(count % 2)
    if len(odd) == 0:
        return []
    pairs = np.column_stack([key[odd] >> 32, key[odd] & (2**32 - 1)])
    length = _loops(pairs)
    order = np.argsort(at_key, kind="stable")
    start = np.cumsum(count) - count
    result = []
    for k, (a, b), size in zip(odd.tolist(), pairs.tolist(), length):
        touching = tuple(owner[order[start[k] : start[k] + count[k]]].tolist())
        middle = outline.points[[a, b]].mean(axis=0)
        close = "a triangle" if size == 3 else f"{size - 2} triangles"
        text = (
            f"the boundary is open: {count[k]} facet{'s meet' if count[k] > 1 else ' ends'} at the edge "
            f"{a}-{b}, near {at(middle)[3:]} (facets {', '.join(map(str, touching))}), but an even number "
            f"must meet. It is one of a loop of {size} such edges; close it ({close} would do), or give "
            "facets that bound nothing as inner"
        )
        result.append(Fault("open boundary", text, place(middle), touching, (a, b)))
    return result


def _closed(triangles: np.ndarray) -> bool:
    """Whether an even number of triangles meets at each edge."""
    a, b, c = triangles.T
    one, two = np.concatenate([a, b, c]), np.concatenate([b, c, a])
    key = np.sort((np.minimum(one, two).astype(np.int64) << 32) | np.maximum(one, two))
    return len(key) % 2 == 0 and np.array_equal(key[::2], key[1::2])


def seams(points: np.ndarray, facets: Polygons) -> dict[tuple[int, int], list[int]]:
    """Open edges (a, b), a < b, with the vertices of other open edges that lie on them up to rounding.

    Vertices that a program has put on an edge are seldom on it exactly. They count if one of the parts into
    which they divide the edge is an open edge, too.
    """
    key, _, count = _edges(facets.sides[0])
    key = key[count % 2 == 1]
    if len(key) == 0:
        return {}
    pairs = np.column_stack([key >> 32, key & (2**32 - 1)])
    is_open = {*map(tuple, pairs.tolist())}
    rows = np.unique(pairs)
    near = SEAM * float((points[rows].max(axis=0) - points[rows].min(axis=0)).max())
    low, high = bounding_boxes(points[pairs])
    query, hit = BoxTree(low - near, high + near).pairs(points[rows], points[rows])
    a, b, x = points[pairs[hit, 0]], points[pairs[hit, 1]], points[rows[query]]
    square = ((b - a) ** 2).sum(axis=1)
    share = ((x - a) * (b - a)).sum(axis=1) / square
    away = np.linalg.norm(x - a - share[:, None] * (b - a), axis=1)
    end = (rows[query] == pairs[hit, 0]) | (rows[query] == pairs[hit, 1])
    on = ~end & (away <= near) & (share > 0.0) & (share < 1.0)
    found: dict[tuple[int, int], list[tuple[float, int]]] = {}
    for e, t, v in zip(hit[on].tolist(), share[on].tolist(), rows[query[on]].tolist()):
        found.setdefault(tuple(pairs[e].tolist()), []).append((t, v))
    result = {}
    for (p, q), inside in found.items():
        chain = [p, *(v for _, v in sorted(inside)), q]
        if any((min(pair), max(pair)) in is_open for pair in pairwise(chain)):
            result[p, q] = chain[1:-1]
    return result


def _edges(ends: np.ndarray) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """The different edges as keys, the edge of each side, and how many sides each has."""
    sides = np.sort(ends, axis=1).astype(np.int64)
    return np.unique((sides[:, 0] << 32) | sides[:, 1], return_inverse=True, return_counts=True)


def _loops(pairs: np.ndarray) -> list[int]:
    """For each open edge the number of edges of the loop in which it is.

    An even number of open edges meets at every vertex, so that walks from edge to edge return.
    """
    around: dict[int, list[int]] = {}
    for k, (a, b) in enumerate(pairs.tolist()):
        around.setdefault(a, []).append(k)
        around.setdefault(b, []).append(k)
    length = [0] * len(pairs)
    free = [True] * len(pairs)
    for first, (start, v) in enumerate(pairs.tolist()):
        if not free[first]:
            continue
        walk, free[first] = [first], False
        passed = {start: 0, v: 1}  # vertex -> how many edges of the walk lie before it
        while walk:
            while not free[around[v][-1]]:
                around[v].pop()
            k = around[v].pop()
            free[k] = False
            walk.append(k)
            v = int(pairs[k].sum()) - v
            if v in passed:  # a loop; the walk goes on before it
                loop = walk[passed[v] :]
                for k in loop:
                    length[k] = len(loop)
                walk = walk[: passed[v]]
                passed = {u: n for u, n in passed.items() if n <= len(walk)}
            else:
                passed[v] = len(walk)
    return length


def flat_sheets(shell: Shell) -> tuple[NDArray[np.int64], bool]:
    """Facets that cannot bound: flat parts of the surface that end at an edge where an odd number meets.

    A part hangs together over edges of two triangles. If it lies in a plane exactly, it encloses nothing,
    however it is closed. Parts with an edge of their own are taken first, all together; if there is none,
    such as for a wall that divides a body, one part.

    Returns
    -------
    pieces : (k,) int64
    open : bool
        Whether there are edges of an odd number of triangles at all.
    """
    bounding = shell.piece < shell.facets
    triangles, piece = shell.triangles[bounding], shell.piece[bounding].astype(np.int64)
    none = np.empty(0, dtype=np.int64)
    if len(triangles) == 0:
        return none, False
    _, edge, count = _edges(triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2))
    meet = count[edge].reshape(-1, 3)
    if (meet % 2 == 0).all():
        return none, False
    component, _, many = triangle_components(triangles)
    odd, free = (
        np.bincount(component, weights=found.any(axis=1), minlength=many) > 0
        for found in (meet % 2 == 1, meet == 1)
    )
    xyz = unit_points(shell.points)
    order = np.argsort(component, kind="stable")
    groups = np.split(order, np.searchsorted(component[order], np.arange(1, many)))
    flat = [k for k in np.flatnonzero(odd).tolist() if _is_flat(xyz, triangles[groups[k]])]
    ending = [k for k in flat if free[k]]
    chosen = ending or flat[:1]
    if len(chosen) == 0:
        return none, True
    return np.unique(piece[np.concatenate([groups[k] for k in chosen])]), True


def _is_flat(xyz: np.ndarray, triangles: np.ndarray) -> bool:
    a, b, c = triangles[0].tolist()
    return all(v in (a, b, c) or side(xyz, a, b, c, v) == 0 for v in np.unique(triangles).tolist())
