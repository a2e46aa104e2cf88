"""Delaunay triangulations of surfaces: flips, refinement, kept edges, names, and `check` on every mesh."""

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from interrupts import interrupt
from surface_shapes import bipyramid, cylinder, icosphere, random_surface, saddle, torus

from unstruct.assess.check import check
from unstruct.base.errors import IncompleteWarning, InputError, MeshError
from unstruct.connect.insertion.delaunay import delaunay
from unstruct.connect.surface.criteria import surface_criteria
from unstruct.domain.domain import Domain
from unstruct.examples.running import random_triangulation
from unstruct.generate.surface.surface_delaunay import surface_delaunay
from unstruct.geometry.embedded import embedded, meeting_pairs
from unstruct.mesh.mesh import Mesh

TETRA = Mesh([(0, 0, 0), (4, 0, 0), (0, 4, 0), (1, 1, 1)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])
BRICK = Domain.box((0, 0, 0), (1, 2, 0.5), markers={"top": [1]})


def made(surface, *arguments, **options):
    """The mesh, checked against its surface."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", IncompleteWarning)
        mesh = surface_delaunay(surface, *arguments, **options)
    report = check(mesh, domain=surface)
    assert report, str(report)
    return mesh


def on_given(mesh, surface):
    """How far vertices are from the planes of given triangles, at most."""
    from unstruct.domain.given_surface import given_surface

    support = given_surface(surface).support
    return np.abs(support.nearest(mesh.points)[2] - mesh.points).max()


# --- without new vertices


def test_the_surface_of_the_ledger_stays_as_it_is():
    mesh = made(TETRA)
    assert not mesh.complete and mesh.unrefined.tolist() == [0]
    assert mesh.counts["not plane-centered"] == 1 and mesh.counts["flips"] == 0
    with pytest.warns(IncompleteWarning, match="kept|bent"):
        surface_delaunay(TETRA)


def test_plane_parts_become_delaunay():
    flat = np.random.default_rng(1).random((80, 2))
    start = random_triangulation(flat, 1)
    space = Mesh(np.column_stack([flat, np.zeros(80)]), start.simplices)
    mesh = made(space)
    assert mesh.complete and mesh.counts["flips"] > 10
    wanted = {tuple(sorted(row)) for row in delaunay(flat).simplices.tolist()}
    assert {tuple(sorted(mesh.origin[row].tolist())) for row in mesh.simplices} == wanted


def test_a_folded_plane_keeps_its_crease():
    """Two half-planes at 72 degrees, moved vertices in each: flips on both sides, the crease stays."""
    rng, bowl = np.random.default_rng(4), saddle(12)
    x, y, _ = bowl.points.T
    inner = (np.abs(x) < 0.99) & (np.abs(x) > 0.01) & (np.abs(y) < 0.99)
    x, y = (c + 0.06 * rng.uniform(-1, 1, len(c)) * inner for c in (x, y))
    bent = Mesh(np.column_stack([x, y, 3 * np.maximum(x, 0.0)]), bowl.simplices)
    mesh = made(bent)
    assert mesh.counts["flips"] > 20 and mesh.figures["deviation"] < 1e-12
    found = surface_criteria(mesh)
    crease = (np.abs(mesh.points[found.edges][:, :, 0]) < 1e-12).all(axis=1)
    assert crease.sum() == 12 and found.intrinsic[~crease].all()


def test_flips_across_shallow_creases():
    surface = icosphere(3, (1.0, 0.5, 0.2))
    still, moved = made(surface), made(surface, deviation=0.01)
    assert still.counts["flips"] == 0 and still.counts["not plane-centered"] == 740
    assert moved.counts["flips"] > 300 and moved.figures["deviation"] <= 0.02
    assert moved.counts["not plane-centered"] < 20
    assert moved.quality("min_angle").min() > still.quality("min_angle").min()
    assert embedded(moved.points, moved.simplices)


@given(st.integers(0, 100_000))
@settings(max_examples=20, deadline=None)
def test_flips_of_random_surfaces(seed):
    surface = random_surface(seed)
    size = float(np.ptp(surface.points, axis=0).max())
    for near in (None, 0.02 * size):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", IncompleteWarning)
            mesh = surface_delaunay(surface, deviation=near)
        assert len(mesh.simplices) == len(surface.simplices)
        if embedded(surface.points, surface.simplices):
            assert embedded(mesh.points, mesh.simplices)
        assert mesh.figures["deviation"] <= (0.04 * size if near else 1e-9 * size)


# --- with new vertices


@pytest.mark.parametrize(
    ("surface", "size"),
    [
        (icosphere(2), 0.2), (icosphere(3, (1.0, 0.5, 0.2)), 0.1), (torus(40, 8), 0.2), (saddle(6), 0.15),
        (cylinder(24, 1), 0.2), (bipyramid(8, 3.0, 0.05), 0.3), (BRICK, 0.15),
    ],
)  # fmt: skip
def test_sizes(surface, size):
    mesh = made(surface, size)
    assert on_given(mesh, surface) < 1e-12
    edges = mesh.points[mesh.edges]
    length = np.sqrt(((edges[:, 1] - edges[:, 0]) ** 2).sum(axis=1))
    assert length.max() <= 2**0.5 * size * (1 + 1e-9)
    assert set(mesh.reasons.tolist()) <= {"sharp: angles of the surface leave no room"}
    assert len(mesh.unrefined) <= 0.02 * len(mesh.simplices)


def test_thirty_degrees_on_closed_surfaces():
    for surface in (icosphere(3, (1.0, 0.3, 0.2)), torus(60, 8)):
        mesh = made(surface, min_angle=30)
        assert mesh.complete and mesh.counts["inserted"] > 0
        assert mesh.quality("min_angle").min() > 25  # of straight triangles; on the surface it is 30


def test_sizes_that_vary_and_deviation():
    mesh = made(BRICK, lambda x: 0.04 + 0.2 * x[:, 1])
    middle = mesh.points[mesh.edges].mean(axis=1)
    step = np.diff(mesh.points[mesh.edges], axis=1)[:, 0]
    length = np.sqrt((step**2).sum(axis=1))
    assert length[middle[:, 1] < 0.2].mean() < 0.4 * length[middle[:, 1] > 1.6].mean()
    near = made(icosphere(1), 0.4, deviation=0.01)
    assert near.complete and near.figures["deviation"] <= 0.01
    assert len(near.simplices) > len(made(icosphere(1), 0.4).simplices)


def test_names_and_kept_edges():
    mesh = made(BRICK, 0.2)
    top = mesh.markers["top"]
    corners = mesh.points[top]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    side = np.ptp(corners.reshape(-1, 3), axis=0)
    assert np.sqrt((area**2).sum(axis=1)).sum() / 2 == pytest.approx(np.prod(side[side > 0]))
    bowl = saddle(6)
    line = np.stack([np.arange(3, 45, 7), np.arange(10, 52, 7)], axis=1)
    marked = Mesh(
        bowl.points, bowl.simplices, markers={"line": line, "half": (np.arange(72) % 36 < 18).astype(int)}
    )
    found = made(marked, 0.15)
    x = found.points[found.markers["line"]]
    assert np.abs(x[:, :, 1]).max() < 1e-12 and len(x) > len(line)
    middle = found.corners.mean(axis=1)
    assert ((middle[:, 0] < 0) == (found.markers["half"] == 1)).all() or set(found.markers["half"]) == {0, 1}


def test_three_sheets_at_an_edge_are_divided_alike():
    points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, -1, 0.3), (0.2, 0, 1)]
    surface = Mesh(points, [(0, 1, 2), (1, 0, 3), (0, 1, 4)])
    mesh = made(surface, 0.1)
    on = np.flatnonzero(np.abs(mesh.points[:, 1:]).max(axis=1) < 1e-14)
    assert len(on) >= 9 and embedded(mesh.points, mesh.simplices)
    assert np.diff(np.sort(mesh.points[on, 0])).min() > 0.05  # no vertex is there twice


def test_the_budget_and_cones():
    few = surface_delaunay(icosphere(1), 0.5)
    with pytest.warns(IncompleteWarning, match="budget"):
        mesh = surface_delaunay(icosphere(1), 0.02, budget=300)
    assert len(mesh.points) <= 320 and len(few.points) < 300
    with pytest.warns(IncompleteWarning, match="sharp"):
        assert not surface_delaunay(bipyramid(3, 30.0, 40.0), min_angle=25).complete


@given(st.integers(0, 100_000))
@settings(max_examples=20, deadline=None)
def test_refinement_of_random_surfaces(seed):
    surface = random_surface(seed)
    size = 0.1 * float(np.ptp(surface.points, axis=0).max())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", IncompleteWarning)
        mesh = surface_delaunay(surface, size, budget=20_000)
    assert on_given(mesh, surface) < 1e-12 * max(1.0, np.abs(surface.points).max())
    rows = mesh.simplices
    assert (rows != np.roll(rows, 1, axis=1)).all()
    if embedded(surface.points, surface.simplices) and not any("not embedded" in r for r in mesh.reasons):
        assert len(meeting_pairs(mesh.points, mesh.simplices)) == 0


def test_errors():
    for wrong in (3, "x", delaunay(np.random.default_rng(0).random((9, 2)))):
        with pytest.raises(InputError):
            surface_delaunay(wrong)
    with pytest.raises(InputError, match="min_angle"):
        surface_delaunay(TETRA, min_angle=31)
    with pytest.raises(InputError, match="deviation"):
        surface_delaunay(TETRA, deviation=-1)
    with pytest.raises(InputError):
        surface_delaunay(TETRA, -0.5)
    with pytest.raises(MeshError, match="flat"):
        surface_delaunay(Mesh([(0, 0, 0), (1, 1, 1), (2, 2, 2), (1, 0, 0)], [(0, 1, 2), (0, 3, 1)]))
    with pytest.raises(MeshError, match="flat"):  # two corners at one place, as of marching cubes
        surface_delaunay(Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 1, 0)], [(0, 1, 2), (1, 3, 2)]))


def test_an_interrupt_is_heard_between_operations(monkeypatch):
    interrupt(monkeypatch, lambda: surface_delaunay(icosphere(2), 0.05, progress=True), "")
