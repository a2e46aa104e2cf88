"""The rule of turning: curves, corners, smooth bodies, edges."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, octree, quadtree
from unstruct.generate.tree.contacts import boundary_of
from unstruct.generate.tree.turning import bending_of


@pytest.mark.parametrize("angle", [30.0, 10.0, 3.0])
def test_a_circle_turns_by_no_more_in_any_leaf(angle: float) -> None:
    tree = quadtree(Domain.disc(), turning=angle)
    t = np.linspace(0, 2 * np.pi, 20_000, endpoint=False)
    leaf = tree.locate(np.stack([np.cos(t), np.sin(t)], axis=1))
    for row in np.unique(leaf):
        around = np.degrees(t[leaf == row])
        away = np.abs(around - around[0])
        assert np.minimum(away, 360 - away).max() <= 1.13 * angle  # chords turn by an eighth of it
    assert tree.complete and 90 / angle < tree.sides.max() / tree.sides.min() * 32
    coarser = quadtree(Domain.disc(), turning=2 * angle)
    assert 1.5 < (tree.states == 0).sum() / (coarser.states == 0).sum() < 3


def test_a_small_circle_and_a_large_one() -> None:
    """Cells are as small as the radius needs: those around a hole of a tenth of the radius are smaller."""
    hole = Domain.disc((0.3, 0.2), 0.05)
    tree = quadtree(Domain.disc().with_holes(hole), turning=15)
    cut = tree.states == 0
    near = np.sqrt(((tree.centers - [0.3, 0.2]) ** 2).sum(axis=1)) < 0.15
    assert tree.sides[cut & near].max() < 0.2 * tree.sides[cut & ~near].min() * 2
    assert 2 * tree.sides[cut & near].max() <= tree.sides[cut & ~near].min()


def test_corners_never_end() -> None:
    square = Domain.polygon([(0, 0), (1, 0), (1, 1), (0, 1)])
    with pytest.warns(match=r"\d leaves are not divided as asked: level 8, the deepest"):
        tree = quadtree(square, turning=45, max_level=8)
    corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    assert (tree.levels[tree.locate(corners)] == 8).all() and len(tree) < 500
    assert set(tree.unfinished.tolist()) <= set(tree.locate(corners).tolist())
    octagon = Domain.polygon([(np.cos(a), np.sin(a)) for a in np.pi / 4 * np.arange(8)])
    assert quadtree(octagon, turning=91).complete  # turns by 45 degrees at each corner


@pytest.mark.parametrize("size", [0.5, 0.2])
@pytest.mark.parametrize("angle", [40.0, 15.0, 4.0])
def test_a_ball_as_smooth_as_its_triangles_are_not(size: float, angle: float) -> None:
    """Cells need not become smaller than the angle over the curvature, though triangles meet at edges."""
    tree = octree(Domain.ball(size=size), turning=angle, balance=None)
    assert tree.complete
    cut = tree.states == 0
    wanted = np.radians(angle)  # of a sphere of radius 1
    assert tree.sides[cut].min() > wanted / 2.6
    if size == 0.2:
        assert tree.sides[cut].max() <= 2.0 * wanted


def test_edges_of_a_body_never_end() -> None:
    box = Domain.box()
    with pytest.warns(match="level 6"):
        tree = octree(box, turning=30, max_level=6)
    t = np.linspace(0.01, 0.99, 50)
    edge = np.stack([t, np.zeros(50), np.zeros(50)], axis=1)
    face = np.stack([t, 0.4 + 0 * t, np.zeros(50)], axis=1)
    assert (tree.levels[tree.locate(edge)] == 6).all()
    assert tree.levels[tree.locate(face)][15:35].max() < 6
    cylinder = Domain.cylinder(size=0.3)
    with pytest.warns(match="level 6"):
        tree = octree(cylinder, turning=30, max_level=6)
    rim, side = np.array([0.4999, 0.0, 0.0]), np.array([0.4999, 0.0, 0.5])
    assert tree.levels[tree.locate(rim)] == 6 > tree.levels[tree.locate(side)]


def test_records() -> None:
    box = Domain.box((0, 0, 0), (1, 2, 3))
    shell = box.triangulated
    boundary = boundary_of(shell.points, shell.bounding, box.bounds, box.contains)
    bending = bending_of(boundary, box)
    np.testing.assert_allclose(np.abs(bending.normals).sum(axis=1), 1.0)
    assert bending.edges.sum() == 24 and (bending.curvature == 0).all()  # 12 edges, seen from two sides
    tiny = Domain.polygon(1e-200 * np.array([(0, 0), (3, 0), (0, 4)]))
    boundary = boundary_of(tiny.points, tiny.facets, tiny.bounds, tiny.contains)
    normals = bending_of(boundary, tiny).normals
    np.testing.assert_allclose(normals, [(0, -1), (0.8, 0.6), (-1, 0)], atol=1e-15)
