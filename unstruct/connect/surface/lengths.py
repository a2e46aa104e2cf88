"""Kernels on a surface that is known by the lengths of its edges: areas, angles, flips.

Triangles are given by half-edges (see `gluing`). Two of them may have several edges or vertices in common, an
edge may join a vertex to itself, and nothing here knows where anything lies in space. The two triangles
beside an edge are laid into the plane side by side; this needs their five lengths alone.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.elementary import angle_of
from ...base.jit import inline, kernel, lean
from .gluing import next_side, previous_side

__all__ = [
    "Sides",
    "corner_angle",
    "cotangents",
    "diagonal",
    "flip_side",
    "four_areas",
    "legalize",
    "signposts",
]

LEGAL_ERROR = 2.0**-50  # of the cotangents' sum, in units of the squares over the areas: it bounds rounding
FLATTEST_CONTENT = 2.0**-100  # the least four areas of a triangle, in units of its longest edge squared


class Sides(NamedTuple):
    """The half-edges of an intrinsic triangulation; arrays may be longer than what is in use.

    Attributes
    ----------
    vertex, twin : (3 m,) int32
        Where each begins; the same edge in the neighbor, -1 for none.
    length : (3 m,) float64
        Of the edge: the same in both twins.
    turn : (3 m,) float64
        Its direction at the vertex where it begins: the angle from the vertex's first half-edge on the given
        surface, counterclockwise, measured along the surface.
    under : (3 m,) int32
        For a half-edge that runs along a half-edge of the given surface and is never flipped: that one.
        Otherwise -1.
    content : (m,) float64
        Four times the area of each triangle.
    label : (m,) int32
        A given triangle in the same part of the surface, of those into which kept edges divide it.
    """

    vertex: NDArray[np.int32]
    twin: NDArray[np.int32]
    length: NDArray[np.float64]
    turn: NDArray[np.float64]
    under: NDArray[np.int32]
    content: NDArray[np.float64]
    label: NDArray[np.int32]


@inline
def four_areas(a, b, c):
    """Four times the area of a triangle with these sides, never less than `FLATTEST_CONTENT` allows.

    Heron's formula in the order by W. Kahan (*Miscalculating area and angles of a needle-like triangle*):
    nothing is lost for needles but what their lengths have lost already.
    """
    if a < b:
        a, b = b, a
    if b < c:
        b, c = c, b
    if a < b:
        a, b = b, a
    product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))
    return max(np.sqrt(max(product, 0.0)), FLATTEST_CONTENT * a * a)


@inline
def corner_angle(left, right, opposite, content):
    """The angle between two sides of a triangle of which all sides and four areas are known."""
    return angle_of(content, left * left + (right - opposite) * (right + opposite))


@inline
def cotangents(sides, h):
    """(sum, scale): of the two angles opposite an inner edge, and the scale of their rounding."""
    g = sides.twin[h]
    square = sides.length[h] * sides.length[h]
    one = sides.length[next_side(h)] ** 2 + sides.length[previous_side(h)] ** 2
    two = sides.length[next_side(g)] ** 2 + sides.length[previous_side(g)] ** 2
    s, t = sides.content[h // 3], sides.content[g // 3]
    return (one - square) / s + (two - square) / t, (one + square) / s + (two + square) / t


@inline
def diagonal(sides, h):
    """The length of the other diagonal of the quadrilateral of the two triangles beside an inner edge."""
    g = sides.twin[h]
    base = sides.length[h]
    bc, ca = sides.length[next_side(h)], sides.length[previous_side(h)]
    ad, db = sides.length[next_side(g)], sides.length[previous_side(g)]
    # twice the difference of the feet of the two corners on the edge, and of their heights
    along = (ca - bc) * (ca + bc) - (ad - db) * (ad + db)
    across = sides.content[h // 3] + sides.content[g // 3]
    return np.sqrt(along * along + across * across) / (2.0 * base)


@lean
def flip_side(sides, h, length):
    """Replace an inner edge by the other diagonal, of known length, in place.

    ::

             c                  c           Before: h runs from a to b, with c on its left and d on its right.
           / | \\              / s \\         Afterwards: half-edge h - 1 of the same triangle runs from c to
           d.
          a-----b     ->     a | | b        Half-edges of five edges are kept or moved to the slots of h and
           \\ | /              \\ t /         of its old twin.
             d                  d
    """
    vertex, twin, turn = sides.vertex, sides.twin, sides.turn
    g = twin[h]
    h1, h2, g1, g2 = next_side(h), previous_side(h), next_side(g), previous_side(g)
    c, d = vertex[h2], vertex[g2]
    ca, db, ad, bc = sides.length[h2], sides.length[g2], sides.length[g1], sides.length[h1]
    upper, lower = four_areas(ca, length, ad), four_areas(db, length, bc)
    at_c = turn[h2] + corner_angle(ca, length, ad, upper)
    at_d = turn[g2] + corner_angle(db, length, bc, lower)
    beyond_h, beyond_g = twin[h2], twin[g2]
    vertex[h], turn[h], sides.length[h], sides.under[h] = d, turn[g2], db, sides.under[g2]
    vertex[g], turn[g], sides.length[g], sides.under[g] = c, turn[h2], ca, sides.under[h2]
    if beyond_g == h2:  # the two edges are one, glued to itself
        twin[h], twin[g] = g, h
    else:
        twin[h], twin[g] = beyond_g, beyond_h
        if beyond_g >= 0:
            twin[beyond_g] = h
        if beyond_h >= 0:
            twin[beyond_h] = g
    vertex[h2], vertex[g2], twin[h2], twin[g2] = c, d, g2, h2
    turn[h2], turn[g2] = at_c, at_d
    sides.length[h2] = sides.length[g2] = length
    sides.under[h2] = sides.under[g2] = -1
    sides.content[h // 3], sides.content[g // 3] = lower, upper


@inline
def _index(one, two, three, content):
    """The sum of the cotangents of a triangle's angles, from its sides and four areas."""
    return (one * one + two * two + three * three) / content


