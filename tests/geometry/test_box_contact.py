"""Whether pieces meet the inside of boxes, against clipping in rational numbers."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from unstruct.geometry.box_contact import pieces_in_boxes
from unstruct.plain.tree_states import meets

GRID = st.integers(-6, 6).map(lambda i: i / 8)  # ties: on faces, through edges and corners
WIDE = st.builds(lambda m, e: float(np.ldexp(m, e)), st.integers(-9, 9), st.integers(-60, -4))
NEAR = st.builds(lambda x, up: float(np.nextafter(x, up)), GRID, st.sampled_from([-np.inf, np.inf]))
NUMBERS = [GRID, GRID | NEAR, GRID | WIDE, NEAR | WIDE, st.floats(-1, 1, allow_subnormal=False)]


def flat(piece: np.ndarray) -> bool:
    """Whether a segment is a point, or a triangle a segment, exactly."""
    rows = [[Fraction(x) - Fraction(y) for x, y in zip(p, piece[0])] for p in piece[1:].tolist()]
    if len(rows) == 1:
        return not any(rows[0])
    u, v = rows
    pairs = [(i, j) for i in range(len(u)) for j in range(i)]
    return all(u[i] * v[j] == u[j] * v[i] for i, j in pairs)


def answered(piece: np.ndarray, low: np.ndarray, high: np.ndarray) -> bool:
    rows = np.arange(len(piece))[None]
    return bool(pieces_in_boxes(piece, rows, np.zeros(1, dtype=np.int64), low[None], high[None])[0])


@pytest.mark.parametrize(("d", "k"), [(2, 1), (2, 2), (3, 1), (3, 2), (3, 3)])
@settings(max_examples=200)
@given(data=st.data())
def test_as_clipped(d: int, k: int, data: st.DataObject) -> None:
    numbers = data.draw(st.sampled_from(NUMBERS))
    drawn = data.draw(st.lists(numbers, min_size=(k + 2) * d, max_size=(k + 2) * d))
    piece, ends = np.split(np.array(drawn).reshape(-1, d), [k])
    low, high = ends.min(axis=0), ends.max(axis=0)
    assume((low < high).all() and (k == 1 or not flat(piece)))
    expected = meets(piece.tolist(), low.tolist(), high.tolist())
    assert answered(piece, low, high) == expected
    for order in ([1, 2, 0], [2, 1, 0])[: 2 * (k == 3)]:
        assert answered(piece[order], low, high) == expected
    assert answered(-piece, -high, -low) == expected


CUBE = (np.zeros(3), np.full(3, 0.5))


@pytest.mark.parametrize(
    ("piece", "expected"),
    [
        ([(0, 0, 0), (0.5, 0, 0), (0, 0.5, 0)], False),  # in a face
        ([(0, 0, 0), (0.5, 0.5, 0), (0.5, 0.5, 0.5)], True),  # through two opposite edges
        ([(1, 0.5, 0), (0, 1, 0.5), (0.5, 0, 1)], False),  # touches a corner
        ([(1, 0, 0.25), (0, 1, 0.25), (1, 1, 0.25)], False),  # touches an edge
        ([(1, 0.5, 0), (0.5, 1, 0), (0.25, 0.75, 1)], False),
        ([(-1, -1, 0.25), (1, -1, 0.25), (0, 1, 0.25)], True),  # goes around it, its corners far away
        ([(0.5, 0.5, 0.5), (1, 1, 1), (1, 0.5, 1)], False),  # a corner in common
    ],
)
def test_named_contacts(piece: list, expected: bool) -> None:
    assert meets(piece, *CUBE) == expected
    assert answered(np.array(piece, dtype=float), *CUBE) == expected


def test_many_at_once() -> None:
    rng = np.random.default_rng(0)
    points = rng.integers(-8, 9, (40, 3)) / 8
    pieces = np.array([rng.choice(40, 3, replace=False) for _ in range(60)])
    pieces = pieces[[not flat(points[row]) for row in pieces]]
    which = np.repeat(np.arange(len(pieces)), 5)
    low = rng.integers(-8, 6, (len(which), 3)) / 8
    high = low + rng.integers(1, 4, low.shape) / 8
    found = pieces_in_boxes(points, pieces, which, low, high)
    rows = zip(points[pieces[which]].tolist(), low.tolist(), high.tolist(), strict=True)
    assert found.tolist() == [meets(*row) for row in rows]
    assert found.any() and not found.all()
