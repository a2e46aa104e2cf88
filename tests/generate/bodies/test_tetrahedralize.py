"""tetrahedralize: the surface is kept, sizes are met, cells are round, and each run gives the same."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from solids import cube, torus

from unstruct import Domain, DomainMesh, IncompleteWarning, InputError, check, delaunay, tetrahedralize

CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
Size = float | Callable[[np.ndarray], np.ndarray] | None


def ball(n: int) -> Domain:
    """Points along a spiral on the unit sphere, and their hull."""
    height = 1 - (2 * np.arange(n) + 1) / n
    turn = np.pi * (1 + np.sqrt(5)) * np.arange(n)
    radius = np.sqrt(1 - height**2)
    points = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), height])
    return Domain(points, delaunay(points).boundary)


def mean_edge(domain: Domain) -> float:
    corners = domain.points[domain.triangulated.triangles]
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean())


def filled(domain: Domain, size: Size = None, **options: bool | int) -> DomainMesh:
    """The mesh, after `check`; every triangle of the surface is a face, and no vertex is new on it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", IncompleteWarning)
        mesh = tetrahedralize(domain, size, **options)
    report = check(mesh, domain=domain)
    assert report, report
    given_ones = np.sort(domain.triangulated.triangles, axis=1)
    there = np.sort(mesh.origin[mesh.faces], axis=1)
    if not mesh.steiner.size:
        assert {*map(tuple, given_ones.tolist())} == {*map(tuple, there.tolist())}
    kept = mesh.origin >= 0
    assert np.array_equal(mesh.points[kept], domain.points[mesh.origin[kept]])
    return mesh


@pytest.mark.parametrize("shape", ["ball", "torus", "cube"])
def test_good_surfaces(shape: str) -> None:
    domain = {"ball": ball(500), "torus": Domain(*torus(36, 13)), "cube": Domain(*cube(6))}[shape]
    raw = filled(domain, mean_edge(domain), optimize=False)
    mesh = filled(domain, mean_edge(domain))
    assert mesh.complete and mesh.counts["lattice points"] > 80
    assert mesh.quality("min_dihedral").min() > (24 if shape == "torus" else 28)
    assert shape == "cube" or raw.quality("min_dihedral").min() < 3
    assert mesh.quality("3r/R").mean() > (0.77 if shape == "torus" else 0.82)
    ends = mesh.points[mesh.edges]
    assert np.median(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)) == pytest.approx(
        mean_edge(domain), rel=0.15
    )


def test_a_size_that_varies() -> None:
    domain = ball(300)
    h = mean_edge(domain)

    def size(x: np.ndarray) -> np.ndarray:
        return h * (0.4 + 0.6 * np.linalg.norm(x, axis=1))

    mesh = filled(domain, size)
    assert mesh.complete and mesh.quality("min_dihedral").min() > 20
    ends = mesh.points[mesh.edges]
    quotient = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) / size(ends.mean(axis=1))
    assert 0.85 < np.median(quotient) < 1.15 and np.mean(np.abs(np.log2(quotient)) < 0.5) > 0.8


def test_sizes_larger_than_the_surface_grow_from_it() -> None:
    domain = ball(400)
    mesh, coarser = filled(domain, 0.5), filled(domain, 50.0)
    assert mesh.complete and mesh.quality("min_dihedral").min() > 24
    assert coarser.size <= mesh.size and coarser.quality("min_dihedral").min() > 24
    alone = filled(domain)
    assert "lattice points" not in alone.counts and len(alone.points) == 400


def test_facets_larger_than_the_size_are_named() -> None:
    low = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]  # an L
    points = np.array([(x, y, z) for z in (0.0, 1.0) for x, y in low])
    sides = [(i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i) for i in range(6)]
    domain = Domain(points, [tuple(range(6)), tuple(range(6, 12)), *sides])
    with pytest.warns(IncompleteWarning, match="a facet is larger than the size"):
        mesh = tetrahedralize(domain, 0.2, split_boundary=False)
    assert check(mesh, domain=domain) and not mesh.complete and not mesh.steiner.size
    assert set(mesh.reasons) == {"a facet is larger than the size; split_boundary=True divides it"}
    assert len(mesh.unrefined) >= 10
    assert filled(domain, 3.0).complete


