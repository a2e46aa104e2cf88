"""A patch of a triangulation, copied into small arrays of its own, so that changes can be tried: compiled.

A patch is some triangles around one, of the same region. Its boundary half-edges are marked, each with a
number, so that the kernels of `connect.planar.stars` never leave it; a vertex inside may move and be removed,
and points may be added. The triangulation itself is changed only when a patch is put back in place of what
was copied: the triangles take the slots of the old ones. Book: 2.6c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import apart, inline, lean
from ...connect.insertion.engine import BUSY, LAST
from ...connect.insertion.halfedges import (
    VERTICES,
    end_of,
    free_slot,
    new_slot,
    next_edge,
    prev_edge,
    start_of,
)
from ...connect.planar.stars import Stars, flip_edge
from ...predicates.kernels import orient2, orientation

__all__ = [
    "Patch", "Vertices", "drop", "fan_of", "gather", "outside_holds", "patch_of", "put_back", "put_inside",
    "same", "turn",
]  # fmt: skip

PATCH_CELLS = 44  # triangles of a patch: those of all vertices around a triangle, and a few more
CELLS, PATCH_VERTICES, RIM = range(
    3
)  # places in ``counters``: numbers of triangles, vertices, boundary half-edges
SPARE = 4  # triangles that may be added


class Vertices(NamedTuple):
    """What is known of each vertex of the whole triangulation."""

    still: NDArray[np.bool_]  # it must not move, or only on its piece
    name: NDArray[np.int32]  # -1
    row: NDArray[np.int32]  # for a vertex that may slide on its piece the row of its places, else -1
    spot: NDArray[np.int32]  # the place in that row where it is
    at: NDArray[np.int32]  # scratch
    asked: NDArray[np.bool_]  # whether it lies in a patch that could not be improved enough


class Patch(NamedTuple):
    """What belongs to the triangles, vertices and boundary half-edges of a patch, beside its `Stars`."""

    counters: NDArray[np.int64]
    live: NDArray[np.int32]  # 0 for each triangle, -1 for those that are gone
    slots: NDArray[np.int32]  # the slot of each triangle
    names: NDArray[np.int32]  # the number of each vertex
    size: NDArray[np.float64]  # the wanted squared edge length at each vertex
    outer: NDArray[np.int32]  # the half-edge beyond each boundary half-edge
    segment: NDArray[np.int32]  # the subsegment on it, or -1
    row: NDArray[np.int32]  # for each vertex, as in `Vertices`
    spot: NDArray[np.int32]


def patch_of() -> tuple[Patch, Stars]:
    """Empty arrays that hold any patch."""
    cells = PATCH_CELLS + SPARE
    points, half_edges = 3 * cells, 3 * cells
    ints, indices = (lambda k: np.zeros(k, dtype=np.int32)), np.zeros(3, dtype=np.int64)
    patch = Patch(
        indices, ints(cells), ints(cells), ints(points), np.zeros(points), ints(half_edges), ints(half_edges),
        ints(points), ints(points),
    )  # fmt: skip
    stars = Stars(
        np.zeros((points, 2)), ints(half_edges), ints(half_edges), ints(half_edges), ints(half_edges),
        ints(points), np.zeros(points, dtype=bool), ints(points), np.zeros((points + 1, 2)),
        ints(8 * half_edges), np.zeros(2, dtype=np.int64),
    )  # fmt: skip
    return patch, stars


@inline
def _fits(plane, place, t):
    """Whether triangle t may join the patch: no marked edge of it may have the patch on its other side."""
    for e in range(3 * t, 3 * t + 3):
        if plane.mark[e] >= 0 and place[plane.twin[e] // 3] >= 0:
            return False
    return True


@apart
def gather(plane, vertices, place, seed, patch, stars):
    """Copy the triangles around triangle ``seed``. ``place`` and ``name``, -1 everywhere, are left so."""
    still, name, row, spot = vertices.still, vertices.name, vertices.row, vertices.spot
    vertex, twin, slots, names = plane.vertex, plane.twin, patch.slots, patch.names
    rims = stars.ring  # how many marked half-edges end or begin at each vertex; 99 and more: also inner ones
    slots[0], place[seed] = seed, 0
    count, points, rim, i = 1, 0, 0, 0
    while i < count and count < PATCH_CELLS:
        for e in range(3 * slots[i], 3 * slots[i] + 3):
            o = np.int64(twin[e] // 3)
            if plane.mark[e] < 0 and place[o] < 0 and count < PATCH_CELLS and _fits(plane, place, o):
                slots[count], place[o] = o, count
                count += 1
        i += 1
    for t in range(count):
        patch.live[t] = 0
        for k in range(3):
            e, own = 3 * np.int64(slots[t]) + k, 3 * t + k
            v = vertex[e]
            if name[v] < 0:
                name[v], names[points] = points, v
                stars.xy[points, 0], stars.xy[points, 1] = plane.xy[v, 0], plane.xy[v, 1]
                stars.still[points] = still[v]
                patch.row[points], patch.spot[points] = row[v], spot[v]
                rims[points] = 0
                points += 1
            stars.vertex[own] = name[v]
    for t in range(count):
        for k in range(3):
            e, own = 3 * np.int64(slots[t]) + k, 3 * t + k
            stars.at[stars.vertex[own]] = own
            o = np.int64(twin[e])
            if plane.mark[e] < 0 and place[o // 3] >= 0:
                stars.twin[own], stars.mark[own] = 3 * place[o // 3] + o % 3, -1
            else:
                stars.twin[own], stars.mark[own], stars.where[rim] = -1, rim, own
                patch.outer[rim], patch.segment[rim] = o, plane.mark[e]
                for v in (start_of(stars.vertex, own), end_of(stars.vertex, own)):
                    stars.still[v] = True
                    rims[v] += 1 if plane.mark[e] >= 0 else 99
                rim += 1
    for t in range(count):
        place[slots[t]] = -1
    for v in range(points):
        name[names[v]] = -1
        if rims[v] != 2:
            patch.row[v] = -1
    patch.counters[CELLS], patch.counters[PATCH_VERTICES], patch.counters[RIM] = count, points, rim


@apart
def same(patch, stars, other, target):
    """Make the second patch a copy of the first; what never changes in a patch is copied, too."""
    cells, points, rim = patch.counters[CELLS], patch.counters[PATCH_VERTICES], patch.counters[RIM]
    other.counters[CELLS], other.counters[PATCH_VERTICES], other.counters[RIM] = cells, points, rim
    for t in range(cells):
        other.live[t], other.slots[t] = patch.live[t], patch.slots[t]
        for e in range(3 * t, 3 * t + 3):
            target.vertex[e], target.twin[e], target.mark[e] = stars.vertex[e], stars.twin[e], stars.mark[e]
    for v in range(points):
        other.names[v], other.size[v] = patch.names[v], patch.size[v]
        other.row[v], other.spot[v] = patch.row[v], patch.spot[v]
        target.xy[v, 0], target.xy[v, 1] = stars.xy[v, 0], stars.xy[v, 1]
        target.at[v], target.still[v] = stars.at[v], stars.still[v]
    for k in range(rim):
        target.where[k] = stars.where[k]
        other.outer[k], other.segment[k] = patch.outer[k], patch.segment[k]


# --- changes -------------------------------------------------------------------------------------


@lean
def turn(stars, e):
    """Swap the diagonal under half-edge e if its two triangles form a convex quadrangle; whether it was."""
    if stars.mark[e] >= 0:
        return False
    xy, vertex, o = stars.xy, stars.vertex, np.int64(stars.twin[e])
    p, a, b, q = vertex[e], start_of(vertex, e), end_of(vertex, e), vertex[o]
    if orientation(xy, p, a, q) <= 0 or orientation(xy, q, b, p) <= 0:
        return False
    flip_edge(vertex, stars.twin, stars.mark, stars.where, stars.at, e)
    return True


@inline
def _join(stars, e, o, k):
    """Make half-edge o the twin of e; o = -1: half-edge e lies on the boundary and has its number k."""
    stars.twin[e], stars.mark[e] = o, k
    if o >= 0:
        stars.twin[o], stars.mark[o] = e, -1
    if k >= 0:
        stars.where[k] = e


@lean
def put_inside(patch, stars, t):
    """A new vertex in the middle of triangle t.

    ::

              c          the triangle keeps edge a-b, half-edge 3 t + 2; the two new ones take b-c and c-a,
            / | \\        each as its half-edge 2, opposite the new vertex
           /  v  \\
          a ----- b
    """
    xy, vertex, twin, mark = stars.xy, stars.vertex, stars.twin, stars.mark
    a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
    v, first = patch.counters[PATCH_VERTICES], patch.counters[CELLS]
    second = first + 1
    patch.counters[PATCH_VERTICES], patch.counters[CELLS] = v + 1, first + 2
    xy[v, 0] = (xy[a, 0] + xy[b, 0] + xy[c, 0]) / 3.0
    xy[v, 1] = (xy[a, 1] + xy[b, 1] + xy[c, 1]) / 3.0
    patch.row[v] = -1
    patch.names[v], patch.size[v] = -1, (patch.size[a] + patch.size[b] + patch.size[c]) / 3.0
    stars.still[v] = False
    patch.live[first] = patch.live[second] = 0
    patch.slots[first] = patch.slots[second] = -1
    opposite_a, opposite_b = (twin[3 * t], mark[3 * t]), (twin[3 * t + 1], mark[3 * t + 1])
    vertex[3 * t + 2] = v
    vertex[3 * first], vertex[3 * first + 1], vertex[3 * first + 2] = b, c, v
    vertex[3 * second], vertex[3 * second + 1], vertex[3 * second + 2] = c, a, v
    _join(stars, 3 * first + 2, opposite_a[0], opposite_a[1])
    _join(stars, 3 * second + 2, opposite_b[0], opposite_b[1])
    _join(stars, 3 * t, 3 * first + 1, -1)
    _join(stars, 3 * first, 3 * second + 1, -1)
    _join(stars, 3 * second, 3 * t + 1, -1)
    stars.at[v], stars.at[a], stars.at[b], stars.at[c] = 3 * t + 2, 3 * t, 3 * t + 1, 3 * first + 1


@lean
def drop(patch, stars, v):
    """Remove vertex v, which lies inside: its edges are swapped away; returns whether that was possible.

    If not, the patch may have changed.
    """
    vertex, twin, mark = stars.vertex, stars.twin, stars.mark
    for _ in range(64):
        degree, e = 0, np.int64(stars.at[v])
        while True:
            e = next_edge(np.int64(twin[next_edge(e)]))
            degree += 1
            if e == stars.at[v] or degree > 64:
                break
        if degree == 3 or degree > 64:
            break
        done = False
        for _ in range(degree):
            spoke = next_edge(e)
            a, b = vertex[e], end_of(vertex, e)
            done = turn(stars, spoke)
            if done:
                break
            e = next_edge(np.int64(twin[spoke]))
        if not done:
            return False
    if degree != 3:
        return False
    e = np.int64(stars.at[v])
    f = next_edge(np.int64(twin[next_edge(e)]))
    g = next_edge(np.int64(twin[next_edge(f)]))
    a, b, c = start_of(vertex, e), start_of(vertex, f), start_of(vertex, g)
    beside = (twin[f], mark[f]), (twin[g], mark[g])
    t = e // 3
    patch.live[f // 3] = patch.live[g // 3] = -1
    # triangle t becomes a, b, c: its half-edge 0 is opposite a
    keep = twin[e], mark[e]
    vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2] = a, b, c
    _join(stars, 3 * t, beside[0][0], beside[0][1])
    _join(stars, 3 * t + 1, beside[1][0], beside[1][1])
    _join(stars, 3 * t + 2, keep[0], keep[1])
    stars.at[a], stars.at[b], stars.at[c] = 3 * t, 3 * t + 1, 3 * t + 2
    stars.still[v], stars.at[v] = True, -1
    return True


# --- back to the triangulation ---------------------------------------------------------------------


@apart
def put_back(plane, patch, stars, vertices, spots):
    """Replace the triangles that were gathered by those of the patch, in the same slots.

    There must be room for a few more triangles and vertices. New vertices get the next numbers. Vertices that
    have slid take the parameters of their places in ``spots``.
    """
    vertex, twin, mark, state = plane.vertex, plane.twin, plane.mark, plane.state
    cells, slots = patch.counters[CELLS], patch.slots
    state[BUSY] = 1
    for t in range(cells):
        if slots[t] < 0:
            slots[t] = new_slot(twin, state)
    for v in range(patch.counters[PATCH_VERTICES]):
        if patch.names[v] < 0:
            patch.names[v] = state[VERTICES]
            vertices.still[patch.names[v]] = False
            state[VERTICES] += 1
        own = patch.names[v]
        plane.xy[own, 0], plane.xy[own, 1] = stars.xy[v, 0], stars.xy[v, 1]
    part = plane.region[slots[0]]
    for t in range(cells):
        if patch.live[t] < 0:
            free_slot(vertex, twin, plane.region, state, slots[t])
            continue
        slot = np.int64(slots[t])
        state[LAST] = slot
        plane.region[slot] = part
        for k in range(3):
            e, own = 3 * slot + k, 3 * t + k
            vertex[e] = patch.names[stars.vertex[own]]
            b = stars.mark[own]
            if b < 0:
                o = np.int64(stars.twin[own])
                twin[e], mark[e] = 3 * slots[o // 3] + o % 3, -1
                continue
            twin[e], mark[e] = patch.outer[b], patch.segment[b]
            twin[patch.outer[b]] = e
            s = patch.segment[b]
            if s >= 0:
                plane.where[s] = e
                for v in (start_of(stars.vertex, own), end_of(stars.vertex, own)):
                    if patch.row[v] >= 0:
                        end = 0 if plane.ends[s, 0] == patch.names[v] else 1
                        plane.span[s, end] = spots[patch.row[v], patch.spot[v], 2]
                        vertices.spot[patch.names[v]] = patch.spot[v]
    state[BUSY] = 0


@lean
def fan_of(xy, vertex, twin, mark, first, places):
    """As `star_of` for a vertex on the boundary of a patch: the points around it from mark to mark."""
    e = np.int64(first)
    while mark[prev_edge(e)] < 0:
        e = prev_edge(np.int64(twin[prev_edge(e)]))
    a = start_of(vertex, e)
    places[0, 0], places[0, 1] = xy[a, 0], xy[a, 1]
    k = 0
    while True:
        b = end_of(vertex, e)
        k += 1
        places[k, 0], places[k, 1] = xy[b, 0], xy[b, 1]
        if mark[next_edge(e)] >= 0:
            return k
        e = next_edge(np.int64(twin[next_edge(e)]))


@lean
def outside_holds(plane, patch, stars, stack):
    """Whether the triangles outside stay counterclockwise if the vertices of the patch slide: -1 if not.

    Otherwise the number of half-edges on the stack: those outside that must be tested afterwards.
    """
    vertex, depth = plane.vertex, 0
    for b in range(patch.counters[RIM]):
        v = start_of(stars.vertex, np.int64(stars.where[b]))
        if patch.segment[b] < 0 or patch.row[v] < 0:
            continue
        own, x, y = patch.names[v], stars.xy[v, 0], stars.xy[v, 1]
        if x == plane.xy[own, 0] and y == plane.xy[own, 1]:
            continue
        o = np.int64(patch.outer[b])  # it ends at v, and so do those of the next triangles around v
        while True:
            e, n = prev_edge(o), next_edge(o)
            p, q = start_of(vertex, e), end_of(vertex, e)
            if min(p, q) >= 0:
                px, py, qx, qy = plane.xy[p, 0], plane.xy[p, 1], plane.xy[q, 0], plane.xy[q, 1]
                for w in range(patch.counters[PATCH_VERTICES]):  # they may have slid, too
                    if patch.names[w] == p:
                        px, py = stars.xy[w, 0], stars.xy[w, 1]
                    if patch.names[w] == q:
                        qx, qy = stars.xy[w, 0], stars.xy[w, 1]
                if orient2(px, py, qx, qy, x, y) <= 0:
                    return -1
            stack[depth] = e
            depth += 1
            if plane.mark[n] >= 0:
                break
            stack[depth] = n
            depth += 1
            o = np.int64(plane.twin[n])
    return depth
