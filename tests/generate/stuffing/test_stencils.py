"""The rule for diagonals: as Labelle and Shewchuk state it, the same for all levels, symmetric."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from unstruct.generate.stuffing.stencils import Cuts, stenciled

LONG = np.array([(2, 0, 0), (0, 2, 0), (0, 0, 2)])


def short_steps() -> list[np.ndarray]:
    return [np.array(step) for step in product((-1, 1), repeat=3)]


def diagonal(place: np.ndarray) -> frozenset[int]:
    """The diagonal of the quadrilateral in the face 0, 1, 3: the ends are vertices and 4, 5, cut points.

    Vertices 0 and 1 are inside, 2 is on the surface, 3 outside; the cut points are on 0 - 3 and 1 - 3.
    """
    signs = np.array([1, 1, 0, -1], dtype=np.int8)
    cuts = Cuts(np.array([0 * 4 + 3, 1 * 4 + 3], dtype=np.int64), 4)
    cells = np.arange(4, dtype=np.int32)[None]
    pieces, owner = stenciled(cells, signs, np.ascontiguousarray(place, dtype=np.int64), cuts)
    assert len(pieces) == 2
    assert not owner.any()
    (found,) = [pair for pair in ({0, 5}, {1, 4}) if all(pair <= set(row) for row in pieces.tolist())]
    return frozenset(found)


def faces() -> list[tuple[int, np.ndarray]]:
    """A whole long edge and a vertex outside, all 24 at a corner (0) and at a center (1) of cubes.

    The third vertex is one of the two that make a tetrahedron of the lattice with the face.
    """
    found = []
    for odd, a in product((0, 1), range(3)):
        for step in short_steps():
            if step[a] < 0:
                continue
            start = np.full(3, 4 + odd)
            d = start + step
            b = (a + 1) % 3
            third = d.copy()
            third[b] -= 2 * step[b]
            found.append((odd, np.array([start, start + LONG[a], third, d])))
    return found


@pytest.mark.parametrize("level", range(4))
@pytest.mark.parametrize("share", [0.3, 0.5, 0.7])
def test_the_rule_of_the_paper(level: int, share: float) -> None:
    """Let a and b be the ends of a long edge that is not cut, and c the cut point next to b. Between corners
    of cubes the diagonal is from a to c if an odd number of coordinates of a is larger than that of c, and
    between centers if an even number is.
    """
    for odd, place in faces():
        for order in ((0, 1), (1, 0)):
            scaled = place[[*order, 2, 3]] << level
            a, b, d = scaled[0], scaled[1], scaled[3]
            c = b + share * (d - b)
            from_a = (a > c).sum() % 2 == 1 - odd
            assert diagonal(scaled) == ({0, 5} if from_a else {1, 4})


def test_corners_and_centers_are_reflections_of_each_other() -> None:
    """A reflection in the middle of a short edge exchanges them, and keeps the rule."""
    for _, place in faces():
        assert diagonal(9 - place) == diagonal(place)


def test_a_long_edge_that_is_cut() -> None:
    """The diagonal ends at its cut point."""
    for odd, a in product((0, 1), range(3)):
        for step in short_steps():
            p = np.full(3, 4 + odd)
            d = p + LONG[a]
            q = p + np.where(np.arange(3) == a, 1, step)
            third = q.copy()
            third[(a + 1) % 3] -= 2 * step[(a + 1) % 3]
            assert diagonal(np.array([p, q, third, d])) == {1, 4}
            assert diagonal(np.array([q, p, third, d])) == {0, 5}
