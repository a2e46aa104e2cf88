"""The running region is a simple region at every spacing, and its points are what they claim to be."""

from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from scipy.spatial import Delaunay, cKDTree

from unstruct.base.errors import UnstructError
from unstruct.examples.running import inside_polygon, running_points, running_region, running_size
from unstruct.plain.predicates import orient


def meet(a, b, c, d):
    """Whether the closed segments ab and cd share a point (exact; no three collinear unless they touch)."""
    return (
        orient([a, b, c]) * orient([a, b, d]) <= 0
        and orient([c, d, a]) * orient([c, d, b]) <= 0
        and max(min(a[0], b[0]), min(c[0], d[0])) <= min(max(a[0], b[0]), max(c[0], d[0]))
    )


@pytest.mark.parametrize("spacing", [0.4, 0.31, 0.2, 0.1, running_size])
def test_region_is_simple_and_has_one_hole(spacing):
    points, segments = running_region(spacing)
    assert points.shape == (len(segments), 2) and segments.dtype == np.int32
    assert (np.bincount(segments.ravel()) == 2).all()
    assert (points >= 0).all() and (points <= [3, 2]).all()
    exact = [tuple(map(Fraction, p)) for p in points.tolist()]
    for s, t in combinations(segments.tolist(), 2):
        if not set(s) & set(t):
            assert not meet(*(exact[v] for v in s), *(exact[v] for v in t))
    x, y = points[segments].transpose(2, 1, 0)
    cross = x[0] * y[1] - x[1] * y[0]
    split = int(np.nonzero(segments[:, 1] < segments[:, 0])[0][0]) + 1
    assert cross[:split].sum() > 0 > cross[split:].sum()  # shore counterclockwise, island clockwise


@pytest.mark.parametrize("spacing", [0.3, 0.1, 0.03, 0.01])
def test_spacing_is_met(spacing):
    points, segments = running_region(spacing)
    length = np.linalg.norm(np.diff(points[segments], axis=1)[:, 0], axis=1)
    assert length.max() < 1.05 * spacing and np.median(length) > 0.9 * spacing


def test_coarse_boundary_is_not_conforming_and_a_fine_one_is():
    missing = []
    for spacing in (0.3, 0.15, 0.1):
        points, segments = running_region(spacing)
        cells = Delaunay(points).simplices
        edges = {frozenset(e) for t in cells.tolist() for e in combinations(t, 2)}
        missing.append(sum(frozenset(s) not in edges for s in segments.tolist()))
    assert missing[0] > 0 and missing[1] > 0 and missing[2] == 0, missing


def test_size_is_a_function_of_points():
    assert running_size([2.1, 0.82]) == 0.03
    assert running_size(np.zeros((4, 5, 2))).shape == (4, 5)
    x = np.random.default_rng(1).random((2, 500, 2)) * 3
    slope = np.abs(np.diff(running_size(x), axis=0)[0]) / np.linalg.norm(x[0] - x[1], axis=1)
    assert slope.max() <= 0.12 + 1e-12


@pytest.mark.parametrize("seed", [0, 7])
def test_points_are_graded_blue_noise(seed):
    points = running_points(seed)
    boundary, segments = running_region(running_size)
    n = len(boundary)
    assert (points[:n] == boundary).all() and (points == running_points(seed)).all()
    inner = points[n:]
    assert inside_polygon(inner, boundary, segments).all()
    gaps, _ = cKDTree(points).query(inner, k=2)
    ratio = gaps[:, 1] / running_size(inner)
    assert ratio.min() > 0.65 and np.median(ratio) < 1.0
    rng = np.random.default_rng(seed)
    probe = rng.random((4000, 2)) * [3, 2]
    probe = probe[inside_polygon(probe, boundary, segments)]
    far, _ = cKDTree(points).query(probe)
    assert (far / running_size(probe)).max() < 1.0


def test_scale_multiplies_the_number_of_points():
    assert 3 < len(running_points(0, scale=0.5)) / len(running_points(0)) < 4.5


@pytest.mark.parametrize("spacing", [0, -1, float("nan"), 0.5, lambda x: 0 * x[:, 0]])
def test_bad_spacing(spacing):
    with pytest.raises(UnstructError, match="spacing"):
        running_region(spacing)


@pytest.mark.parametrize("scale", [0, -1, float("nan")])
def test_bad_scale(scale):
    with pytest.raises(UnstructError, match="scale"):
        running_points(scale=scale)
