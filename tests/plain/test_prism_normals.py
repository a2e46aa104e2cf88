"""The plain directions: a cube's corners and edges, the fan that the angle-weighted normal does not see."""

from __future__ import annotations

from math import sqrt

import numpy as np
import pytest

from unstruct import Domain
from unstruct.plain.prism_normals import most_normal, sees, staged_normals
from unstruct.plain.prisms import unit

FAN = [(0, -2, 1), (1, 0, -2), (-1, 1, 1), (-2, 1, 0)]  # edges from a vertex at the origin


def test_a_cube() -> None:
    cube = Domain.box((0, 0, 0), (2, 2, 2))
    triangles = [tuple(t) for t in cube.triangulated.triangles.tolist()]
    points = [tuple(p) for p in cube.points.tolist()]
    for ray, p in zip(staged_normals(points, triangles, 40.0), points):
        outward = [(x - 1) / sqrt(3) for x in p]
        np.testing.assert_allclose(ray, outward, atol=1e-12)


def test_an_edge_takes_the_mean_of_its_two_sides() -> None:
    points = [(0, 0, 0), (0, 1, 0), (0, -1, 0), (1, 0.7, 0), (1, -0.7, 0), (-1, 0, -3)]
    triangles = [(0, 4, 3), (0, 3, 1), (0, 2, 4), (0, 1, 5), (0, 5, 2)]
    side = unit((-3, 0, 1))
    mean = unit((side[0], 0, side[2] + 1))
    np.testing.assert_allclose(staged_normals(points, triangles, 40.0)[0], mean)


def test_the_most_normal_direction_of_the_fan() -> None:
    """The four faces all see (0, 0, 1), but the angle-weighted normal not all of them."""
    points = [(0, 0, 0), *FAN]
    triangles = [(0, 1 + k, 1 + (k + 1) % 4) for k in range(4)]
    sign = -1 if not sees(points, triangles, 0, (0, 0, 1)) else 1
    turned = triangles if sign > 0 else [(a, c, b) for a, b, c in triangles]
    assert sees(points, turned, 0, (0, 0, 1))
    assert not sees(points, turned, 0, staged_normals(points, turned, 180.0)[0])
    normals = [unit(np.cross(np.subtract(points[b], points[a]), np.subtract(points[c], points[a])).tolist())
               for a, b, c in turned]  # fmt: skip
    best = most_normal(normals)
    assert best is not None and sees(points, turned, 0, best)
    least = min(np.array(normals) @ best)
    rng = np.random.default_rng(0)
    for direction in rng.normal(size=(2000, 3)):
        assert (np.array(normals) @ (direction / np.linalg.norm(direction))).min() < least + 1e-9


def test_no_direction_sees_opposite_sides() -> None:
    assert most_normal([(0, 0, 1), (0, 0, -1)]) is None
    assert most_normal([(1, 0, 0), (-0.6, 0.8, 0), (-0.6, -0.8, 0)]) is None
    assert most_normal([(1, 0, 0)]) == pytest.approx((1, 0, 0))
