"""Conforming tetrahedra: as the plain templates."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from trees import exact, leaves, planted, toward

from unstruct import Mesh, check
from unstruct.generate.tree.cubes import cubes_as_tetrahedra
from unstruct.generate.tree.vertices import numbered
from unstruct.plain import tree as plain
from unstruct.plain.tree_templates import tetrahedra


def everywhere(tree):
    return cubes_as_tetrahedra(tree.grid, numbered(tree.grid), np.ones(len(tree), dtype=bool))


@pytest.mark.parametrize("across", ["edges", "corners"])
def test_as_the_plain_templates(across: str) -> None:
    @settings(max_examples=10)
    @given(leaves(3, deepest=4, targets=3))
    def check_all(cells: frozenset) -> None:
        tree = planted(cells, 3).balanced(across)
        points, rows, leaf = everywhere(tree)
        expected = {frozenset(t) for t in tetrahedra(plain.balance(cells, across))}
        assert {frozenset(map(exact, t)) for t in points[rows]} == expected and len(rows) == len(expected)
        assert bool(check(Mesh(points, rows)))
        low, high = tree.corners
        middle = points[rows].mean(axis=1)
        assert ((low[leaf] < middle) & (middle < high[leaf])).all()

    check_all()


def test_dihedral_angles() -> None:
    """The bounds that `Tree.mesh` states, over trees with all kinds of neighbors."""
    rng = np.random.default_rng(0)
    least, most = 180.0, 0.0
    for across in ("edges", "corners"):
        for _ in range(4):
            rows = [(tuple(rng.integers(0, 256, 3).tolist()), 5) for _ in range(3)]
            points, cells, _ = everywhere(planted(toward(3, rows), 3).balanced(across))
            mesh = Mesh(points, cells)
            least = min(least, mesh.quality("min_dihedral").min())
            most = max(most, mesh.quality("max_dihedral").max())
    assert 19.4 < least < 19.5 and 144.7 < most < 144.8
