"""Places where triangles meet, beside fractions."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.geometry.crossing_places import crossing_places, near_places
from unstruct.geometry.embedded import flat_rows, meeting_pairs

ROWS = np.array([[0, 1, 2], [3, 4, 5]])


def heights(corners: list, x: list) -> list[Fraction]:
    """Six times the volumes of a triangle with each point."""
    a, b, c = corners
    u, v = ([p - q for p, q in zip(y, a)] for y in (b, c))
    n = [u[k - 2] * v[k - 1] - u[k - 1] * v[k - 2] for k in range(3)]
    return [sum((s * (p - q) for s, p, q in zip(n, y, a)), Fraction(0)) for y in x]


def is_in(corners: list, y: list) -> bool:
    """Whether a point of the plane of a triangle lies in it: by areas on the three coordinate planes."""
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        turns = [
            (q[i] - p[i]) * (y[j] - p[j]) - (q[j] - p[j]) * (y[i] - p[i])
            for p, q in zip(corners, corners[1:] + corners[:1])
        ]
        if min(turns) < 0 < max(turns):
            return False
    return True


def piercings(one: list, two: list) -> list[list[Fraction]]:
    """Where the sides of each pierce the other."""
    found = []
    for x, y in ((one, two), (two, one)):
        high = heights(y, x)
        for k in range(3):
            a, b = high[k], high[k - 1]
            if (a > 0) != (b > 0) and a != b:
                place = [p + a / (a - b) * (q - p) for p, q in zip(x[k], x[k - 1])]
                if is_in(y, place):
                    found.append(place)
    return found


@settings(deadline=None, max_examples=150)
@given(st.integers(0, 2**32), st.sampled_from([2, 4, 1000]))
def test_common_segments_beside_fractions(seed: int, span: int) -> None:
    x = np.random.default_rng(seed).integers(-span, span + 1, (6, 3)) / (2.0 * span)
    if len(flat_rows(x, ROWS)) or len(np.unique(x, axis=0)) < 6 or not len(meeting_pairs(x, ROWS)):
        return
    place = crossing_places(x, ROWS, np.array([[0, 1]]))[0]
    one, two = ([[Fraction(v) for v in row] for row in x[r].tolist()] for r in ROWS)
    wanted = np.array(piercings(one, two), dtype=float)
    if not any(heights(one, two)) or (place[1] != place[2]).any():  # one plane, or no more than a touch
        assert any((place == x[r]).all() for r in ROWS)
        return
    assert len(wanted)
    for end in wanted:
        assert np.abs(place[:2] - end).sum(axis=1).min() < 1e-9


def test_places_that_are_near() -> None:
    places = np.array([[[0, 0, 0], [1, 0, 0], [1, 0, 0]], [[0, 5, 0], [0, 6, 0], [1, 5, 0]]], dtype=float)
    others = np.array([[[0.5, 0.2, 0]] * 3, [[0.1, 5.1, 0.3]] * 3, [[3, 0, 0]] * 3], dtype=float)
    assert near_places(places, others, np.array([0.21, 0.31, 1.9])).tolist() == [True, True, False]
    assert near_places(places, others, np.array([0.19, 0.29, 2.1])).tolist() == [False, False, True]
    assert near_places(places[:0], others, np.ones(3)).tolist() == [False] * 3
