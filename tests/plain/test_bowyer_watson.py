"""The plain Bowyer-Watson algorithm against brute force: every simplex with an empty open sphere."""

import inspect
from collections import defaultdict
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from fixtures import FLAT, HARD_2D, HARD_3D, lattice3, moment_curve, sphere_integer
from hypothesis import given, settings
from hypothesis import strategies as st

import unstruct.plain.bowyer_watson as plain
from unstruct.base.errors import DegenerateInputError, InputError, UnstructError
from unstruct.plain.bowyer_watson import GHOST, boundary, bowyer_watson, insert, triangulate, with_ghosts
from unstruct.plain.predicates import in_sphere, orient

SMALL = {f"{name}-2d": p for name, p in HARD_2D.items() if len(p) <= 40} | {
    f"{name}-3d": p for name, p in HARD_3D.items() if len(p) <= 16
}


def grid_points(d, most, reach):
    """Sets of integer points: ties, collinear triples and copies abound."""
    return st.lists(st.tuples(*[st.integers(0, reach)] * d), min_size=1, max_size=most)


def empty_simplices(points):
    """All positively oriented simplices of the points whose open circumsphere holds no point."""
    distinct = sorted(set(map(tuple, points)))
    found = set()
    for simplex in combinations(distinct, len(distinct[0]) + 1):
        sign = orient(simplex)
        if sign and all(sign * in_sphere(simplex, q) <= 0 for q in distinct if q not in simplex):
            found.add(frozenset(simplex))
    return found


def rank(points):
    return np.linalg.matrix_rank(np.array(points, dtype=float) - np.array(points[0], dtype=float))


def verify(points, cells):
    """The cells are a triangulation of the hull, by exact signs and without any Delaunay test."""
    points = [tuple(p) for p in points]
    sides = defaultdict(list)
    for cell in cells:
        assert orient([points[v] for v in cell]) == 1, f"cell {cell} is flat or inverted"
        for k in range(len(cell)):
            sides[frozenset(cell[:k] + cell[k + 1 :])].append(cell[k])
    for facet, apexes in sides.items():
        base = [points[v] for v in sorted(facet)]
        signs = {orient([*base, points[v]]) for v in apexes}
        if len(apexes) == 1:  # on the boundary, all points lie on one side
            assert signs == {s for s in (orient([*base, p]) for p in points) if s}
        else:
            assert len(apexes) == 2 and signs == {-1, 1}, f"facet {set(facet)} overlaps"
    used = {points[v] for cell in cells for v in cell}
    assert used == set(points), "a point is missing"
    first = [points[v] for v in next(iter(cells))]
    center = [sum(map(Fraction, x)) / len(first) for x in zip(*first)]
    holders = [c for c in cells if all(orient(s) > 0 for s in replaced([points[v] for v in c], center))]
    assert len(holders) == 1, "the cells cover the hull more than once"


def replaced(simplex, q):
    return [[*simplex[:k], q, *simplex[k + 1 :]] for k in range(len(simplex))]


def delaunay_against_brute_force(points):
    if rank(points) < len(points[0]):
        with pytest.raises(DegenerateInputError) as caught:
            triangulate(points)
        assert caught.value.dimension == rank(points)
        return
    cells = triangulate(points)
    verify(points, cells)
    made = {frozenset(tuple(points[v]) for v in cell) for cell in cells}
    empty = empty_simplices(points)
    assert made <= empty
    spheres = {len({q for q in map(tuple, points) if in_sphere(sorted(s), q) == 0}) for s in made}
    if spheres == {len(points[0]) + 1}:  # no tie: the triangulation is unique
        assert made == empty


@given(grid_points(1, 8, 9))
@settings(max_examples=60, deadline=None)
def test_brute_force_on_the_line(points):
    delaunay_against_brute_force(points)


@given(grid_points(2, 9, 4))
@settings(max_examples=120, deadline=None)
def test_brute_force_in_the_plane(points):
    delaunay_against_brute_force(points)


@given(grid_points(3, 8, 3))
@settings(max_examples=60, deadline=None)
def test_brute_force_in_space(points):
    delaunay_against_brute_force(points)


