"""Missing edges put in, the outside removed: the same mesh as by constrained Delaunay triangulation."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from segments import cells_of, coastline, noncrossing, square

from unstruct import (
    Domain,
    InputError,
    Mesh,
    MeshError,
    check,
    constrained_delaunay,
    delaunay,
    swap_diagonals,
)
from unstruct.examples.running import random_triangulation
from unstruct.generate.boundary.edge_recovery import (
    complex_of_mesh,
    recover_edges,
    remove_outside,
    with_ghosts,
)


def spiky(seed, n=40):
    """A star polygon, and points in its hull."""
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.random(n)) * 2 * np.pi
    ring = rng.uniform(0.2, 1, n)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.concatenate([ring, rng.uniform(-1, 1, (n, 2))])
    return points, [(i, (i + 1) % n) for i in range(n)]


@given(st.integers(0, 10**6))
@settings(max_examples=25, deadline=None)
def test_weatherill_and_hassan_arrive_at_the_constrained_triangulation(seed):
    points, facets = spiky(seed)
    domain = Domain(points, facets)
    mesh = delaunay(points)
    recovered = recover_edges(mesh, facets)
    assert check(recovered, delaunay="constrained")
    edges = {frozenset(e) for e in mesh.edges.tolist()}
    assert recovered.counts["missing"] == sum(frozenset(f) not in edges for f in facets)
    inside = remove_outside(recovered, domain)
    assert check(inside, delaunay="constrained")
    assert inside.volume == pytest.approx(domain.area, rel=1e-13)
    expected = constrained_delaunay(domain)
    assert cells_of(inside.simplices) == cells_of(expected.simplices)
    np.testing.assert_array_equal(inside.origin, expected.origin)
    assert inside.counts["removed vertices"] == len(points) - len(inside.points)


@given(st.integers(0, 10**6))
@settings(max_examples=25, deadline=None)
def test_any_triangulation_takes_edges_and_swaps_make_it_constrained_delaunay(seed):
    rng = np.random.default_rng(seed)
    points = rng.random((30, 2))
    mesh = random_triangulation(points, rng)
    edges = noncrossing(points, [tuple(rng.choice(30, 2, replace=False).tolist()) for _ in range(12)])
    recovered = recover_edges(mesh, edges)
    assert check(recovered, brute=True)
    np.testing.assert_array_equal(recovered.markers["recovered"], edges)
    swapped = swap_diagonals(recovered, constrained="recovered")
    assert check(swapped, delaunay="constrained")
    domain = Domain(points, [], inner=edges)
    assert cells_of(swapped.simplices) == cells_of(constrained_delaunay(domain, hull=True).simplices)


def test_markers_that_still_hold_stay():
    mesh = delaunay(square(0, 2))
    (diagonal,) = {tuple(e) for e in mesh.edges.tolist()} - {(0, 1), (1, 2), (2, 3), (0, 3)}
    mesh = Mesh(mesh.points, mesh.simplices, markers={"side": [[0, 1]], "cut": [diagonal], "part": [5, 6]})
    other = sorted({0, 1, 2, 3} - set(diagonal))
    recovered = recover_edges(mesh, [other])
    assert recovered.markers["side"].tolist() == [[0, 1]] and len(recovered.markers["cut"]) == 0
    assert "part" not in recovered.markers
    assert recovered.counts == {"missing": 1, "crossed": 2, "split": 0}
    assert recover_edges(mesh, [diagonal]).markers["part"].tolist() == [5, 6]
    assert recover_edges(mesh, []).counts["missing"] == 0


def test_a_region_with_a_hole_has_ghosts_on_both_rims():
    ring = constrained_delaunay(Domain.polygon(square(0, 9), [square(3, 6)]))
    vertex, twin = with_ghosts(ring)
    np.testing.assert_array_equal(twin[twin], np.arange(len(twin)))
    after = np.arange(len(twin)).reshape(-1, 3)[:, [1, 2, 0]].ravel()
    before = np.arange(len(twin)).reshape(-1, 3)[:, [2, 0, 1]].ravel()
    np.testing.assert_array_equal(vertex[after], vertex[before][twin], "twins run against each other")
    with pytest.raises(InputError, match=r"edges\[0\].*leaves the mesh"):
        recover_edges(ring, [(0, 2)])


@pytest.mark.parametrize(
    ("edges", "words"),
    [
        ([(0, 9)], "vertex of no triangle"),
        ([(0, -1)], "vertex of no triangle"),
        ([(0, 1, 2)], "pairs"),
        ([(0, 2), (1, 3)], "crosses"),
        ([(1, 1)], "nowhere"),
    ],
)
def test_edges_that_cannot_be(edges, words):
    with pytest.raises(InputError, match=words):
        recover_edges(delaunay([*square(0, 4), (1, 2)]), edges)


def test_meshes_that_cannot_be():
    with pytest.raises(MeshError, match="triangles in the plane"):
        recover_edges(delaunay(np.random.default_rng(0).random((8, 3))), [(0, 1)])
    pinched = Mesh(np.array([(0, 0), (1, 0), (0, 1), (-1, 0), (0, -1)], float), [(0, 1, 2), (0, 3, 4)])
    with pytest.raises(MeshError, match="pinched at vertex 0"):
        complex_of_mesh(pinched)
    with pytest.raises(InputError, match="exponents"):
        complex_of_mesh(delaunay([*square(0, 1e200), (1e-200, 2e-200)]))


def test_the_boundary_must_be_there():
    for seed in range(20):
        points, facets = spiky(seed)
        mesh, domain = delaunay(points), Domain(points, facets)
        if recover_edges(mesh, facets).counts["missing"]:
            break
    with pytest.raises(InputError, match="recover_edges first"):
        remove_outside(mesh, domain)
    with pytest.raises(InputError, match="no vertex of the mesh"):
        remove_outside(delaunay(points[3:]), domain)
    with pytest.raises(InputError, match="no facets"):
        remove_outside(mesh, Domain(points, []))


def test_a_long_coast():
    points = coastline(100_000, seed=3)
    domain = Domain.polygon(points)
    inside = remove_outside(recover_edges(delaunay(points), domain.facets), domain)
    assert check(inside, delaunay="constrained") and inside.size == len(points) - 2
