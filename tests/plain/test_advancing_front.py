"""The plain fronts: each step by exact signs, what must not be left out, the ledger's cases."""

from __future__ import annotations

from fractions import Fraction
from math import dist, inf, nan, sqrt

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from regions import random_region

from unstruct.base.errors import InputError, MeshError
from unstruct.plain import advancing_front as plain
from unstruct.plain import constrained, front_delaunay
from unstruct.plain.predicates import in_sphere, orient

SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
RING = [(0, 1), (1, 2), (2, 3), (3, 0)]
# C12.3.1-03: the triangle to the apex (5, 9) crosses nothing and swallows the hole.
SWALLOWED = [(0.0, 0.0), (10.0, 0.0), (5.0, 9.0), (4.0, 2.0), (6.0, 2.0), (5.0, 4.0)]
SWALLOWED_FACETS = [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3)]
CROSSING_ONLY = {name: plain.TESTS[name] for name in ("behind", "crosses")}


def twice_area(points, cell):
    (ax, ay), (bx, by), (cx, cy) = [[Fraction(z) for z in points[v]] for v in cell]
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


def enclosed(points, facets):
    """Twice the area that facets bound, by the rows of a first front."""
    front = plain.boundary_front(points, facets, ())
    total = Fraction(0)
    for a, b in front.edges:
        (ax, ay), (bx, by) = [[Fraction(z) for z in points[v]] for v in (a, b)]
        total += ax * by - bx * ay
    return total


def cells_of(points, facets, size, **options):
    """March to the end; check that the front stays closed and that the cells fill the region."""
    rows = [tuple(p) for p in points]
    cells = []
    for step in plain.advancing_front(points, facets, lambda x: size, **options):
        if step.reason == "new point":
            assert step.chosen == len(rows)
            rows.append(step.ideal)
        cells.append((*step.edge, step.chosen))
        assert orient([rows[v] for v in cells[-1]]) == 1
        starts, stops = sorted(a for a, _ in step.front), sorted(b for _, b in step.front)
        assert starts == stops  # the front is closed after each step
        verdicts = [c.verdict for c in step.candidates]
        assert verdicts[-1] == "" and all(verdicts[:-1])
        assert all(c.distance <= step.radius for c in step.candidates) or step.reason == "wider search"
    assert sum(twice_area(rows, cell) for cell in cells) == enclosed(points, facets)
    sides = [side for a, b, c in cells for side in ((a, b), (b, c), (c, a))]
    assert len(set(sides)) == len(sides)
    return rows, cells


@pytest.mark.parametrize("key", [plain.smallest, plain.shortest, plain.oldest])
@pytest.mark.parametrize("size", [0.5, 0.8, 3.0])
def test_a_square(key, size) -> None:
    rows, cells = cells_of(SQUARE, RING, size, key=key)
    assert len(cells) == 2 * len(rows) - 2 - 4  # Euler


def test_inner_segments_and_loose_vertices() -> None:
    points = [*SQUARE, (0.25, 0.5), (0.75, 0.5), (0.5, 0.75)]
    rows, cells = cells_of(points, RING, 0.5, inner=[(4, 5)])
    assert {v for cell in cells for v in cell} == set(range(len(rows)))
    assert any({4, 5} <= set(cell) for cell in cells)


def test_the_crossing_test_alone_swallows_a_hole() -> None:
    """C12.3.1-03, and the front that is left is no boundary of anything."""
    before = plain.boundary_front(SWALLOWED, SWALLOWED_FACETS, ())
    assert not any(fails(before, (0, 1), 2) for fails in CROSSING_ONLY.values())
    assert plain.holds(before, (0, 1), 2)
    options = {"reach": 3.0, "key": lambda front, edge, size: edge != (0, 1)}
    first = next(
        plain.advancing_front(SWALLOWED, SWALLOWED_FACETS, lambda x: 10.0, tests=CROSSING_ONLY, **options)
    )
    assert first.edge == (0, 1) and first.reason == "near vertex"
    assert plain.holds(before, (0, 1), first.chosen)  # sides of the hole are inside of the triangle
    right = next(plain.advancing_front(SWALLOWED, SWALLOWED_FACETS, lambda x: 10.0, **options))
    assert not plain.holds(before, (0, 1), right.chosen)
    cells_of(SWALLOWED, SWALLOWED_FACETS, 10.0)