def test_four_dimensions():
    cells = triangulate(moment_curve(7, 4))
    verify(moment_curve(7, 4), cells)
    assert {frozenset(c) for c in cells} == {
        frozenset(int(x) for x in np.array(sorted(s))[:, 0])
        for s in empty_simplices(moment_curve(7, 4).tolist())
    }


@pytest.mark.parametrize("name", SMALL)
def test_hard_inputs(name):
    points = SMALL[name].tolist()
    cells = triangulate(points)
    verify(points, cells)
    for cell in cells:
        assert all(in_sphere([points[v] for v in cell], q) <= 0 for q in points)


@pytest.mark.parametrize("name", FLAT)
def test_flat_input_names_its_dimension(name):
    points, dimension = FLAT[name]
    with pytest.raises(DegenerateInputError, match=f"dimension {dimension},") as caught:
        triangulate(points)
    assert caught.value.dimension == dimension


@pytest.mark.parametrize("bad", [[], [[]], [[1.0, 2.0], [1.0]], [[np.nan, 0.0]], [[np.inf, 0.0]], [["a", 0]]])
def test_bad_input_raises_the_typed_error(bad):
    with pytest.raises(InputError):
        triangulate(bad)


@pytest.mark.parametrize("points", [HARD_2D["lattice"], lattice3(2, 2, 3), sphere_integer()])
def test_every_stage_is_what_it_says(points):
    """Located cell in the cavity, ghosts all round, star and cavity with one boundary, one cell per facet."""
    exact = [tuple(p) for p in points]
    d = points.shape[1]
    last = None
    for step in bowyer_watson(points):
        assert boundary(step.cells) == frozenset()  # with the ghosts a closed surface
        assert all(orient([exact[v] for v in c]) > 0 for c in step.cells if GHOST not in c)
        if last is not None:
            assert step.before == last.cells
            assert step.located in step.cavity
            assert not step.star & last.cells
            assert step.boundary == boundary(step.cavity) == boundary(step.star)
            assert {frozenset(c) - {step.vertex} for c in step.star} == step.boundary
            assert len(step.star) == len(step.boundary)
            if d == 2:  # with the ghosts every cavity is a disk without vertices inside
                assert len(step.cavity) == len(step.boundary) - 2
        last = step


def test_a_copy_changes_nothing():
    steps = list(bowyer_watson([(0, 0), (1, 0), (0, 1), (1, 0), (0.0, -0.0)]))
    assert [len(s.star) for s in steps] == [4, 0, 0]
    assert steps[1].cells == steps[0].cells and not steps[1].cavity
    assert {1, 3} & set(steps[1].located) == {1}


def test_points_on_the_hull_make_no_flat_cell():
    """The middle of a hull edge removes one triangle and its ghost; beyond its ends, ghosts only."""
    points = [(0, 0), (4, 0), (1, 3), (2, 0), (6, 0), (-1, 0)]
    steps = list(bowyer_watson(points))
    assert steps[1].cavity == {(0, 1, 2), *(c for c in steps[0].cells if set(c) == {0, 1, GHOST})}
    assert all(GHOST in c for c in steps[2].cavity | steps[3].cavity)
    verify(points, {c for c in steps[-1].cells if GHOST not in c})


def test_cells_without_ghosts_are_refused():
    points = [(0, 0), (1, 0), (0, 1), (3, 0)]
    with pytest.raises(UnstructError, match="ghosts"):
        insert(points, {(0, 1, 2)}, 3)
    assert insert(points, with_ghosts({(0, 1, 2)}), 3).cavity


def test_input_of_any_numeric_type():
    square = [(0, 0), (1, 0), (0, 1), (1, 1)]
    expected = triangulate(square)
    for kind in (
        np.array(square, dtype=np.int64),
        np.array(square, dtype=np.float32),
        np.array(square) * Fraction(1, 3),
    ):
        assert triangulate(kind) == expected


def test_functions_stay_readable():
    """The chapter lists them: at most 30 lines each, without their docstring."""
    for name, function in inspect.getmembers(plain, inspect.isfunction):
        if function.__module__ == plain.__name__:
            body = inspect.getsource(function).replace(function.__doc__ or "", "")
            assert body.count("\n") <= 30, name
