"""Distances of a tree's points from segments, and leaves along segments, beside sums over all pairs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import quadtree
from unstruct.generate.tree_regions.fitted import Spots
from unstruct.generate.tree_regions.near import leaves_along, nearness

pytestmark = pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")

coordinate = st.integers(0, 16).map(lambda i: i / 16) | st.floats(0.0, 1.0)
segment = st.tuples(coordinate, coordinate, coordinate, coordinate)
UNIT = [[0, 0], [1, 1]]


def tree_of(seed: int):
    return quadtree(UNIT, points=np.random.default_rng(seed).random((12, 2)) ** 2, max_level=6)


def distance(x, one):
    a, b = np.array(one[:2]), np.array(one[2:])
    u, v = b - a, x - a
    t = np.clip((v @ u) / (u @ u), 0, 1) if u.any() else np.zeros(len(x))
    return np.sqrt(((v - t[:, None] * u) ** 2).sum(axis=1))


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 9), rows=st.lists(segment, min_size=1, max_size=6))
def test_nearness_beside_all_pairs(seed, rows):
    tree = tree_of(seed)
    spots = Spots.of(tree)
    found, which, place = nearness(tree.grid, np.array(rows), 2.0, spots.of_leaf, spots.points, spots.sizes).T
    true = np.min([distance(spots.points, one) for one in rows], axis=0) / spots.sizes
    used = np.unique(spots.of_leaf[spots.of_leaf >= 0])
    within = used[true[used] < 1.999]
    np.testing.assert_allclose(np.sqrt(found[within]), true[within], atol=1e-6)
    assert (np.sqrt(found[used]) >= true[used] - 1e-6).all()
    assert ((which < 0) == np.isinf(found)).all()
    one = np.array(rows)[which[within].astype(int)]
    foot = one[:, :2] + place[within, None] * (one[:, 2:] - one[:, :2])
    away = np.sqrt(((spots.points[within] - foot) ** 2).sum(axis=1)) / spots.sizes[within]
    np.testing.assert_allclose(away, true[within], atol=1e-6)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 9), one=segment)
def test_leaves_along_beside_samples(seed, one):
    tree = tree_of(seed)
    a, b = np.array(one[:2]), np.array(one[2:])
    t = (np.arange(20000) + 0.5) / 20000
    leaf = tree.locate(a + t[:, None] * (b - a))
    length = float(np.sqrt(((b - a) ** 2).sum()))
    mean = float((1 / tree.sides[leaf]).mean()) * length
    assert leaves_along(tree.grid, np.array([one]))[0] == pytest.approx(mean, rel=5e-3, abs=5e-3)


def test_a_segment_on_a_side_of_leaves_counts_once():
    tree = quadtree(UNIT, 0.25)
    rows = np.array([[0.0, 0.5, 1.0, 0.5], [0.5, 0.0, 0.5, 1.0], [0.0, 1.0, 1.0, 1.0], [0.0, 0.0, 1.0, 1.0]])
    np.testing.assert_allclose(leaves_along(tree.grid, rows), [4, 4, 4, 4 * 2**0.5])


@pytest.mark.parametrize("scale", [2.0**-400, 2.0**400])
def test_any_scale(scale):
    unit, tree = quadtree(UNIT, 0.25), quadtree(scale * np.array(UNIT), 0.25 * scale)
    rows = np.array([[0.1, 0.2, 0.7, 0.9]])
    assert (leaves_along(tree.grid, scale * rows) == leaves_along(unit.grid, rows)).all()
    one, two = Spots.of(unit), Spots.of(tree)
    first = nearness(unit.grid, rows, 1.0, one.of_leaf, one.points, one.sizes)
    assert (nearness(tree.grid, scale * rows, 1.0, two.of_leaf, two.points, two.sizes) == first).all()
