"""The places of section 2.3, and the limit on growth, by their definitions."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise, takewhile
from math import hypot, isclose

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import unstruct
from unstruct import InputError
from unstruct.plain import circumcenters, placement
from unstruct.plain.bowyer_watson import bowyer_watson
from unstruct.sizing import control, limit_nodes

COORDINATES = st.tuples(st.integers(-20, 20), st.integers(-20, 20))


@settings(max_examples=60, deadline=None)
@given(COORDINATES, COORDINATES, COORDINATES)
def test_places(a: tuple, b: tuple, c: tuple) -> None:
    if (b[0] - a[0]) * (c[1] - a[1]) == (b[1] - a[1]) * (c[0] - a[0]):
        with pytest.raises(InputError, match="flat"):
            placement.voronoi_vertex(a, b, c)
        return
    q = placement.voronoi_vertex(a, b, c)
    assert len({placement.square(tuple(map(Fraction, p)), q) for p in (a, b, c)}) == 1
    assert placement.centroid(a, b, c) == (Fraction(a[0] + b[0] + c[0], 3), Fraction(a[1] + b[1] + c[1], 3))
    m = placement.edge_midpoint(a, b, c)
    edges = [(p[0] - r[0]) ** 2 + (p[1] - r[1]) ** 2 for p, r in pairwise((a, b, c, a))]
    ends = [((p[0] + r[0]), (p[1] + r[1])) for p, r in pairwise((a, b, c, a))]
    assert (2 * m[0], 2 * m[1]) in [e for e, length in zip(ends, edges) if length == max(edges)]


def test_a_point_of_a_voronoi_segment() -> None:
    x = placement.voronoi_segment((-1, 0), (1, 0), (0.5, 9), 2 / 3**0.5)
    assert isclose(x[0], 0, abs_tol=1e-15) and isclose(x[1], 3**0.5)  # the equilateral triangle on AB
    with pytest.raises(InputError, match="not beyond"):
        placement.voronoi_segment((-4, 0), (4, 0), (0, 1), 5)


@settings(max_examples=20, deadline=None)
@given(st.lists(COORDINATES, min_size=5, max_size=9, unique=True))
def test_new_edges_are_no_shorter_than_the_circumradius(points: list) -> None:
    mesh = [c for c in _cells(points) if -1 not in c]
    if not mesh:
        return
    for cell in mesh:
        corners = [points[v] for v in cell]
        q = placement.voronoi_vertex(*corners)
        done, edges = placement.new_edges(points, _cells(points), q)
        radius = placement.square(q, tuple(map(Fraction, corners[0])))
        assert min(edges.values()) == radius  # Delaunay: the circle is empty, and its corners are joined to q
        assert all(edges[v] == radius for v in cell) and cell in done.cavity


def _cells(points: list) -> frozenset:
    try:
        return list(bowyer_watson(points))[-1].cells
    except unstruct.DegenerateInputError:
        return frozenset()


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_alpha_and_limit_agree_with_the_fast_ones(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 1000, (12, 2))
    mesh = unstruct.delaunay(points)
    wanted = control(mesh, lambda x: 1 + np.abs(x[:, 0])) ** 2
    found = [placement.alpha2(*mesh.points[t], lambda q: 1 + abs(q[0])) * 3 for t in mesh.simplices]
    assert np.allclose(np.array(found, dtype=float), wanted, rtol=1e-9)
    values = 10.0 ** rng.uniform(-1, 3, 12)
    lengths = {(i, j): hypot(*(mesh.points[i] - mesh.points[j])) for i, j in mesh.edges.tolist()}
    plain = placement.limit(dict(enumerate(values)), lengths, 0.3)
    used = np.unique(mesh.simplices)
    assert np.allclose(limit_nodes(mesh, values, 0.3)[used], [plain[v] for v in used], rtol=1e-12)


RING = [(x, y) for x in (0, 2, 4, 6, 8) for y in (0, 2, 4, 6, 8) if x in (0, 8) or y in (0, 8)]


def test_the_loop_with_circumcenters_is_that_of_section_2_6a() -> None:
    """Where all circumcenters are inside: the same points in the same order."""

    def measure(have: list, cell: tuple) -> Fraction:
        return placement.alpha2(*(have[v] for v in cell), lambda q: 1.1)

    steps = circumcenters.circumcenter_insertion(RING, 60, measure)
    wanted = [s.point for s in takewhile(lambda s: measure(s.points, s.triangle) > 1, steps)]
    points, cells = placement.insert_while_large(RING, lambda q: 1.1, placement.voronoi_vertex)
    assert points[len(RING) :] == wanted and len(wanted) > 20
    assert all(measure(points, t) <= 1 for t in cells)


@pytest.mark.parametrize("place", [placement.edge_midpoint, placement.centroid])
def test_the_loop_ends(place: object) -> None:
    """With all triangles small enough, or with as many points as are allowed."""
    points, cells = placement.insert_while_large(RING, lambda q: 1.1, place, 60)  # type: ignore[arg-type]
    small = all(placement.alpha2(*(points[v] for v in t), lambda q: 1.1) <= 1 for t in cells)
    assert small or len(points) == 60
    assert len(placement.insert_while_large(RING, lambda q: 9, place)[0]) == len(RING)  # type: ignore[arg-type]
