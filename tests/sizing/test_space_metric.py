"""Metrics in space: by numpy's eigenvalues, refusals, intersections, tables, and how faces see them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import InputError, sizing
from unstruct.sizing.field import as_size
from unstruct.sizing.on_faces import on_plane, wanted_along, wanted_triangles
from unstruct.sizing.space_metric_table import factors_in_space
from unstruct.sizing.space_spectrum import ENTRY_OF_MATRIX


def frames(seed: int, count: int, decades: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Orthogonal directions, lengths, and the matrices of the metric, by numpy alone."""
    rng = np.random.default_rng(seed)
    d = np.linalg.qr(rng.normal(size=(count, 3, 3)))[0]
    h = 10 ** rng.uniform(-decades / 2, decades / 2, (count, 3))
    return d, h, np.einsum("kia,ki,kib->kab", d, h**-2.0, d)


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 10**6), decades=st.sampled_from([0.0, 1.0, 3.0]))
def test_lengths_and_directions(seed: int, decades: float) -> None:
    d, h, matrices = frames(seed, 20, decades)
    x, v = np.random.default_rng(seed).normal(size=(2, 20, 3))
    for metric in (
        sizing.SpaceMetric(lambda p: matrices),
        sizing.directional_space(lambda p: 3 * d, [lambda p, k=k: h[:, k] for k in range(3)]),
    ):
        assert metric.lengths(x) == pytest.approx(-np.sort(-h, axis=1), rel=1e-6)
        assert metric.at(x) == pytest.approx(matrices, rel=1e-6, abs=1e-6 * matrices.max())
        wanted = np.sqrt(np.einsum("ka,kab,kb->k", v, matrices, v))
        assert metric.length(x, v) == pytest.approx(wanted, rel=1e-6)
        assert metric.along(x, v) == pytest.approx(np.linalg.norm(v, axis=1) / wanted, rel=1e-6)
        for k in range(3):
            own = metric.directions(x)[:, k]
            assert metric.along(x, own) == pytest.approx(metric.lengths(x)[:, k], rel=1e-5)


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 10**6))
def test_intersection(seed: int) -> None:
    """Within both ellipsoids, and the largest such: in the common basis the shorter length is taken."""
    _, _, one = frames(seed, 10, 2.0)
    _, _, two = frames(seed + 1, 10, 2.0)
    x = np.zeros((10, 3))
    met = sizing.intersection_space(sizing.SpaceMetric(lambda p: one), sizing.SpaceMetric(lambda p: two))
    for k in range(10):
        low = np.linalg.cholesky(one[k])
        inverse = np.linalg.inv(low)
        values, basis = np.linalg.eigh(inverse @ two[k] @ inverse.T)
        root = low @ basis
        wanted = root @ np.diag(np.maximum(values, 1.0)) @ root.T
        assert met.at(x)[k] == pytest.approx(wanted, rel=1e-6, abs=1e-6 * wanted.max())


def test_constants() -> None:
    flat = sizing.directional_space(np.eye(3), [1, 1, 0.1])
    assert flat.constant is not None and "constant" in repr(flat)
    met = sizing.intersection_space(flat, 0.5)
    assert met.constant is not None
    assert met.lengths([[0, 0, 0]]) == pytest.approx(np.array([[0.5, 0.5, 0.1]]))
    assert sizing.intersection_space(flat) is flat
    assert len(flat.table([0, 0, 0], [1, 1, 1]).child) == 1


def test_table() -> None:
    """Lengths in all directions within what the table allows, where a layer follows a sphere."""

    def radial(x: np.ndarray) -> np.ndarray:
        d = x / np.linalg.norm(x, axis=1)[:, None]
        first = np.cross(d, [0.7, -0.5, 0.2])
        first /= np.linalg.norm(first, axis=1)[:, None]
        return np.stack([d, first, np.cross(d, first)], axis=1)

    thin = sizing.directional_space(radial, [lambda x: 0.05 + 0.1 * x[:, 0], 0.3, 0.3])
    table = thin.table([1, 1, 1], [2, 2, 3], factor=0.25)
    rng = np.random.default_rng(0)
    x, v = 1 + rng.random((500, 3)) * [1, 1, 2], rng.normal(size=(500, 3))
    l = np.empty((500, 6))
    factors_in_space(table, x * 0.25, l)
    lower = l[:, ENTRY_OF_MATRIX] * np.tri(3)
    image = np.linalg.solve(lower, v[:, :, None] * 0.25)[:, :, 0]
    assert np.linalg.norm(image, axis=1) == pytest.approx(thin.length(x, v), rel=0.12)
    marked = sizing.SpaceMetric(lambda x: np.tile(np.eye(3), (len(x), 1, 1)), landmarks=[[0.3, 0.3, 0.3]])
    assert len(marked.table([0, 0, 0], [1, 1, 1]).child) >= 585


@pytest.mark.parametrize(
    ("matrix", "words"),
    [
        (np.diag([1.0, 1.0, 0.0]), "positive definite"),
        (np.diag([1.0, -1.0, 1.0]), "positive definite"),
        (np.diag([1.0, np.nan, 1.0]), "positive definite and finite"),
        (np.eye(3) + np.array([[0, 0.1, 0], [0, 0, 0], [0, 0, 0]]), "symmetric"),
        (np.diag([1.0, 1.0, 1e12]), "ratio"),
        (np.eye(2), "shape"),
    ],
)
def test_wrong_matrices(matrix: np.ndarray, words: str) -> None:
    metric = sizing.SpaceMetric(lambda x: [matrix] * len(x))
    with pytest.raises(InputError, match=words):
        metric.lengths([[0, 0, 0], [1, 1, 1]])


