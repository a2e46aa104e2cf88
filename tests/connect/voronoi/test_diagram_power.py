"""Power diagrams: vertices, areas, windows and nearest sites against the definition."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from windows import exact_areas

from unstruct import Voronoi, delaunay, voronoi

heavy = st.integers(-4, 4)
grid = st.lists(st.tuples(*[st.integers(0, 4)] * 2, heavy), min_size=1, max_size=8)
solid = st.lists(st.tuples(*[st.integers(0, 2)] * 3, heavy), min_size=5, max_size=10)
some = settings(max_examples=60, deadline=None)
BEND = [(-1, -1), (5, -1), (5, 5), (2, 2), (-1, 5)]


def split(rows):
    rows = np.array(rows, dtype=float)
    return rows[:, :-1], rows[:, -1]


def powers(points, weights, x):
    return ((points - x) ** 2).sum(axis=1) - weights


@some
@given(grid)
def test_areas_within_any_window(rows):
    points, weights = split(rows)
    diagram = voronoi(points, weights=weights)
    kept = dict(diagram.duplicates.tolist())
    alone = [i for i in range(len(rows)) if i not in kept]
    sites, heavy = [rows[i][:2] for i in alone], [rows[i][2] for i in alone]
    for window in ([BEND], [[(-3, -3), (9, -3), (9, 9), (-3, 9)]]):
        exact = dict(zip(alone, exact_areas(sites, window, heavy)))
        areas = diagram.areas(clip=window if len(window[0]) > 4 else window[0])[diagram.point_region]
        assert np.allclose(
            areas, [float(exact[kept.get(i, i)]) for i in range(len(rows))], rtol=0, atol=1e-11
        )
    for i in diagram.mesh.hidden.tolist():
        assert diagram.regions[diagram.point_region[i]] == []
    energies = diagram.relax(2, clip=BEND).energies
    assert (np.diff(energies) <= 1e-9).all()


@some
@given(solid)
def test_vertices_are_power_centers(rows):
    points, weights = split(rows)
    if np.linalg.matrix_rank(points - points[0]) < 3:
        return
    diagram = voronoi(points, weights=weights)
    for simplex, vertex in zip(diagram.mesh.simplices, diagram.simplex_vertex):
        found = powers(points, weights, diagram.vertices[vertex])
        assert np.allclose(found[simplex], found.min(), rtol=0, atol=1e-9 * (1 + np.abs(found).max()))
    for pair, ring in zip(diagram.ridge_points, diagram.ridge_vertices):
        for v in ring:
            if v >= 0:
                found = powers(points, weights, diagram.vertices[v])
                assert np.allclose(found[pair], found.min(), rtol=0, atol=1e-9 * (1 + np.abs(found).max()))
    x = np.random.default_rng(1).random((20, 3)) * 4 - 1
    nearest = diagram.nearest(x)
    for query, i in zip(x, nearest.tolist()):
        found = powers(points, weights, query)
        assert found[i] <= found.min() + 1e-12


def test_volumes_fill_a_box_of_ghost_sites():
    """A lattice with random weights in the middle: all inner cells together keep their volume."""
    lattice = np.stack(np.meshgrid(*[np.arange(5.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    weights = np.random.default_rng(3).random(125) * 0.3
    border = ((lattice == 0) | (lattice == 4)).any(axis=1)
    weights[border] = 0.0
    outer = ((lattice <= 1) | (lattice >= 3)).any(axis=1)
    weights[outer] = 0.0
    volumes = voronoi(lattice, weights=weights).areas()
    assert volumes[~border].sum() == pytest.approx(27, rel=1e-12)
    assert volumes[62] != pytest.approx(1, rel=1e-3)


def test_a_hidden_site_has_an_empty_region():
    sites = [(0, 0), (7, 0), (8, 5), (3, 7), (-1, 5), (3, 2), (5, 4)]
    diagram = voronoi(sites, weights=[0, 0, 0, 0, 0, -30, 0])
    assert diagram.mesh.hidden.tolist() == [5] and diagram.regions[5] == [] and diagram.areas()[5] == 0
    assert diagram.clip(((-2, -2), (9, 8)))[5].shape == (0, 2) and not diagram.unbounded[5]
    assert diagram.neighbors(5) == [] and 5 not in diagram.ridge_points
    assert Voronoi(diagram.mesh).areas(clip=((-2, -2), (9, 8))).sum() == pytest.approx(110, rel=1e-14)


def test_equal_weights_give_the_plain_diagram():
    points = np.random.default_rng(0).random((50, 2))
    plain, same = voronoi(points), voronoi(points, weights=np.full(50, 3.0))
    assert np.array_equal(plain.vertices, same.vertices) and plain.regions == same.regions
    assert np.array_equal(plain.areas(), same.areas())
    assert np.array_equal(plain.areas(clip=((0, 0), (1, 1))), same.areas(clip=((0, 0), (1, 1))))
    assert Voronoi(delaunay(points, weights=np.zeros(50))).regions == plain.regions


def test_weights_on_a_line():
    diagram = voronoi([(0, 0), (1, 0), (2, 0), (3, 0)], weights=[0, -5, 0, 1])
    assert diagram.regions == [[-1], [], [-1], [-1]] and diagram.ridge_points.tolist() == [[0, 2], [2, 3]]
    assert diagram.areas(clip=((-1, -1), (4, 1))).tolist() == [4, 0, 2, 4]
    assert voronoi([(0, 0), (1, 0)], weights=[0, 9]).areas(clip=((-1, -1), (4, 1))).tolist() == [0, 10]
