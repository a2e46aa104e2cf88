"""Edges turned in planes: cubes of squares and columns of prisms, each square with a diagonal by chance."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from recovered import judge

from unstruct.connect.spatial import recover
from unstruct.connect.spatial.complex import SpatialComplex
from unstruct.connect.spatial.held import hold
from unstruct.connect.spatial.lookup import edges_there

PLAIN = (5, 0, 100, 2000)  # flips alone: no cavity has six vertices


def squares(shape: tuple[int, int, int], seed: int) -> tuple[np.ndarray, np.ndarray]:
    """The surface of a block of unit cubes, each square with one of its diagonals by chance."""
    rng = np.random.default_rng(seed)
    number: dict[tuple[int, ...], int] = {}
    rows = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for end in (0, shape[axis]):
            for i, j in np.ndindex(shape[u], shape[v]):
                square = []
                for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    corner = [0, 0, 0]
                    corner[axis], corner[u], corner[v] = end, i + di, j + dj
                    square.append(number.setdefault(tuple(corner), len(number)))
                k = int(rng.integers(2))
                a, b, c, d = square[k:] + square[:k]
                rows += [(a, b, c), (a, c, d)]
    return np.array(list(number), dtype=float), np.array(rows)


@settings(max_examples=40, deadline=None)
@given(st.tuples(*[st.integers(1, 5)] * 3), st.integers(0, 10**6), st.sampled_from([1.0, 0.1, 1 / 3]))
def test_blocks_keep_their_diagonals(shape: tuple[int, int, int], seed: int, step: float) -> None:
    """Exactly cospherical, or nearly so by a step that is rounded; always exact and without a point on it."""
    points, triangles = squares(shape, seed)
    c = SpatialComplex(points * step)
    found = c.recover(triangles)
    judge(c, triangles, found)
    assert found.exact


@pytest.mark.parametrize("step", [1.0, 2 / 33])
def test_few_points_inside_are_left_of_a_cube(step: float) -> None:
    points, triangles = squares((12, 12, 12), 0)
    c = SpatialComplex(points * step)
    found = c.recover(triangles)
    judge(c, triangles, found)
    assert found.exact and len(found.inner) <= 5


@pytest.mark.parametrize("seed", range(3))
def test_flips_alone_turn_most_diagonals(seed: int) -> None:
    """Cells around a diagonal fill the same space before and after; what was held stays."""
    points, triangles = squares((8, 8, 8), seed)
    c = SpatialComplex(points)
    run = recover.Recovery(
        c, recover.Given(triangles.astype(np.int32), np.empty((0, 2), np.int32)), budget=0, seed=0
    )
    goals = np.zeros((len(run.given.segment), 4), dtype=np.int32)
    goals[:, :2] = run.given.segment
    there = edges_there(c.solid(), run.given.segment)
    for u, v in run.given.segment[there].tolist():
        hold(run.held, u, v, 1)
    left = np.where(there, 0, 1).astype(np.int64)
    run._refill(recover.EDGE, goals, left, PLAIN)
    c.validate()
    now = edges_there(c.solid(), run.given.segment)
    assert now[there].all() and (now == (left == 0)).all()
    assert (~now).sum() < 0.15 * (~there).sum()
