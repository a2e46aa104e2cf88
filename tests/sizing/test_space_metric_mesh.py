"""Metrics at the vertices of meshes of tetrahedra: logarithms by numpy, growth by a slow sweep, Hessians."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import unstruct
from unstruct import Domain, InputError, MeshError, sizing


@pytest.fixture(scope="module")
def mesh() -> unstruct.Mesh:
    return unstruct.tetrahedralize(Domain.box(), 0.35)


def matrices(seed: int, count: int, decades: float) -> np.ndarray:
    """Random metrics whose lengths span so many decades."""
    rng = np.random.default_rng(seed)
    d = np.linalg.qr(rng.normal(size=(count, 3, 3)))[0]
    h = 10 ** rng.uniform(-decades, 0.0, (count, 3))
    return np.einsum("kia,ki,kib->kab", d, h**-2.0, d)


def powers(rows: np.ndarray, function: Any) -> np.ndarray:
    """A function of symmetric matrices, by numpy's eigenvalues."""
    values, vectors = np.linalg.eigh(rows)
    return np.einsum("kai,ki,kbi->kab", vectors, function(values), vectors)


@settings(deadline=None, max_examples=20)
@given(seed=st.integers(0, 10**6), decades=st.sampled_from([0.0, 1.0, 3.0]))
def test_logarithms_are_interpolated(seed: int, decades: float) -> None:
    """In random tetrahedra: exp of the mean of logarithms; lengths and ratios are within those at corners."""
    rng = np.random.default_rng(seed)
    cloud = unstruct.delaunay(rng.random((12, 3)))
    given_ = matrices(seed, 12, decades)
    metric = sizing.metric_background(cloud, given_)
    assert isinstance(metric, sizing.BackgroundSpaceMetric)
    cell = rng.integers(0, len(cloud.simplices), 30)
    weights = rng.dirichlet(np.ones(4), 30)
    rows = cloud.simplices[cell]
    x = np.einsum("kc,kcj->kj", weights, cloud.points[rows])
    mean = np.einsum("kc,kcab->kab", weights, powers(given_, np.log)[rows])
    true = powers(mean, np.exp)
    # x is rounded, and in a flat cell that moves the weights
    near = np.abs(np.linalg.det(cloud.points[rows[:, 1:]] - cloud.points[rows[:, :1]])) > 1e-4
    scale = np.abs(true).max(axis=(1, 2), keepdims=True)
    assert (np.abs(metric.at(x) - true)[near] <= 1e-6 * scale[near]).all()
    h, corners = metric.lengths(x), metric.lengths(cloud.points)[rows]
    slack = 1 + 1e-5
    assert (h[:, 2] * slack >= corners[:, :, 2].min(axis=1)).all()
    assert (h[:, 0] <= slack * corners[:, :, 0].max(axis=1)).all()
    ratios = (corners[:, :, 0] / corners[:, :, 2]).max(axis=1)
    assert (h[:, 0] / h[:, 2] <= slack * ratios).all()
    assert metric.outside == 0


def test_outside_it_is_that_of_the_nearest_boundary_point(mesh: unstruct.Mesh) -> None:
    metric = sizing.metric_background(mesh, matrices(3, len(mesh.points), 1.0))
    assert isinstance(metric, sizing.BackgroundSpaceMetric) and "tetrahedra" in repr(metric)
    inner = np.array([[1.0, 0.3, 0.4], [0.2, 0.0, 0.7]])
    outer = inner + np.array([[2.0, 0, 0], [0, -0.5, 0]])
    np.testing.assert_allclose(metric.at(outer), metric.at(inner), rtol=1e-6, atol=1e-6)
    assert metric.outside == 2


@pytest.mark.parametrize("space", ["metric", "space"])
def test_gradation_as_a_slow_sweep(mesh: unstruct.Mesh, space: str) -> None:
    """The same sweeps by numpy; then no edge asks for less, and nothing has become longer."""
    rng = np.random.default_rng(5)
    start = matrices(5, len(mesh.points), 0.3)
    start[rng.random(len(start)) < 0.2] *= 400.0
    found = sizing.gradation(sizing.metric_background(mesh, start), 0.4, space=space).values
    assert np.linalg.eigvalsh(found - start).min() >= -1e-6 * found.max()

    def grown(m: np.ndarray, v: np.ndarray) -> np.ndarray:
        if space == "metric":
            return m / (1 + 0.4 * np.sqrt(v @ m @ v)) ** 2
        return powers(m[None], lambda e: (e**-0.5 + 0.4 * np.linalg.norm(v)) ** -2.0)[0]

    slow = start.copy()
    edges = np.concatenate([mesh.edges[:, None], mesh.edges[:, None, ::-1]], axis=1)
    for sweep in range(50):
        before = slow.copy()
        for pair in edges[::-1] if sweep % 2 else edges:
            for i, j in pair:
                low = np.linalg.cholesky(slow[j])
                inverse = np.linalg.inv(low)
                values, basis = np.linalg.eigh(
                    inverse @ grown(slow[i], mesh.points[j] - mesh.points[i]) @ inverse.T
                )
                if values.max() > 1 + 1e-9:
                    root = low @ basis
                    slow[j] = root @ np.diag(np.maximum(values, 1.0)) @ root.T
        if np.array_equal(before, slow):
            break
    scale = np.abs(slow).max(axis=(1, 2), keepdims=True)
    assert (np.abs(found - slow) <= 1e-5 * scale).all()
    for i, j in np.concatenate([mesh.edges, mesh.edges[:, ::-1]]):
        wanted = grown(found[i], mesh.points[j] - mesh.points[i])
        assert np.linalg.eigvalsh(found[j] - wanted).min() >= -1e-6 * np.abs(found[j]).max()


