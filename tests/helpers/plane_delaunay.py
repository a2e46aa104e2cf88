"""The judge of plain Delaunay triangulations in the plane: the definition, in rational numbers."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

from hypothesis import strategies as st

__all__ = ["assert_delaunay", "hull_area2", "lattice_sets", "ring", "turn"]

# Integer points of a small square, each once, in any order: ties, lines, rows of equal height abound.
lattice_sets = st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), min_size=1, max_size=14, unique=True)

# The twelve lattice points at distance 5 from the center, counterclockwise: all on one circle.
ring = [
    *[(5, 0), (4, 3), (3, 4), (0, 5), (-3, 4), (-4, 3)],
    *[(-5, 0), (-4, -3), (-3, -4), (0, -5), (3, -4), (4, -3)],
]


def turn(a, b, c):
    """Twice the signed area of a triangle."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def hull_area2(points):
    """Twice the area of the convex hull (A. M. Andrew's two chains)."""
    order = sorted(points)
    chain = []
    for row in (order, order[::-1]):
        half = []
        for p in row:
            while len(half) > 1 and turn(half[-2], half[-1], p) <= 0:
                half.pop()
            half.append(p)
        chain += half[:-1]
    return sum(turn(chain[0], p, q) for p, q in pairwise(chain))


def assert_delaunay(points, cells):
    """Counterclockwise, each side once, all points, the whole hull, and no circle with a point inside.

    A side that no other triangle has in reverse has all points on its left, so it is on the hull. Then inside
    the hull the number of triangles over a place is the same everywhere, and by the areas it is one.
    """
    points = [tuple(Fraction(x) for x in p) for p in points]
    sides = [(t[k - 1], t[k]) for t in cells for k in range(3)]
    assert len(sides) == len(set(sides)), "a side comes twice"
    for u, v in set(sides) - {(v, u) for u, v in sides}:
        assert all(turn(points[u], points[v], p) >= 0 for p in points), "a side within has one triangle"
    assert {v for t in cells for v in t} == set(range(len(points))), "a point is missing"
    assert sum(turn(*(points[v] for v in t)) for t in cells) == hull_area2(points), "not the whole hull"
    for t in cells:
        a, b, c = (points[v] for v in t)
        assert turn(a, b, c) > 0, f"{t} is flat or clockwise"
        for d in points:
            rows = [(p[0] - d[0], p[1] - d[1], (p[0] - d[0]) ** 2 + (p[1] - d[1]) ** 2) for p in (a, b, c)]
            (ax, ay, al), (bx, by, bl), (cx, cy, cl) = rows
            inside = al * (bx * cy - by * cx) - bl * (ax * cy - ay * cx) + cl * (ax * by - ay * bx)
            assert inside <= 0, f"{d} is in the circle of {t}"
