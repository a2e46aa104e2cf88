"""``Triangulation``: growing, asking, shrinking."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import brute_force, complex_of, grid_points

from unstruct import DegenerateInputError, InputError, MeshError, Triangulation, check, delaunay
from unstruct.predicates.batch import in_sphere, orient


def same_complex(mesh, other):
    points = mesh.points
    assert np.array_equal(points, other.points)
    assert complex_of(points, points[mesh.simplices]) == complex_of(points, points[other.simplices])


@settings(max_examples=60, deadline=None)
@given(grid_points(dimensions=(1, 2, 3, 4), side=4, most=16), st.lists(st.integers(0, 16), max_size=4))
def test_batches_as_one_go(points, cuts):
    """Any split into batches, most of them outside the hull of those before, held until they span."""
    t = Triangulation(dimension=points.shape[1])
    for part in np.split(points, sorted(min(c, len(points)) for c in cuts)):
        t.insert(part)
        assert isinstance(t.spans, bool)
    assert np.array_equal(t.points, points) and len(t) == len(points)
    try:
        expected = delaunay(points)
    except (DegenerateInputError, InputError):
        assert not t.spans and "not spanning" in repr(t)
        with pytest.raises(DegenerateInputError):
            t.mesh()
        assert (t.locate(points) == -1).all() and len(t.cavity(points[0])) == 0
        return
    brute_force(t.mesh())
    same_complex(t.mesh(), expected)
    assert np.array_equal(t.mesh().duplicates, expected.duplicates)


def test_batches_of_growing_extent_are_scaled_anew():
    rng = np.random.default_rng(0)
    for d in (2, 3):
        t = Triangulation(rng.random((20, d)) * 1e-5)
        parts = [t.points]
        for size in (1.0, 1e7, 1e40, 1e-200):
            parts.append((rng.random((15, d)) - 0.5) * size)
            t.insert(parts[-1])
        points = np.concatenate(parts)
        assert np.array_equal(t.points, points)
        brute_force(t.mesh())
        t.insert(np.full(d, 1e300))
        t.insert(np.full(d, 1e-300))  # no scale serves both: from here on by integers
        brute_force(t.mesh())


def test_a_later_point_beyond_every_scale_so_far():
    t = Triangulation(np.eye(3)[:, :2] * 1e-305)
    with np.errstate(over="raise", invalid="raise"):
        t.insert([1e300, 1e300])
    brute_force(t.mesh())


def test_large_second_batch():
    rng = np.random.default_rng(1)
    for d, n in ((2, 30_000), (3, 6_000)):
        points = rng.random((n, d))
        t = Triangulation(points[: n // 10])
        t.mesh()
        t.insert(points[n // 10 :], progress=False)
        rows = {tuple(sorted(r)) for r in t.mesh().simplices.tolist()}
        assert rows == {tuple(sorted(r)) for r in delaunay(points).simplices.tolist()}


@pytest.mark.parametrize("d", [1, 2, 3, 4])
def test_locate_and_cavity(d):
    rng = np.random.default_rng(d)
    points = rng.integers(0, 6, (25, d)).astype(float) if d > 1 else rng.random((25, 1)) * 6
    t = Triangulation(points)
    mesh = t.mesh()
    queries = np.concatenate([rng.integers(-1, 8, (30, d)) * 0.75, points[:5], [[1e9] * d], [[3e-320] * d]])
    found = t.locate(queries)
    assert found.dtype == np.int32 and found.shape == (len(queries),)
    for x, cell in zip(queries, found):
        inside = np.array([_holds(points[s], x) for s in mesh.simplices])
        for one in (cell, t.locate(x)):  # on a common face, either of its cells
            assert inside[one] if one >= 0 else not inside.any()
        expected = np.flatnonzero(np.asarray(in_sphere(points[mesh.simplices], x)) > 0)
        assert np.array_equal(t.cavity(x), expected)
    assert len(t.cavity(points[0])) == 0


@pytest.mark.parametrize("d", [2, 3])
def test_locate_finds_what_the_mesh_finds(d):
    rng = np.random.default_rng(7)
    t = Triangulation(rng.random((3000, d)))
    queries = rng.random((5000, d)) * 1.4 - 0.2
    assert np.array_equal(t.locate(queries), t.mesh().find_simplex(queries))


def _holds(simplex, x):
    turned = np.repeat(simplex[None], len(simplex), axis=0)
    turned[np.arange(len(simplex)), np.arange(len(simplex))] = x
    return (np.asarray(orient(turned)) >= 0).all()


def test_queries_change_nothing():
    for d in (2, 3):
        t = Triangulation(np.random.default_rng(0).random((200, d)))
        before = t.mesh().simplices.copy()
        for x in np.random.default_rng(1).random((50, d)) * 1.4 - 0.2:
            t.cavity(x)
            t.locate(x)
        assert np.array_equal(t._engine.cells(t._labels()[0])[0], before)
        t.insert(np.random.default_rng(2).random((20, d)))
        brute_force(t.mesh())


@settings(max_examples=80, deadline=None)
@given(grid_points(dimensions=(2,), side=5, most=22), st.randoms(use_true_random=False))
def test_removal_as_building_without(points, random):
    """Hull vertices, ties, collinear remainders, copies, to the last vertex."""
    t = Triangulation(points)
    alive = list(range(len(points)))
    while alive:
        t.remove(alive.pop(random.randrange(len(alive))))
        try:
            expected = delaunay(points[alive])
        except (DegenerateInputError, InputError):
            assert not t.spans
            continue
        mesh, there = t.mesh(), points[alive]
        assert check(mesh, delaunay=True)
        assert np.array_equal(mesh.origin, alive) and np.array_equal(mesh.points, there)
        assert np.array_equal(mesh.duplicates, expected.duplicates)
        assert complex_of(there, there[mesh.simplices]) == complex_of(there, there[expected.simplices])
        assert len(mesh.simplices) == len(expected.simplices)


def test_removal_then_insertion():
    rng = np.random.default_rng(5)
    points = rng.random((3000, 2))
    t = Triangulation(points)
    gone = rng.choice(3000, 2000, replace=False)
    for v in gone:
        t.remove(v)
    t.insert(rng.random((500, 2)) * 1.5)
    kept = np.setdiff1d(np.arange(3500), gone)
    expected = delaunay(t.points[kept]).simplices
    assert np.array_equal(t.mesh().origin, kept) and check(t.mesh(), delaunay=True)
    assert {tuple(sorted(r)) for r in t.mesh().simplices.tolist()} == {
        tuple(sorted(r)) for r in expected.tolist()
    }


def test_removal_of_a_vertex_with_many_neighbors():
    angle = np.linspace(0, 2 * np.pi, 700, endpoint=False)
    points = np.vstack([np.stack([np.cos(angle), np.sin(angle)], axis=1), [[0.0, 0.0]]])
    t = Triangulation(points)
    assert len(t.mesh().simplices) == 700
    t.remove(700)
    assert len(t.mesh().simplices) == 698
    ring = points[:700]
    assert (np.asarray(orient(points[t.mesh().simplices])) > 0).all()
    for q in ring[::50]:
        assert (np.asarray(in_sphere(points[t.mesh().simplices], q)) <= 0).all()


def test_removal_by_the_integer_engine():
    points = np.array([[0, 0], [1e300, 0], [0, 1e300], [1e-300, 1e-300], [1e-300, 2e-300], [5.0, 5.0]])
    t = Triangulation(points)
    t.remove(4)
    alive = [0, 1, 2, 3, 5]
    expected = delaunay(points[alive]).simplices
    assert t.mesh().origin.tolist() == alive
    assert {tuple(sorted(r)) for r in t.mesh().simplices.tolist()} == {
        tuple(sorted(r)) for r in expected.tolist()
    }


def test_what_cannot_be_done_is_said():
    t = Triangulation(np.random.default_rng(0).random((10, 2)))
    t.remove(3)
    for vertex in (3, 10, -1):
        with pytest.raises(MeshError, match=f"no vertex {vertex}"):
            t.remove(vertex)
    with pytest.raises(MeshError, match="two dimensions"):
        Triangulation(np.random.default_rng(0).random((10, 3))).remove(0)
    with pytest.raises(InputError, match="points or dimension"):
        Triangulation()
    with pytest.raises(InputError, match="dimension is 3"):
        Triangulation([[0.0, 0.0]], dimension=3)
    with pytest.raises(InputError, match="at least 1"):
        Triangulation(dimension=0)
    with pytest.raises(InputError, match="3 coordinates"):
        t.insert([[0.0, 0.0, 0.0]])
    with pytest.raises(InputError, match="3 coordinates"):
        t.locate([0.0, 0.0, 0.0])
    with pytest.raises(InputError, match="not finite"):
        t.insert([0.0, np.nan])
    with pytest.raises(DegenerateInputError, match="no points yet"):
        Triangulation(dimension=2).mesh()


def test_progress_bar(capsys):
    t = Triangulation(np.random.default_rng(0).random((500, 2)), progress=True)
    assert len(t) == 500 and "points" in capsys.readouterr().err
