"""Greedy insertion against a brute-force evaluation of the surface in rationals."""

from fractions import Fraction

import matplotlib.cbook
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import unstruct
from unstruct import InputError, UnstructError
from unstruct.assess.check import check
from unstruct.connect.terrain import greedy_terrain, grid_surface
from unstruct.plain.predicates import orient

FLAT = np.zeros((4, 5))
heights = st.tuples(st.integers(2, 7), st.integers(2, 7)).flatmap(
    lambda shape: arrays(np.int64, shape, elements=st.integers(-9, 9))
)


def surface_by_definition(terrain, shape):
    """Barycentric interpolation in rationals, over every triangle that holds the grid point."""
    found = np.empty(shape, dtype=object)
    places = [tuple(map(int, p)) for p in terrain.places[:, ::-1]]  # (column, row)
    for t in terrain.mesh.simplices.tolist():
        a, b, c = (places[v] for v in t)
        for i, j in np.ndindex(*shape):
            q = (j, i)
            signs = [orient([b, c, q]), orient([c, a, q]), orient([a, b, q])]
            if min(signs) >= 0:
                area = cross(a, b, c)
                weights = [cross(b, c, q), cross(c, a, q), cross(a, b, q)]
                value = sum(Fraction(w, area) * Fraction(terrain.heights[v]) for w, v in zip(weights, t))
                assert found[i, j] in (None, value), "neighbors disagree on their edge"
                found[i, j] = value
    return found


