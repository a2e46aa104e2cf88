"""Hanging vertices, and what they are the means of."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from trees import exact, leaves, planted

from unstruct import Domain, quadtree
from unstruct.generate.tree.hanging import hanging_of
from unstruct.generate.tree.vertices import numbered
from unstruct.plain import tree as plain
from unstruct.plain.tree_templates import hanging, vertices


def inside_of(x: tuple, cell: tuple) -> bool:
    low, high = plain.box(cell)
    corner = all(c in (a, b) for c, a, b in zip(x, low, high, strict=True))
    return not corner and all(a <= c <= b for c, a, b in zip(x, low, high, strict=True))


@pytest.mark.parametrize("d", [2, 3])
def test_as_by_looking_at_all_leaves(d: int) -> None:
    @settings(max_examples=20)
    @given(leaves(d, targets=2))
    def check(cells: frozenset) -> None:
        tree = planted(cells, d)
        vs = numbered(tree.grid)
        found = hanging_of(tree.grid, vs, np.ones(len(tree), dtype=bool))
        expected = {x for x in vertices(cells) if any(inside_of(x, cell) for cell in cells)}
        assert {exact(x) for x in vs.points[found.vertices]} == expected
        assert (np.diff(found.vertices) > 0).all()
        parents = np.where(found.parents[:, :, None] >= 0, vs.points[found.parents], 0.0)
        means = (parents * found.weights[:, :, None]).sum(axis=1)
        np.testing.assert_array_equal(means, vs.points[found.vertices])  # weights of any tree are dyadic
        assert ((found.weights > 0) == (found.parents >= 0)).all()
        np.testing.assert_array_equal(found.weights.sum(axis=1), 1.0)

    check()


@pytest.mark.parametrize("d", [2, 3])
def test_in_balanced_trees_they_are_middles(d: int) -> None:
    @settings(max_examples=10)
    @given(leaves(d, deepest=4, targets=2))
    def check(cells: frozenset) -> None:
        tree = planted(cells, d).balanced()
        found = tree.hanging
        assert len(found.vertices) == len(hanging(plain.balance(cells)))
        assert {*np.unique(found.weights).tolist()} <= {0.0, 0.25, 0.5}
        mesh = tree.mesh("cells")
        np.testing.assert_array_equal(mesh.markers["hanging"].ravel(), found.vertices)

    check()


def test_a_linear_function_is_continuous() -> None:
    """Also where parents hang on larger leaves themselves, and with leaves outside left out."""
    tree = quadtree(Domain.disc(), boundary_size=0.1, balance=None)
    mesh, found = tree.mesh("cells"), tree.hanging
    u = mesh.points[:, 0] - 2.0 * mesh.points[:, 1]
    np.testing.assert_allclose((u[found.parents] * found.weights).sum(axis=1), u[found.vertices], atol=1e-14)
    assert len(found.vertices) and found.vertices.max() < len(mesh.points)
