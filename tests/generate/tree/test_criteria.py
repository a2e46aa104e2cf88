"""Rules, one by one: what each promises of the leaves."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from unstruct import Domain, InputError, octree, quadtree, sizing
from unstruct.generate.tree.criteria import FINE_LEVEL, by_count, by_function
from unstruct.generate.tree.growing import level_of
from unstruct.generate.tree.keys import keys_of
from unstruct.sizing import SizeField

UNIT = [(0.0, 0.0), (1.0, 1.0)]


def test_a_constant_size() -> None:
    for size, depth in ((2.0, 0), (1.0, 0), (0.999, 1), (0.5, 1), (0.25, 2), (0.2, 3)):
        tree = quadtree(UNIT, size)
        assert tree.counts.tolist() == [*[0] * depth, 4**depth], size
    assert octree([(0, 0, 0), (1, 2, 4)], 1.0).counts.tolist() == [0, 0, 64]  # the longest edge


def test_the_size_holds_at_centers_and_with_a_growth_everywhere() -> None:
    at, places = np.array([0.3, 0.7]), np.random.default_rng(0).random((4000, 2))

    def size(x):
        return 0.01 + 0.2 * np.sqrt(((x - at) ** 2).sum(axis=1))

    tree = quadtree(UNIT, size)
    assert (tree.sides <= size(tree.centers)).all()
    known = quadtree(UNIT, SizeField(size, growth=0.2))
    assert (known.sides[known.locate(places)] <= size(places)).all()
    assert len(tree) < len(known) < 3 * len(tree)
    # no leaf is smaller than was asked for: its parent may hold a place where a smaller size is wanted
    known = quadtree(UNIT, SizeField(size, growth=0.2), balance=None)
    rows = known.nodes.leaves >= 0
    parents, side = known.nodes.parents[rows], known.sides[known.nodes.leaves[rows]]
    assert (size(known.nodes.centers[parents]) - 0.2 * np.sqrt(2) * side < 2 * side).all()


def test_a_detail_below_the_first_levels() -> None:
    """Four first levels are asked at the places of level 4; smaller details need a landmark, or a level."""
    at = np.array([0.1, 0.15])

    def size(x):
        return np.where(((x - at) ** 2).sum(axis=1) < 1e-6, 1e-4, 1.0)

    assert len(quadtree(UNIT, size)) == 1
    assert quadtree(UNIT, SizeField(size, landmarks=[at])).depth == 14
    side = 0.9 / (1 << FINE_LEVEL)

    def square(x):
        return np.where((np.abs(x - at) <= side).all(axis=1), 1e-2, 1.0)

    tree = quadtree(UNIT, square)
    assert tree.depth == 7 and tree.sides[tree.locate(at)] < 1e-2


def test_points_per_cell() -> None:
    points = np.random.default_rng(1).random((300, 2)) ** 3
    for most in (0, 1, 5):
        with warnings.catch_warnings(action="ignore"):
            tree = quadtree(UNIT, points=points, most_points=most, max_level=12, balance=None)
        count = np.bincount(tree.locate(points), minlength=len(tree))
        assert (count[tree.levels < 12] <= most).all()
        if most:
            parents = tree.nodes.parents[1:]
            inner = np.bincount(parents[tree.nodes.leaves[1:] >= 0], minlength=len(tree.nodes.levels))
            assert tree.complete and inner.max() <= 4
    corner = octree([(0, 0, 0), (1, 1, 1)], points=[(1, 1, 1), (0, 0, 0)])
    assert len(corner) == 8 and corner.locate([(1, 1, 1), (0, 0, 0)]).tolist() == [7, 0]


def test_points_that_coincide_never_part() -> None:
    with pytest.warns(match="1 leaves are not divided as asked: level 30, the deepest"):
        tree = quadtree(UNIT, points=[(0.3, 0.3), (0.3, 0.3), (0.9, 0.1)])
    assert tree.depth == 30 and not tree.complete and tree.unfinished.tolist() == [tree.locate((0.3, 0.3))]
    near = np.nextafter(0.3, 1)
    with pytest.warns(match="level 30"):
        quadtree(UNIT, points=[(0.3, 0.3), (near, 0.3)])


def test_count_of_a_level() -> None:
    keys = np.sort(keys_of(np.array([[0, 0], [1, 1], [3, 3]])))
    nodes = level_of(np.zeros(2), np.ones(2), np.arange(4, dtype=np.uint64), 1, None, None)
    assert by_count(keys, 2, 1)(nodes).tolist() == [True, False, False, False]


def test_a_function_of_cells() -> None:
    tree = quadtree(UNIT, divide=lambda x, side: (np.abs(x[:, 0] - 0.5) < side) & (side > 0.1))
    assert tree.depth == 4 and (np.abs(tree.centers[tree.levels == 4, 0] - 0.5) < 0.3).all()
    for wrong in (lambda x, side: side, lambda x, side: True, lambda x, side: [True] * (len(x) + 1)):
        with pytest.raises(InputError, match="divide must return one bool for each of 1 cells"):
            quadtree(UNIT, divide=wrong)
    assert by_function(lambda x, side: side < 0).__name__ == "rule"


def test_sizes_from_an_error_indicator() -> None:
    """As in adaptive solution: from the values at the vertices of one mesh to the size of the next tree."""
    tree = quadtree(UNIT, 0.125)
    mesh = tree.mesh("conforming")
    error = np.exp(-20 * ((mesh.points - 0.5) ** 2).sum(axis=1))
    size = sizing.from_error(mesh, error, 0.05)
    finer = quadtree(UNIT, size)
    assert finer.levels[finer.locate((0.5, 0.5))] > finer.levels[finer.locate((0.01, 0.01))]


@pytest.mark.parametrize("growth", [0.0, 0.3, 2.0])
def test_distance_from_the_boundary(growth: float) -> None:
    square = Domain.polygon([(0, 0), (4, 0), (4, 4), (0, 4)])
    tree = quadtree(square, boundary_size=0.06, growth=growth)
    x = np.random.default_rng(0).uniform(0, 4, (3000, 2))
    distance = np.minimum(x, 4 - x).min(axis=1)
    assert (tree.sides[tree.locate(x)] <= 0.06 + growth * distance).all()
    ball = octree(Domain.ball(size=0.4), boundary_size=0.2, growth=growth)
    x = np.random.default_rng(0).uniform(-0.5, 0.5, (500, 3))
    assert (ball.sides[ball.locate(x)] <= 0.2 + growth * (1 - np.sqrt((x * x).sum(axis=1)))).all()


def test_cells_of_the_boundary() -> None:
    domain = Domain.polygon([(1 / 3, 0), (1, 1 / 7), (0, 1)])
    tree = quadtree(domain, boundary_size=0.05, balance=None)
    assert (tree.sides[tree.states == 0] <= 0.05).all() and (tree.sides[tree.states != 0] > 0.1).any()
