"""Pieces cut by the leaves of a tree."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, quadtree
from unstruct.domain.plane.prescribed import Spacing
from unstruct.generate.tree_regions.cutting import MOST_OVER, cut_by_leaves, leaf_size
from unstruct.generate.tree_regions.near import leaves_along


def lengths(tree, sampled):
    return leaves_along(tree.grid, sampled.points[sampled.ends].reshape(-1, 4))


def test_the_size_is_that_of_the_leaf():
    tree = quadtree([[0, 0], [1, 1]], 0.3)
    size = leaf_size(tree)
    assert size([[0.1, 0.1], [5.0, -3.0]]).tolist() == [0.25, 0.25]


@pytest.mark.parametrize("side", [0.3, 0.05, 0.004])
def test_a_circle_is_cut_on_its_true_curve(side):
    disc = Domain.disc((0, 0), 1)
    tree = quadtree(disc, side)
    sampled = cut_by_leaves(tree, disc)
    assert np.abs(np.hypot(*sampled.points.T) - 1).max() < 1e-15
    assert 0.4 < lengths(tree, sampled).min() and lengths(tree, sampled).max() < MOST_OVER


def test_small_leaves_between_the_places_that_are_looked_at():
    """Leaves of 1/16384 beside a side of length 1, at 0.31 of it."""
    square = Domain.rectangle((0, 0), (1, 1))

    def divide(center, side):
        return (np.abs(center - [0.31, 0]).max(axis=1) <= side / 2 + 1e-9) & (side > 1e-4)

    tree = quadtree(square, min_level=7, divide=divide, box=[[-0.2, -0.3], [1.3, 1.2]])
    plain = square.sampled(leaf_size(tree))
    assert lengths(tree, plain).max() > 4
    assert lengths(tree, cut_by_leaves(tree, square)).max() <= MOST_OVER


def test_pieces_that_have_their_points_get_no_others():
    square = Domain.rectangle((0, 0), (1, 1)).spaced({0: Spacing(count=2)})
    sampled = cut_by_leaves(quadtree(square, 0.05), square)
    assert (sampled.piece == 0).sum() == 2
    assert (sampled.piece == 1).sum() > 15
