"""Restricted Delaunay triangulations: dense samples give the surface, others something else."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from surface_shapes import icosphere, torus

from unstruct.base.errors import DegenerateInputError, InputError
from unstruct.connect.insertion.delaunay import delaunay
from unstruct.connect.surface.criteria import surface_criteria
from unstruct.connect.surface.crossing import dual_crossings, meets_exactly
from unstruct.connect.surface.density import feature_sizes, sampling_density
from unstruct.connect.surface.restricted import duals_of, restricted_delaunay
from unstruct.mesh.mesh import Mesh


def on_sphere(n, seed=0):
    x = np.random.default_rng(seed).standard_normal((n, 3))
    return x / np.sqrt((x**2).sum(axis=1))[:, None]


def ball(x):
    return (x**2).sum(axis=1) - 1.0


def ring(x):
    """A torus of radii 1 and 0.4, whose local feature size is 0.4 at least where it is outside."""
    return (np.sqrt(x[:, 0] ** 2 + x[:, 1] ** 2) - 1.0) ** 2 + x[:, 2] ** 2 - 0.16


def on_ring(n, seed=0):
    rng = np.random.default_rng(seed)
    u, v = 2 * np.pi * rng.random((2, 4 * n))
    keep = rng.random(4 * n) < (1 + 0.4 * np.cos(v)) / 1.4
    u, v = u[keep][:n], v[keep][:n]
    far = 1 + 0.4 * np.cos(v)
    return np.stack([far * np.cos(u), far * np.sin(u), 0.4 * np.sin(v)], axis=1)


def test_a_dense_sample_of_a_sphere():
    """All points on a sphere: the triangles are the faces of the convex hull."""
    x = on_sphere(300)
    found = restricted_delaunay(x, ball)
    assert found.manifold and found.euler_characteristic == 2 and found.components == 1
    hull = {tuple(sorted(row)) for row in delaunay(x).boundary.tolist()}
    assert {tuple(sorted(row)) for row in found.mesh.simplices.tolist()} == hull
    outward = np.cross(*(found.mesh.corners[:, k] - found.mesh.corners[:, 0] for k in (1, 2)))
    assert ((outward * found.mesh.corners[:, 0]).sum(axis=1) > 0).all()
    assert np.abs(ball(found.centers)).max() < 1e-9
    for center, radius in zip(found.centers, found.radii):
        assert np.sqrt(((x - center) ** 2).sum(axis=1)).min() > radius * (1 - 1e-9)


@pytest.mark.parametrize("exact", [False, True])
def test_a_dense_sample_of_a_torus(exact):
    x = on_ring(2500)
    found = restricted_delaunay(x, torus(80, 40) if exact else ring)
    assert found.manifold and found.euler_characteristic == 0 and found.components == 1
    assert "a closed surface" in str(found)
    if not exact:
        assert np.abs(ring(found.centers)).max() < 1e-9
    size = feature_sizes(x)
    assert 0.2 < np.median(size) < 0.45


def test_too_few_points_give_something_else():
    """Twenty points of a torus: seldom a torus, mostly no surface at all."""
    found = [restricted_delaunay(on_ring(20, seed), ring) for seed in range(8)]
    tori = [f.manifold and f.euler_characteristic == 0 for f in found]
    assert sum(tori) <= 2 and sum(not f.manifold for f in found) >= 4
    assert "no closed surface" in " ".join(map(str, found))
    assert sampling_density(on_ring(30), torus(60, 30), 0.4) > 1.0
    assert sampling_density(on_ring(2500), torus(60, 30), 0.4) < 0.45


def test_two_sheets_that_are_nearer_than_points():
    """Two spheres 0.05 apart with points 0.2 apart: dense for each sphere, but not for both."""
    outer = on_sphere(300)
    both = np.concatenate([outer, 0.95 * on_sphere(300, 1)])

    def shell(x):
        far = np.sqrt((x**2).sum(axis=1))
        return np.maximum(far - 1.0, 0.95 - far)

    found = restricted_delaunay(both, shell)
    assert not found.manifold
    assert (
        restricted_delaunay(
            np.concatenate([outer, 0.5 * on_sphere(200, 1)]),
            lambda x: np.maximum(np.sqrt((x**2).sum(axis=1)) - 1.0, 0.5 - np.sqrt((x**2).sum(axis=1))),
        ).components
        == 2
    )


def test_triangles_of_a_mesh_that_are_delaunay_are_found_again():
    mesh = icosphere(3)
    found = restricted_delaunay(mesh.points, mesh)
    assert surface_criteria(found.mesh).restricted.all()
    assert len(found.mesh.simplices) == len(mesh.simplices) and found.manifold


@given(st.integers(0, 10_000))
@settings(max_examples=20, deadline=None)
def test_crossings_by_fractions(seed):
    """Points and a surface of few bits: all pairs of Voronoi edges and triangles, compared."""
    rng = np.random.default_rng(seed)
    x = np.unique(rng.integers(-2, 3, (9, 3)), axis=0).astype(float)
    try:
        mesh = delaunay(x)
    except DegenerateInputError:
        return
    corner = rng.integers(-2, 3, (6, 3, 3)).astype(float)
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    corner = corner[(normal != 0).any(axis=1)]
    duals = duals_of(x, mesh, 100.0)
    tets = np.asarray(mesh.simplices)
    pairs = np.array([(f, t) for f in range(len(duals.start)) for t in range(len(corner))]).reshape(-1, 2)
    wanted = pairs[meets_exactly(x, tets, duals, corner, pairs)]
    assert dual_crossings(x, tets, duals, corner).tolist() == wanted.tolist()


def test_errors():
    x = on_sphere(20)
    with pytest.raises(InputError, match="rows of three"):
        restricted_delaunay(x[:, :2], ball)
    with pytest.raises(InputError, match="surface must be"):
        restricted_delaunay(x, 3)
    with pytest.raises(InputError, match="function surface returned nan at"):
        restricted_delaunay(icosphere(1).points, lambda x: np.full(len(x), np.nan))
    with pytest.raises(InputError, match="one number for each"):
        restricted_delaunay(x, lambda p: p)
    with pytest.raises(InputError, match="function surface raised ZeroDivisionError"):
        restricted_delaunay(np.eye(4)[:, :3], lambda x: 1 / 0)
    with pytest.raises(InputError, match="feature_size must be positive"):
        sampling_density(x, icosphere(0), 0.0)
    with pytest.raises(InputError, match="surface must be a Mesh"):
        sampling_density(x, Mesh(x[:, :2], [(0, 1, 2)]), 1.0)
    with pytest.raises(InputError, match="rows of three"):
        feature_sizes(x[:, :2])
    with pytest.raises(DegenerateInputError):
        restricted_delaunay(x * [1, 1, 0], icosphere(0))
