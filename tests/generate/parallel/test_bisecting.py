"""Division of triangles: each part hangs together, weights are even, and no triangle is forgotten."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import unstruct
from unstruct.generate.parallel.bisecting import divided
from unstruct.generate.parallel.straightening import straightened


def _graph(mesh):
    x = mesh.points[mesh.simplices]
    sides = x[:, [2, 0, 1]] - x[:, [1, 2, 0]]
    return x.mean(axis=1), (mesh.simplices, mesh.neighbors, np.sqrt((sides * sides).sum(axis=2)))


def _pieces(neighbors, part, k):
    """How many pieces a part has that do not hang together, by a search."""
    left, count = set(np.flatnonzero(part == k).tolist()), 0
    while left:
        count += 1
        stack = [left.pop()]
        while stack:
            for u in neighbors[stack.pop()].tolist():
                if u in left:
                    left.remove(u)
                    stack.append(u)
    return count


@pytest.mark.parametrize("parts", [1, 2, 3, 7, 12])
def test_even_and_whole(parts):
    domain = unstruct.Domain.disc().with_holes(unstruct.Domain.disc((0.3, 0.1), 0.35))
    mesh = unstruct.voronoi_segment(domain, 0.05)
    centers, graph = _graph(mesh)
    weight = 1.0 + centers[:, 0] ** 2
    part = divided(centers, graph, weight, parts)
    sums = np.bincount(part, weight, minlength=parts)
    assert sums.max() / sums.mean() < 1.05
    assert [_pieces(mesh.neighbors, part, k) for k in range(parts)] == [1] * parts


@given(st.integers(4, 60), st.integers(1, 9), st.integers(0, 2**32 - 1))
@settings(deadline=None, max_examples=60)
def test_every_part_has_triangles(n, parts, seed):
    random = np.random.default_rng(seed)
    mesh = unstruct.delaunay(random.random((n, 2)))
    parts = min(parts, mesh.size)
    centers, graph = _graph(mesh)
    weight = random.random(mesh.size) ** 8 + 1e-12
    part = divided(centers, graph, weight, parts)
    assert sorted(set(part.tolist())) == list(range(parts))


def test_the_cut_is_short():
    """A square in two: the shortest cut has the length 1."""
    mesh = unstruct.voronoi_segment(unstruct.Domain.rectangle(), 0.04)
    centers, graph = _graph(mesh)
    part = divided(centers, graph, np.ones(mesh.size), 2)
    t, k = np.nonzero((mesh.neighbors >= 0) & (part[mesh.neighbors] != part[:, None]))
    assert graph[2][t, k].sum() / 2 < 1.3


def test_straighter_and_no_angle_too_small():
    mesh = unstruct.voronoi_segment(unstruct.Domain.rectangle(), 0.07)
    centers, graph = _graph(mesh)
    part = divided(centers, graph, np.ones(mesh.size), 3)
    t, k = np.nonzero((mesh.neighbors >= 0) & (part[mesh.neighbors] > part[:, None]))
    edges = np.column_stack([mesh.simplices[t, (k + 1) % 3], mesh.simplices[t, (k + 2) % 3]]).astype(np.int64)
    free = np.ones(len(mesh.points), dtype=bool)
    free[mesh.boundary.ravel()] = False
    points = straightened(mesh.points, mesh.simplices, edges, free)
    assert np.array_equal(points[~free], mesh.points[~free])

    def length(x):
        return np.sqrt(((x[edges[:, 1]] - x[edges[:, 0]]) ** 2).sum(axis=1)).sum()

    assert length(points) < 0.97 * length(mesh.points)
    moved = unstruct.Mesh(points, mesh.simplices)
    assert unstruct.check(moved)
    assert moved.quality("min_angle").min() >= min(25.0, mesh.quality("min_angle").min()) - 1e-9