@lean
def _better(sides, h, length):
    """Whether the sum of all cotangents becomes less by a flip, as it is computed."""
    g = sides.twin[h]
    base = sides.length[h]
    bc, ca = sides.length[next_side(h)], sides.length[previous_side(h)]
    ad, db = sides.length[next_side(g)], sides.length[previous_side(g)]
    before = _index(base, bc, ca, sides.content[h // 3]) + _index(base, ad, db, sides.content[g // 3])
    upper, lower = four_areas(ca, length, ad), four_areas(db, length, bc)
    return _index(ca, length, ad, upper) + _index(db, length, bc, lower) < before


@inline
def _push(sides, h, queued, stack, top):
    g = sides.twin[h]
    if g < 0 or queued[h] or queued[g] or sides.under[h] >= 0:
        return top
    queued[h] = True
    stack[top] = h
    return top + 1


@kernel
def suspect_all(sides, many, queued, stack):
    """Put every inner edge that may be flipped on the stack; its height."""
    top = 0
    for h in range(many - 1, -1, -1):
        if sides.twin[h] > h:
            top = _push(sides, h, queued, stack, top)
    return top


@kernel
def legalize(sides, queued, stack, top, events):
    """Examine as many edges of the stack as there is room for events; (height, flips, held).

    ``held`` counts edges that seem illegal although a flip would not lower the computed sum of cotangents.
    """
    count = held = 0
    for _ in range(events.shape[0]):
        if top == 0:
            break
        top -= 1
        h = stack[top]
        queued[h] = False
        g = sides.twin[h]
        if (
            g < 0 or sides.under[h] >= 0 or g // 3 == h // 3
        ):  # an edge with one triangle on both sides is legal
            continue
        total, scale = cotangents(sides, h)
        if not total < -LEGAL_ERROR * scale:
            continue
        length = diagonal(sides, h)
        if not _better(sides, h, length):
            held += 1
            continue
        flip_side(sides, h, length)
        events[count] = h
        count += 1
        top = _push(sides, h, queued, stack, top)
        top = _push(sides, next_side(h), queued, stack, top)
        top = _push(sides, g, queued, stack, top)
        top = _push(sides, next_side(g), queued, stack, top)
    return top, count, held


@kernel
def flip_again(sides, events):
    """Perform recorded flips; the number of the first one that meets a boundary, or -1."""
    for i in range(events.shape[0]):
        if sides.twin[events[i]] < 0:
            return i
        flip_side(sides, events[i], diagonal(sides, events[i]))
    return -1


@kernel
def signposts(sides, first, around):
    """Write contents, directions of all half-edges, and the whole angle around each vertex."""
    for t in range(sides.content.shape[0]):
        sides.content[t] = four_areas(sides.length[3 * t], sides.length[3 * t + 1], sides.length[3 * t + 2])
    for v in range(first.shape[0]):
        around[v] = 0.0
        h = first[v]
        while h >= 0:
            p = previous_side(h)
            sides.turn[h] = around[v]
            around[v] += corner_angle(
                sides.length[h], sides.length[p], sides.length[next_side(h)], sides.content[h // 3]
            )
            h = sides.twin[p]
            if h == first[v]:
                break
