"""Vertices between quadrilaterals and triangles move to better places, and nothing turns over."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.generate.tree_regions.mixed_stars import cells_at, smoothed


def grid(n: int):
    """Squares, every third one cut into two triangles, with shaken inner vertices."""
    x, y = np.meshgrid(np.arange(n + 1), np.arange(n + 1))
    points = np.column_stack([x.ravel(), y.ravel()]).astype(float)
    cells = []
    for j in range(n):
        for i in range(n):
            a = j * (n + 1) + i
            quad = [a, a + 1, a + n + 2, a + n + 1]
            cells += [[*quad[:3], -1], [quad[0], *quad[2:], -1]] if (i + j) % 3 == 0 else [quad]
    free = ((points > 0) & (points < n)).all(axis=1)
    return points, np.array(cells, dtype=np.int32), free


def corners(points, cells):
    """The sines at all corners, and the exact signs of their turns."""
    sines, signs = [], []
    for row in cells:
        row = row[row >= 0]
        for k in range(len(row)):
            a, b, c = points[[row[k - 1], row[k], row[(k + 1) % len(row)]]]
            u, v = c - b, a - b
            unit = 1.0 if len(row) == 4 else 2 / 3**0.5
            sines.append(unit * (u[0] * v[1] - u[1] * v[0]) / np.sqrt((u @ u) * (v @ v)))
            (ax, ay), (bx, by), (cx, cy) = (tuple(map(Fraction, p.tolist())) for p in (a, b, c))
            signs.append((bx - ax) * (cy - ay) - (by - ay) * (cx - ax) > 0)
    return np.array(sines), np.array(signs)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), scale=st.sampled_from([1.0, 2.0**-300, 3e200]))
def test_the_worst_corner_rises_and_all_stay_positive(seed, scale):
    points, cells, free = grid(4)
    points[free] += np.random.default_rng(seed).uniform(-0.3, 0.3, (int(free.sum()), 2))
    if not corners(points, cells)[1].all():
        return
    found, moves = smoothed(points * scale, cells, free)
    assert (found[~free] == points[~free] * scale).all()
    before, (after, signs) = corners(points, cells)[0], corners(found / scale, cells)
    assert signs.all() and after.min() >= before.min() - 1e-12
    assert moves > 0 or before.min() > 0.7


def test_a_triangle_does_not_gain_by_a_poor_quadrilateral():
    """A vertex between a flat triangle, which gains as it goes up, and a quadrilateral that loses by it."""
    points = np.array([[0.0, 0], [2, 0], [1, 0.1], [2, 0.9], [0.6, 1.0], [0, 1]])
    cells = np.array([[0, 1, 2, -1], [1, 3, 4, 2], [0, 2, 4, 5]], dtype=np.int32)
    for x in np.linspace(0.5, 1.5, 21):
        points[2, 0] = x
        before, signs = corners(points, cells)
        found, _ = smoothed(points, cells, np.arange(6) == 2)
        after, _ = corners(found, cells)
        assert signs.all() and after.min() >= before.min()
        assert before[3:].min() < 0.63 or after[3:].min() >= 0.63


def test_good_cells_stay():
    points, cells, free = grid(3)
    found, moves = smoothed(points, cells, free)
    assert moves == 0 and (found == points).all()


@pytest.mark.parametrize("n", [1, 4])
def test_cells_at_a_vertex(n):
    points, cells, _ = grid(n)
    indptr, members = cells_at(cells, len(points))
    for v in range(len(points)):
        assert (
            members[indptr[v] : indptr[v + 1]].tolist() == np.flatnonzero((cells == v).any(axis=1)).tolist()
        )
