"""Lattice points: inside, far enough from the surface by a plain measure, as dense as wanted."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from solids import cube

from unstruct import Domain, sizing
from unstruct.generate.volume.lattice import FROM_SURFACE, lattice_points

CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def test_as_many_as_wanted() -> None:
    for h in (0.1, 0.07):
        found = lattice_points(Domain(CORNERS, SIDES), sizing.as_size(h)).inside
        side = 1 - 2 * FROM_SURFACE * h
        assert len(found) == pytest.approx(2 * (side / (1.1 * h)) ** 3, rel=0.25)
        assert (np.abs(found - 0.5) <= 0.5 - FROM_SURFACE * h).all()


def test_nested_lattices_follow_the_size() -> None:
    domain = Domain(CORNERS, SIDES)
    field = sizing.as_size(lambda x: 0.06 + 0.2 * x[:, 0])
    found = lattice_points(domain, field).inside
    gaps = np.sort(np.linalg.norm(found[:, None] - found[None], axis=2), axis=1)[:, 1]
    quotient = gaps / field(found)
    assert 0.4 < np.quantile(quotient, 0.02) and np.quantile(quotient, 0.98) < 1.6
    landmark = sizing.points([(0.513, 0.487, 0.5)], 0.004, growth=0.5, far=0.3)
    near = np.linalg.norm(lattice_points(domain, landmark).inside - (0.513, 0.487, 0.5), axis=1)
    assert near.min() < 0.005


def test_a_fine_surface_makes_fine_cells() -> None:
    points, faces = cube(8)
    found = lattice_points(Domain(points, faces), sizing.as_size(100.0)).inside
    depth = np.minimum(found, 8 - found).min(axis=1)
    assert np.count_nonzero(depth < 2) > 100 and depth.min() > 0.5


def distance(p: np.ndarray, corners: np.ndarray) -> float:
    """From a triangle, by many points of it."""
    k = 60
    share = np.array([(i, j, k - i - j) for i in range(k + 1) for j in range(k + 1 - i)]) / k
    return float(np.linalg.norm(share @ corners - p, axis=1).min())


@settings(deadline=None, max_examples=10)
@given(st.integers(0, 2**32), st.sampled_from([0.2, 0.35]))
def test_far_from_the_surface(seed: int, h: float) -> None:
    rng = np.random.default_rng(seed)
    points = rng.random((4, 3))
    if np.linalg.det(np.diff(points, axis=0)) ** 2 < 1e-4:
        return
    inside = points.mean(axis=0)
    domain = Domain(3 * np.vstack([points, inside]), [(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)])
    found = lattice_points(domain, sizing.as_size(h)).inside
    if len(found):
        assert domain.contains(found).all()
        assert np.linalg.norm(found - 3 * inside, axis=1).min() >= FROM_SURFACE * h
    for p in found[:5]:
        least = min(distance(p, domain.points[list(row)]) for row in domain.facets.tolist())
        assert least >= FROM_SURFACE * h - 1e-9
