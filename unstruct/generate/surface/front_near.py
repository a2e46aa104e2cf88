"""What is near an edge of the front, seen along its normal, and which triangles on it are valid there.

All vertices and edges of the front in a ball are projected onto the tangent plane of the edge. Of these only
those count that lie on the same sheet: on the same component of the surface, with a normal that does not turn
away, not far above or below. In the plane the tests are exact: which side, whether edges cross, whether a
triangle holds a vertex. But the projections of edges of a curved surface need not be a front in the plane. So
the tests decide what is tried, and `check` decides, exactly, what the mesh is worth.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, lean
from ...predicates.kernels import orient2
from .front_records import FRONT_LEVELS, bucket_of, known_edge, side_of_cubes

__all__ = ["Nearby", "fault_of", "gather_near", "matching_edge", "nearby_arrays", "project"]

MOST_NEAR = 4096  # vertices, and edges, that are gathered
SAME_SHEET = 0.2  # the least product of normals of edges that see each other
HEIGHT_OF_SHEET = 1.0  # times the reach: what is farther above or below is on another sheet


class Nearby(NamedTuple):
    """The vertices and edges of the front that an edge sees.

    Attributes
    ----------
    vertex, inner : (c,) int64
        Vertices of the front, and others of the mesh.
    place : (n, 2)
        The projection of each vertex of the front, by its number, as far as ``seen`` has the number of the
        step.
    seen : (n,) int64
    edge : (c,) int64
    frame : (5, 3)
        Origin, two directions in the plane, the normal; the normal of the triangle that was looked at last.
    many : (4,) int64
        How many vertices and edges; the number of the step; how many inner vertices.
    """

    vertex: NDArray[np.int64]
    inner: NDArray[np.int64]
    place: NDArray[np.float64]
    seen: NDArray[np.int64]
    edge: NDArray[np.int64]
    frame: NDArray[np.float64]
    many: NDArray[np.int64]


def nearby_arrays(vertices: int) -> Nearby:
    """Room for what is near, of so many vertices."""
    return Nearby(
        np.empty(MOST_NEAR, dtype=np.int64),
        np.empty(MOST_NEAR, dtype=np.int64),
        np.empty((vertices, 2)),
        np.full(vertices, -1, dtype=np.int64),
        np.empty(MOST_NEAR, dtype=np.int64),
        np.zeros((5, 3)),
        np.zeros(4, dtype=np.int64),
    )


@inline
def project(nearby, p, k):
    """The coordinate k of a point in the frame: 0 and 1 in the plane, 2 above it."""
    f = nearby.frame
    return (p[0] - f[0, 0]) * f[k + 1, 0] + (p[1] - f[0, 1]) * f[k + 1, 1] + (p[2] - f[0, 2]) * f[k + 1, 2]


@inline
def _agrees(front, e, n):
    """Whether an edge of the front may be on the sheet with normal n."""
    return front.normal[e, 0] * n[0] + front.normal[e, 1] * n[1] + front.normal[e, 2] * n[2] > SAME_SHEET


@inline
def _see(front, nearby, v):
    """Project a vertex, if it has not been."""
    if nearby.seen[v] != nearby.many[2]:
        nearby.seen[v] = nearby.many[2]
        nearby.place[v, 0] = project(nearby, front.xyz[v], 0)
        nearby.place[v, 1] = project(nearby, front.xyz[v], 1)


@lean
def _add(front, nearby, v, part):
    """Add a vertex and its edges, as far as they are on the sheet."""
    n = nearby.frame[3]
    if front.part[v] != part or nearby.many[0] == MOST_NEAR:
        return
    on = front.loose[v] == 1
    for way in range(2):
        e = front.heads[v] if way == 0 else front.tails[v]
        while e >= 0:
            if _agrees(front, e, n):
                on = True
                other = front.ends[e, 1 - way]
                # edges come with their first end, if that is near, else with their last one
                if (way == 0 or nearby.seen[other] != nearby.many[2]) and nearby.many[1] < MOST_NEAR:
                    nearby.edge[nearby.many[1]] = e
                    nearby.many[1] += 1
            e = front.next_head[e] if way == 0 else front.next_tail[e]
    if on:
        nearby.vertex[nearby.many[0]] = v
        nearby.many[0] += 1
    elif nearby.many[3] < MOST_NEAR:
        h, t = front.held_normals, front.near[v]
        if h[t, 0] * n[0] + h[t, 1] * n[1] + h[t, 2] * n[2] > SAME_SHEET:
            nearby.inner[nearby.many[3]] = v
            nearby.many[3] += 1


@lean
def _look(front, nearby, v, part, reach):
    """Add a vertex, if it is in the ball and has not been seen."""
    dx, dy, dz = (
        front.xyz[v, 0] - nearby.frame[0, 0],
        front.xyz[v, 1] - nearby.frame[0, 1],
        front.xyz[v, 2] - nearby.frame[0, 2],
    )
    if (
        nearby.seen[v] != nearby.many[2]
        and dx * dx + dy * dy + dz * dz <= reach * reach
        and abs(project(nearby, front.xyz[v], 2)) <= HEIGHT_OF_SHEET * reach
    ):
        _see(front, nearby, v)
        _add(front, nearby, v, part)


@lean
def gather_near(front, nearby, part, reach):
    """Find the vertices in a ball around the origin of the frame, and their edges. Some edges come twice."""
    nearby.many[0] = nearby.many[1] = nearby.many[3] = 0
    nearby.many[2] += 1
    x = nearby.frame[0]
    for i in range(front.at_level.shape[0]):
        count = front.at_level[i]
        for m in range(3):
            if x[m] + reach < front.level_box[i, 0, m] or x[m] - reach > front.level_box[i, 1, m]:
                count = 0
        if count == 0:
            continue
        level = front.state[FRONT_LEVELS] + i
        side = side_of_cubes(level)
        a, b = np.floor((x[0] - reach) / side), np.floor((x[0] + reach) / side)
        c, d = np.floor((x[1] - reach) / side), np.floor((x[1] + reach) / side)
        g, h = np.floor((x[2] - reach) / side), np.floor((x[2] + reach) / side)
        if (b - a + 1.0) * (d - c + 1.0) * (h - g + 1.0) > count:
            v = front.of_level[i]
            while v >= 0:
                _look(front, nearby, v, part, reach)
                v = front.same[v]
            continue
        for j in range(np.int64(a), np.int64(b) + 1):
            for k in range(np.int64(c), np.int64(d) + 1):
                for m in range(np.int64(g), np.int64(h) + 1):
                    v = front.buckets[bucket_of(front, level, j, k, m)]
                    while v >= 0:
                        if front.level[v] == level:
                            _look(front, nearby, v, part, reach)
                        v = front.after[v]
    for i in range(nearby.many[1]):
        _see(front, nearby, front.ends[nearby.edge[i], 0])
        _see(front, nearby, front.ends[nearby.edge[i], 1])


@inline
def _side(a, b, c):
    return orient2(a[0], a[1], b[0], b[1], c[0], c[1])


@lean
def _crosses(p, q, a, b):
    """Whether segments cross inside of both, or one has an end inside of the other; they share no end."""
    one, two = _side(p, q, a), _side(p, q, b)
    if one * two > 0:
        return False
    three, four = _side(a, b, p), _side(a, b, q)
    if three * four > 0:
        return False
    if one != 0 or two != 0:
        return True
    k = 0 if abs(p[0] - q[0]) >= abs(p[1] - q[1]) else 1  # on one line: whether they overlap
    return min(p[k], q[k]) <= max(a[k], b[k]) and min(a[k], b[k]) <= max(p[k], q[k])


@lean
def matching_edge(front, u, v, n):
    """The edge of the front from u to v whose normal agrees most with n; -1 for none."""
    best, found = SAME_SHEET, -1
    e = front.heads[u]
    while e >= 0:
        if front.ends[e, 1] == v:
            product = front.normal[e, 0] * n[0] + front.normal[e, 1] * n[1] + front.normal[e, 2] * n[2]
            if product > best:
                best, found = product, e
        e = front.next_head[e]
    return found


@lean
def fault_of(front, nearby, a, b, c, p):
    """Why the triangle on edge a b with the corner c, or a new one at p if c < 0, is not valid; else 0.

    1: it turns the wrong way; 2: it has an edge of the mesh that is not in the front there; 3: it holds a
    vertex; 4: an edge of the front crosses its sides.
    """
    place, n = nearby.place, nearby.frame[3]
    pa, pb = place[a], place[b]
    if _side(pa, pb, p) <= 0:
        return 1
    opens_a = opens_b = True
    if c >= 0:
        opens_a = matching_edge(front, c, a, n) < 0
        opens_b = matching_edge(front, b, c, n) < 0
        if (opens_a and known_edge(front, a, c)) or (opens_b and known_edge(front, b, c)):
            return 2
    for i in range(nearby.many[0]):
        v = nearby.vertex[i]
        if v != a and v != b and v != c:
            q = place[v]
            if _side(pa, pb, q) >= 0 and _side(pb, p, q) >= 0 and _side(p, pa, q) >= 0:
                return 3
    for i in range(nearby.many[1]):
        e = nearby.edge[i]
        u, w = front.ends[e, 0], front.ends[e, 1]
        if opens_a and u != a and w != a and u != c and w != c and _crosses(pa, p, place[u], place[w]):
            return 4
        if opens_b and u != b and w != b and u != c and w != c and _crosses(pb, p, place[u], place[w]):
            return 4
    return 0
