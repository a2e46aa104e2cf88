"""Plain intrinsic flips: angles, one flip by hand, a cone whose edge returns to its own vertex."""

from math import cos, isclose, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.plain.intrinsic_delaunay import (
    angle,
    flip,
    following,
    glue,
    intrinsic_delaunay,
    opposite_angles,
    other_diagonal,
)


def area(a, b, c):
    s = (a + b + c) / 2
    return sqrt(max(s * (s - a) * (s - b) * (s - c), 0.0))


def areas(surface):
    found = 0.0
    for side in surface.vertex:
        if side[1] == 0:
            one = following(side)
            found += area(surface.length[side], surface.length[one], surface.length[following(one)])
    return found


def angles_around(surface, vertex):
    """The whole angle of a vertex, which no flip changes."""
    total = 0.0
    for side, v in surface.vertex.items():
        if v == vertex:
            one = following(side)
            two = following(one)
            total += angle(surface.length[side], surface.length[two], surface.length[one])
    return total


def test_angles():
    assert isclose(angle(3, 4, 5), pi / 2)
    assert isclose(angle(1, 1, 1), pi / 3)
    assert angle(1, 1, 2) == pi


def test_one_flip_by_hand():
    """Two flat triangles folded along their common long edge: the new edge is as long as in the plane."""
    folded = [(0, 0, 0), (4, 0, 0), (2, 1, 0), (2, 0, -1)]
    surface, flips = intrinsic_delaunay(folded, [(0, 1, 2), (1, 0, 3)])
    assert flips == [(1, 0)] or flips == [(0, 0)]
    lengths = sorted(surface.length.values())
    assert isclose(lengths[0], 2.0) and isclose(lengths[1], 2.0)  # in space it would be sqrt 2
    side = next(s for s in surface.twin)
    assert opposite_angles(surface, side) < pi


def test_a_flip_undoes_a_flip():
    surface = glue([(0, 0, 0), (4, 0, 0), (2, 1, 0), (2, -1, 0)], [(0, 1, 2), (1, 0, 3)])
    before = {tuple(sorted((surface.vertex[s], surface.vertex[following(s)]))) for s in surface.vertex}
    side = next(s for s in surface.twin if s[0] == 0)
    assert isclose(other_diagonal(surface, side), 2.0)
    flip(surface, side)
    flip(surface, next(s for s in surface.twin))
    after = {tuple(sorted((surface.vertex[s], surface.vertex[following(s)]))) for s in surface.vertex}
    assert before == after and isclose(max(surface.length.values()), 4.0)


def test_an_edge_from_a_vertex_to_itself():
    """A needle of a pyramid: lines around its tip are shorter than edges along it."""
    base = [(cos(2 * pi * k / 3) / 10, cos(2 * pi * k / 3 - pi / 2) / 10, 0.0) for k in range(3)]
    points = [*base, (0.0, 0.0, 1.0), (0.7, 0.0, 0.3)]
    triangles = [(0, 1, 3), (1, 2, 3), (2, 0, 4), (0, 3, 4), (3, 2, 4), (0, 2, 1)]
    surface, _ = intrinsic_delaunay(points, triangles)
    assert all(opposite_angles(surface, s) <= pi + 1e-9 for s, t in surface.twin.items() if s[0] != t[0])


@given(st.integers(0, 10_000))
@settings(max_examples=60, deadline=None)
def test_random_tetrahedra(seed):
    rng = np.random.default_rng(seed)
    points = (rng.random((4, 3)) * 10.0 ** rng.integers(-2, 1, 3)).tolist()
    triangles = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
    start = glue(points, triangles)
    surface, _ = intrinsic_delaunay(points, triangles)
    assert areas(surface) == pytest.approx(areas(start), rel=1e-6)
    for v in range(4):
        assert angles_around(surface, v) == pytest.approx(angles_around(start, v), abs=1e-5)
    for side, other in surface.twin.items():
        assert surface.twin[other] == side and surface.length[other] == surface.length[side]
        assert surface.vertex[other] == surface.vertex[following(side)]
