"""Insertion in space from an artificial start, against ghosts and the fast version."""

from collections import Counter
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import unstruct
from unstruct.base.errors import InputError
from unstruct.plain import bowyer_watson_space as space
from unstruct.plain.bowyer_watson import bowyer_watson
from unstruct.plain.predicates import determinant, in_sphere, orient

lattices = st.lists(st.tuples(*[st.integers(0, 3)] * 3), min_size=4, max_size=12, unique=True)


def six_volume(points, cells):
    """Six times the sum of volumes, exactly; each cell must be positive."""
    total = Fraction(0)
    for cell in cells:
        p = [[Fraction(x) for x in points[v]] for v in cell]
        assert orient(p) > 0
        scale = Fraction(2520) ** 3  # all denominators of these tests divide it
        rows = [[int((x - y) * scale) for x, y in zip(q, p[0])] for q in p[1:]]
        total += Fraction(determinant(rows)) / scale**3
    return total


def is_delaunay(points, cells):
    return all(in_sphere([points[v] for v in c], q) <= 0 for c in cells for q in points)


@pytest.mark.parametrize("start", ["cube", "tetrahedron"])
@given(points=lattices)
@settings(max_examples=12, deadline=None)
def test_each_step_fills_the_start_with_empty_spheres(start, points):
    rows, cells = space.around(points, start, 4)
    whole = six_volume(rows, cells)
    for step in space.by_insertion(rows, cells, range(len(points))):
        assert six_volume(rows, step.cells) == whole
        cells = step.cells
    used = rows[len(points) :] + rows[: len(points)]
    assert is_delaunay(used, [tuple((v - len(points)) % len(rows) for v in c) for c in cells])


@given(points=lattices)
@settings(max_examples=12, deadline=None)
def test_far_start_has_the_cells_of_the_fast_version(points):
    """From a start that is far enough away for these lattices, only ties are cut differently."""
    if np.linalg.matrix_rank(np.array(points) - points[0]) < 3:
        return
    cells = space.triangulate_space(points, size=10**6)
    fast = unstruct.delaunay(np.array(points, float))
    assert is_delaunay(points, cells)
    assert six_volume(points, cells) == six_volume(points, fast.simplices.tolist())
    mesh = unstruct.Mesh(np.array(points, float), sorted(cells))
    assert unstruct.check(mesh, delaunay=True)


@pytest.mark.parametrize("seed", range(4))
def test_points_in_general_position_have_the_same_cells(seed):
    points = np.random.default_rng(seed).integers(0, 1000, (14, 3)).tolist()
    for start in ("cube", "tetrahedron"):
        cells = {tuple(sorted(c)) for c in space.triangulate_space(points, start, 10**7)}
        fast = {tuple(sorted(c)) for c in unstruct.delaunay(np.array(points, float)).simplices.tolist()}
        *_, last = bowyer_watson(points)
        assert cells == fast == {tuple(sorted(c)) for c in last.cells if min(c) >= 0}


def test_five_cells_of_the_cube_share_a_sphere():
    rows, cells = space.around([(0, 0, 0), (1, 1, 1)], "cube", 2)
    assert len(cells) == 5 and is_delaunay(rows[2:], [tuple(v - 2 for v in c) for c in cells])
    assert sorted(six_volume(rows, [c]) for c in cells) == [8] * 4 + [16]
    step = next(space.by_insertion(rows, cells, [0]))
    assert step.cavity == cells and len(step.star) == 12


def test_a_finite_start_damages_the_hull():
    """The sphere of four nearly coplanar points contains a corner of the start: no cell is left."""
    points = [(12, 0, 0), (-12, 10, 0), (-12, -10, 0), (0, 0, Fraction(1, 2))]
    assert space.triangulate_space(points, size=10) == set()
    assert len(space.triangulate_space(points, size=10**4)) == 1


def test_faces_copies_and_errors():
    assert Counter(map(len, space.faces_of([(0, 1, 2, 3), (1, 2, 3, 4)]))) == {3: 6}
    copies = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)]
    assert space.triangulate_space(copies, size=100) == space.triangulate_space(copies[:4], size=100)
    with pytest.raises(InputError, match="three numbers"):
        space.triangulate_space([(0, 0)])
    with pytest.raises(InputError, match="at least 2"):
        space.triangulate_space(copies, size=1)
    with pytest.raises(InputError, match="start must be"):
        space.triangulate_space(copies, start="ball")
    with pytest.raises(InputError, match="lie in a plane"):
        space.joined([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], (0, 1, 2), 3)
