"""tetrahedralize: the surface is kept, sizes are met, cells are round, and each run gives the same."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from itertools import product
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from solids import cube, torus

from unstruct import (
    Domain,
    DomainMesh,
    IncompleteWarning,
    InputError,
    check,
    delaunay,
    sizing,
    tetrahedralize,
)
from unstruct.connect.spatial.complex import SpatialComplex

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


def twelve(low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    points, triangles = cube(1)
    return points * (high - low) + low, triangles


def together(*bodies: tuple[np.ndarray, np.ndarray]) -> Domain:
    first = np.cumsum([0] + [len(points) for points, _ in bodies])
    rows = [triangles + k for (_, triangles), k in zip(bodies, first)]
    return Domain(np.concatenate([points for points, _ in bodies]), np.concatenate(rows))


def schonhardt() -> tuple[np.ndarray, np.ndarray]:
    turn = np.array([0, 2, 4, 0.5, 2.5, 4.5]) * np.pi / 3
    points = np.column_stack([np.cos(turn), np.sin(turn), np.repeat([0.0, 1.0], 3)])
    sides = [((i, j, 3 + j), (i, 3 + j, 3 + i)) for i, j in ((0, 1), (1, 2), (2, 0))]
    return points, np.array([(0, 2, 1), (3, 4, 5), *(row for pair in sides for row in pair)])


COARSE_BODIES = {
    "a cube of twelve triangles": (lambda: together(twelve(0, 1)), (0.2, 0.07, 0.05)),
    "a thin gap": (lambda: together(twelve(0, 1), twelve(0.01, 0.99)), (0.3, 0.1, 0.05)),
    "three in each other": (lambda: together(*(twelve(i, 20 - i) for i in range(3))), (2, 1)),
    "nine in each other": (lambda: together(*(twelve(i, 20 - i) for i in range(9))), (2, 1)),
    "a prism that cannot be filled": (lambda: Domain(*schonhardt()), (0.5, 0.1)),
}


@pytest.mark.parametrize("name", COARSE_BODIES)
def test_facets_much_larger_than_the_size(name: str) -> None:
    """Kept triangles, however large, are faces, and the mesh fills the body; away from them sizes are met."""
    make, sizes = COARSE_BODIES[name]
    domain = make()
    for size in sizes:
        mesh = filled(domain, size, seed=2)
        assert mesh.counts["missing triangles"] == 0 and mesh.volume == pytest.approx(domain.volume, 1e-14)
        assert set(mesh.reasons) == {"a facet is larger than the size; split_boundary=True divides it"}
    if name.startswith("a cube"):
        corners = mesh.points[mesh.simplices]
        middle = np.abs(corners.mean(axis=1) - 0.5).max(axis=1) < 0.2
        sides = np.linalg.norm(corners[middle][:, 0] - corners[middle][:, 1], axis=1)
        assert middle.sum() > 2000 and sides.mean() < 0.07 and mesh.quality("min_dihedral").min() > 1


def test_where_lattice_points_are_in_the_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """If a facet is missing with the points inside, it is recovered without; they come afterwards."""
    domain, recover = Domain(*cube(4)), SpatialComplex.recover

    def failing(cells: SpatialComplex, *given: Any, **options: Any) -> Any:
        found = recover(cells, *given, **options)
        many = cells.given > len(domain.points)
        return found._replace(triangles=np.zeros(1, np.int32)) if many else found

    usual = filled(domain, 0.8)
    monkeypatch.setattr(SpatialComplex, "recover", failing)
    mesh = filled(domain, 0.8)
    assert mesh.complete and mesh.counts["lattice points"] == usual.counts["lattice points"]


def test_a_facet_that_is_missing_is_told_first() -> None:
    with pytest.warns(IncompleteWarning) as told:
        mesh = tetrahedralize(Domain(*schonhardt()), 0.8, budget=0)
    first = str(told[0].message)
    assert first.startswith("the mesh is not one of the body: facet ") and "missing near [" in first
    assert "its volume is 1.11603 instead of 0.866025; try split_boundary=True" in first
    assert all("missing" not in str(one.message) for one in told[1:])
    assert not mesh.complete and not check(mesh, domain=Domain(*schonhardt()))


def test_advice_that_is_in_effect_is_not_given() -> None:
    """Rectangles are divided; a size that oscillates makes some of the parts too large all the same."""
    with pytest.warns(IncompleteWarning, match="although it is divided; a size that changes less"):
        tetrahedralize(Domain.box(), lambda p: 0.2 + 0.15 * np.sign(np.sin(1e4 * p[:, 0])), optimize=False)


def test_sizes_of_very_different_lengths() -> None:
    """A ball of radius 1e-4 in a box of 2e3: the cells differ by 2^24."""
    body = Domain.box((-1e3,) * 3, (1e3,) * 3).with_holes(Domain.ball((0, 0, 0), 1e-4, 5e-5))
    mesh = filled(body, sizing.sources([[0, 0, 0]], 5e-5, growth=1.0), optimize=False)
    assert mesh.complete and mesh.volume == pytest.approx(body.volume, 1e-14)


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
