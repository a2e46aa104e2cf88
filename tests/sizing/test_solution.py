"""Sizes from errors and from second derivatives."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import unstruct
from unstruct import InputError, Mesh, MeshError
from unstruct.sizing import from_error, from_hessian, hessian, mesh_size, to_vertices

RNG = np.random.default_rng(11)
MESH = unstruct.delaunay(RNG.random((80, 2)))
SQUARE = unstruct.delaunay([[0, 0], [1, 0], [1, 1], [0, 1]])


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(8, 60), st.sampled_from([1.0, 1e-5, 1e6]))
def test_second_derivatives_of_quadratics_are_exact(seed: int, many: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    points = rng.random((many, 2)) * scale + rng.normal(size=2) * scale
    a, b, c, d, e, f = rng.normal(size=6)
    x, y = points.T / scale
    found = hessian(unstruct.delaunay(points), a * x * x + b * x * y + c * y * y + d * x + e * y + f)
    assert np.allclose(found * scale**2, [[2 * a, b], [b, 2 * c]], atol=1e-4)


def test_second_derivatives_converge() -> None:
    errors = []
    for k in (11, 21, 41):
        side = np.linspace(0, 1, k)
        points = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
        inner = ((points > 0) & (points < 1)).all(axis=1)
        points[inner] += 0.3 / k * (RNG.random((inner.sum(), 2)) - 0.5)
        x, y = points.T
        u = np.sin(3 * x) * np.exp(y)
        true = np.array([[-9 * u, 3 * np.cos(3 * x) * np.exp(y)], [3 * np.cos(3 * x) * np.exp(y), u]])
        miss = np.abs(hessian(unstruct.delaunay(points), u) - np.moveaxis(true, -1, 0)).max(axis=(1, 2))
        errors.append(miss.max())
        deep = (np.abs(points - 0.5) < 0.3).all(axis=1)
        assert miss[deep].max() < 0.25 * miss.max()
    assert errors[1] < 0.6 * errors[0] and errors[2] < 0.6 * errors[1]  # at the boundary the worst


def test_patches_grow_until_they_suffice() -> None:
    strip = Mesh(
        [[i / 2, i % 2] for i in range(9)], [[i, i + 1, i + 2][:: 1 if i % 2 else -1] for i in range(7)]
    )
    x, y = strip.points.T  # two rows of vertices: y * y cannot be told from y
    with pytest.raises(MeshError, match="vertex 0 for second derivatives"):
        hessian(strip, x * y)
    with pytest.raises(MeshError, match="too few vertices"):
        hessian(SQUARE, np.ones(4))
    six = [[0, 0], [1, 0], [0, 1], [2, 2], [3, 1], [1, 3], [0, 0]]
    mesh = unstruct.delaunay(six)
    found = hessian(mesh, np.array([p[0] * p[1] for p in six]))
    assert np.allclose(found[:6], [[0, 1], [1, 0]]) and (found[6] == 0).all()  # 6 is a duplicate, in no cell


def test_the_size_for_an_interpolation_error() -> None:
    """On an equilateral triangle of the returned size the error is the wanted one: attained at the center."""
    curved, error = 7.0, 0.01
    field = from_hessian(
        MESH, np.broadcast_to(np.diag([curved, curved]), (80, 2, 2)), error, lower=1e-9, upper=1.0
    )
    h = field([[0.5, 0.5]])[0]
    corners = h * np.array([[0, 0], [1, 0], [0.5, math.sqrt(0.75)]])
    weights = RNG.dirichlet([1, 1, 1], 40000)
    x = weights @ corners
    miss = np.abs(curved / 2 * (x**2).sum(axis=1) - weights @ (curved / 2 * (corners**2).sum(axis=1)))
    assert 0.995 * error < miss.max() <= error * (1 + 1e-9)


def test_the_size_looks_at_the_steepest_direction_and_keeps_its_bounds() -> None:
    second = np.zeros((80, 2, 2))
    second[:40] = [[0, 5], [5, 0]]  # eigenvalues 5 and -5
    second[40:60] = [[-1e6, 0], [0, 0]]
    field = from_hessian(MESH, second, 0.001, lower=0.001, upper=0.2)
    assert np.allclose(field.values[:40], math.sqrt(6 * 0.001 / 5))
    assert (field.values[40:60] == 0.001).all() and (field.values[60:] == 0.2).all()


def test_sizes_from_errors() -> None:
    own = mesh_size(MESH)
    error = np.full(80, 0.01)
    assert np.allclose(from_error(MESH, error, 0.01).values, own)
    assert np.allclose(from_error(MESH, error, 0.005).values, own / math.sqrt(2))
    assert np.allclose(from_error(MESH, error, 0.005, order=1).values, own / 2)
    assert np.allclose(from_error(MESH, error, 1e-9, finer=3).values, own / 3)
    assert np.allclose(from_error(MESH, 0 * error, 0.01, coarser=1.5).values, own * 1.5)
    cells = RNG.random(MESH.size)
    by_cell, at = from_error(MESH, cells, 0.3), np.zeros(80)
    np.maximum.at(at, MESH.simplices, cells[:, None])
    assert np.allclose(by_cell.values, from_error(MESH, at, 0.3).values)


def test_the_size_of_a_mesh() -> None:
    assert len(SQUARE.edges) == 5
    degree = np.bincount(SQUARE.edges.ravel())
    assert np.allclose(mesh_size(SQUARE), np.where(degree == 2, 1.0, (2 + math.sqrt(2)) / 3))
    double = unstruct.delaunay([[0, 0], [1, 0], [0, 1], [0, 0]])
    assert np.isnan(mesh_size(double)[3])


def test_to_vertices() -> None:
    mesh = Mesh([[0, 0], [1, 0], [0, 1], [3, 3], [7, 7]], [[0, 1, 2], [1, 3, 2]])
    areas = mesh.volumes
    mean = (areas[0] * 1 + areas[1] * 4) / areas.sum()
    assert np.allclose(to_vertices(mesh, [1, 4]), [1, mean, mean, 4, np.nan], equal_nan=True)
    assert np.allclose(to_vertices(mesh, [1, 4], largest=True), [1, 4, 4, 4, np.nan], equal_nan=True)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: from_error(SQUARE, [0, 0, -1e-9, 0], 1), "-1e-09 at vertex 2; it must be finite"),
        (lambda: from_error(SQUARE, [0, math.nan, 0, 0], 1), "nan at vertex 1; it must be finite"),
        (lambda: from_error(SQUARE, [0, 0, 0], 1), r"vertex \(4,\) or per cell \(2,\)"),
        (lambda: from_error(SQUARE, np.ones(4), 0), "target"),
        (lambda: from_error(SQUARE, np.ones(4), 1, order=-1), "order"),
        (lambda: from_error(SQUARE, np.ones(4), 1, finer=0.5), "finer"),
        (lambda: from_error(SQUARE, np.ones(4), 1, coarser=math.inf), "coarser"),
        (lambda: hessian(SQUARE, [0, 0, math.inf, 0]), "vertex 2 is inf"),
        (lambda: hessian(SQUARE, [0, 0]), "one number per vertex"),
        (lambda: to_vertices(SQUARE, [0, 0, 0]), "one number per cell"),
        (lambda: from_hessian(SQUARE, np.zeros((4, 2)), 1, lower=1, upper=2), r"shape \(4, 2, 2\)"),
        (lambda: from_hessian(SQUARE, np.full((4, 2, 2), np.nan), 1, lower=1, upper=2), "at vertex 0"),
        (lambda: from_hessian(SQUARE, np.zeros((4, 2, 2)), -1, lower=1, upper=2), "error must be positive"),
        (lambda: from_hessian(SQUARE, np.zeros((4, 2, 2)), 1, lower=2, upper=1), "bounds"),
        (lambda: from_hessian(SQUARE, np.zeros((4, 2, 2)), 1, lower=0, upper=1), "bounds"),
    ],
)
def test_bad_input_is_named(call: object, words: str) -> None:
    with pytest.raises(InputError, match=words):
        call()


def test_foreign_meshes() -> None:
    shell = Mesh(np.eye(3), [[0, 1, 2]])
    for call in (lambda: hessian(shell, np.ones(3)), lambda: from_error(shell, np.ones(3), 1)):
        with pytest.raises(MeshError, match="triangles in the plane or tetrahedra in space"):
            call()


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(16, 60), st.sampled_from([1.0, 1e-5, 1e6]))
def test_quadratics_in_space_are_exact(seed: int, many: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    points = (rng.random((many, 3)) + rng.normal(size=3)) * scale
    second = rng.normal(size=(3, 3))
    second += second.T
    x = points / scale
    u = np.einsum("ni,ij,nj->n", x, second, x) / 2 + x @ rng.normal(size=3)
    found = hessian(unstruct.delaunay(points), u)
    assert np.allclose(found * scale**2, second, atol=1e-4)


def test_sizes_from_a_solution_in_space() -> None:
    """The bound of the error is attained at the center of a regular tetrahedron."""
    corners = np.array([[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]])
    one = Mesh(corners, [[0, 1, 3, 2]])
    h, k = np.sqrt(8.0), 3.0
    error = k * 3.0 / 2  # of k |x|^2 / 2, whose interpolant is k |corner|^2 / 2 = 3 k / 2 everywhere
    second = np.broadcast_to(k * np.eye(3), (4, 3, 3))
    assert from_hessian(one, second, error, lower=0.1, upper=9).values == pytest.approx(np.full(4, h))
    mesh = unstruct.delaunay(RNG.random((200, 3)))
    u = np.tanh(20 * (mesh.points[:, 0] - 0.5))
    size = from_hessian(mesh, hessian(mesh, u), 0.02, lower=0.03, upper=0.4)
    near, far = size([[0.45, 0.5, 0.5]])[0], size([[0.95, 0.5, 0.5]])[0]
    assert 0.03 <= near < 0.9 * far
    finer = from_error(mesh, np.full(mesh.size, 4.0), 1.0)
    assert finer.values == pytest.approx(mesh_size(mesh) / 2)
