"""Points into a recovered complex: faces and segments stay, impossible points are left out."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from solids import cube, torus

from unstruct.connect.spatial.adding import add_points
from unstruct.connect.spatial.complex import Recovered, SpatialComplex

NO_SEGMENTS = np.empty((0, 2), dtype=np.int32)


def recovered(
    points: np.ndarray, triangles: np.ndarray, segments: np.ndarray = NO_SEGMENTS
) -> tuple[SpatialComplex, Recovered]:
    cells = SpatialComplex(points)
    found = cells.recover(triangles, segments)
    assert found.complete
    cells.flood()
    return cells, found


def volume(cells: SpatialComplex) -> float:
    made = cells.inside()
    a, b, c, d = made.points[made.simplices].transpose(1, 0, 2)
    return float((np.cross(b - a, c - a) * (d - a)).sum() / 6)


@pytest.mark.parametrize("body", [cube(1), cube(4), torus(18, 9)], ids=["twelve", "cube", "torus"])
def test_faces_stay(body: tuple[np.ndarray, np.ndarray]) -> None:
    points, triangles = body
    cells, found = recovered(points, triangles)
    before, was = cells.inside(), volume(cells)
    low, high = points.min(axis=0), points.max(axis=0)
    rows = low + np.random.default_rng(0).uniform(-0.1, 1.1, (400, 3)) * (high - low)
    added = add_points(cells, rows, found, NO_SEGMENTS)
    cells.validate()
    after = cells.inside()
    assert 0 < added < 400 and len(after.points) == len(before.points) + added
    assert abs(volume(cells) - was) < 1e-14 * was
    assert np.array_equal(np.sort(before.triangle), np.sort(after.triangle))
    corners = [
        np.sort(made.vertex[made.faces], axis=1)[np.argsort(made.triangle)] for made in (before, after)
    ]
    assert np.array_equal(*corners)


def test_points_that_cannot_be_in_are_left_out() -> None:
    """Vertices, points of faces and of edges, and those outside: nothing changes."""
    points, triangles = cube(1)
    cells, found = recovered(points, triangles)
    middle = points[triangles].mean(axis=1)
    halves = (points[triangles[:, 0]] + points[triangles[:, 1]]) / 2
    rows = np.concatenate([points, middle, halves, points * 2 + 1])
    before = cells.cells()
    inside = cells.inside()
    assert add_points(cells, rows, found, NO_SEGMENTS) <= len(halves)  # diagonals of the inside may take some
    cells.validate()
    assert len(before) and np.array_equal(np.sort(inside.triangle), np.sort(cells.inside().triangle))


def test_segments_stay() -> None:
    """A diagonal through the inside stays an edge when points come close to it; a point twice is in once."""
    points, triangles = cube(2)
    a, b = (
        int(np.flatnonzero((points == end).all(axis=1))[0])
        for end in (points.min(axis=0), points.max(axis=0))
    )
    inner = np.array([[a, b]], dtype=np.int32)
    cells, found = recovered(points, triangles, inner)
    share = np.linspace(0.05, 0.95, 19)[:, None]
    rows = points[a] + share * (points[b] - points[a]) + np.random.default_rng(1).normal(0, 1e-3, (19, 3))
    assert add_points(cells, np.concatenate([rows, rows]), found, inner) <= 19
    cells.validate()
    corner = cells.cells()
    chain = found.chains.get((min(a, b), max(a, b)), [a, b])
    for u, v in pairwise(chain):
        assert ((corner == u).any(axis=1) & (corner == v).any(axis=1)).any()