def test_wrong_arguments() -> None:
    axes = np.eye(3)
    for wrong, words in (
        (lambda: sizing.SpaceMetric(3), "function"),  # type: ignore[arg-type]
        (lambda: sizing.SpaceMetric(lambda x: x, landmarks=[[0, 0]]), "landmarks"),
        (lambda: sizing.directional_space(axes, 0.1), "three sizes"),
        (lambda: sizing.directional_space(axes, [0.1, 0.2]), "three sizes"),
        (lambda: sizing.directional_space(axes[:2], [1, 1, 1]), "shape"),
        (lambda: sizing.directional_space([[1, 0, 0], [1, 1, 0], [0, 0, 1]], [1, 1, 1]), "orthogonal"),
        (lambda: sizing.directional_space([[1, 0, 0], [0, 0, 0], [0, 0, 1]], [1, 1, 1]), "none zero"),
        (lambda: sizing.directional_space(axes, [1, 1, 1e-7]), "ratio"),
        (lambda: sizing.directional_space(axes, [1, 1, lambda x: 0 * x[:, 0]]).lengths([[0, 0, 0]]), "0"),
        (lambda: sizing.directional_space(lambda x: x, [1, 1, 1]).lengths([[0, 0, 0]]), "shape"),
        (lambda: sizing.intersection_space(), "at least one"),
        (lambda: sizing.directional_space(axes, [1, 1, 1]).lengths([[0, 0]]), "shape"),
        (lambda: sizing.directional_space(axes, [1, 1, 1]).length([[0, 0, 0]], [[1, 1]]), "vectors"),
        (lambda: sizing.directional_space(axes, [1, 1, 1]).table([0, 0, 0], [1, 0, 1]), "box"),
    ):
        with pytest.raises(InputError, match=words):
            wrong()


def test_faces_see_the_metric() -> None:
    """On a turned plane: lengths of vectors in it, and areas, are those in space."""
    d, h, _ = frames(3, 1, 1.0)
    metric = sizing.directional_space(d[0], [*h[0, :2], lambda x: h[0, 2] * (1 + x[:, 0] ** 2)])
    frame, origin = (
        np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0][:2],
        np.array([0.1, 0.2, 0.3]),
    )
    rng = np.random.default_rng(2)
    y, w = rng.normal(size=(2, 20, 2))
    plane = on_plane(metric, origin, frame)
    assert plane.length(y, w) == pytest.approx(metric.length(origin + y @ frame, w @ frame), rel=1e-9)
    assert on_plane(as_size(0.3), origin, frame) == 0.3
    graded = as_size(lambda x: 1 + x[:, 2] ** 2)
    assert on_plane(graded, origin, frame)(y) == pytest.approx(graded(origin + y @ frame))
    assert wanted_along(graded, y @ frame, w @ frame) == pytest.approx(graded(y @ frame))
    corners = rng.normal(size=(20, 3, 3))
    root = np.linalg.cholesky(metric.at(corners.mean(axis=1))).swapaxes(1, 2)
    one, two = (np.einsum("kab,kb->ka", root, corners[:, j] - corners[:, 0]) for j in (1, 2))
    area = np.linalg.norm(np.cross(one, two), axis=1) / 2
    assert wanted_triangles(metric, corners, 1.0) == pytest.approx(area, rel=1e-6)
    same = sizing.directional_space(np.eye(3), [0.3] * 3)
    assert wanted_triangles(as_size(0.3), corners, 2.0) == pytest.approx(wanted_triangles(same, corners, 1.0))


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("scale", (1e-300, 1e-200, 1.0, 1e200, 1e300))
def test_long_and_short_vectors(scale: float) -> None:
    """Squares of vectors are no doubles here: lengths were infinite or zero, and sizes NaN."""
    x, v = np.zeros((2, 3)), np.array([[1.0, 2.0, 2.0], [0.0, 0.0, 0.0]])
    metric = sizing.directional_space(np.eye(3), [0.5, 0.2, 0.1])
    np.testing.assert_allclose(metric.length(x, v * scale), metric.length(x, v) * scale, rtol=1e-14)
    one = v[:1]
    np.testing.assert_allclose(metric.along(x[:1], one * scale), metric.along(x[:1], one), rtol=1e-14)
    assert metric.length(x, v)[1] == 0.0


@pytest.mark.parametrize("wrong", (0.0, np.nan, np.inf))
def test_no_length_is_wanted_in_no_direction(wrong: float) -> None:
    space = sizing.directional_space(np.eye(3), [1, 0.5, 0.1])
    with pytest.raises(InputError, match=r"direction\[1\] = .* finite, and not zero"):
        space.along(np.zeros((2, 3)), [[1, 0, 0], [0, 0, wrong]])
    assert wanted_along(space, np.zeros((1, 3)), np.zeros((1, 3))) == 1.0
    plane = sizing.Metric(lambda x: np.tile(np.eye(2), (len(x), 1, 1)))
    with pytest.raises(InputError, match=r"direction\[1\] = .* finite, and not zero"):
        plane.along(np.zeros((2, 2)), [[1, 0], [0, wrong]])


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("dimension", (2, 3))
@pytest.mark.parametrize("entry", (1e-300, 1e300, 1.7e308))
def test_metrics_beyond_all_lengths_are_refused(dimension: int, entry: float) -> None:
    make: Any = sizing.Metric if dimension == 2 else sizing.SpaceMetric
    for matrix in (np.eye(dimension) * entry, np.full((dimension, dimension), entry)):
        metric = make(lambda x, matrix=matrix: np.tile(matrix, (len(x), 1, 1)))
        x = np.ones((1, dimension))
        for asked in (metric.lengths, lambda x, m=metric: m.along(x, x), lambda x, m=metric: m.length(x, x)):
            with pytest.raises(InputError, match="metric is"):
                asked(x)
