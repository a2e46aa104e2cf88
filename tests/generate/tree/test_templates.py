"""Conforming triangles: as the plain templates, all angles 45 or 90 degrees, exactly."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from trees import BOXES, exact, leaves, planted

from unstruct import Mesh, check
from unstruct.generate.tree.templates import middles_of, squares_as_triangles
from unstruct.generate.tree.vertices import numbered
from unstruct.plain import tree as plain
from unstruct.plain.tree_templates import hanging, triangles


def everywhere(tree):
    return squares_as_triangles(tree.grid, numbered(tree.grid), np.ones(len(tree), dtype=bool))


@pytest.mark.parametrize("across", ["faces", "corners"])
def test_as_the_plain_templates(across: str) -> None:
    @settings(max_examples=30)
    @given(leaves(2, deepest=6))
    def check_all(cells: frozenset) -> None:
        tree = planted(cells, 2).balanced(across)
        points, rows, leaf = everywhere(tree)
        x = points[rows]
        sides = np.roll(x, -1, axis=1) - x
        length = np.sort((sides * sides).sum(axis=2), axis=1)  # exact: coordinates are multiples of 2**-9
        assert (length[:, 0] == length[:, 1]).all() and (length[:, 2] == 2 * length[:, 0]).all()
        expected = {frozenset(t) for t in triangles(plain.balance(cells, across))}
        assert {frozenset(map(exact, t)) for t in x} == expected and len(rows) == len(expected)
        assert bool(check(Mesh(points, rows)))
        low, high = tree.corners
        middle = x.mean(axis=1)
        assert ((low[leaf] < middle) & (middle < high[leaf])).all()

    check_all()


@given(leaves(2, deepest=6))
def test_middles_hang(cells: frozenset) -> None:
    tree = planted(cells, 2).balanced("faces")
    vertices = numbered(tree.grid)
    found = middles_of(tree.grid, vertices)
    low, high = tree.corners
    middle = 0.5 * (low + high)
    sides = [(middle[:, 0], low[:, 1]), (high[:, 0], middle[:, 1])]
    sides += [(middle[:, 0], high[:, 1]), (low[:, 0], middle[:, 1])]
    for k, side in enumerate(sides):
        rows = found[:, k] >= 0
        np.testing.assert_array_equal(vertices.points[found[rows, k]], np.stack(side, axis=1)[rows])
    hung = {exact(x) for x in vertices.points[found[found >= 0]]}
    assert hung == hanging(plain.balance(cells, "faces"))


@pytest.mark.parametrize("box", range(3))
def test_any_box_and_some_leaves_only(box: int) -> None:
    cells = plain.balance(plain.build(2, lambda cell: cell[1:] == (0, 0), 6))
    tree = planted(cells, 2, BOXES[2][box])
    chosen = np.random.default_rng(0).random(len(tree)) < 0.7
    points, rows, leaf = squares_as_triangles(tree.grid, numbered(tree.grid), chosen)
    assert set(leaf.tolist()) == set(np.flatnonzero(chosen).tolist())
    x = points[rows] - tree.box[0]
    u, v = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
    area = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    low, high = tree.corners
    np.testing.assert_allclose(area.sum(), (high - low)[chosen].prod(axis=1).sum(), rtol=1e-7)
    assert (area > 0).all()
