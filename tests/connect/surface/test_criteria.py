"""Criteria of surfaces against fractions over everything, with ties, folds, needles, and in the plane."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from surface_shapes import bipyramid, cylinder, icosphere, random_surface, saddle, torus

from unstruct.base.errors import InputError, MeshError
from unstruct.connect.insertion.delaunay import delaunay
from unstruct.connect.surface.criteria import surface_criteria
from unstruct.examples.running import random_triangulation
from unstruct.mesh.mesh import Mesh
from unstruct.plain import surface_delaunay as plain

TETRA = Mesh([(0, 0, 0), (4, 0, 0), (0, 4, 0), (1, 1, 1)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])


def agrees(mesh):
    """Compare everything with the plain version."""
    found = surface_criteria(mesh)
    points, rows = mesh.points.tolist(), mesh.simplices.tolist()
    inside = plain.is_surface_delaunay(points, rows)
    assert found.plane_centered.tolist() == [not row for row in inside]
    for t, row in enumerate(inside):
        assert found.culprits(t).tolist() == row
        assert found.culprit[t] in row if row else found.culprit[t] == -1
    for name, good in (("intrinsic", found.intrinsic), ("extrinsic", found.at_edges)):
        wanted = getattr(plain, name)(points, rows)
        assert {tuple(e): bool(g) for e, g in zip(found.edges.tolist(), good)} == wanted
    assert found.restricted.tolist() == plain.restricted(points, rows)
    return found


def test_the_surface_of_the_ledger_has_no_delaunay_triangulation():
    """The only closed surface on four points are the four faces; one sphere is not empty."""
    found = agrees(TETRA)
    assert found.plane_centered.tolist() == [False, True, True, True] and found.culprit[0] == 3
    assert not found.report and "plane-centered" in str(found.report)
    assert found.counts["plane-centered"] == 1 and "1 triangles plane-centered" in str(found)


@given(st.lists(st.tuples(*[st.integers(-3, 3)] * 3), min_size=4, max_size=4, unique=True))
@settings(max_examples=100, deadline=None)
def test_tetrahedra_on_a_lattice(corners):
    x = np.array(corners, dtype=float)
    if np.linalg.det(x[1:] - x[0]) != 0:
        agrees(Mesh(x, [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]))


@given(st.integers(0, 100_000))
@settings(max_examples=15, deadline=None)
def test_random_surfaces(seed):
    mesh = random_surface(seed)
    if len(mesh.simplices) <= 40:
        agrees(mesh)


@given(st.integers(0, 100_000))
@settings(max_examples=15, deadline=None)
def test_rounded_surfaces_with_many_ties(seed):
    """Coordinates of few bits: many vertices on common spheres, exactly."""
    rng = np.random.default_rng(seed)
    n, m = rng.integers(2, 5, 2)
    height = rng.integers(0, 3, (n + 1, m + 1))
    points = [(i, j, height[i, j]) for i in range(n + 1) for j in range(m + 1)]
    rows = []
    for i in range(n):
        for j in range(m):
            a, b, c, d = (
                i * (m + 1) + j,
                (i + 1) * (m + 1) + j,
                (i + 1) * (m + 1) + j + 1,
                i * (m + 1) + j + 1,
            )
            rows += [(a, b, c), (a, c, d)] if rng.random() < 0.5 else [(a, b, d), (b, c, d)]
    agrees(Mesh(np.array(points, dtype=float), rows))


@pytest.mark.parametrize(
    "mesh", [icosphere(0), torus(6, 4), cylinder(6, 2), saddle(3), bipyramid(5, 9.0, 0.1)]
)
def test_even_surfaces(mesh):
    agrees(mesh)


def test_in_the_plane_all_agree():
    flat = np.random.default_rng(3).random((80, 2))
    for mesh in (delaunay(flat), random_triangulation(flat, 1)):
        space = Mesh(np.column_stack([flat, np.full(80, 0.5)]), mesh.simplices)
        found = surface_criteria(space)
        assert (found.intrinsic == found.at_edges).all()
        assert found.intrinsic.all() == found.plane_centered.all()
    agrees(space.select(np.arange(30)))


def test_exact_to_the_last_bit():
    x = np.array([(0, 0, 0), (4, 0, 0), (0, 4, 0), (4, 4, 0), (2, 2, 5)], dtype=float)
    rows = [(0, 1, 2), (1, 3, 4)]
    assert surface_criteria(Mesh(x, rows)).plane_centered[0]  # (4, 4, 0) is on the circle
    x[3, 0] = np.nextafter(4.0, 0.0)
    assert surface_criteria(Mesh(x, rows)).culprit[0] == 3
    x[3] = (4, 4, 2.0**-500)
    assert surface_criteria(Mesh(x, rows)).plane_centered[0]


def test_needles_are_compared_with_all_vertices():
    x = np.array([(0, 0, 0), (1, 0, 0), (0.5, 1e-12, 0), (0.5, -3e4, 1.0), (3, 1, 1), (0.5, -1e6, 0)])
    agrees(Mesh(x, [(0, 1, 2), (1, 0, 3), (1, 4, 5)]))


def test_large_surfaces_are_quick():
    found = surface_criteria(icosphere(6))
    assert len(found.plane_centered) == 81920 and found.plane_centered.all() and found.restricted.all()


def test_errors():
    with pytest.raises(InputError, match="Mesh of triangles in space"):
        surface_criteria(delaunay(np.random.default_rng(0).random((5, 3))))
    with pytest.raises(MeshError, match="flat"):
        surface_criteria(Mesh([(0, 0, 0), (1, 1, 1), (2, 2, 2)], [(0, 1, 2)]))
