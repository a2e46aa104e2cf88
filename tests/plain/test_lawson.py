"""The six-angle rule is the in-circle sign; plain swapping and the enumeration stand on their own."""

from itertools import combinations, product

import pytest
import sympy
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from unstruct.base.errors import InputError
from unstruct.plain.lawson import angle_cotangents, lawson, least_angle_choice, six_angles, triangle
from unstruct.plain.predicates import in_sphere, orient
from unstruct.plain.triangulations import all_triangulations, is_delaunay


def turn(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def strictly_convex(a, b, c, d):
    """The strictly convex quadrilateral with these corners, counterclockwise from a; None where none is."""
    for ring in [(a, b, c, d), (a, b, d, c), (a, c, b, d)]:
        turns = [turn(ring[k - 2], ring[k - 1], ring[k]) for k in range(4)]
        if min(turns) > 0:
            return ring
        if max(turns) < 0:
            return ring[0], ring[3], ring[2], ring[1]
    return None


def strictly_convex_quadrilaterals(side):
    """All of them on a grid, each once up to translation."""
    for four in combinations(list(product(range(side), repeat=2)), 4):
        if min(p[0] for p in four) == min(p[1] for p in four) == 0:
            ring = strictly_convex(*four)
            if ring:
                yield ring


def test_least_angle_is_the_in_circle_sign_on_the_whole_grid():
    counts = {-1: 0, 0: 0, 1: 0}
    weighted = ties = 0
    for a, b, c, d in strictly_convex_quadrilaterals(6):
        sign = in_sphere([a, b, c], d)
        assert least_angle_choice(a, b, c, d) == sign
        counts[sign] += 1
        width, height = (max(p[k] for p in (a, b, c, d)) for k in (0, 1))
        weighted += (6 - width) * (6 - height)
        ties += (6 - width) * (6 - height) * (sign == 0)
    assert weighted == 35_727  # translates included
    assert counts == {-1: 3485, 0: 447, 1: 6537}
    assert ties == 2_257


@given(st.lists(st.tuples(st.integers(-50, 50), st.integers(-50, 50)), min_size=4, max_size=4, unique=True))
@settings(max_examples=300, deadline=None)
def test_least_angle_is_the_in_circle_sign(corners):
    ring = strictly_convex(*corners)
    assume(ring is not None)
    a, b, c, d = ring
    assert least_angle_choice(a, b, c, d) == in_sphere([a, b, c], d)
    assert least_angle_choice(b, c, d, a) == -least_angle_choice(a, b, c, d)


def test_angles_are_angles():
    assert angle_cotangents((0, 0), (1, 0), (0, 1)) == [0, 1, 1]
    assert six_angles((0, 0), (1, 0), (1, 1), (0, 1)) == [1, 0, 1, 1, 1, 0]
    corners = (0, 0), (4, 1), (1, 3)
    angles = sympy.Triangle(*corners).angles
    for p, cot in zip(corners, angle_cotangents(*corners), strict=True):
        assert sympy.simplify(sympy.cot(angles[sympy.Point(*p)]) - cot) == 0


def test_one_diagonal_only():
    with pytest.raises(InputError, match="strictly convex"):
        least_angle_choice((0, 0), (2, 0), (0.5, 0.5), (0, 2))
    with pytest.raises(InputError, match="strictly convex"):
        least_angle_choice((0, 0), (1, 0), (2, 0), (0, 2))


def test_constrained_edges_stay_in_the_plain_version():
    points = [(-5, 0), (5, 0), (0, 1), (0, -1)]
    start = [(0, 1, 2), (0, 3, 1)]
    assert lawson(points, start, [(1, 0)]) == ({triangle(*t) for t in start}, [])
    cells, flips = lawson(points, start)
    assert cells == {(0, 3, 2), (1, 2, 3)} and flips == [((0, 1), (2, 3))]


@pytest.mark.parametrize(
    ("points", "count"),
    [
        ([(i, i * i) for i in range(8)], 132),  # Catalan(6)
        (list(product(range(3), range(3))), 64),  # lattice triangulations: Kaibel and Ziegler (2003)
        (list(product(range(4), range(3))), 852),
        ([(0, 0), (4, 0), (0, 4), (1, 1)], 1),
        ([(0, 0), (1, 0), (2, 0)], 0),
    ],
)
def test_known_numbers_of_triangulations(points, count):
    found = list(all_triangulations(points))
    assert len(found) == len(set(found)) == count


@given(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 3)), min_size=3, max_size=7, unique=True))
@settings(max_examples=40, deadline=None)
def test_triangulations_are_valid_and_connected_by_flips(points):
    assume(any(orient([points[0], p, q]) for p, q in combinations(points[1:], 2)))
    found = set(all_triangulations(points))
    areas = {sum(turn(*[points[v] for v in t]) for t in cells) for cells in found}
    assert len(areas) == 1 and all(
        {v for t in cells for v in t} == set(range(len(points))) for cells in found
    )
    start = next(iter(found))
    reached, todo = {start}, [start]
    while todo:  # all flips of strictly convex pairs: the flip graph is connected (Lawson 1972)
        cells = todo.pop()
        apex = {(t[k - 2], t[k - 1]): t[k] for t in cells for k in range(3)}
        for (u, v), p in apex.items():
            q = apex.get((v, u))
            if q is not None and orient([points[i] for i in (p, u, q)]) > 0 < orient(
                [points[i] for i in (q, v, p)]
            ):
                after = frozenset(
                    cells - {triangle(u, v, p), triangle(v, u, q)} | {triangle(p, u, q), triangle(q, v, p)}
                )
                if after not in reached:
                    reached.add(after)
                    todo.append(after)
    assert reached == found
    assert any(is_delaunay(points, cells) for cells in found)
