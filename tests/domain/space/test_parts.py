"""The parts of space between triangles: nested shells, walls, sheets, common edges and vertices."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.domain.space.parts import UNBOUNDED, parts_in_space

CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))
SQUARES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
CUBE = np.array([row for a, b, c, d in SQUARES for row in ((a, b, c), (a, c, d))])


def test_no_triangles() -> None:
    found = parts_in_space(np.empty((0, 3)), np.empty((0, 3), dtype=np.int32))
    assert found.walls == [] and found.locate(np.zeros((1, 3))).tolist() == [UNBOUNDED]


def test_nested_cubes() -> None:
    points = np.vstack([CORNERS * 4 - 1.5, CORNERS, CORNERS * 0.2 + 0.4])
    found = parts_in_space(points, np.vstack([CUBE, CUBE[:, ::-1] + 8, CUBE + 16]).astype(np.int32))
    assert found.locate(
        np.array([(0.5, 0.5, 0.45), (0.1, 0.1, 0.1), (-1, -1, -1.2), (9, 9, 9)])
    ).tolist() == [0, 1, 2, -1]
    assert found.front.reshape(3, -1)[:, 0].tolist() == [-1, 1, 1]
    assert found.back.reshape(3, -1)[:, 0].tolist() == [2, 2, 0]


@pytest.mark.parametrize("exponent", (-1000, -370, -340, 340, 900))
@pytest.mark.parametrize("stretch", ((0, 0, 0), (-300, 0, 0), (-450, -450, 0)))
def test_parts_in_any_unit_and_of_needles(exponent: int, stretch: tuple[int, int, int]) -> None:
    """A volume below the smallest doubles is one: nothing was inside of a body of size 1e-110."""
    points = np.ldexp(np.vstack([CORNERS * 4, CORNERS + 1]), np.maximum(np.array(stretch) + exponent, -1000))
    found = parts_in_space(points, np.vstack([CUBE, CUBE + 8]).astype(np.int32))
    assert len(found.walls) == 2 and sorted({*found.front.tolist(), *found.back.tolist()}) == [-1, 0, 1]
    assert found.front[0] == UNBOUNDED and found.back[0] == found.front[12] == 1 and found.back[12] == 0


def test_a_tiny_hollow_beside_a_large_body() -> None:
    points = np.vstack([CORNERS * 2 - 1, (CORNERS - 0.5) * 1e-120])
    found = parts_in_space(points, np.vstack([CUBE, CUBE + 8]).astype(np.int32))
    assert len(found.walls) == 2 and found.front[12] == 1 and found.back[12] == 0


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 3))
def test_unit_cubes_of_a_grid(seed: int, size: int) -> None:
    """Some squares of a grid of cubes: parts are those of the cubes joined where a square is missing."""
    rng = np.random.default_rng(seed)
    n = size + 1
    points = np.array(list(product(range(n), repeat=3)), dtype=float)
    at = np.arange(n**3).reshape(n, n, n)
    cubes = {cell: i for i, cell in enumerate(product(range(size), repeat=3))}
    label = list(range(len(cubes) + 1))  # the last is the outside

    def root(i: int) -> int:
        return i if label[i] == i else root(label[i])

    rows, sides = [], []
    for axis in range(3):
        for cell in product(*(range(n if k == axis else size) for k in range(3))):
            before = tuple(c - (k == axis) for k, c in enumerate(cell))
            one, two = cubes.get(before, len(cubes)), cubes.get(cell, len(cubes))
            if rng.random() < 0.25:
                label[root(one)] = root(two)
                continue
            steps = [np.eye(3, dtype=int)[k] for k in range(3) if k != axis]
            a, b, c, d = (at[tuple(np.array(cell) + s)] for s in (0, steps[0], steps[0] + steps[1], steps[1]))
            for row in ((a, b, c), (a, c, d)):
                turned = rng.random() < 0.5
                normal = np.cross(points[row[1]] - points[row[0]], points[row[2]] - points[row[0]])[axis] > 0
                rows.append(row[::-1] if turned else row)
                sides.append((two, one) if normal != turned else (one, two))
    if not rows:
        return
    order = rng.permutation(len(rows))
    found = parts_in_space(points, np.array(rows, dtype=np.int32)[order])
    roots = np.array([[root(i) for i in sides[k]] for k in order])
    mine = np.column_stack([found.front, found.back])
    outside = root(len(cubes))
    assert ((mine == UNBOUNDED) == (roots == outside)).all()
    pairs = set(zip(mine.ravel().tolist(), roots.ravel().tolist()))
    assert len(pairs) == len({a for a, _ in pairs}) == len({b for _, b in pairs})
    middles = np.array(list(cubes)) + np.array([0.5, 0.4375, 0.28125])
    where = found.locate(middles)
    assert [(-1 if root(i) == outside else 0) for i in range(len(cubes))] == [
        min(w, 0) for w in where.tolist()
    ]


@pytest.mark.parametrize("shift", [(1, 1, 1), (1, 1, 0), (1, 0, 0)])
def test_cubes_that_touch(shift: tuple) -> None:
    """In a vertex, an edge, a square: always two parts."""
    points = np.unique(np.vstack([CORNERS, CORNERS + shift]), axis=0)
    where = {tuple(x): i for i, x in enumerate(points.tolist())}
    two = [[where[tuple(x)] for x in (CORNERS[row] + shift).tolist()] for row in CUBE]
    one = [[where[tuple(x)] for x in CORNERS[row].tolist()] for row in CUBE]
    rows = {tuple(sorted(row)): row for row in one + two}
    if shift == (1, 0, 0):  # the diagonals of the common square may differ
        rows = {key: row for key, row in rows.items() if not all(points[row][:, 0] == 1)}
        rows |= {tuple(sorted(row)): row for row in one if all(points[row][:, 0] == 1)}
    found = parts_in_space(points, np.array(list(rows.values()), dtype=np.int32))
    seeds = np.array([(0.5, 0.25, 0.375), np.array(shift) + np.array([0.5, 0.25, 0.375])])
    assert sorted(found.locate(seeds).tolist()) == [0, 1] and len(found.walls) == 2
