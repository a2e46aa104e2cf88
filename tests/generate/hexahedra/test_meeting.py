"""Leaves and pieces that meet: as by clipping in rationals, one pair after the other."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import octree, quadtree
from unstruct.generate.hexahedra.meeting import TOUCHES_WITHIN, meetings


def enters(a: list[float], b: list[float], low: list[float], high: list[float], off: Fraction) -> bool:
    """Whether a segment meets the inside of a box, larger by a share of its sides."""
    first, last = Fraction(0), Fraction(1)
    for p, q, u, v in zip(*(map(Fraction, row) for row in (a, b, low, high)), strict=True):
        u, v = u - off * (v - u), v + off * (v - u)
        if p == q:
            if not u < p < v:
                return False
            continue
        one, two = sorted([(u - p) / (q - p), (v - p) / (q - p)])
        if not (one < 1 and two > 0):
            return False
        first, last = max(first, one), min(last, two)
    return first < last


@settings(max_examples=40, deadline=None)
@given(st.integers(2, 3), st.integers(0, 10**6), st.booleans())
def test_segments_on_a_lattice(d: int, seed: int, touching: bool) -> None:
    rng = np.random.default_rng(seed)
    tree = (quadtree if d == 2 else octree)([[0] * d, [4] * d], 1.0).refined([0, 3])
    points = rng.integers(0, 9, (8, d)) / 2
    pieces = np.array([(i, i + 1) for i in range(0, 8, 2) if (points[i] != points[i + 1]).any()])
    chosen = rng.random(len(tree)) < 0.8
    leaf, piece = meetings(tree, chosen, points, pieces, touching=touching)
    low, high = tree.corners
    off = Fraction(TOUCHES_WITHIN) if touching else Fraction(0)
    wanted = [
        (i, k)
        for i in np.flatnonzero(chosen).tolist()
        for k, (a, b) in enumerate(pieces)
        if enters(points[a].tolist(), points[b].tolist(), low[i].tolist(), high[i].tolist(), off)
    ]
    assert list(zip(leaf.tolist(), piece.tolist(), strict=True)) == wanted


@pytest.mark.parametrize("unit", [1e-200, 1.0, 1e200])
def test_points_triangles_and_nothing(unit: float) -> None:
    tree = octree([[0, 0, 0], [2 * unit] * 3], 1.0 * unit)
    every = np.ones(8, dtype=bool)
    x = np.array([[1, 1, 1], [0.5, 0.5, 0.5], [2, 0, 0], [0, 2, 0], [0, 0, 1]]) * unit
    assert meetings(tree, every, x, np.array([[0]]))[0].tolist() == []
    assert len(meetings(tree, every, x, np.array([[0]]), touching=True)[0]) == 8
    assert meetings(tree, every, x, np.array([[1]]))[0].tolist() == [0]
    assert meetings(tree, every, x, np.array([[2, 3, 4]]))[0].tolist() == [0, 1, 2]
    assert len(meetings(tree, every, x, np.empty((0, 3), dtype=np.int32))[0]) == 0