def cross(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


@given(heights, st.integers(4, 30))
@settings(max_examples=60, deadline=None)
def test_surface_and_errors_are_those_of_the_definition(grid, count):
    terrain = greedy_terrain(grid, count=count)
    expected = surface_by_definition(terrain, grid.shape)
    assert all(value is not None for value in expected.flat), "the triangles cover the grid"
    assert np.allclose(terrain.surface, expected.astype(float), rtol=0, atol=1e-12)
    worst = max(abs(value - int(h)) for value, h in zip(expected.flat, grid.flat))
    assert np.isclose(terrain.errors[-1], float(worst), rtol=0, atol=1e-12)
    assert len(terrain.errors) == len(terrain.heights) - 3
    assert len(terrain.heights) == min(count, grid.size) or terrain.errors[-1] < 1e-12
    assert np.array_equal(terrain.surface[tuple(terrain.places.T)], terrain.heights)


@given(heights)
@settings(max_examples=40, deadline=None)
def test_without_a_count_the_surface_is_exact(grid):
    terrain = greedy_terrain(grid)
    assert terrain.errors[-1] == 0 or len(terrain.heights) == grid.size
    assert np.allclose(terrain.surface, grid, rtol=0, atol=1e-12)
    assert check(terrain.mesh, delaunay=True)


def test_each_step_takes_the_worst_point():
    """A prefix of the points is the history: at every stage the next point is the worst of its surface."""
    grid = np.random.default_rng(5).integers(0, 1000, (12, 15)).astype(float)
    full = greedy_terrain(grid, count=60)
    for count in (4, 5, 17, 40, 59):
        part = greedy_terrain(grid, count=count)
        assert np.array_equal(part.places, full.places[:count])
        error = np.abs(part.surface - grid)
        i, j = full.places[count]
        assert np.isclose(error[i, j], error.max()) and np.isclose(error.max(), full.errors[count - 4])


def test_planes_need_four_points():
    i, j = np.mgrid[0:20, 0:31]
    for plane in (0 * i + 5.0, 2.0 * i - 3.0 * j + 0.5):
        terrain = greedy_terrain(plane)
        assert len(terrain.heights) == 4 and terrain.errors.tolist() == [0.0]


def test_tolerance_is_reached_and_kept():
    i, j = np.mgrid[0:40, 0:50]
    hill = 100 * np.exp(-((i - 15) ** 2 + (j - 30) ** 2) / 200)
    terrain = greedy_terrain(hill, tolerance=2.0)
    assert terrain.errors[-1] <= 2.0 < terrain.errors[-2]
    assert np.abs(terrain.surface - hill).max() <= 2.0
    assert 4 < len(terrain.heights) < 200
    regular = [np.abs(regular_grid(hill, s) - hill).max() for s in (3, 6)]
    assert regular[1] > 2.0


def regular_grid(grid, step):
    """The surface over every ``step``-th row and column (the last included)."""
    rows = np.unique(np.append(np.arange(0, grid.shape[0], step), grid.shape[0] - 1))
    columns = np.unique(np.append(np.arange(0, grid.shape[1], step), grid.shape[1] - 1))
    places = np.stack(np.meshgrid(rows, columns, indexing="ij"), axis=-1).reshape(-1, 2)
    mesh = unstruct.delaunay(places[:, ::-1].astype(float))
    return grid_surface(mesh.simplices, places, grid[tuple(places.T)], grid.shape)


def test_real_elevation_model():
    """138,632 heights: a thousand points, beside a regular grid of as many."""
    data = matplotlib.cbook.get_sample_data("jacksboro_fault_dem.npz")["elevation"].astype(float)
    terrain = greedy_terrain(data, count=1000, spacing=(75.0, 92.6))
    assert check(terrain.mesh, delaunay=True)
    assert terrain.mesh.points.max(axis=0).tolist() == [402 * 75.0, 343 * float(np.float32(92.6))]
    error = terrain.surface - data
    coarse = regular_grid(data, 12)
    assert np.abs(error).max() == pytest.approx(terrain.errors[-1])
    assert np.abs(error).max() < 0.7 * np.abs(coarse - data).max()
    assert terrain.mesh3d().points.shape == (1000, 3)
    assert "1000 vertices" in repr(terrain)


def test_spacing_keeps_collinear_points_collinear():
    """Without the rounding of 0.1 to few bits, rows of the grid would bend and cut slivers."""
    grid = np.random.default_rng(0).random((9, 11))
    terrain = greedy_terrain(grid, spacing=(0.1, 0.3))
    assert check(terrain.mesh, delaunay=True)
    assert terrain.mesh.quality("min_angle").min() > 10


@pytest.mark.parametrize(
    ("arguments", "options", "text"),
    [
        ((np.zeros(5),), {}, "shape"),
        ((np.zeros((1, 5)),), {}, "shape"),
        ((np.zeros((2, 2, 2)),), {}, "shape"),
        (([["a", "b"], ["c", "d"]],), {}, "numbers"),
        (([[1.0, 2.0], [3.0]],), {}, "numbers"),
        ((np.where(np.arange(20).reshape(4, 5) == 13, np.nan, 0.0),), {}, "row 2, column 3"),
        ((np.ma.masked_equal(np.arange(20).reshape(4, 5), 7),), {}, "row 1, column 2"),
        ((FLAT,), {"count": 3}, "4 vertices"),
        ((FLAT,), {"tolerance": -1.0}, "tolerance"),
        ((FLAT,), {"tolerance": np.nan}, "tolerance"),
        ((FLAT,), {"spacing": (1.0, 0.0)}, "spacing"),
        ((FLAT,), {"spacing": (1.0, np.inf)}, "spacing"),
        ((FLAT,), {"spacing": (1e-300, 1.0)}, "spacing"),
        ((FLAT,), {"spacing": 1.0}, "spacing"),
    ],
)
def test_bad_input_raises_the_typed_error(arguments, options, text):
    with pytest.raises(UnstructError, match=text):
        greedy_terrain(*arguments, **options)


def test_a_vertex_outside_the_grid_is_named():
    with pytest.raises(InputError, match="vertex 2"):
        grid_surface([[0, 1, 2]], [(0, 0), (0, 2), (3, 0)], [0, 0, 0], (3, 3))


def test_no_triangle_no_value():
    surface = grid_surface([[0, 1, 2]], [(0, 0), (0, 2), (2, 0)], [0, 2, 4], (3, 3))
    assert np.array_equal(np.isnan(surface), [[0, 0, 0], [0, 0, 1], [0, 1, 1]])
    assert surface[0].tolist() == [0, 1, 2] and surface[:, 0].tolist() == [0, 2, 4]
