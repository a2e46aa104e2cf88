"""A point at any place: its shortest new edges and the local maxima of the distance, by brute force."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from unstruct import InputError
from unstruct.plain import placement
from unstruct.plain.bowyer_watson import bowyer_watson
from unstruct.view import check_frame
from unstruct.view.scenes.places import PLACE_POINTS, is_peak, nearest_points, place_state

GRID = [*product((-8, -5, -3, 0, 3, 8), (-10, -5, -3, 0, 1, 5))]


@pytest.mark.parametrize("preset", PLACE_POINTS)
def test_the_whole_range(preset: str) -> None:
    """The shortest edges are those of the plain insertion, which shares no code, also where points tie."""
    rows = [tuple(map(int, p)) for p in PLACE_POINTS[preset]]
    cells = list(bowyer_watson(rows))[-1].cells
    for place in GRID:
        one = place_state(preset, *map(float, place))
        check_frame(one)
        if place in rows:
            assert "nothing to insert" in one["number"]
            continue
        lengths = placement.new_edges(rows, cells, place)[1]
        shortest = min(lengths.values())
        near = sorted(v for v, length in lengths.items() if length == shortest)
        assert one["number"].startswith(f"shortest new edge {float(shortest) ** 0.5:.2f}")
        names = ", ".join("ABCDEFGHI"[v] for v in near)
        assert one["caption"].split(";")[0] == f"nearest: {names}"


@pytest.mark.parametrize("preset", PLACE_POINTS)
def test_a_peak_is_higher_than_all_places_around(preset: str) -> None:
    """On a circle of small steps, in exact numbers: a direction that does not descend ends a peak."""
    rows = [tuple(map(Fraction, p)) for p in PLACE_POINTS[preset]]

    def far(x: Fraction | int, y: Fraction | int) -> Fraction:
        return min((x - a) ** 2 + (y - b) ** 2 for a, b in rows)

    turns = [(Fraction(1 - t * t, 1 + t * t), 2 * t / (1 + t * t)) for t in map(Fraction, range(-9, 10))]
    turns += [(-c, -s) for c, s in turns] + [(-s, c) for c, s in turns] + [(s, -c) for c, s in turns]
    found = 0
    for x, y in GRID:
        higher = all(far(x + c / 10**6, y + s / 10**6) < far(x, y) for c, s in turns)
        peak = is_peak(np.array(PLACE_POINTS[preset], dtype=float), np.array([x, y], dtype=float))
        assert peak == higher
        found += peak
    assert (found > 0) == ("acute" in preset or "lattice" in preset)


def test_ties_are_exact() -> None:
    rho, near = nearest_points(np.array(PLACE_POINTS["nasty: a lattice"], dtype=float), np.array([3.0, 1.0]))
    assert rho == np.sqrt(18) and near.tolist() == [1, 2, 4, 5]


@pytest.mark.parametrize(("x", "y"), [(-8.1, 0), (0, 5.1), (float("nan"), 0)])
def test_wrong_places(x: float, y: float) -> None:
    with pytest.raises(InputError, match=r"must lie between"):
        place_state("an obtuse triangle", x, y)
    with pytest.raises(InputError, match="no preset"):
        place_state("none")
