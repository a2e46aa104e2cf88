"""Which cells of strips are good: the kernel beside `orient` for each corner, and for wide exponents."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.generate.layers.heights import Fronts
from unstruct.generate.layers.rays import FREE_RAY, Rays
from unstruct.generate.layers.stops import Stops
from unstruct.generate.layers.strips import positive


def turn(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> Fraction:
    ax, ay, bx, by, cx, cy = (Fraction(float(v)) for p in (a, b, c) for v in p)
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


@settings(max_examples=60, deadline=None)
@given(
    st.integers(0, 2**32 - 1), st.integers(2, 6), st.integers(1, 4), st.sampled_from([1.0, 1e-200, 5e-310])
)
def test_all_cells_are_positive_afterwards(seed: int, many: int, layers: int, thin: float) -> None:
    """An open chain of rays over a wall, with places on a small grid: many ties and turned cells.

    With 5e-310 the exponents are too wide for one scale.
    """
    rng = np.random.default_rng(seed)
    base = np.column_stack([np.arange(many) * 2.0, np.zeros(many)])
    shift = rng.integers(-1, 2, (many, layers, 2)) * [1.0, 1.0]
    rise = np.arange(1, layers + 1)[None, :, None] * np.array([0.0, 2.0])
    places = np.concatenate([base[:, None], base[:, None] + (shift + rise) * [1.0, thin]], axis=1)
    none = np.zeros(many)
    rays = Rays(
        np.arange(many), np.tile([0.0, 1.0], (many, 1)), none + 1, np.full(many, FREE_RAY, dtype=np.int8),
        np.full(many, -1), none + 1, np.arange(many - 1), np.arange(1, many), np.arange(many - 1),
        np.arange(many) - 1, np.append(np.arange(1, many), -1),
    )  # fmt: skip
    level = rng.integers(0, layers + 1, many)
    fronts = Fronts(places, np.zeros((many, layers)), np.zeros((many, layers + 1)), level, none, False)
    found = positive(base, rays, fronts, Stops(level, np.zeros(many, dtype=np.int8))).level
    assert (found <= level).all() and (np.abs(np.diff(found)) <= 1).all()
    for i in range(many - 1):
        for m in range(min(found[i], found[i + 1])):
            a, b, c, d = places[i, m], places[i + 1, m], places[i + 1, m + 1], places[i, m + 1]
            assert min(turn(a, b, c), turn(b, c, d), turn(c, d, a), turn(d, a, b)) > 0
        if found[i] != found[i + 1]:
            m, up = min(found[i], found[i + 1]), i if found[i] > found[i + 1] else i + 1
            assert turn(places[i, m], places[i + 1, m], places[up, m + 1]) > 0
