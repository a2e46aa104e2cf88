"""Curvatures of surfaces that are known, with the stated orders, and Gauss and Bonnet's sum."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from surface_shapes import bipyramid, cylinder, icosphere, random_surface, saddle, torus

from unstruct.base.errors import InputError, MeshError
from unstruct.connect.surface.curvature import curvature
from unstruct.mesh.mesh import Mesh


def falls(errors, order):
    """Each error is at most about 2^-order times the one before."""
    return all(b < 1.25 * a * 2.0**-order or b < 1e-9 for a, b in pairwise(errors))


def on_torus(mesh):
    x, y, _ = mesh.points.T
    far = np.sqrt(x * x + y * y)
    return np.stack([np.full(len(far), 2.5), (far - 1) / 0.4 / far], axis=1), np.stack(
        [-y, x, 0 * x], axis=1
    ) / far[:, None]


def test_spheres():
    found = [curvature(icosphere(level)) for level in (2, 3, 4)]
    for name in ("gaussian", "mean", "principal"):
        assert falls([np.abs(getattr(f, name) - 1).max() for f in found], 1.9)
    mesh = icosphere(3)
    assert np.abs(found[1].normals - mesh.points).max() < 0.01
    assert np.abs(curvature(mesh, weights="area").normals - mesh.points).max() < 0.02
    half = curvature(Mesh(mesh.points * 2, mesh.simplices))
    assert np.allclose(half.principal * 2, found[1].principal) and np.allclose(
        half.gaussian * 4, found[1].gaussian
    )
    inward = curvature(Mesh(mesh.points, mesh.simplices[:, ::-1]))
    assert np.allclose(inward.mean, -found[1].mean) and np.allclose(inward.gaussian, found[1].gaussian)


def test_tori():
    errors = []
    for n in (16, 32, 64):
        mesh = torus(2 * n, n)
        found = curvature(mesh)
        k, along = on_torus(mesh)
        slope = np.abs((found.directions[:, 0] * along).sum(axis=1)).max()
        mean, gauss = k.mean(axis=1), k.prod(axis=1)
        errors.append([
            np.abs(found.principal - k).max(), np.abs(found.mean - mean).max(),
            np.abs(found.gaussian - gauss).max(), slope,
        ])  # fmt: skip
    for column in np.array(errors).T:
        assert falls(column, 1.85)


def test_cylinder_and_saddle():
    errors = []
    for n in (16, 32, 64):
        mesh = cylinder(n, n // 2)
        found = curvature(mesh)
        inner = ~found.boundary
        assert np.abs(found.gaussian[inner]).max() < 1e-9 * n * n
        assert np.abs(np.abs(found.directions[:, 1, 2]) - 1).max() < 0.05
        errors.append([np.abs(found.mean[inner] - 0.5).max(), np.abs(found.principal - [1, 0])[inner].max()])
        bowl = saddle(n)
        x, y, _ = bowl.points.T
        bent = curvature(bowl)
        true = -1 / (1 + x * x + y * y) ** 2
        errors[-1] += [np.abs(bent.gaussian - true)[~bent.boundary].max()]
        errors[-1] += [np.sqrt(np.abs(bent.gaussian - true)[bent.boundary].max())]  # of first order
    assert found.boundary.sum() == 2 * 64
    errors = np.array(errors)
    assert falls(errors[:, 0], 1.9) and falls(errors[:, 1], 1.9) and falls(errors[:, 2], 1.7)
    assert falls(errors[:, 3] ** 2, 0.9)


def test_irregular_vertices_exactly_on_a_sphere():
    errors = []
    for level in (3, 4, 5):
        mesh = icosphere(level)
        x = (
            mesh.points
            + 0.25 * 0.5**level * np.random.default_rng(0).standard_normal(mesh.points.shape) * 0.5
        )
        x /= np.sqrt((x**2).sum(axis=1))[:, None]
        errors.append(np.abs(curvature(Mesh(x, mesh.simplices)).principal - 1).max())
    assert falls(errors, 0.9)


@given(st.integers(0, 100_000))
@settings(max_examples=40, deadline=None)
def test_sums_and_frames(seed):
    mesh = random_surface(seed)
    found = curvature(mesh)
    size = np.cross(*(mesh.corners[:, k] - mesh.corners[:, 0] for k in (1, 2)))
    assert found.areas.sum() == pytest.approx(np.sqrt((size**2).sum(axis=1)).sum() / 2, rel=1e-9)
    assert (found.areas > 0).all()
    if not found.boundary.any():  # Gauss and Bonnet
        total = (found.gaussian * found.areas)[found.areas > 0].sum()
        assert total == pytest.approx(2 * np.pi * mesh.euler_characteristic, abs=1e-6)
    lengths = np.sqrt((found.normals**2).sum(axis=1))
    assert np.allclose(lengths[np.isfinite(lengths)], 1)
    good = np.isfinite(found.directions).all(axis=(1, 2))
    d = found.directions[good]
    assert np.allclose((d**2).sum(axis=2), 1) and np.allclose((d[:, 0] * d[:, 1]).sum(axis=1), 0, atol=1e-9)
    assert (found.principal[good, 0] >= found.principal[good, 1]).all()


def test_boundary_vertices_and_few_neighbors():
    found = curvature(bipyramid(4, 1.0, 1.0))
    assert not found.boundary.any() and np.isfinite(found.gaussian).all()
    one = curvature(Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (5, 5, 5)], [(0, 1, 2)]))
    assert one.boundary.tolist() == [True, True, True, False]
    assert np.isnan(one.principal).all() and np.allclose(one.normals[:3], [0, 0, 1])
    assert np.isnan(one.normals[3]).all()


def test_errors():
    with pytest.raises(InputError, match="weights must be"):
        curvature(icosphere(0), weights="size")
    with pytest.raises(InputError, match="Mesh of triangles in space"):
        curvature(None)
    rows = icosphere(0).simplices.copy()
    rows[0] = rows[0, ::-1]
    with pytest.raises(MeshError, match="opposite directions"):
        curvature(Mesh(icosphere(0).points, rows))


def test_triangles_of_a_file_of_stl():
    """Each triangle has corners of its own, so all values were nan without a word."""
    mesh = icosphere(1)
    soup = Mesh(mesh.points[mesh.simplices].reshape(-1, 3), np.arange(3 * mesh.size).reshape(-1, 3))
    with pytest.raises(MeshError, match="merge equal points"):
        curvature(soup)


@pytest.mark.parametrize("scale", [1e170, 1e-170])
@pytest.mark.filterwarnings("error")
def test_coordinates_whose_squares_no_double_can_hold(scale):
    mesh = icosphere(2)
    found = curvature(Mesh(mesh.points * scale, mesh.simplices))
    assert np.allclose(found.mean * scale, curvature(mesh).mean)
    assert (found.areas == (np.inf if scale > 1.0 else 0.0)).all()
