"""The apex of a front edge by the empty circle, without a triangulation; and cells made of nothing else,
compiled.

The apex of the front edge AB is, of all vertices at the front that are *visible* from AB, the one whose
circle with A and B has no other of them inside. C is visible if no edge of the front meets the open triangle
ABC. Only the left side of AB counts, where nothing is meshed:

            . - .
          .   C   .          Circles through A and B grow steadily on the left of AB as their centers move to
         .  /   \\  .         the left. So one comparison orders all candidates: C is before D if it is inside
         . /     \\ .         the circle ABD. The apex is the first visible one.
          A-------B
                             D

**Why it exists, and why the result is constrained Delaunay.** What is not meshed has a constrained Delaunay
triangulation, with the front as its segments. Let ABC be its triangle on AB. It is free, so C is visible. If
D came before C and were visible, the triangle ABD would be free, too; near AB both triangles have points in
common, from which D is seen inside the circle of ABC, which contradicts the definition. So the rule finds C,
or a vertex on the same circle, and then another constrained Delaunay triangulation of the rest. With *all*
points in the place of the visible ones on the left there may be no apex: see the book.

The search goes down the digital tree of the vertices, nearest parts first. It leaves out whatever is on the
right of AB, outside of the best circle so far, or in the shade of edges that have hidden other candidates.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, lean
from ...predicates.kernels import incircle
from ..advancing.digital_tree import LOWER, UPPER
from .open_front import blocking_edge, meets_inside, turn

__all__ = ["Ahead", "apex_ahead", "apex_within", "cap_of", "new_ahead"]

SHADES = 4  # edges that have hidden candidates are remembered, the latest so many
FIRST_CAP, CAP_GROWTH = (
    0.6,
    12.0,
)  # times |AB|: the centers of the circles that are searched, one after the other
FLAT_CAP = 1e4  # a center so many times |AB| away: its circle is taken for a straight line


class Ahead(NamedTuple):
    """What the search for an apex needs besides the front."""

    shade: NDArray[np.int32]  # (SHADES, 2) edges that hide, with AB on their right
    found: NDArray[
        np.int64
    ]  # (4,) the apex; 1 if another is on its circle; how many were hidden; visited nodes


def new_ahead() -> Ahead:
    """Scratch for one search at a time."""
    return Ahead(np.zeros((SHADES, 2), dtype=np.int32), np.zeros(4, dtype=np.int64))


@inline
def center_of(xy, a, b, c):
    """How far the center of the circle abc is on the left of the middle of ab, in |ab|, or more than that.

    c is on the left of ab. inf stands for distances that are large or lost to rounding.
    """
    mx, my = 0.5 * (xy[a, 0] + xy[b, 0]), 0.5 * (xy[a, 1] + xy[b, 1])
    ux, uy, wx, wy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1], xy[c, 0] - mx, xy[c, 1] - my
    one, two, square, far = ux * wy, uy * wx, ux * ux + uy * uy, wx * wx + wy * wy
    cross = one - two
    slack = 1e-14 * (abs(one) + abs(two)) + 2e-15 * (abs(ux) + abs(uy))
    if not (cross > 1e3 * slack and cross > 1e-280):
        return inf
    k = (far - 0.25 * square) / (2.0 * cross)
    k += abs(k) * 2.0 * slack / cross + 1e-14 * (far + square) / cross
    return k if k < FLAT_CAP else inf


@inline
def cap_at(xy, a, b, k):
    """The circle through a and b whose center is k |ab| to the left of their middle: center and squared
    radius.

    It is rounded so that its part on the left of ab is never too small; inf stands for the half-plane.
    """
    mx, my = 0.5 * (xy[a, 0] + xy[b, 0]), 0.5 * (xy[a, 1] + xy[b, 1])
    if not k < FLAT_CAP:
        return mx, my, inf
    ux, uy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
    r = sqrt((0.25 + k * k) * (ux * ux + uy * uy)) * (1.0 + 1e-12) + 4e-15
    return mx - k * uy, my + k * ux, r * r


@inline
def cap_of(xy, a, b, c):
    """`cap_at` for the circle through a, b and c."""
    return cap_at(xy, a, b, center_of(xy, a, b, c))


@inline
def all_right(ax, ay, nx, ny, place, node):
    """Whether n (p - a) < 0 for the whole rectangle of a node."""
    px = (place[node, 2] if nx > 0.0 else place[node, 0]) - ax
    py = (place[node, 3] if ny > 0.0 else place[node, 1]) - ay
    one, two = nx * px, ny * py
    return one + two < -(1e-14 * (abs(one) + abs(two)) + 1e-280)


@inline
def in_shade(xy, a, b, s, t, place, node):
    """Whether st hides the whole rectangle from at least a part of ab, which is on the right of st.

    Such points are beyond st, on the right of the line from b through s, and on the left of that from a
    through t.
    """
    sx, sy, tx, ty = xy[s, 0], xy[s, 1], xy[t, 0], xy[t, 1]
    return (
        all_right(sx, sy, ty - sy, sx - tx, place, node)
        and all_right(xy[b, 0], xy[b, 1], xy[b, 1] - sy, sx - xy[b, 0], place, node)
        and all_right(xy[a, 0], xy[a, 1], ty - xy[a, 1], xy[a, 0] - tx, place, node)
    )


@inline
def distance_to(place, node, x, y):
    """The squared distance of a point to the rectangle of a node."""
    dx = max(place[node, 0] - x, x - place[node, 2], 0.0)
    dy = max(place[node, 1] - y, y - place[node, 3], 0.0)
    return dx * dx + dy * dy


@inline
def left_out(front, a, b, cap, shade, shades, node):
    """Whether no vertex below a node can come before the best one so far."""
    xy, place = front.xy, front.vertices.place
    cx, cy, r2 = cap
    if distance_to(place, node, cx, cy) > r2:
        return True
    if all_right(xy[a, 0], xy[a, 1], xy[a, 1] - xy[b, 1], xy[b, 0] - xy[a, 0], place, node):
        return True
    for i in range(min(shades, SHADES)):
        if in_shade(xy, a, b, np.int64(shade[i, 0]), np.int64(shade[i, 1]), place, node):
            return True
    return False


@lean
def hidden_by(front, a, b, c, shade, shades):
    """Whether c is hidden from ab; then the edge that hides it is remembered: (hidden, shades)."""
    xy = front.xy
    for i in range(min(shades, SHADES)):
        if meets_inside(xy, a, b, c, np.int64(shade[i, 0]), np.int64(shade[i, 1])):
            return True, shades
    row = blocking_edge(front, a, b, c)
    if row < 0:
        return False, shades
    s, t = np.int64(front.ends[row, 0]), np.int64(front.ends[row, 1])
    at_a, at_b = turn(xy, s, t, a), turn(xy, s, t, b)
    if at_a >= 0 and at_b >= 0:
        s, t, at_a, at_b = t, s, -at_a, -at_b
    if at_a <= 0 and at_b <= 0:
        shade[shades % SHADES, 0], shade[shades % SHADES, 1] = s, t
        shades += 1
    return True, shades


@inline
def is_before(xy, u, v):
    """Whether vertex u has the smaller x, or the same x and the smaller y."""
    return xy[u, 0] < xy[v, 0] or (xy[u, 0] == xy[v, 0] and xy[u, 1] < xy[v, 1])


@lean
def first_in_order(front, a, b, ahead, k, visible):
    """The first candidate in the order of circles, -1 for none; only visible ones if ``visible``.

    Of several on one circle the leftmost, lowest one is taken. Only the circle with its center k |ab| to
    the left is searched (`FLAT_CAP` means the half-plane); -1 also if it is not certain that none is before.
    """
    xy, tree, shade = front.xy, front.vertices, ahead.shade
    place, links, stack = tree.place, tree.links, tree.stack
    best, tied, shades, depth = np.int64(-1), False, np.int64(0), 0
    cap = cap_at(xy, a, b, k)
    x, y, _ = cap_at(xy, a, b, 0.5)
    if tree.root[0] >= 0:
        stack[0] = tree.root[0]
        depth = 1
    while depth > 0:
        depth -= 1
        node = np.int64(stack[depth])
        ahead.found[3] += 1
        if distance_to(place, node, cap[0], cap[1]) > cap[2]:
            continue
        dx, dy = xy[node, 0] - cap[0], xy[node, 1] - cap[1]
        if not dx * dx + dy * dy > cap[2] and node != a and node != b and turn(xy, a, b, node) > 0:
            sign = 1
            if best >= 0:
                sign = incircle(
                    xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[best, 0], xy[best, 1], xy[node, 0], xy[node, 1]
                )
            if sign >= 0:
                hidden = False
                if visible:
                    hidden, shades = hidden_by(front, a, b, node, shade, shades)
                    ahead.found[2] += hidden
                if not hidden:
                    tied = sign == 0
                    if sign > 0:
                        best, cap = node, cap_of(xy, a, b, node)
                    elif is_before(xy, node, best):
                        best = node
        one, two = np.int64(links[node, LOWER]), np.int64(links[node, UPPER])
        if one >= 0 and two >= 0 and distance_to(place, one, x, y) < distance_to(place, two, x, y):
            one, two = two, one
        if one >= 0 and not left_out(front, a, b, cap, shade, shades, one):
            stack[depth] = one
            depth += 1
        if two >= 0 and not left_out(front, a, b, cap, shade, shades, two):
            stack[depth] = two
            depth += 1
    ahead.found[1] = tied
    # A vertex that is in the circle by rounding only may come after others that are not.
    return best if best < 0 or not k < FLAT_CAP or center_of(xy, a, b, best) <= k else np.int64(-1)


@lean
def apex_within(front, ahead, row, k):
    """The apex of a front edge, -1 if its circle has its center more than k |ab| to the left of ab."""
    a, b = np.int64(front.ends[row, 0]), np.int64(front.ends[row, 1])
    ahead.found[2] = 0
    c = first_in_order(front, a, b, ahead, k, False)
    if c >= 0 and (ahead.found[1] > 0 or blocking_edge(front, a, b, c) >= 0):
        c = first_in_order(front, a, b, ahead, k, True)
    ahead.found[0] = c
    return c


@lean
def apex_ahead(front, ahead, row):
    """The apex of a front edge, -1 for none; small circles are searched first."""
    k = FIRST_CAP
    c = apex_within(front, ahead, row, k)
    while c < 0 and k < FLAT_CAP:
        k *= CAP_GROWTH
        c = apex_within(front, ahead, row, k)
    return c
