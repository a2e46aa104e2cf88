"""Interpolation on meshes: against SciPy, stolen areas, and what must hold exactly."""

import numpy as np
import pytest
import scipy.interpolate
from fixtures import HARD_2D, lattice2, uniform
from hypothesis import given, settings
from hypothesis import strategies as st
from windows import exact_areas

from unstruct import (
    Domain,
    InputError,
    Mesh,
    MeshError,
    constrained_delaunay,
    delaunay,
    interpolate,
    voronoi,
)

METHODS = ("linear", "natural", "laplace")
grid = st.lists(st.tuples(*[st.integers(0, 4)] * 2), min_size=3, max_size=9)
some = settings(max_examples=25, deadline=None)


def spans(points):
    return np.linalg.matrix_rank(points - points[0]) == points.shape[1]


@pytest.mark.parametrize("d", [1, 2, 3, 4])
def test_linear_as_in_scipy(d):
    points, rng = uniform(80, d, seed=2), np.random.default_rng(1)
    values, x = rng.random((80, 3)), rng.random((1500 if d < 4 else 30, d)) * 1.2 - 0.1
    mesh = delaunay(points)
    found = interpolate(mesh, values, x)
    if d > 1:
        expected = scipy.interpolate.LinearNDInterpolator(points, values)(x)
        assert np.array_equal(np.isnan(found), np.isnan(expected))
    else:
        order = points[:, 0].argsort()
        expected = np.stack(
            [np.interp(x[:, 0], points[order, 0], v[order], np.nan, np.nan) for v in values.T], axis=1
        )
    assert np.allclose(found, expected, rtol=0, atol=1e-12, equal_nan=True)
    assert np.array_equal(interpolate(mesh, values[:, 0], x), found[:, 0], equal_nan=True)
    assert interpolate(mesh, values, x.reshape(2, -1, d)).shape == (2, len(x) // 2, 3)
    complex_ = interpolate(mesh, values + 1j, x)
    assert np.allclose(complex_.imag[np.isfinite(found)], 1, rtol=0, atol=1e-14)
    assert np.allclose(complex_.real, found, rtol=0, atol=1e-15, equal_nan=True)


@some
@given(grid, st.lists(st.tuples(*[st.integers(-2, 18)] * 2), min_size=1, max_size=12))
def test_natural_neighbors_steal_areas(points, queries):
    """The same weights by rational arithmetic: what a new site takes from every cell, in a large window."""
    sites = list(dict.fromkeys(points))
    rows = np.array(sites, dtype=float)
    if not spans(rows):
        return
    mesh, x = delaunay(rows), np.array(queries, dtype=float) / 4
    weights = interpolate(mesh, np.eye(len(sites)), x, "natural")
    laplace = interpolate(mesh, np.eye(len(sites)), x, "laplace")
    inside = np.asarray(mesh.find_simplex(x)) >= 0
    assert np.array_equal(np.isnan(weights).any(axis=1), ~inside)
    room = [[(-9e5, -9e5), (9e5, -9e5), (9e5, 9e5), (-9e5, 9e5)]]
    before = exact_areas(sites, room)
    on_hull = np.isclose(interpolate(mesh, np.eye(len(sites)), x), weights, rtol=0, atol=1e-15).all(axis=1)
    for i in np.flatnonzero(inside).tolist():
        place = tuple(x[i].tolist())
        assert np.allclose([weights[i] @ rows, laplace[i] @ rows], place, rtol=0, atol=1e-13)
        assert weights[i].sum() == pytest.approx(1, abs=1e-14) and (weights[i] >= 0).all()
        if place in [tuple(map(float, p)) for p in sites]:
            assert sorted(weights[i].tolist()) == [0.0] * (len(sites) - 1) + [1.0]
        elif not on_hull[i]:
            lost = [a - b for a, b in zip(before, exact_areas([*sites, place], room))]
            assert np.allclose(weights[i], [float(a / sum(lost)) for a in lost], rtol=0, atol=1e-11)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", [n for n in HARD_2D if n not in ("wide_exponents",)])
def test_linear_functions_and_vertices_on_hard_inputs(name, method):
    points = HARD_2D[name][:300]
    if not spans((points - points[0]) / np.abs(points - points[0]).max()):
        return
    mesh, rng = delaunay(points), np.random.default_rng(0)
    unit = np.abs(points).max()
    values = (points[:, 0] - 2 * points[:, 1]) / unit
    used = np.unique(mesh.simplices)
    assert np.array_equal(interpolate(mesh, values, points[used], method), values[used])
    cells = mesh.simplices[rng.integers(0, len(mesh), 200)]
    shares = rng.dirichlet(np.ones(3), 200)
    x = (points[cells] * shares[..., None]).sum(axis=1)
    found = interpolate(mesh, values, x, method)
    inside = np.isfinite(found)
    assert np.allclose(found[inside], ((x[:, 0] - 2 * x[:, 1]) / unit)[inside], rtol=0, atol=1e-9)
    assert inside.mean() > 0.3


@pytest.mark.parametrize("method", METHODS)
def test_edges_of_the_hull_and_ties(method):
    points = lattice2(5, 5)
    mesh = delaunay(points)
    values = points[:, 0] ** 2 + points[:, 1]
    on_hull = [(0.25, 0.0), (0.0, 2.5), (4.0, 3.75), (1.0, 4.0)]
    assert np.allclose(interpolate(mesh, values, on_hull, method), [0.25, 2.5, 19.75, 5], rtol=0, atol=1e-14)
    center = interpolate(mesh, values, (1.5, 1.5), method)
    assert center == pytest.approx(4.0, abs=1e-14)  # all four corners alike, by symmetry, or both ends
    near = interpolate(mesh, values, [(1.5, 1e-13), (1.5, 1e-300)], method)
    assert np.allclose(near, 2.5, rtol=0, atol=1e-12)


def test_sibson_is_smooth_where_linear_has_a_crease():
    """The slopes on the two sides of an inner edge, across it."""
    points = uniform(300, 2, seed=7)
    mesh, values = delaunay(points), uniform(300, 1, seed=8)[:, 0]
    cell, corner = np.nonzero(mesh.neighbors > np.arange(len(mesh))[:, None])
    ends = points[np.stack([mesh.simplices[cell, (corner + k) % 3] for k in (1, 2)], axis=1)]
    middle, along = ends.mean(axis=1), ends[:, 1] - ends[:, 0]
    step = 1e-4 * along[:, ::-1] * (-1, 1)
    jumps = []
    for method in METHODS[:2]:
        low, mid, high = (interpolate(mesh, values, middle + k * step, method) for k in (-1, 0, 1))
        jumps.append(np.nanmedian(np.abs(high - 2 * mid + low)) / 1e-4)
    assert jumps[1] < 0.01 * jumps[0]


def test_holes_and_notches():
    ring = Domain.polygon([(0, 0), (3, 0), (3, 3), (0, 3)], holes=[[(1, 1), (2, 1), (2, 2), (1, 2)]])
    mesh = constrained_delaunay(ring)
    values = 2 * mesh.points[:, 0] + 1
    x = uniform(3000, 2, seed=5) * 3.2 - 0.1
    found = interpolate(mesh, values, x)
    assert np.array_equal(np.isfinite(found), ring.contains(x))
    assert np.allclose(found[np.isfinite(found)], (2 * x[:, 0] + 1)[np.isfinite(found)], rtol=0, atol=1e-13)
    assert (interpolate(mesh, values, [(1.5, 1.5), (9, 9)], fill_value=-7) == -7).all()
    for method in METHODS[1:]:
        with pytest.raises(MeshError, match="leave the hull"):
            interpolate(mesh, values, x, method)


def test_values_that_do_not_count():
    points = [(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)]
    mesh = delaunay(points)
    values = [1.0, np.nan, 2.0, 3.0, np.nan]
    for method in METHODS:
        assert interpolate(mesh, values, (0, 0), method) == 1.0
        assert interpolate(mesh, values, (0, 0.5), method) == 2.0
        assert np.isnan(interpolate(mesh, values, (0.75, 0.25), method))
    assert isinstance(interpolate(mesh, values, (0, 0)), float)
    assert interpolate(mesh, np.zeros((5, 0)), [(0, 0)]).shape == (1, 0)
    assert interpolate(mesh, values, np.empty((0, 2)), "natural").shape == (0,)


@pytest.mark.parametrize(
    "arguments, words",
    [
        (([0, 1, 2], (0, 0)), r"shape \(4,\)"),
        ((np.zeros((4, 1, 1)), (0, 0)), r"shape \(4,\)"),
        ((list("abcd"), (0, 0)), "numbers"),
        (([0, 1, 2, 3], (0, 0, 0)), r"\(..., 2\)"),
        (([0, 1, 2, 3], [(0, 0), (np.nan, 0)]), r"x\[1\]"),
        (([0, 1, 2, 3], (0, 0), "cubic"), "linear, natural, laplace"),
    ],
)
def test_bad_input(arguments, words):
    mesh = delaunay([(0, 0), (1, 0), (1, 1), (0, 1)])
    with pytest.raises(InputError, match=words):
        interpolate(mesh, *arguments)


def test_meshes_that_do_not_fit():
    solid, points = delaunay(uniform(20, 3)), [(0, 0), (4, 0), (4.2, 1), (0, 1.1)]
    x = np.full((1, 3), 0.5)
    with pytest.raises(MeshError, match="planar"):
        interpolate(solid, np.zeros(20), x, "natural")
    with pytest.raises(MeshError, match="without weights"):
        interpolate(delaunay(points, weights=[1, 2, 3, 4]), np.zeros(4), (1, 0.5), "natural")
    other = Mesh(points, [[0, 1, 2], [0, 2, 3]])
    assert interpolate(other, [0, 1, 2, 3], (4, 0)) == 1
    with pytest.raises(MeshError, match="facet"):
        interpolate(other, np.zeros(4), (1, 0.5), "laplace")
    surface = Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [[0, 1, 2]])
    with pytest.raises(MeshError, match="full dimension"):
        interpolate(surface, np.zeros(3), (0, 0, 0))
    with pytest.raises(InputError, match="must be a Mesh"):
        interpolate(points, np.zeros(4), (0, 0))
    square = constrained_delaunay(Domain.rectangle())
    assert interpolate(square, [0, 1, 1, 0], (0.25, 0.5), "natural") == pytest.approx(0.25)


def test_many_queries_agree_with_few():
    """Long lists walk through the mesh, short ones look into its tree."""
    points = np.vstack([uniform(500, 2), 0.5 + 1e-6 * uniform(100, 2)])
    mesh, values = delaunay(points), uniform(600, 1)[:, 0]
    x = np.vstack([uniform(2500, 2, seed=3) * 1.4 - 0.2, points])
    for method in METHODS:
        many = interpolate(mesh, values, x, method)
        few = np.concatenate([interpolate(mesh, values, part, method) for part in np.array_split(x, 8)])
        assert np.allclose(many, few, rtol=0, atol=1e-9, equal_nan=True)
    assert voronoi(points).areas(clip=((0, 0), (1, 1))).sum() == pytest.approx(1)
