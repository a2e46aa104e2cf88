"""Divide and conquer: triangles by the definition, the state of each merge, the rings of quad-edges."""

from fractions import Fraction
from itertools import pairwise

import pytest
from fixtures import HARD_2D
from hypothesis import given, settings
from hypothesis import strategies as st
from plane_delaunay import assert_delaunay, hull_area2, lattice_sets, ring, turn

import unstruct
from unstruct.base.errors import DegenerateInputError, InputError
from unstruct.plain.divide_and_conquer import QuadEdges, divide, divide_and_conquer, turned

HARD = {name: p for name, p in HARD_2D.items() if len(p) <= 40 and len(set(map(tuple, p))) == len(p)}
large = st.lists(st.tuples(*[st.integers(-9, 9)] * 2), min_size=15, max_size=30, unique=True)


@given(lattice_sets | large)
@settings(max_examples=150, deadline=None)
def test_delaunay_by_definition(points):
    if hull_area2(points) == 0:
        with pytest.raises(DegenerateInputError) as caught:
            divide_and_conquer(points)
        assert caught.value.dimension == min(len(points) - 1, 1)
        return
    assert_delaunay(points, divide_and_conquer(points))


@pytest.mark.parametrize("name", HARD)
def test_hard_inputs(name):
    points = HARD[name]
    cells = divide_and_conquer(points)
    assert_delaunay(points.tolist(), cells)
    assert len(unstruct.delaunay(points).simplices) == len(cells)


def proper_crossing(p, q, r, s):
    return turn(p, q, r) * turn(p, q, s) < 0 and turn(r, s, p) * turn(r, s, q) < 0


@given(lattice_sets)
@settings(max_examples=80, deadline=None)
def test_every_state(points):
    """Bases rise without crossing; a part that is done has all edges of a triangulation of its sites."""
    last = None
    for step in divide(points):
        assert list(step.sites) == sorted(step.sites, key=points.__getitem__)
        if step.kind in ("few", "merged"):
            inside = [points[v] for v in step.sites]
            own = {e for e in step.edges if set(e) <= set(step.sites)}
            n, flat = len(inside), hull_area2(inside) == 0
            if flat:
                assert own == {tuple(sorted(pair)) for pair in pairwise(step.sites)}
            else:  # Euler: n - edges + triangles = 1, with as many triangles as the hull leaves
                assert len(own) == n - 1 + len({t for t in faces(points, own)})
        if step.kind in ("tangent", "rise"):
            a, b = (points[v] for v in step.base)
            half = len(step.sites) // 2
            assert step.base[0] in step.sites[:half] and step.base[1] in step.sites[half:]
            if step.kind == "tangent":
                assert all(turn(a, b, points[v]) >= 0 for v in step.sites)
            else:
                assert len(set(step.base) & set(last.base)) == 1
                new = next(v for v in step.base if v not in last.base)
                assert new in step.candidates
                assert turn(*(points[v] for v in last.base), points[new]) > 0
                assert not any(proper_crossing(a, b, points[u], points[v]) for u, v in step.edges)
            assert not set(step.deleted) & step.edges
        last = step


def faces(points, edges):
    """The triangles of a drawing by straight edges: three edges with no vertex inside or on them."""
    near = {v: {u for e in edges if v in e for u in e} - {v} for e in edges for v in e}
    for u, v in edges:
        for w in near[u] & near[v]:
            if u < v < w and turn(points[u], points[v], points[w]) != 0:
                a, b, c = (u, v, w) if turn(points[u], points[v], points[w]) > 0 else (u, w, v)
                others = [p for x, p in enumerate(points) if x not in (u, v, w)]
                sides = [(a, b), (b, c), (c, a)]
                if not any(all(turn(points[x], points[y], p) >= 0 for x, y in sides) for p in others):
                    yield a, b, c


def test_rings_about_vertices():
    """A star of three edges: counterclockwise about the origin, one face; parted again by deletion."""
    quad = QuadEdges([(Fraction(x), Fraction(y)) for x, y in [(0, 0), (1, 0), (0, 1), (-1, -1)]])
    a, b, c = (quad.make(0, v) for v in (1, 2, 3))
    quad.splice(a, b)
    quad.splice(b, c)
    assert [quad.next_at[e] for e in (a, b, c)] == [b, c, a]
    assert [quad.before_at(e) for e in (a, b, c)] == [c, a, b]
    assert quad.along_left(turned(a, 2)) == c
    assert quad.connect(a, turned(b, 2)) is not None
    assert quad.triangles() == {(0, 1, 2)} and len(quad.edges()) == 4
    quad.splice(a, a)  # twice the same: nothing
    assert quad.delete(b) == (0, 2) and quad.next_at[a] == c and quad.next_at[c] == a
    assert quad.edges() == {(0, 1), (0, 3), (1, 2)}


def test_a_ring_and_a_lattice():
    for k in range(4):
        assert len(divide_and_conquer(ring[k:] + ring[:k])) == 10
    assert len(divide_and_conquer([(x, y) for x in range(6) for y in range(5)])) == 40


def test_deletions_happen():
    """Two columns whose gap is wider than the columns' edges lose those within the bubble."""
    points = [(0, 0), (0, 9), (1, 4), (2, 5), (8, 4), (7, 5), (9, 0), (9, 9)]
    assert any(step.deleted for step in divide(points))


def test_few_sites():
    assert list(divide([(3, 4)])) == []
    (step,) = divide([(1, 0), (0, 0)])
    assert step.edges == {(0, 1)} and step.sites == (1, 0)
    assert len(list(divide([(0, 0), (1, 1), (2, 2), (3, 3)]))[-1].edges) == 3


@pytest.mark.parametrize("bad", [[], [(0, 0), (0, 0)], [(0, 0, 0)], [(0, float("inf"))], [(0, 1), (2,)]])
def test_bad_input(bad):
    with pytest.raises(InputError):
        divide_and_conquer(bad)
    with pytest.raises(InputError):
        next(divide(bad))