def test_gradation_of_sizes_is_that_of_limit_nodes(mesh: unstruct.Mesh) -> None:
    h = np.where(np.arange(len(mesh.points)) % 17 == 0, 0.01, 1.0)
    start = sizing.metric_background(mesh, np.eye(3) / h[:, None, None] ** 2)
    graded = sizing.gradation(start, 0.3, space="space")
    np.testing.assert_allclose(graded.values[:, 0, 0] ** -0.5, sizing.limit_nodes(mesh, h, 0.3), rtol=1e-7)
    still = sizing.gradation(sizing.metric_background(mesh, matrices(0, 1, 2.0).repeat(len(h), 0)), 0.3)
    np.testing.assert_array_equal(still.values[0], still.values[-1])
    for wrong, words in (
        (lambda: sizing.gradation(start, 0), "growth"),
        (lambda: sizing.gradation(start, 0.3, space="plane"), "'space'"),
        (lambda: sizing.gradation(0.1, 0.3), "background"),  # type: ignore[arg-type]
    ):
        with pytest.raises(InputError, match=words):
            wrong()


def test_second_derivatives_give_the_error(mesh: unstruct.Mesh) -> None:
    """On a cell that is regular in the metric a quadratic function has the wanted error, and not less."""
    d = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    second = d.T @ np.diag([400.0, -25.0, 4.0]) @ d
    values = 0.5 * np.einsum("ni,ij,nj->n", mesh.points, second, mesh.points)
    found = sizing.hessian(mesh, values)
    metric = sizing.metric_from_hessian(mesh, found, 1e-3, lower=1e-3, upper=1.0)
    true = np.sqrt(16e-3 / 3 / np.array([4.0, 25.0, 400.0]))
    np.testing.assert_allclose(metric.lengths(mesh.points), np.tile(true, (len(mesh.points), 1)), rtol=1e-4)
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(8)
    corners = corners @ np.linalg.inv(np.linalg.cholesky(metric.at(mesh.points[:1])[0]))
    bary = np.random.default_rng(0).dirichlet(np.ones(4), 4000)
    convex = d.T @ np.diag([400.0, 25.0, 4.0]) @ d
    exact = 0.5 * np.einsum("ni,ij,nj->n", bary @ corners, convex, bary @ corners)
    at = 0.5 * np.einsum("ni,ij,nj->n", corners, convex, corners)
    assert 0.9e-3 < np.abs(exact - bary @ at).max() <= 1e-3 * (1 + 1e-4)
    flat = sizing.metric_from_hessian(mesh, 0 * found, 1e-3, lower=0.01, upper=0.3)
    np.testing.assert_allclose(flat.lengths(mesh.points), 0.3)
    thin = sizing.metric_from_hessian(mesh, found, 1e-3, lower=1e-3, upper=1.0, ratio=3)
    np.testing.assert_allclose(thin.lengths(mesh.points[:1])[0, [0, 2]], [3 * true[2], true[2]], rtol=1e-4)
    with pytest.raises(InputError, match="ratio"):
        sizing.metric_from_hessian(mesh, found, 1e-3, lower=1e-3, upper=1.0, ratio=1e6)


def test_wrong_meshes_and_matrices(mesh: unstruct.Mesh) -> None:
    bad = np.tile(np.eye(3), (len(mesh.points), 1, 1))
    bad[5, 0, 0] = -1.0
    surface = Domain.ball(size=0.6).surface
    for wrong, kind, words in (
        (lambda: sizing.metric_background(mesh, bad), InputError, r"x\[5\]"),
        (lambda: sizing.metric_background(mesh, np.eye(3)), InputError, "one matrix per vertex"),
        (lambda: sizing.metric_background(surface, bad), MeshError, "tetrahedra"),
        (
            lambda: sizing.metric_background(
                unstruct.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], [(0, 1, 2, 3)]), [np.eye(3)] * 4
            ),
            MeshError, "flat",
        ),
    ):  # fmt: skip
        with pytest.raises(kind, match=words):
            wrong()
