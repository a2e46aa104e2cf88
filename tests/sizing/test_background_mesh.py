"""Background meshes and the limit on growth along their edges, over plain searches."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import unstruct
from unstruct import InputError, Mesh, MeshError
from unstruct.sizing import background, limit_nodes


def annulus() -> Mesh:
    """The square [0, 3]^2 without its middle ninth."""
    grid = np.stack(np.meshgrid(range(4), range(4)), axis=-1).reshape(-1, 2).astype(float)
    mesh = unstruct.delaunay(grid)
    centers = mesh.corners.mean(axis=1)
    return mesh.select(~((centers > 1) & (centers < 2)).all(axis=1))


def plain_interpolation(mesh: Mesh, values: np.ndarray, x: np.ndarray) -> float | None:
    p = [Fraction(float(v)) for v in x]
    for cell in mesh.simplices.tolist():
        a, b, c = ([Fraction(float(v)) for v in mesh.points[i]] for i in cell)

        def area(u: list, v: list, w: list) -> Fraction:
            return (v[0] - u[0]) * (w[1] - u[1]) - (v[1] - u[1]) * (w[0] - u[0])

        parts = [area(p, b, c), area(a, p, c), area(a, b, p)]
        if min(parts) >= 0:
            return float(sum(s * Fraction(float(values[i])) for s, i in zip(parts, cell)) / area(a, b, c))
    return None


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1.0, 1e-9, 1e9]))
def test_inside_it_interpolates(seed: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    mesh = unstruct.delaunay(rng.integers(0, 9, (14, 2)) * scale)
    values = (rng.random(len(mesh.points)) + 0.01) * scale
    field = background(mesh, values)
    x = rng.random((15, 2)) * 8 * scale
    wanted = [plain_interpolation(mesh, values, p) for p in x]
    inside = np.array([w is not None for w in wanted])
    assert np.allclose(field(x)[inside], [w for w in wanted if w is not None], rtol=1e-9)
    assert field.outside == (~inside).sum()
    used = np.unique(mesh.simplices)
    assert np.allclose(field(mesh.points[used]), values[used], rtol=1e-12)


def test_outside_the_nearest_point_of_the_boundary_counts() -> None:
    mesh = annulus()
    values = 1 + mesh.points[:, 0] + 0.1 * mesh.points[:, 1]
    field = background(mesh, values)
    x = np.random.default_rng(0).random((200, 2)) * 7 - 2
    t = np.linspace(0, 1, 2001)[:, None]
    edges = mesh.points[mesh.boundary]
    dense = np.concatenate([a + t * (b - a) for a, b in edges])
    outside = mesh.find_simplex(x) < 0
    nearest = dense[[np.argmin(((dense - p) ** 2).sum(axis=1)) for p in x]]
    away = np.where(outside[:, None], nearest, x)
    assert np.allclose(field(x), 1 + away[:, 0] + 0.1 * away[:, 1], atol=1e-3)
    assert field.outside == outside.sum() > 50
    assert (
        np.isclose(field([[1.5, 1.4]])[0], 1 + 1.5 + 0.1) and field.outside == outside.sum() + 1
    )  # in the hole
    field([[0.5, 0.5]])
    assert field.outside == outside.sum() + 1


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1.0, 1e-9, 1e9]))
def test_in_space(seed: int, scale: float) -> None:
    """Linear functions are met inside; outside counts the nearest point of the hull, here of a cube."""
    rng = np.random.default_rng(seed)
    corners = np.array(np.meshgrid(*3 * [[0.0, 8.0]])).reshape(3, -1).T
    mesh = unstruct.delaunay(np.concatenate([corners, rng.integers(1, 8, (12, 3))]) * scale)
    slope = rng.random(3)
    values = (1 + mesh.points @ slope / scale) * scale
    field = background(mesh, values)
    x = rng.uniform(-4, 12, (40, 3)) * scale
    assert np.allclose(field(x), (1 + np.clip(x / scale, 0, 8) @ slope) * scale, rtol=1e-9)
    outside = ((x < 0) | (x > 8 * scale)).any(axis=1)
    assert field.outside == outside.sum()
    used = np.unique(mesh.simplices)
    assert np.allclose(field(mesh.points[used]), values[used], rtol=1e-12)
    turned = Mesh(mesh.points, mesh.simplices[:, [1, 0, 2, 3]])
    assert np.allclose(background(turned, values)(x), field(x))


def test_limited_in_space() -> None:
    mesh = unstruct.delaunay(np.random.default_rng(1).random((60, 3)))
    values = np.where(np.arange(60) == 7, 0.01, 1.0)
    found = limit_nodes(mesh, values, 0.5)
    i, j = mesh.edges.T
    length = np.linalg.norm(mesh.points[i] - mesh.points[j], axis=1)
    assert (np.abs(found[i] - found[j]) <= 0.5 * length + 1e-12).all()
    assert found[7] == 0.01 and (found <= values).all()


def test_unused_vertices_and_pieces() -> None:
    mesh = unstruct.delaunay([[0, 0], [1, 0], [0, 1], [0, 0]])
    assert background(mesh, [0.1, 0.2, 0.3, math.nan])([[0, 0]]).tolist() == [0.1]
    two = Mesh([[0, 0], [1, 0], [0, 1], [5, 5], [6, 5], [5, 6]], [[0, 1, 2], [3, 4, 5]])
    field = background(two, [1, 1, 1, 2, 2, 2])
    assert field([[0.1, 0.1], [5.1, 5.1], [9, 9], [-1, -1]]).tolist() == [1, 2, 2, 1]
    turned = Mesh([[0, 0], [1, 0], [0, 1]], [[0, 2, 1]])
    assert background(turned, [1, 2, 3])([[0.5, 0]]).tolist() == [1.5]


def test_its_table() -> None:
    rng = np.random.default_rng(3)
    mesh = unstruct.delaunay(rng.random((200, 2)))
    field = background(mesh, limit_nodes(mesh, 0.01 + 0.3 * rng.random(200), 0.3))
    table = field.table([0, 0], [1, 1], tolerance=0.05)
    x = rng.random((5000, 2))
    assert np.quantile(np.abs(table(x) / field(x) - 1), 0.95) < 0.05
    assert np.abs(table(mesh.points) / field(mesh.points) - 1).max() <= max(0.05, table.error) * (1 + 1e-9)


SQUARE = unstruct.delaunay([[0, 0], [1, 0], [1, 1], [0, 1]])


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf])
def test_bad_values_are_named(bad: float) -> None:
    for call in (lambda v: background(SQUARE, v), lambda v: limit_nodes(SQUARE, v, 0.2)):
        with pytest.raises(InputError, match=r"at vertex 2, \[1.0, 1.0\]"):
            call([1, 1, bad, 1])


def test_bad_meshes() -> None:
    with pytest.raises(InputError, match=r"one size per vertex, shape \(4,\)"):
        background(SQUARE, [1, 1, 1])
    with pytest.raises(InputError, match="values must be real numbers"):
        background(SQUARE, ["a", "b", "c", "d"])
    with pytest.raises(MeshError, match="triangles in the plane or tetrahedra"):
        background(Mesh(np.eye(3), [[0, 1, 2]]), np.ones(3))
    with pytest.raises(MeshError, match="tetrahedron 0 of the background mesh is flat"):
        background(Mesh(np.eye(4)[:, :3] * [1, 1, 0], [[0, 1, 2, 3]]), np.ones(4))
    with pytest.raises(MeshError, match="at least one"):
        background(SQUARE.select([]), [])
    with pytest.raises(MeshError, match="triangle 1 of the background mesh is flat"):
        background(Mesh([[0, 0], [1, 0], [0, 1], [2, 0]], [[0, 1, 2], [0, 1, 3]]), np.ones(4))
    with pytest.raises(InputError, match="growth"):
        limit_nodes(SQUARE, np.ones(4), 0.0)


# ---------------------------------------------------------------------- the limit on growth


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.01, 3))
def test_limit_nodes_is_the_fixed_point_of_lowering_edges(seed: int, growth: float) -> None:
    rng = np.random.default_rng(seed)
    mesh = unstruct.delaunay(rng.random((30, 2)))
    values = 10.0 ** rng.uniform(-3, 1, 30)
    wanted = values.tolist()
    changed = True
    while changed:  # lower the upper end of a steep edge, until there is none
        changed = False
        for i, j in mesh.edges.tolist():
            for a, b in ((i, j), (j, i)):
                bound = wanted[b] + growth * math.dist(mesh.points[a], mesh.points[b])
                if wanted[a] > bound * (1 + 1e-14):
                    wanted[a], changed = bound, True
    result = limit_nodes(mesh, values, growth)
    assert np.allclose(result, wanted, rtol=1e-12) and (result <= values).all()
    assert np.allclose(limit_nodes(mesh, result, growth), result, rtol=1e-12)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_gradient_inside_triangles_is_bounded_by_the_largest_angle(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mesh = unstruct.delaunay(rng.random((40, 2)))
    h = limit_nodes(mesh, 10.0 ** rng.uniform(-3, 1, 40), 0.3)
    corners, values = mesh.corners, h[mesh.simplices]
    gradient = np.linalg.solve(corners[:, 1:] - corners[:, :1], (values[:, 1:] - values[:, :1])[..., None])[
        ..., 0
    ]
    bound = 0.3 / np.cos(np.radians(mesh.quality("max_angle")) / 2)
    assert (np.hypot(*gradient.T) <= bound * (1 + 1e-6)).all()


def test_that_bound_is_attained() -> None:
    mesh = Mesh([[0, 0], [1, 0], [0.5, math.sqrt(0.75)]], [[0, 1, 2]])
    h = limit_nodes(mesh, [0.1, 9, 9], 0.3)
    assert np.allclose(h, [0.1, 0.4, 0.4])  # gradient 0.3 / cos 30 degrees, along the bisector
    field = background(mesh, h)
    assert np.isclose(field([[0.75, math.sqrt(0.1875)]])[0], 0.4)
    assert np.isclose((0.4 - 0.1) / math.hypot(0.75, math.sqrt(0.1875)), 0.3 / math.cos(math.pi / 6))


def test_paths_go_round_holes() -> None:
    mesh = annulus()
    values = np.full(len(mesh.points), 9.0)
    values[np.argmin(np.hypot(*(mesh.points - [1, 1]).T))] = 0.1
    h = limit_nodes(mesh, values, 1.0)
    far = h[np.argmin(np.hypot(*(mesh.points - [2, 2]).T))]
    assert np.isclose(far, 0.1 + 2.0)  # not 0.1 + sqrt(2): the straight way lies in the hole