def test_no_vertex_passes() -> None:
    with pytest.raises(MeshError, match="valid"):
        next(plain.advancing_front(SQUARE, RING, lambda x: 2.0, tests={"all": lambda *_: True}))


@settings(max_examples=25, deadline=None)
@given(st.sampled_from(["grid", "triangles", "star", "cracks"]), st.integers(0, 10**6))
def test_any_region(kind, seed) -> None:
    domain = random_region(seed, kind)
    if len(domain.points) > 16:
        return
    facets = [tuple(row) for row in domain.facets.tolist()]
    inner = [] if kind == "triangles" or kind == "grid" else [tuple(row) for row in domain.inner.tolist()]
    cells_of(domain.points.tolist(), facets, 1.0, inner=inner)


# --- by the empty circle --------------------------------------------------------------------------


def test_plain_emptiness_has_no_apex() -> None:
    """C12.3.4-01: with all points counted, each circle has another one inside."""
    points = [(-5.0, 0.0), (5.0, 0.0), (0.0, 1.0), (0.0, 8.0), (0.0, -1.0)]
    front = plain.Front(points, {(0, 1): None, (1, 3): None, (3, 0): None}, {2})
    assert front_delaunay.apex(front, (0, 1), visible=False, behind=[4]) is None
    assert front_delaunay.apex(front, (0, 1)) == 2
    assert in_sphere([points[v] for v in (0, 1, 2)], points[4]) == 1


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(st.integers(1, 5), st.integers(1, 5)), max_size=7, unique=True), st.booleans())
def test_the_definition(inside, wall) -> None:
    """The cells are constrained Delaunay by the definition, and fill the square."""
    points = [(0, 0), (6, 0), (6, 6), (0, 6), *inside]
    inner = [(4, 5)] if wall and len(inside) > 1 else []
    if inner and any(orient([points[4], points[5], p]) == 0 for p in points[6:]):
        inner = []
    steps = list(front_delaunay.front_delaunay(points, RING, inner=inner))
    cells = [(*step.edge, step.apex) for step in steps]
    assert sum(twice_area(points, cell) for cell in cells) == 72
    assert constrained.is_constrained_delaunay(points, cells, [*RING, *inner])


def test_a_tie_is_taken_and_told() -> None:
    steps = list(front_delaunay.front_delaunay(SQUARE, RING))
    assert [step.cocircular for step in steps] == [(2,), ()] or len(steps) == 2
    assert steps[0].cocircular


@pytest.mark.parametrize("reach", [0.0, -1.0, inf, nan])
def test_a_search_needs_a_radius(reach: float) -> None:
    with pytest.raises(InputError, match="reach must be positive and finite"):
        list(plain.advancing_front(SQUARE, RING, lambda x: 1.0, reach=reach))


@given(st.floats(0.01, 100), st.floats(0.01, 100))
def test_the_circle_contains_the_ideal_point(length: float, wanted: float) -> None:
    """From a radius of sqrt(5)/2 heights on; and no smaller number will do."""
    front = plain.Front([(0.0, 0.0), (length, 0.0)], {(0, 1): None}, set())
    for h in (wanted, 1e3 * length):
        x, side = plain.ideal_point(front, (0, 1), lambda p, h=h: h)
        assert dist(x, (length / 2, 0)) <= sqrt(5) / 2 * (sqrt(3) / 2 * side) * (1 + 1e-12)
    assert dist(x, (length / 2, 0)) > 1.118 * (sqrt(3) / 2 * side)
