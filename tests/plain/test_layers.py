"""The plain layers: by hand on a square, and against the library's springs and cells."""

from __future__ import annotations

from math import hypot, sqrt

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from unstruct.generate.layers.spring import spring_force as forces
from unstruct.plain.layers import advance, layer_cells, least_force, march, spring_force, wall_rays

SQUARE = [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0)]  # a body: what is to be meshed lies to the left
NUMBER = st.floats(-10, 10)
POINT = st.tuples(NUMBER, NUMBER)


def test_rays_of_a_square() -> None:
    half = sqrt(0.5)
    expected = [(-half, -half), (-half, half), (half, half), (half, -half)]
    np.testing.assert_allclose(wall_rays(SQUARE), expected)
    np.testing.assert_allclose(advance(SQUARE, wall_rays(SQUARE), sqrt(2.0))[0], (-1.0, -1.0))


@given(POINT, POINT, POINT, st.floats(0, 5))
def test_springs_as_in_the_library(x: tuple, a: tuple, b: tuple, rest: float) -> None:
    one = spring_force(x, a, b, rest)
    many = forces(np.array([x]), np.array([a]), np.array([b]), np.array([rest]))
    np.testing.assert_allclose(many, [one], atol=1e-12)


def test_an_opposing_point_within_a_cell_takes_least_force() -> None:
    a, b, step = (0.0, 0.0), (1.0, 0.0), 0.01
    new = [(0.0, step), (1.0, step)]
    assert least_force([*new, (0.5, 1.3)], a, b) == 2
    assert least_force([*new, (0.5, 1.5)], a, b) != 2


def test_layers_stop_by_match_by_a_front_and_by_neighbors() -> None:
    side = [k / 8 for k in range(8)]  # a box from within
    ring = [(t, 0.0) for t in side] + [(1.0, t) for t in side]
    ring += [(1 - t, 1.0) for t in side] + [(0.0, 1 - t) for t in side]
    heights = np.cumsum(0.01 * 1.3 ** np.arange(20)).tolist()
    free = march(ring, heights, [], lambda x: 1.0)
    assert max(abs(p - q) for p, q in zip(free, [*free[1:], free[0]])) <= 1
    near = march(ring, heights, [(0.5, 0.2)], lambda x: 1.0)
    middle = ring.index((0.5, 0.0))
    assert 0 < near[middle] < free[middle]
    fine = march(ring, heights, [], lambda x: 0.015)
    assert max(fine) <= 2


@given(st.lists(st.integers(0, 4), min_size=3, max_size=12))
def test_cells_fill_the_strips(level: list[int]) -> None:
    level = [min(k, level[i - 1] + 1) if i else k for i, k in enumerate(level)]
    cells = layer_cells(level)
    sides = [(p, q) for cell in cells for p, q in zip(cell, [*cell[1:], cell[0]])]
    inner = [(p, q) for p, q in sides if (q, p) in set(sides)]
    n = len(level)
    outer = set(sides) - set(inner)
    for i in range(n):
        j = (i + 1) % n
        if abs(level[i] - level[j]) <= 1 and max(level[i], level[j]) > 0:
            assert ((i, 0), (j, 0)) in outer  # the wall
            top = (j, level[j]), (i, level[i])
            assert top in outer  # the envelope
    assert all(hypot(p[0] - q[0], p[1] - q[1]) > 0 for p, q in sides)
