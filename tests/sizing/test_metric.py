"""Metrics: values against linear algebra, tables, meshes, second derivatives, gradation, and every error."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import unstruct
from unstruct import Domain, InputError, MeshError, sizing

SQUARE = Domain.polygon([(0, 0), (1, 0), (1, 1), (0, 1)])
ORIGIN = np.zeros((1, 2))


def matrix(angle: float, h: float, g: float) -> np.ndarray:
    """The metric with length h in this direction and g at right angles to it."""
    d = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return d.T @ np.diag([h**-2.0, g**-2.0]) @ d


def turning(x: np.ndarray) -> np.ndarray:
    return np.stack([np.cos(3 * x[:, 0]), np.sin(3 * x[:, 0])], axis=1)


@pytest.fixture(scope="module")
def mesh() -> unstruct.DomainMesh:
    return unstruct.voronoi_segment(SQUARE, 0.12)


# --- values ----------------------------------------------------------------------------------------


@given(st.floats(0, np.pi), st.floats(1e-3, 1e3), st.floats(1e-4, 1.0), st.floats(0, 7))
def test_lengths_and_matrices(angle: float, h: float, share: float, other: float) -> None:
    metric = sizing.directional([np.cos(angle), np.sin(angle)], h, h * share)
    true = matrix(angle, h, h * share)
    np.testing.assert_allclose(metric.at(ORIGIN)[0], true, rtol=1e-7, atol=1e-7 * np.abs(true).max())
    np.testing.assert_allclose(metric.lengths(ORIGIN)[0], [h, h * share], rtol=1e-6)
    v = np.array([[np.cos(other), np.sin(other)]])
    np.testing.assert_allclose(metric.length(ORIGIN, v)[0] ** 2, v[0] @ true @ v[0], rtol=1e-6)
    np.testing.assert_allclose(metric.along(ORIGIN, 5 * v) * metric.length(ORIGIN, v), 1.0, rtol=1e-12)
    if share < 0.9:
        d = metric.directions(ORIGIN)[0]
        assert abs(d[0] * np.sin(angle) - d[1] * np.cos(angle)) < 1e-6 and d[0] >= 0


def test_a_function_and_what_it_is_asked() -> None:
    metric = sizing.Metric(lambda x: np.array([matrix(3 * a, 0.5, 0.1) for a in x[:, 0]]))
    same = sizing.directional(turning, 0.5, 0.1)
    x = np.random.default_rng(1).random((50, 2))
    np.testing.assert_allclose(metric.at(x), same.at(x), rtol=1e-10, atol=1e-9)
    assert metric.constant is None and "function" in repr(metric)
    copy = pickle.loads(pickle.dumps(sizing.directional(turning, 0.5, 0.1)))
    np.testing.assert_array_equal(copy.at(x), same.at(x))


def test_a_size_is_a_metric() -> None:
    metric = sizing.as_metric(lambda x: 0.1 + x[:, 0])
    np.testing.assert_allclose(metric.lengths([[0.4, 0]]), [[0.5, 0.5]])
    constant = sizing.as_metric(0.25)
    assert constant.constant is not None and sizing.as_metric(constant) is constant
    np.testing.assert_allclose(constant.constant, np.eye(2) * 16)


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda x: np.tile(np.diag([1.0, -1.0]), (len(x), 1, 1)), r"x\[0\] = \[0.25, 0.5\].*positive"),
        (lambda x: np.where(x[:, :1, None] > 0.3, np.nan, np.eye(2)), r"x\[1\] = \[0.5, 0.5\].*finite"),
        (lambda x: np.tile([[1.0, 0.5], [0.0, 1.0]], (len(x), 1, 1)), "symmetric"),
        (lambda x: np.tile(np.diag([1.0, 1e14]), (len(x), 1, 1)), "ratio of its lengths"),
        (lambda x: np.tile([[1.0, 2.0], [2.0, 1.0]], (len(x), 1, 1)), "positive definite"),
        (lambda x: np.zeros((len(x), 2, 2)), "positive definite"),
        (lambda x: np.eye(2), r"shape \(2, 2, 2\)"),
        (lambda x: np.full((len(x), 2, 2), "a"), "real numbers"),
        (lambda x: 1 / 0, "ZeroDivisionError.*takes points"),
    ],
)
def test_errors_name_the_place(make: Any, text: str) -> None:
    with pytest.raises(InputError, match=text):
        sizing.Metric(make).at([[0.25, 0.5], [0.5, 0.5]])


def test_errors_of_directions() -> None:
    for direction, along, across, text in (
        ([0, 0], 1, 1, "direction is"), ([1, np.nan], 1, 1, "direction"), ([1, 0, 0], 1, 1, "shape"),
        ([1, 0], 1e7, 1, "ratio"), ([1, 0], 1e-160, 1e-160, "doubles"),
        ([1, 0], -1, 1, "positive"), (lambda x: x[:, 0], 1, 1, "shape"),
        ([1, 0], lambda x: x[:, 0] - 2, 1, "size must be positive"), (lambda x: x * 0, 1, 1, r"x\[0\]"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=text):
            sizing.directional(direction, along, across).at([[0.5, 0.5]])
    for wrong in (3.0, None):
        with pytest.raises(InputError, match="function of points"):
            sizing.Metric(wrong)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="of the plane"):
        sizing.as_metric(0.1).at([[0, 0, 0]])
    for method in (unstruct.voronoi_segment, unstruct.refine):
        with pytest.raises(InputError, match="number, a function of points or a SizeField"):
            method(SQUARE, size=sizing.as_metric(0.1))


# --- intersection ----------------------------------------------------------------------------------


@settings(max_examples=200)
@given(*[st.floats(0, np.pi), st.floats(0.1, 10), st.floats(1e-3, 1)] * 2)
def test_the_intersection_is_the_largest_within_both(a, h, r, b, g, s) -> None:  # type: ignore[no-untyped-def]
    one, two = matrix(a, h, h * r), matrix(b, g, g * s)
    metric = sizing.intersection(
        *[sizing.Metric(lambda x, m=m: np.tile(m, (len(x), 1, 1))) for m in (one, two)]
    )
    found = metric.at(ORIGIN)[0]
    root = np.linalg.cholesky(one)  # simultaneous reduction, by linear algebra
    inner = np.linalg.solve(root, np.linalg.solve(root, two).T)
    values, q = np.linalg.eigh((inner + inner.T) / 2)
    true = root @ q @ np.diag(np.maximum(values, 1)) @ q.T @ root.T
    np.testing.assert_allclose(found, true, rtol=1e-5, atol=1e-6 * np.abs(true).max())
    angle = np.linspace(0, np.pi, 60)
    v = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    for m in (one, two):
        assert (np.einsum("ki,ij,kj->k", v, found - m, v) >= -1e-6 * np.abs(found).max()).all()


def test_intersections_of_sizes_constants_and_many() -> None:
    metric = sizing.intersection(sizing.directional([1, 0], 1.0, 0.1), 0.3)
    np.testing.assert_allclose(metric.lengths(ORIGIN), [[0.3, 0.1]])
    assert metric.constant is not None
    assert sizing.intersection(metric) is metric
    three = sizing.intersection(0.3, lambda x: 0.2 + x[:, 0], metric)
    np.testing.assert_allclose(three.lengths([[0.0, 0], [1, 0]]), [[0.2, 0.1], [0.3, 0.1]])
    with pytest.raises(InputError, match="at least one"):
        sizing.intersection()


# --- tables ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("ratio", [1.0, 10.0, 100.0])
def test_the_table_has_the_wanted_error(ratio: float) -> None:
    metric = sizing.directional(turning, 0.2, 0.2 / ratio)
    table = metric.table([0, 0], [1, 1])
    assert len(table.nodes.child) < 10_000  # with inverse matrices it would be 200,000 for the largest ratio
    assert table.error <= 0.05 and table.capped == 0 and "leaves" in repr(table)
    x = np.random.default_rng(2).random((2000, 2))
    guess, true = table.inverses(x), metric.inverses(x)
    for rows in (guess, true):
        assert (rows[:, 0] * rows[:, 2] > rows[:, 1] ** 2).all()
    b = guess[:, [[0, 1], [1, 2]]]
    quotients = np.sqrt(np.linalg.eigvals(metric.at(x) @ b).real)
    assert np.abs(quotients - 1).max() < 0.08
    assert 0.9 < table.area() / (ratio / 0.04) < 1.1


def test_the_table_of_a_jump_stays_positive_definite() -> None:
    metric = sizing.directional(lambda x: np.where(x[:, :1] < 0.4, [[1.0, 0.1]], [[-0.3, 1.0]]), 0.5, 0.005)
    table = metric.table([0, 0], [1, 1], factor=0.25)
    assert table.capped > 0
    rows = table.inverses(np.random.default_rng(3).random((3000, 2)))
    small = np.linalg.eigvalsh(rows[:, [[0, 1], [1, 2]]])[:, 0]
    assert small.min() >= 0.005**2 * (1 - 1e-6)
    with pytest.raises(InputError, match="range of doubles"):
        metric.table([0, 0], [1, 1], factor=1e-200)
    with pytest.raises(InputError, match="shape"):
        table.inverses([[0, 0, 0]])


def test_landmarks_show_what_samples_miss() -> None:
    def across(x: np.ndarray) -> np.ndarray:
        return np.where(np.abs(x[:, 0] - 0.414) < 0.004, 0.002, 0.2)

    places = np.stack([np.full(50, 0.414), np.linspace(0, 1, 50)], axis=1)
    size = sizing.SizeField(across, landmarks=places)
    for metric in (sizing.directional([1, 0], size, 0.2), sizing.intersection(0.3, sizing.as_metric(size))):
        table = metric.table([0, 0], [1, 1])
        np.testing.assert_allclose(table.inverses(places)[:, 0], 4e-6, rtol=0.2)
    assert sizing.directional([1, 0], across, 0.2).table([0, 0], [1, 1]).inverses(places)[:, 0].min() > 1e-3


# --- meshes ----------------------------------------------------------------------------------------


def test_background(mesh: unstruct.DomainMesh) -> None:
    exact = sizing.directional(turning, 0.5, 0.02)
    metric = sizing.metric_background(mesh, exact.at(mesh.points))
    np.testing.assert_allclose(metric.at(mesh.points), exact.at(mesh.points), rtol=1e-7, atol=1e-5)
    assert set(map(tuple, metric.landmarks)) == set(map(tuple, mesh.points[np.unique(mesh.simplices)]))
    cell = mesh.simplices[7]
    middle = metric.inverses(mesh.points[cell].mean(axis=0)[None])[0]
    np.testing.assert_allclose(middle, exact.inverses(mesh.points[cell]).mean(axis=0), rtol=1e-10)
    assert metric.outside == 0
    np.testing.assert_allclose(metric.at([[-3, 0.0]]), metric.at([[0, 0.0]]), rtol=1e-9)
    assert metric.outside == 1 and "background" in repr(metric)
    bad = exact.at(mesh.points)
    bad[5] = [[1, 2], [2, 1]]
    with pytest.raises(InputError, match=r"x\[5\] = "):
        sizing.metric_background(mesh, bad)
    with pytest.raises(InputError, match="one matrix per vertex"):
        sizing.metric_background(mesh, np.eye(2))
    with pytest.raises(MeshError, match="triangles in the plane"):
        sizing.metric_background(unstruct.Domain.ball(size=0.9).surface, np.eye(2))


def test_second_derivatives_give_directions_lengths_and_the_error(mesh: unstruct.DomainMesh) -> None:
    second = matrix(0.5, 1 / 20, 1 / 2)  # eigenvalues 400 and 4
    values = 0.5 * np.einsum("ni,ij,nj->n", mesh.points, second, mesh.points)
    found = sizing.hessian(mesh, values)
    metric = sizing.metric_from_hessian(mesh, found, 1e-3, lower=1e-3, upper=1.0)
    true = np.sqrt(6e-3 / np.array([4, 400]))
    np.testing.assert_allclose(metric.lengths(mesh.points), np.tile(true, (len(mesh.points), 1)), rtol=1e-5)
    corners = np.array([[0, 0], [1, 0], [0.5, np.sqrt(0.75)]]) @ np.linalg.inv(
        np.linalg.cholesky(metric.values[0])
    )
    bary = np.random.default_rng(0).dirichlet(np.ones(3), 4000)
    x = bary @ corners
    exact = 0.5 * np.einsum("ni,ij,nj->n", x, second, x)
    at = 0.5 * np.einsum("ni,ij,nj->n", corners, second, corners)
    assert 0.9e-3 < np.abs(exact - bary @ at).max() <= 1e-3 * (1 + 1e-6)
    bounded = sizing.metric_from_hessian(mesh, found, 1e-3, lower=0.01, upper=0.03)
    np.testing.assert_allclose(bounded.lengths(ORIGIN), [[0.03, 0.01]], rtol=0.3)
    assert (
        sizing.metric_from_hessian(mesh, 0 * found, 1e-3, lower=0.01, upper=0.3).lengths(ORIGIN) == 0.3
    ).all()
    limited = sizing.metric_from_hessian(mesh, found, 1e-3, lower=1e-3, upper=1.0, ratio=3)
    np.testing.assert_allclose(limited.lengths(ORIGIN)[0], [3 * true[1], true[1]], rtol=1e-5)
    for change, text in (
        ({"error": 0}, "error"), ({"lower": 2.0}, "bounds"), ({"ratio": 0.5}, "ratio"),
        ({"ratio": 1e9}, "ratio"),
        ({"second": found[1:]}, "shape"), ({"second": np.where(found > 0, np.nan, found)}, "vertex 0"),
        ({"second": np.add(found, [[0.0, 1e-3], [0.0, 0.0]])}, "must be symmetric"),
    ):  # fmt: skip
        options: dict[str, Any] = {"second": found, "error": 1e-3, "lower": 0.01, "upper": 1.0} | change
        with pytest.raises(InputError, match=text):
            sizing.metric_from_hessian(mesh, **options)


@pytest.mark.parametrize("space", ["metric", "plane"])
def test_after_gradation_no_edge_asks_for_less(mesh: unstruct.DomainMesh, space: str) -> None:
    rng = np.random.default_rng(4)
    count = len(mesh.points)
    h = np.where(rng.random(count) < 0.05, 0.01, 1.0)
    start = np.array([matrix(*row) for row in zip(rng.random(count) * 3, h, h * 0.1)])
    metric = sizing.gradation(sizing.metric_background(mesh, start), 0.4, space=space)
    m = metric.values
    assert np.linalg.eigvalsh(m - start).min() >= -1e-6 * m.max()
    for i, j in np.concatenate([mesh.edges, mesh.edges[:, ::-1]]):
        v = mesh.points[j] - mesh.points[i]
        values, q = np.linalg.eigh(m[i])
        if space == "metric":
            grown = m[i] / (1 + 0.4 * np.sqrt(v @ m[i] @ v)) ** 2
        else:
            grown = q @ np.diag(values / (1 + 0.4 * np.linalg.norm(v) * np.sqrt(values)) ** 2) @ q.T
        assert np.linalg.eigvalsh(m[j] - grown).min() >= -1e-6 * np.abs(m[j]).max()


def test_gradation_of_sizes_is_that_of_limit_nodes(mesh: unstruct.DomainMesh) -> None:
    h = np.where(np.arange(len(mesh.points)) % 17 == 0, 0.01, 1.0)
    start = sizing.metric_background(mesh, np.eye(2) / h[:, None, None] ** 2)
    metric = sizing.gradation(start, 0.3, space="plane")
    np.testing.assert_allclose(metric.values[:, 0, 0] ** -0.5, sizing.limit_nodes(mesh, h, 0.3), rtol=1e-9)
    for args, text in (((start, 0), "growth"), ((0.1, 0.3), "background"), ((start, np.nan), "growth")):
        with pytest.raises(InputError, match=text):
            sizing.gradation(*args)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="space"):
        sizing.gradation(start, 0.3, space="other")
