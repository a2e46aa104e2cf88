"""The inside of a domain: even-odd parity from the ghosts on, and the connected parts, compiled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import fill
from ...base.errors import InputError
from ...base.jit import inline, kernel
from ...geometry.boxes import BoxTree
from ...geometry.ordering import radix_argsort
from ...predicates.kernels import orient2
from ..insertion.halfedges import next_edge, prev_edge
from .complex import PlanarComplex

__all__ = ["flood", "hold_seeds", "mark_regions", "number_parts"]

FEW_SEEDS = 16  # so many are compared with all triangles, which takes less than a tree of their boxes


@kernel
def _parity(vertex, twin, mark, piece, facets, part, stack):
    """Write -1 outside and -2 inside: crossing a facet changes sides, crossing an inner segment does not.

    Returns -1, or a facet where this fails.
    """
    fill(part, -3)
    for t in range(len(part)):
        if vertex[3 * t] < 0 or vertex[3 * t + 1] < 0 or vertex[3 * t + 2] < 0:
            part[t] = -1
            stack[0] = t
            break
    depth = 1
    while depth > 0:
        depth -= 1
        t = np.int64(stack[depth])
        for e in range(3 * t, 3 * t + 3):
            other = twin[e] // 3
            s = mark[e]
            side = -3 - part[t] if s >= 0 and piece[s] < facets else part[t]
            if part[other] == -3:
                part[other] = side
                stack[depth] = other
                depth += 1
            elif part[other] != side:
                return _odd_facet(vertex, mark, piece, facets)
    return np.int64(-1)


@kernel
def _most(vertex):
    most = vertex[0]
    for e in range(len(vertex)):
        most = max(most, vertex[e])
    return most


@kernel
def _odd_facet(vertex, mark, piece, facets):
    """A facet whose end belongs to an odd number of facets."""
    degree = fill(np.empty(_most(vertex) + 1, dtype=np.int64), 0)
    for e in range(len(mark)):
        if mark[e] >= 0 and piece[mark[e]] < facets:
            degree[vertex[next_edge(e)]] += 1  # each subsegment is met twice, once from each side
    for e in range(len(mark)):
        if mark[e] >= 0 and piece[mark[e]] < facets and degree[vertex[next_edge(e)]] % 2 == 1:
            return np.int64(mark[e])
    return np.int64(0)


@inline
def _root(above, t):
    """The root of the tree of triangle t; paths are halved."""
    while above[t] != t:
        above[t] = above[above[t]]
        t = np.int64(above[t])
    return t


@kernel
def flood(plane, facets, hull, part, stack, least):
    """Number the connected parts of the inside in ``part``, one entry a triangle; -1 outside.

    Returns -1 and the number of parts, or a facet with the same side of the boundary on both of its sides
    (the facets do not close). ``least`` gets the lowest vertex of each part if there are several. With
    ``hull`` everything but the ghosts is inside. Parts are connected across edges that are not marked.
    """
    vertex, twin, mark = plane.vertex, plane.twin, plane.mark
    if hull:
        for t in range(len(part)):
            ghost = vertex[3 * t] < 0 or vertex[3 * t + 1] < 0 or vertex[3 * t + 2] < 0
            part[t] = -1 if ghost else -2
    else:
        odd = _parity(vertex, twin, mark, plane.piece, facets, part, stack)
        if odd >= 0:
            return odd, 0
    for t in range(len(part)):  # a forest: each triangle is joined to connected ones before it
        if part[t] != -2:
            continue
        root = np.int64(t)
        stack[t] = t
        for e in range(3 * t, 3 * t + 3):
            other = np.int64(twin[e] // 3)
            joined = (other < t) & (mark[e] < 0) & (part[other] == -2)
            other = _root(stack, other if joined else root)
            stack[max(root, other)] = min(root, other)
            root = min(root, other)
    parts = 0
    for t in range(len(part)):
        if part[t] == -2:
            if stack[t] == t:
                part[t] = parts
                parts += 1
            else:
                part[t] = part[stack[t]]
    if parts > 1:
        most = _most(vertex)
        for k in range(parts):
            least[k] = most
        for t in range(len(part)):
            p = part[t]
            if p >= 0:
                least[p] = min(least[p], vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2])
    return np.int64(-1), parts


@inline
def _hold(xy, vertex, mark, t, x, y):
    """Whether the closed triangle t contains (x, y): 1, on a marked edge 2, otherwise 0."""
    on = False
    for e in range(3 * t, 3 * t + 3):
        u, v = vertex[next_edge(e)], vertex[prev_edge(e)]
        side = orient2(xy[u, 0], xy[u, 1], xy[v, 0], xy[v, 1], x, y)
        if side < 0:
            return 0
        on = on or (side == 0 and mark[e] >= 0)
    return 2 if on else 1


@kernel
def hold_seeds(xy, vertex, mark, count, seeds):
    """For each seed the slot of a closed triangle that contains it; -1 for none, -2 on a segment.

    All triangles are tested: a walk may run in circles if the triangulation is not Delaunay.
    """
    found = fill(np.empty(len(seeds), dtype=np.int64), -1)
    for t in range(count):
        a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
        if a < 0 or b < 0 or c < 0:
            continue
        for i in range(len(seeds)):
            x, y = seeds[i, 0], seeds[i, 1]
            if (
                min(xy[a, 0], xy[b, 0], xy[c, 0]) <= x <= max(xy[a, 0], xy[b, 0], xy[c, 0])
                and min(xy[a, 1], xy[b, 1], xy[c, 1]) <= y <= max(xy[a, 1], xy[b, 1], xy[c, 1])
                and found[i] != -2
            ):
                held = _hold(xy, vertex, mark, t, x, y)
                if held > 0:
                    found[i] = -2 if held == 2 else t
    return found


@kernel
def hold_pairs(xy, vertex, mark, query, slots, seeds, found):
    """As `hold_seeds`, with pairs of a seed and a triangle whose box contains it."""
    for i in range(len(query)):
        q = query[i]
        if found[q] != -2:
            held = _hold(xy, vertex, mark, slots[i], seeds[q, 0], seeds[q, 1])
            if held > 0:
                found[q] = -2 if held == 2 else slots[i]


def mark_regions(complex_: PlanarComplex, facets: int, regions: dict[str, NDArray], hull: bool) -> None:
    """Flood the inside and number its connected parts; parts with a named seed first."""
    count = complex_.triangles
    part = complex_.region[:count]
    stack = np.empty(3 * count + 3, dtype=np.int32)
    least = np.empty(count, dtype=np.int32)
    odd, parts = flood(complex_.plane(), facets, hull, part, stack, least)
    if odd >= 0:
        a, b = complex_.ends[odd].tolist()
        raise InputError(
            f"facet {complex_.piece[odd]} (vertices {a} and {b}) has the same side of the boundary on both "
            "sides: the facets do not close; make them rings, or inner segments"
        )
    if parts == 0:
        raise InputError("the facets bound no area, so nothing is inside: check the domain")
    number_parts(complex_, regions, int(parts), least)


def number_parts(
    complex_: PlanarComplex, regions: dict[str, NDArray], parts: int, least: NDArray[np.int32]
) -> None:
    """Number the parts that `flood` has found by their lowest vertices; those with a named seed first."""
    complex_.regions = {name: k for k, name in enumerate(regions)}
    if parts == 1 and not regions:
        return
    number = np.empty(parts, dtype=np.int32)
    _rank(least, number)
    part = complex_.region[: complex_.triangles]
    _relabel(part, _named(complex_, regions, part, number) if regions else number)


@kernel
def _rank(least, number):
    """Number the parts in the order of their lowest vertices, not of their slots."""
    keys = np.empty(len(number), dtype=np.int64)
    for i in range(len(number)):
        keys[i] = least[i]
    order = radix_argsort(keys, 31) if len(number) > 1 else fill(np.empty(1, dtype=np.int64), 0)
    for i in range(len(order)):
        number[order[i]] = i


@kernel
def _relabel(part, label):
    for t in range(len(part)):
        if part[t] >= 0:
            part[t] = label[part[t]]


def _named(
    complex_: PlanarComplex, regions: dict[str, NDArray], part: NDArray, number: NDArray[np.int32]
) -> NDArray[np.int32]:
    """For each part the place of the name of its seed; without one, further numbers ordered by ``number``."""
    names = list(regions)
    rows = [np.asarray(seeds, dtype=np.float64).reshape(-1, 2) for seeds in regions.values()]
    seeds, start = np.concatenate(rows), np.cumsum([0] + [len(row) for row in rows])
    named = np.full(len(number), -1, dtype=np.int32)
    found, k = _held(complex_, seeds * complex_.factor), 0
    for i, slot in enumerate(found.tolist()):
        while i >= start[k + 1]:
            k += 1
        p = part[slot] if slot >= 0 else -1
        if p >= 0 and named[p] in (-1, k):
            named[p] = k
            continue
        where = f"regions[{names[k]!r}][{i - start[k]}] = {seeds[i].tolist()}"
        if slot == -2:
            raise InputError(f"{where} lies on a segment: move it into one of the parts")
        if p < 0:
            raise InputError(f"{where} lies outside of the domain: move it inside")
        raise InputError(f"{where} lies in the same part as {names[named[p]]!r}: drop one of them")
    free = np.flatnonzero(named < 0)
    named[free[np.argsort(number[free])]] = len(names) + np.arange(len(free))
    return named


def _held(complex_: PlanarComplex, seeds: NDArray[np.float64]) -> NDArray[np.int64]:
    """`hold_seeds`; for many seeds with only the triangles near each of them."""
    count = complex_.triangles
    if len(seeds) <= FEW_SEEDS:
        return hold_seeds(complex_.xy, complex_.vertex, complex_.mark, count, seeds)
    vertex = complex_.vertex[: 3 * count].reshape(-1, 3)
    solid = np.flatnonzero((vertex >= 0).all(axis=1))
    corners = complex_.xy[vertex[solid]]
    tree = BoxTree(corners.min(axis=1), corners.max(axis=1))
    found = np.full(len(seeds), -1, dtype=np.int64)
    query, hit = tree.pairs(seeds, seeds)
    hold_pairs(complex_.xy, complex_.vertex, complex_.mark, query, solid[hit], seeds, found)
    return found
