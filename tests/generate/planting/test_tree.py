"""Tree: its meshes, their markers, and its picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from trees import leaves, planted

from unstruct import (
    Domain,
    IncompleteWarning,
    InputError,
    Mesh,
    check,
    constrained_delaunay,
    octree,
    quadtree,
)
from unstruct.generate.planting.tree import KINDS_OF_MESHES


@settings(max_examples=25)
@given(leaves(2))
def test_cells_and_triangles_cover_the_box(cells: frozenset) -> None:
    tree = planted(cells, 2).balanced()
    squares, triangles = tree.mesh("cells"), tree.mesh("conforming")
    assert len(squares.cells["quad"]) == len(tree) and squares.volumes.sum() == triangles.volumes.sum() == 1
    assert bool(check(triangles)) and len(triangles.simplices) >= 2 * len(tree)
    uniform = tree.counts.max() == len(tree)
    assert bool(check(squares)) == uniform  # hanging vertices are no fault of the tree, but of a mesh
    assert (len(squares.markers["hanging"]) == 0) == uniform


@settings(max_examples=8)
@given(leaves(3, deepest=3, targets=2))
def test_cubes_and_tetrahedra_fill_the_box(cells: frozenset) -> None:
    tree = planted(cells, 3).balanced("edges")
    cubes, tetrahedra = tree.mesh("cells"), tree.mesh("conforming")
    assert len(cubes.cells["hexahedron"]) == len(tree)
    np.testing.assert_allclose([cubes.volumes.sum(), tetrahedra.volumes.sum()], 1.0)
    assert bool(check(tetrahedra)) and (cubes.volumes > 0).all()


def test_cells_outside_are_left_out() -> None:
    for tree in (quadtree(Domain.disc(), 0.2), octree(Domain.ball(size=0.5), 0.4)):
        inside = tree.states >= 0
        for kind in ("cells", "conforming"):
            mesh = tree.mesh(kind)
            assert set(mesh.markers["leaf"].tolist()) == set(np.flatnonzero(inside).tolist())
            np.testing.assert_array_equal(mesh.markers["level"], tree.levels[mesh.markers["leaf"]])
            np.testing.assert_array_equal(mesh.markers["state"], tree.states[mesh.markers["leaf"]])
            assert (mesh.origin == -1).all() and mesh.complete
            rows = np.concatenate([block.ravel() for block in mesh.cells.values()])
            np.testing.assert_array_equal(np.unique(rows), np.arange(len(mesh.points)))
        assert bool(check(tree.mesh("conforming")))


def test_sides_of_cells_agree_with_corners() -> None:
    tree = quadtree([(-0.3, 0.1), (0.8, 0.5)], lambda x: 0.02 + 0.2 * np.abs(x[:, 0]))
    mesh, (low, high) = tree.mesh("cells"), tree.corners
    x = mesh.points[mesh.cells["quad"]]
    np.testing.assert_array_equal(x[:, 0], low)
    np.testing.assert_array_equal(x[:, 2], high)
    np.testing.assert_array_equal(x[:, 1], np.stack([high[:, 0], low[:, 1]], axis=1))


def test_errors() -> None:
    loose = quadtree([(0, 0), (1, 1)], points=[(0.49, 0.49), (0.4901, 0.49)], balance=None)
    with pytest.raises(InputError, match=r"balanced across faces: tree.balanced\('faces'\)"):
        loose.mesh("conforming")
    assert bool(check(loose.balanced("faces").mesh("conforming")))
    for kind in ("quads?", None, 3, ["cells"]):
        with pytest.raises(InputError, match="kind must be one of 'cells', 'conforming'"):
            loose.mesh(kind)
    assert KINDS_OF_MESHES[:2] == ("cells", "conforming")


def test_meshes_are_written_and_read(tmp_path: Path) -> None:
    mesh = quadtree(Domain.disc(), boundary_size=0.1).mesh("cells")
    mesh.write(tmp_path / "tree.vtu")
    again = Mesh.read(tmp_path / "tree.vtu")
    np.testing.assert_array_equal(again.cells["quad"], mesh.cells["quad"])
    for name in ("leaf", "level", "state", "hanging"):
        np.testing.assert_array_equal(again.markers[name], mesh.markers[name])


def test_scikit_fem_ready_constraints() -> None:
    """A hanging value is the mean of its parents: a quadratic function is then off by a known amount."""
    tree = quadtree([(0, 0), (1, 1)], lambda x: 0.05 + 0.4 * x[:, 0])
    mesh, hanging = tree.mesh("cells"), tree.hanging
    x = mesh.points
    ends = x[hanging.parents]
    length = np.abs(ends[:, 1] - ends[:, 0]).max(axis=1)
    u = (x * x).sum(axis=1)
    error = (u[hanging.parents] * hanging.weights).sum(axis=1) - u[hanging.vertices]
    np.testing.assert_allclose(error, 0.25 * length**2)


def test_vertices_are_shared_and_found_once() -> None:
    tree = octree([(0, 0, 0), (1, 1, 1)], 0.26)
    assert len(tree.mesh().points) == 5**3 and len(tree.hanging.vertices) == 0
    assert tree.hanging.parents.shape == (0, 4)


def test_angles_of_templates_need_a_square_box() -> None:
    square = quadtree(Domain.disc(), 0.2).mesh("conforming").quality("min_angle")
    assert np.allclose(square, 45.0)
    long = quadtree([(0, 0), (1, 10)], 0.3).mesh("conforming").quality("min_angle")
    assert np.allclose(long.min(), np.degrees(np.arctan(0.1)))


def test_leaves_that_meet_at_a_corner_only_are_pinched_and_check_tells() -> None:
    """As the domain is itself, where two holes touch; with a gap, smaller leaves part them."""
    sides, low = [(0, 0), (1, 0), (1, 1), (0, 1)], [(0.25, 0.25), (0.5, 0.25), (0.5, 0.5), (0.25, 0.5)]
    touching = Domain.polygon(sides, holes=[low, [(x + 0.25, y + 0.25) for x, y in low]])
    with pytest.warns(IncompleteWarning, match=r"meet here at a corner only.*near \(0.5, 0.5\)"):
        pinched = quadtree(touching, 0.13).mesh("conforming")
    assert not pinched.complete
    for mesh in (pinched, constrained_delaunay(touching)):
        assert [problem.kind for problem in check(mesh).problems] == ["pinched vertex"]
    apart = Domain.polygon(sides, holes=[low, [(x + 0.26, y + 0.26) for x, y in low]])
    assert check(quadtree(apart, 0.004, box=[[0, 0], [1, 1]]).mesh("conforming"))


@pytest.mark.parametrize("kind", ["cells", "conforming"])
def test_nothing_is_inside_of_a_domain_without_facets(kind: str) -> None:
    rod = Domain([[0, 0, 0], [1, 1, 1]], [], inner=[[0, 1]])
    with pytest.raises(InputError, match="no facets, so nothing is inside"):
        octree(rod, 0.3).mesh(kind)


def test_which_meshes_tell_of_leaves() -> None:
    tree = quadtree(Domain.disc(), 0.3)
    for kind in ("cells", "conforming"):
        assert {"leaf", "level", "state"} <= tree.mesh(kind).markers.keys()
    for kind in ("fitted", "quads", "warped"):
        assert tree.mesh(kind).markers.keys() == {"facets", "inner", "region"}
