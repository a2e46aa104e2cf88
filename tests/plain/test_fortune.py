"""Fortune's sweep: triangles by the definition, the beach line by the nearest site, the order by decimals."""

from decimal import Decimal, localcontext
from fractions import Fraction
from itertools import pairwise

import pytest
from fixtures import FLAT, HARD_2D
from hypothesis import given, settings
from hypothesis import strategies as st
from plane_delaunay import assert_delaunay, hull_area2, lattice_sets, ring

import unstruct
from unstruct.base.errors import DegenerateInputError, InputError
from unstruct.plain.fortune import arc_above, breakpoint, fortune, is_left_of, sign_of_roots, sweep
from unstruct.plain.predicates import in_sphere

HARD = {name: p for name, p in HARD_2D.items() if len(p) <= 40 and len(set(map(tuple, p))) == len(p)}


def decimal(x):
    x = Fraction(x)
    return Decimal(x.numerator) / Decimal(x.denominator)


@given(lattice_sets)
@settings(max_examples=150, deadline=None)
def test_delaunay_by_definition(points):
    if hull_area2(points) == 0:
        with pytest.raises(DegenerateInputError) as caught:
            fortune(points)
        assert caught.value.dimension == min(len(points) - 1, 1)
        return
    assert_delaunay(points, fortune(points))


@pytest.mark.parametrize("name", HARD)
def test_hard_inputs(name):
    points = HARD[name]
    cells = fortune(points)
    assert_delaunay(points.tolist(), cells)
    fast = unstruct.delaunay(points)
    assert len(fast.simplices) == len(cells)
    if all(
        in_sphere([points[v] for v in t], q) < 0 for t in cells for v, q in enumerate(points) if v not in t
    ):
        assert {frozenset(t) for t in fast.simplices.tolist()} == {frozenset(t) for t in cells}  # no tie


@given(lattice_sets)
@settings(max_examples=60, deadline=None)
def test_the_beach_line_is_the_nearest_site(points):
    """At heights between two events: below each place, the arc is that of a site with the lowest parabola."""
    events = list(sweep(points))
    for event, after in pairwise(events):
        y = Fraction((event.height + after.height) / 2)
        if not event.height > y > after.height:
            continue  # two events at one height
        known = [p for p in points if p[1] > y]
        for x in (Fraction(k, 3) - 1 for k in range(22)):
            place = [(Fraction(x), y), *points]  # as number 0, the site that would come next
            k = arc_above(place, [v + 1 for v in event.beach], 0)
            below = [((x - px) ** 2 + py**2 - y * y) / (2 * (py - y)) for px, py in known]
            px, py = points[event.beach[k]]
            assert ((x - px) ** 2 + py**2 - y * y) / (2 * (py - y)) == min(below)


@given(lattice_sets)
@settings(max_examples=100, deadline=None)
def test_the_order_and_the_number_of_events(points):
    events = list(sweep(points))
    sites = [e.site for e in events if e.site is not None]
    assert sorted(sites) == list(range(len(points)))
    heights = []
    with localcontext() as context:
        context.prec = 60
        for e in events:
            if e.site is not None:
                heights.append(Decimal(points[e.site][1]))
                continue
            heights.append(decimal(e.circle.center[1]) - decimal(e.circle.squared_radius).sqrt())
            for v in e.triangle:  # the center is as far from all three
                assert (
                    sum((x - c) ** 2 for x, c in zip(points[v], e.circle.center)) == e.circle.squared_radius
                )
        assert all(low <= high + Decimal("1e-40") for high, low in pairwise(heights))
    assert len(events) == len(points) + len(events[-1].triangles)
    for before, e in pairwise(events):
        assert len(e.beach) - len(before.beach) in ((-1,) if e.site is None else (1, 2))
        assert all(a != b for a, b in pairwise(e.beach))
        assert e.triangles[: len(before.triangles)] == before.triangles


@given(*[st.fractions(-20, 20, max_denominator=6)] * 3, st.booleans())
@settings(max_examples=300, deadline=None)
def test_signs_of_roots(a, b, c, tie):
    b, c = abs(b), abs(c)
    if tie:  # a + b - c = 0 with squares under the roots
        a, b, c = c - b, b * b, c * c
    with localcontext() as context:
        context.prec = 80
        value = decimal(a) + decimal(b).sqrt() - decimal(c).sqrt()
        expected = 0 if abs(value) < Decimal("1e-60") else 1 if value > 0 else -1
    assert sign_of_roots(a, b, c) == expected
    assert sign_of_roots(-a, c, b) == -expected


def test_roots_that_are_no_squares():
    assert sign_of_roots(Fraction(0), Fraction(2), Fraction(2)) == 0
    assert sign_of_roots(Fraction(1), Fraction(2), Fraction(6)) == -1  # 2.414 and 2.449
    assert sign_of_roots(Fraction(-1), Fraction(8), Fraction(3)) == 1  # 1.828 and 1.732


@given(st.tuples(*[st.integers(-9, 9)] * 4), st.integers(-99, 99))
@settings(max_examples=200, deadline=None)
def test_breakpoints_for_pictures(coordinates, x):
    """The drawn breakpoint is where the exact test changes."""
    p, q = [tuple(map(Fraction, pair)) for pair in (coordinates[:2], coordinates[2:])]
    if p == q:
        return
    line = Fraction(-10)
    drawn = breakpoint(p, q, float(line))
    if abs(drawn - x) > 1e-6:
        assert is_left_of((Fraction(x), line), p, q) == (x < drawn)


def test_a_first_row_a_ring_and_a_site_below_its_circle():
    row = list(sweep([(4, 0), (0, 0), (2, 0)]))
    assert [e.beach for e in row] == [(1,), (1, 2), (1, 2, 0)]  # side by side, no triangle
    assert [len(fortune(ring[k:] + ring[:k])) for k in range(3)] == [10, 10, 10]
    events = list(sweep([(-4, 3), (3, 4), (0, -5)]))  # the last one is the lowest point of the circle
    assert [e.site for e in events] == [1, 0, 2, None] and events[-1].triangle == (0, 2, 1)
    assert events[-1].height == events[-2].height == -5
    twice = list(sweep([(-3, 4), (3, 4), (0, 5), (0, -5), (5, 0)]))  # two circle events at one place
    assert [e.circle.center for e in twice if e.circle] == [(0, 0)] * 3


@pytest.mark.parametrize("name", [name for name, (points, _) in FLAT.items() if points.shape[1] == 2])
def test_flat_input(name):
    with pytest.raises((DegenerateInputError, InputError)):  # some hold copies
        fortune(FLAT[name][0])


@pytest.mark.parametrize("bad", [[], [(0, 0), (0, 0)], [(0, 0, 0)], [(0, float("nan"))], [(0, 1), (2,)]])
def test_bad_input(bad):
    with pytest.raises(InputError):
        fortune(bad)


def test_two_points_have_a_beach_line_of_three_arcs():
    assert [e.beach for e in sweep([(0, 1), (1, 0)])] == [(0,), (0, 1, 0)]
    assert [e.beach for e in sweep([(0, 0)])] == [(0,)]