def test_cavity_and_interface() -> None:
    outer, faces = cube(6)
    small, others = cube(2)
    points = np.vstack([outer, small / 2 + 1, small / 2 + 3.5])
    hollow = np.vstack([faces, others + len(outer)])
    inner = others + len(outer) + len(small)
    domain = Domain(points, hollow, inner=inner, regions={"core": (4.0, 4.0, 4.0), "rest": (0.5, 3.0, 3.0)})
    mesh = filled(domain, 1.0)
    assert mesh.complete and mesh.quality("min_dihedral").min() > 15
    core = mesh.markers["region"] == mesh.regions["core"]
    volumes = np.abs(np.linalg.det(np.diff(mesh.corners, axis=1))) / 6
    assert volumes[core].sum() == pytest.approx(1.0) and volumes.sum() == pytest.approx(216 - 1)


def test_inner_segments_and_loose_vertices_stay() -> None:
    outer, faces = cube(4)
    inside = np.array([(2.0, 2.0, 1.0), (2.0, 2.0, 3.0), (1.0, 1.3, 2.1), (2.0, 3.1, 1.7)])
    n = len(outer)
    domain = Domain(np.vstack([outer, inside]), faces, inner=[(n, n + 1)])
    mesh = filled(domain, 0.8, split_boundary=False)
    assert mesh.origin[mesh.segments].tolist() == [[n, n + 1]]
    assert set(range(n, n + 4)) <= set(mesh.origin.tolist())
    free = mesh.points[mesh.origin < 0]
    assert np.linalg.norm(free[:, None] - inside, axis=2).min() > 0.3


def test_the_same_mesh_in_each_run() -> None:
    domain = ball(100)
    one, two = (filled(domain, 0.3) for _ in range(2))
    assert np.array_equal(one.points, two.points) and np.array_equal(one.simplices, two.simplices)
    other = filled(domain, 0.3, seed=5)
    assert abs(other.size - one.size) < 0.1 * one.size


def test_far_and_tiny_bodies() -> None:
    domain = ball(60)
    for points in (domain.points * 1e-150, domain.points * 1e150, domain.points + 1e6):
        small = float(np.ptp(points, axis=0).max()) / 5
        assert filled(Domain(points, domain.facets), small).counts["lattice points"] > 10


def test_no_size_is_optimized_without_new_points() -> None:
    domain = Domain(*torus(20, 8))
    raw, mesh = filled(domain, optimize=False), filled(domain)
    assert len(mesh.points) == len(raw.points)
    assert mesh.quality("min_dihedral").min() >= raw.quality("min_dihedral").min()


def test_refused() -> None:
    box = Domain(CORNERS, SIDES)
    with pytest.raises(InputError, match="bodies in space"):
        tetrahedralize(Domain.rectangle(), 0.1)
    with pytest.raises(InputError, match="positive and finite"):
        tetrahedralize(box, -1.0)
    with pytest.raises(InputError, match=r"points inside.* more than the 2000000"):
        tetrahedralize(box, 1e-4)
    with pytest.raises(InputError, match="more than the 10"):
        tetrahedralize(box, 0.2, budget=10)
    with pytest.raises(InputError, match="points inside"):
        tetrahedralize(box, lambda x: 1e-3 + 1e-3 * x[:, 0], budget=1000)
    with pytest.raises(InputError, match="must be positive"):
        tetrahedralize(box, lambda x: x[:, 0] - 0.5)
    with pytest.raises(InputError, match="no facets"):
        tetrahedralize(Domain(CORNERS, np.empty((0, 3), int)), 0.1)


@pytest.mark.parametrize("seed", range(30))
def test_random_bodies(seed: int) -> None:
    """Bodies that are seen as a whole from the origin, with very uneven surfaces."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(8, 60))
    points = rng.normal(size=(n, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    faces = delaunay(points).boundary
    points *= np.exp(rng.normal(size=n) * rng.choice([0.05, 0.2, 0.5]))[:, None]
    points *= rng.choice([1.0, 1e-3, 1e6]) * np.array([1, 1, rng.choice([1, 0.1])])
    extent = float(np.ptp(points, axis=0).max())
    mesh = filled(Domain(points, faces), extent * rng.choice([0.1, 0.3, 3]))
    raw = filled(Domain(points, faces), optimize=False)
    assert len(mesh.points) >= n and len(raw.points) >= n


@settings(deadline=None, max_examples=15)
@given(
    st.lists(st.tuples(*[st.integers(0, 4)] * 3), min_size=5, max_size=10, unique=True),
    st.sampled_from([0.4, 1.0, 9.0]),
)
def test_hulls_of_lattice_points(points: list, size: float) -> None:
    rows = np.array(points, dtype=float)
    if np.linalg.matrix_rank(rows[1:] - rows[0]) < 3:
        return
    hull = delaunay(rows)
    domain = Domain(rows, hull.boundary) if len(np.unique(hull.boundary)) == len(rows) else None
    if domain is not None:
        filled(domain, size)
