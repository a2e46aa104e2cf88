"""Which side is inside, where a part of the boundary lies in a plane that is seen edge-on along an axis."""

from __future__ import annotations

from itertools import permutations, product

import numpy as np
import pytest

from unstruct import Domain

CORNERS = np.array(list(product((0, 1), repeat=3)))
SQUARES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
CROSS = [(0, 0, 0), (1, 0, 1), (-1, 0, 1), (0, 1, 1), (0, -1, 1)]


@pytest.mark.parametrize("axes", list(permutations(range(3))))
def test_a_square_at_whose_four_sides_four_facets_meet(axes: tuple[int, ...]) -> None:
    """The top of the lowest of five cubes hangs together with nothing: its volume had the wrong sign."""
    every = np.concatenate([CORNERS + low for low in CROSS])[:, axes]
    points, number = np.unique(every, axis=0, return_inverse=True)
    number = number.ravel()
    body = Domain(
        points.astype(float), [[number[8 * i + v] for v in row] for i in range(5) for row in SQUARES]
    )
    assert body.volume == 5.0
    seeds = np.array([np.array(low) + np.array([0.5, 0.25, 0.375]) for low in [*CROSS, (0, 0, 1)]])[:, axes]
    assert body.contains(seeds).tolist() == [True] * 5 + [False]
