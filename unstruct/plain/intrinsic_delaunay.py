"""Intrinsic Delaunay triangulation by flips, from angles alone (section 2.7 of the book).

A triangle is known by its three side lengths, a surface by how sides are glued. Side (t, k) of triangle t
runs from corner k to the next one. ``twin`` leads from a side to the same edge in the neighbor.

Source: M. Fisher, B. Springborn, P. Schroeder and A. I. Bobenko, An algorithm for the construction of
intrinsic Delaunay triangulations with applications to digital geometry processing, Computing 81 (2007)
199-213.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import acos, cos, dist, pi, sqrt
from typing import Any, NamedTuple

__all__ = ["Glued", "angle", "flip", "glue", "intrinsic_delaunay", "opposite_angles", "other_diagonal"]

Side = tuple[int, int]
ROUNDING = 1e-10  # angles that add up to so much more than pi are not illegal: rounding cannot tell


class Glued(NamedTuple):
    """A surface of triangles: the vertex where each side begins, its length, its twin."""

    vertex: dict[Side, int]
    length: dict[Side, float]
    twin: dict[Side, Side]


def following(side: Side) -> Side:
    """The next side of the same triangle."""
    return side[0], (side[1] + 1) % 3


def glue(points: Sequence[Sequence[float]], triangles: Sequence[Sequence[int]]) -> Glued:
    """The sides of an oriented surface in space; an edge of one triangle has no twin."""
    vertex = {(t, k): v for t, row in enumerate(triangles) for k, v in enumerate(row)}
    ends = {(v, vertex[following(side)]): side for side, v in vertex.items()}
    length = {side: dist(points[a], points[b]) for (a, b), side in ends.items()}
    twin = {side: ends[b, a] for (a, b), side in ends.items() if (b, a) in ends}
    return Glued(vertex, length, twin)


def angle(left: float, right: float, opposite: float) -> float:
    """The angle between two sides of a triangle, by the law of cosines."""
    value = (left * left + right * right - opposite * opposite) / (2 * left * right)
    return acos(min(max(value, -1.0), 1.0))


def sides_of(surface: Glued, side: Side) -> tuple[float, float, float]:
    """The lengths of a side and of the two that follow it."""
    one = following(side)
    return surface.length[side], surface.length[one], surface.length[following(one)]


def opposite_angles(surface: Glued, side: Side) -> float:
    """The sum of the two angles opposite an edge: more than pi if it is illegal."""
    total = 0.0
    for one in (side, surface.twin[side]):
        base, right, left = sides_of(surface, one)
        total += angle(left, right, base)
    return total


def other_diagonal(surface: Glued, side: Side) -> float:
    """The length of the other diagonal when the two triangles of an edge lie side by side in the plane."""
    base, right, left = sides_of(surface, side)
    same, near, far = sides_of(surface, surface.twin[side])
    turn = angle(base, left, right) + angle(same, near, far)
    return sqrt(left * left + near * near - 2 * left * near * cos(turn))


def flip(surface: Glued, side: Side) -> None:
    """Replace an edge by the other diagonal: its sides become those that lie between the four others."""
    vertex, length, twin = surface
    other, new = twin[side], other_diagonal(surface, side)
    bc, ad = following(side), following(other)
    ca, db = following(bc), following(ad)
    moved: dict[Any, Side] = {db: side, ca: other}  # two sides of the ring change their triangle
    ring = {at: (vertex[old], length[old], twin.get(old)) for old, at in moved.items()}
    ends = vertex[ca], vertex[db]
    for at, (v, size, beyond) in ring.items():
        vertex[at], length[at] = v, size
        twin.pop(at, None)
        if beyond is not None:
            twin[at] = moved.get(beyond, beyond)
            twin[twin[at]] = at
    (vertex[ca], vertex[db]), length[ca], length[db] = ends, new, new
    twin[ca], twin[db] = db, ca


def intrinsic_delaunay(
    points: Sequence[Sequence[float]], triangles: Sequence[Sequence[int]]
) -> tuple[Glued, list[Side]]:
    """Flip edges whose opposite angles add up to more than pi until there is none.

    Parameters
    ----------
    points : n points of 3 numbers
    triangles : of an oriented surface, which may have a boundary

    Returns
    -------
    surface : Glued
    flips : list of sides, in order, which `flip` repeats
    """
    surface = glue(points, triangles)
    stack, flips = list(surface.vertex), []
    while stack:
        side = stack.pop()
        other = surface.twin.get(side)
        if other is None or other[0] == side[0] or opposite_angles(surface, side) <= pi + ROUNDING:
            continue  # at the boundary; a triangle glued to itself, whose base angles are acute; legal
        flip(surface, side)
        flips.append(side)
        stack += [side, following(side), other, following(other)]
    return surface, flips
