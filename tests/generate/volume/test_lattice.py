"""Lattice points: inside, far enough from the surface by a plain measure, as dense as wanted."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from solids import cube

from unstruct import Domain, sizing
from unstruct.generate.volume.lattice import FROM_SURFACE, REACH_OUTSIDE, lattice_points

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


def test_a_size_is_met_where_most_cells_are() -> None:
    """One fine place made the cells elsewhere larger, by up to the square root of 2."""
    for h in (0.1, 0.083, 0.071):
        field = sizing.points([(0.9, 0.9, 0.9)], h / 7, growth=1.0, far=h)
        found = lattice_points(Domain(CORNERS, SIDES), field).inside
        far = found[(found < 0.6).all(axis=1)]
        gaps = np.sort(np.linalg.norm(far[:, None] - found[None], axis=2), axis=1)[:, 1]
        assert np.median(gaps) == pytest.approx(1.1 * h * np.sqrt(3) / 2, rel=0.01)


def test_points_outside_are_next_to_the_surface() -> None:
    points, faces = cube(6)
    hole = np.array([[2.0, 2.0], [4.0, 2.0], [4.0, 4.0], [2.0, 4.0]])
    plate = Domain.extruded(Domain.polygon([[0, 0], [6, 0], [6, 6], [0, 6]], [hole]), 6.0)
    for domain, h in ((Domain(points, faces), 1.0), (plate, 0.8)):
        found = lattice_points(domain, sizing.as_size(h))
        assert len(found.inside) > 50 and not domain.contains(found.outside).any()
        assert (found.outside > -REACH_OUTSIDE * h).all() and (found.outside < 6 + REACH_OUTSIDE * h).all()
    in_hole = (np.abs(found.outside[:, :2] - 3) < 1).all(axis=1)
    assert in_hole.sum() > 10


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


@pytest.mark.parametrize("exponent", [-330, -270, 330])
def test_scale_does_not_matter(exponent: int) -> None:
    """Distances from triangles have fourth powers of lengths in them."""
    rows = [t for a, b, c, d in SIDES for t in ((a, b, c), (a, c, d))]
    scale = 2.0**exponent
    one = lattice_points(Domain(CORNERS, rows), sizing.as_size(0.3))
    two = lattice_points(Domain(CORNERS * scale, rows), sizing.as_size(0.3 * scale))
    assert (two.inside == one.inside * scale).all() and (two.outside == one.outside * scale).all()
