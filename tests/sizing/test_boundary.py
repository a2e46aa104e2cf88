"""Local feature size and curvature, over exhaustive pairs and known shapes."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import InputError
from unstruct.domain.domain import Domain
from unstruct.geometry.curves import Arc
from unstruct.sizing import FeatureSize, from_curvature, from_features, local_feature_size


def star(seed: int, corners: int = 9) -> np.ndarray:
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.random(corners) + np.arange(corners)) * 2 * np.pi / (corners + 1)
    radius = rng.uniform(0.2, 2.0, corners)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def to_segment(p: np.ndarray, a: np.ndarray, b: np.ndarray) -> float:
    t = np.dot(p - a, b - a) / np.dot(b - a, b - a)
    return math.dist(p, a + min(max(t, 0.0), 1.0) * (b - a))


def exhaustive(points: np.ndarray, segments: list, x: np.ndarray) -> float:
    """Ruppert's definition: over all pairs of disjoint features, the larger of the two distances."""
    features = [({i}, math.dist(x, points[i])) for i in range(len(points))]
    features += [({i, j}, to_segment(x, points[i], points[j])) for i, j in segments]
    return min(max(d, e) for (a, d), (b, e) in combinations(features, 2) if not a & b)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1.0, 1e-6, 1e8]))
def test_polygons_have_ruppert_s_local_feature_size(seed: int, scale: float) -> None:
    corners = star(seed) * scale
    segments = [(i, (i + 1) % len(corners)) for i in range(len(corners))]
    x = np.random.default_rng(seed).normal(size=(12, 2)) * scale
    x[:3] = corners[:3]
    wanted = [exhaustive(corners, segments, p) for p in x]
    assert np.allclose(local_feature_size(Domain.polygon(corners), x), wanted, rtol=1e-10)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_it_is_lipschitz(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for domain in (Domain.polygon(star(seed)), Domain.disc()):
        feature = FeatureSize(domain)
        a, b = rng.normal(size=(2, 40, 2))
        b[:20] = a[:20] + 0.01 * rng.normal(size=(20, 2))
        bound = np.hypot(*(a - b).T)
        assert (np.abs(feature(a) - feature(b)) <= bound * (1 + 1e-9) + 1e-12).all()
        assert (feature(a) > 0).all()


def test_sharp_corners_count_as_ruppert_counts_them() -> None:
    wedge = Domain.polygon([(0, 0), (4, 0), (4, 0.1)])  # an angle of 1.4 degrees
    size = local_feature_size(wedge, [[0, 0], [1, 0], [3.9, 0.05]])
    assert np.allclose(size, [4.0, 3.0, math.dist((3.9, 0.05), (4, 0))])


def test_inner_pieces_and_loose_points_are_features() -> None:
    corners = [(0, 0), (4, 0), (4, 4), (0, 4)]
    plain = Domain.polygon(corners)
    crack = Domain([*corners, (1, 2), (3, 2)], plain.facets, inner=[(4, 5)])
    assert np.allclose(local_feature_size(plain, [[2, 2]]), 2.0)
    assert np.allclose(local_feature_size(crack, [[2, 2], [2, 1]]), [1.0, 1.0])
    loose = Domain([*corners, (2, 2), (2.5, 2)], plain.facets)
    assert np.allclose(local_feature_size(loose, [[2, 2], [2.25, 2]]), [0.5, 0.25])


def test_a_circle_is_no_feature_of_itself_for_a_quarter() -> None:
    """In whichever way a circle is cut into arcs, its middle has the radius, and it does not fall to zero."""
    for arcs in (2, 3, 4):
        angle = 2 * np.pi * np.arange(arcs) / arcs
        corners = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        curves = {i: Arc((0, 0), 1.0, angle[i], 2 * np.pi / arcs) for i in range(arcs)}
        circle = Domain(corners, [(i, (i + 1) % arcs) for i in range(arcs)], curves=curves)
        rim = np.linspace(0, 2 * np.pi, 200)
        size = local_feature_size(circle, [[0, 0], *np.stack([np.cos(rim), np.sin(rim)], axis=1)])
        assert abs(size[0] - 1) < 2e-3 and 0.7 < size[1:].min() <= size[1:].max() < 1.5
    assert np.isclose(size[1], math.sqrt(2))  # at a vertex, of four: the next vertex


def test_a_curve_that_comes_back_is_a_feature_of_itself() -> None:
    """A horseshoe, drawn as one arc each side: across its gap the size is half the gap's width."""
    width, gap = 0.3, np.radians(10)
    outer = Arc((0, 0), 1.0, gap / 2, 2 * np.pi - gap)
    inner = Arc((0, 0), 1.0 - width, 2 * np.pi - gap / 2, gap - 2 * np.pi)
    a, b = np.array([math.cos(gap / 2), math.sin(gap / 2)]), np.array([math.cos(gap / 2), -math.sin(gap / 2)])
    shoe = Domain(
        [a, b, (1 - width) * b, (1 - width) * a],
        [(0, 1), (1, 2), (2, 3), (3, 0)],
        curves={0: outer, 2: inner},
    )
    assert abs(local_feature_size(shoe, [[-1 + width / 2, 0]])[0] - width / 2) < 1e-3
    middle = local_feature_size(shoe, [[0.95, 0]])[0]
    assert abs(middle - 0.95 * math.sin(gap / 2)) < 1e-3


def test_size_from_features() -> None:
    wedge = Domain.polygon([(0, 0), (4, 0), (4, 1), (0, 1)])
    x = np.random.default_rng(0).random((50, 2))
    feature = local_feature_size(wedge, x)
    assert np.allclose(from_features(wedge, 0.4)(x), 0.4 * feature)
    assert np.allclose(from_features(wedge, 0.4, far=0.25)(x), np.minimum(0.4 * feature, 0.25))
    assert from_features(wedge).table([0, 0], [4, 1], tolerance=0.05).error < 0.05
    for bad in (0.0, -1.0, math.nan):
        with pytest.raises(InputError, match="fraction"):
            from_features(wedge, bad)
        with pytest.raises(InputError, match="far"):
            from_features(wedge, far=bad)
    with pytest.raises(InputError, match=r"shape \(k, 2\)"):
        local_feature_size(wedge, [[1, 2, 3]])


@pytest.mark.parametrize("radius", [0.1, 1.0, 50.0])
def test_a_circle_gets_so_many_edges(radius: float) -> None:
    circle = Domain.disc((3, 4), radius)
    field = from_curvature(circle, 30, far=10 * radius, growth=0.25)
    angle = np.random.default_rng(1).random(50) * 2 * np.pi
    rim = np.stack([3 + radius * np.cos(angle), 4 + radius * np.sin(angle)], axis=1)
    wanted = 2 * np.pi * radius / 30
    assert np.allclose(field(rim), wanted, rtol=2e-3)
    assert np.isclose(field([[3, 4]])[0], wanted + 0.25 * radius, rtol=2e-3)
    assert np.allclose(from_curvature(circle, 30, far=0.5 * wanted)(rim), 0.5 * wanted)
    assert np.allclose(
        from_curvature(circle, 30, far=9 * wanted, lower=2 * wanted)(rim), 2 * wanted, rtol=2e-3
    )


def test_an_ellipse_by_its_formula() -> None:
    from unstruct.geometry.curves import Curve

    a, b = 3.0, 1.0
    halves = {
        i: Curve(lambda t: np.stack([a * np.cos(t), b * np.sin(t)], axis=-1), i * np.pi, (i + 1) * np.pi)
        for i in (0, 1)
    }
    ellipse = Domain([(a, 0), (-a, 0)], [(0, 1), (1, 0)], curves=halves)
    field = from_curvature(ellipse, 40, far=100.0, growth=1.0)
    t = np.random.default_rng(2).random(60) * 2 * np.pi
    curvature = a * b / ((a * np.sin(t)) ** 2 + (b * np.cos(t)) ** 2) ** 1.5
    x = np.stack([a * np.cos(t), b * np.sin(t)], axis=1)
    assert np.allclose(field(x), 2 * np.pi / 40 / curvature, rtol=0.1)  # one value for each step: blurred
    assert np.median(np.abs(field(x) * curvature * 40 / (2 * np.pi) - 1)) < 0.03


def test_straight_boundaries_have_no_curvature() -> None:
    assert from_curvature(Domain.rectangle(), 24, far=0.3).constant == 0.3
    for options in ({"per_turn": 0.0, "far": 1.0}, {"far": -1.0}, {"far": 1.0, "lower": math.nan}):
        with pytest.raises(InputError, match="must be positive"):
            from_curvature(Domain.disc(), **options)


def test_neither_the_order_of_points_nor_a_cut_off_changes_a_size() -> None:
    rng = np.random.default_rng(11)
    t = np.sort(rng.uniform(0, 2 * np.pi, 400))
    shore = (1 + 0.3 * np.sin(9 * t))[:, None] * np.column_stack([np.cos(t), np.sin(t)])
    feature = FeatureSize(Domain.polygon(shore, holes=[0.1 * shore[::20]]))
    x = rng.uniform(-1.5, 1.5, (500, 2))
    size = feature(x)
    order = np.lexsort((x[:, 1], np.round(4 * x[:, 0])))
    assert np.allclose(feature(x[order]), size[order], rtol=1e-11)
    cut = float(np.median(size))
    assert np.array_equal(np.isinf(feature(x, cut)), size > cut)
    assert np.allclose(feature(x, cut)[size <= cut], size[size <= cut], rtol=1e-11)
    with pytest.raises(InputError, match="shape"):
        feature([[1.0, 2.0, 3.0]])


def test_many_rough_pieces_are_no_fault_of_the_size(monkeypatch: pytest.MonkeyPatch) -> None:
    n = 500  # pieces, each of which asks for some samples of the size
    t = 2 * np.pi * np.arange(n) / n
    radius = 1 + 0.005 * np.random.default_rng(5).random(n)
    domain = Domain.polygon(radius[:, None] * np.column_stack([np.cos(t), np.sin(t)]))
    monkeypatch.setattr("unstruct.domain.plane.by_size.STRETCH", 1000)  # as if a thousand times as many
    sampled = domain.sampled(from_features(domain, 0.5))
    assert 2 * n < len(sampled.ends) < 10 * n
    monkeypatch.setattr("unstruct.domain.plane.by_size.STRETCH_SHARE", 1)
    with pytest.raises(InputError, match="too small or too rough"):
        domain.sampled(from_features(domain, 0.5))
