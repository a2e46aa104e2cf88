"""Slow and simple: what fast triangulations are held against."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from unstruct import topology
from unstruct.predicates.batch import in_sphere, orient


def brute_force(mesh):
    """No flat cell, right neighbors, empty balls over all points, a hull that has all points behind it."""
    points, simplices = mesh.points, mesh.simplices
    assert simplices.dtype == mesh.neighbors.dtype == np.int32
    assert (np.asarray(orient(points[simplices])) > 0).all()
    assert np.array_equal(mesh.neighbors, topology.neighbors(simplices))
    copies = set(mesh.duplicates[:, 0].tolist())
    assert set(simplices.ravel().tolist()) == set(range(len(points))) - copies
    for copy, kept in mesh.duplicates:
        assert kept < copy and kept not in copies and (points[copy] == points[kept]).all()
    for q in points:
        assert (np.asarray(in_sphere(points[simplices], q)) <= 0).all()
    cell, k = np.nonzero(mesh.neighbors < 0)
    for t, j in zip(cell, k):
        turned = np.repeat(points[simplices[t]][None], len(points), axis=0)
        turned[:, j] = points
        assert (np.asarray(orient(turned)) >= 0).all(), "a point beyond a hull facet"


def complex_of(points, corners):
    """The Delaunay complex: the sets of points on the empty spheres, which no tie-break changes."""
    return {frozenset(map(tuple, points[np.asarray(in_sphere(c, points)) == 0].tolist())) for c in corners}


@st.composite
def grid_points(draw, dimensions=(2, 3), side=4, most=14):
    d = draw(st.sampled_from(dimensions))
    row = st.tuples(*[st.integers(0, side - 1)] * d)
    return np.array(draw(st.lists(row, min_size=d + 2, max_size=most)), dtype=float)
