"""The theorem behind refills (book, 2.8b): faces that cancel are enough.

The oracle tries all sets of tetrahedra, fits them by circuits, and adds up volumes; it knows no faces.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import combinations

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from unstruct import delaunay
from unstruct.errors import DegenerateInputError
from unstruct.plain.predicates import orient
from unstruct.plain.refilling import in_the_way, recovery_steps, refills, walls_of

Cell = tuple[int, int, int, int]


def six_volume(rows: list) -> int:
    """Six times the volume of a tetrahedron."""
    return abs(round(np.linalg.det(np.array(rows[1:]) - np.array(rows[0]))))  # small integers


def positive(points: list, cell: list[int]) -> Cell:
    a, b, c, d = cell
    return (a, b, c, d) if orient([points[v] for v in cell]) > 0 else (a, b, d, c)


def circuits(points: list) -> set[tuple[frozenset[int], frozenset[int]]]:
    """Pairs of disjoint smallest sets of vertices whose hulls meet, in both orders."""
    found = set()
    for five in combinations(range(len(points)), 5):
        signs = [(-1) ** k * orient([points[v] for v in five[:k] + five[k + 1 :]]) for k in range(5)]
        plus, minus = (frozenset(v for v, s in zip(five, signs) if s == t) for t in (1, -1))
        found |= {(plus, minus), (minus, plus)} if any(signs) else set()
    return found


def by_oracle(points: list, cavity: list[Cell]) -> set[frozenset[frozenset[int]]]:
    pairs = circuits(points)

    def fit(s: frozenset[int], t: frozenset[int]) -> bool:
        return not any(p <= s and m <= t for p, m in pairs)

    def volume(cell: frozenset[int]) -> int:
        return six_volume([points[v] for v in sorted(cell)])

    def inside(cell: frozenset[int]) -> bool:
        middle = [Fraction(sum(points[v][i] for v in cell), 4) for i in range(3)]
        rows = [[points[v] for v in one] for one in cavity]
        return any(min(orient([*r[:k], middle, *r[k + 1 :]]) for k in range(4)) >= 0 for r in rows)

    walls = [frozenset(face) for face in walls_of(cavity)]
    fours = map(frozenset, combinations(sorted({v for cell in cavity for v in cell}), 4))
    fours = [c for c in fours if volume(c) and all(fit(c, w) for w in walls) and inside(c)]

    def grow(first: int, chosen: list, left: int) -> Iterator[frozenset]:
        if left == 0:
            yield frozenset(chosen)
        for k in range(first, len(fours)):
            if volume(fours[k]) <= left and all(fit(fours[k], c) for c in chosen):
                yield from grow(k + 1, [*chosen, fours[k]], left - volume(fours[k]))

    return set(grow(0, [], sum(volume(frozenset(cell)) for cell in cavity)))


CLOUDS = st.lists(st.tuples(*[st.integers(0, 4)] * 3), min_size=5, max_size=7, unique=True)


def delaunay_cells(points: list) -> list[Cell]:
    try:
        rows = delaunay(np.array(points, dtype=float)).simplices.tolist()
    except DegenerateInputError:
        assume(False)
    return sorted(positive(points, cell) for cell in rows)


@settings(max_examples=60, deadline=None)
@given(CLOUDS, st.integers(0, 3))
def test_faces_that_cancel_are_enough(points: list, left_out: int) -> None:
    """All refills of a cavity, each once, whether it is convex or not."""
    cavity = delaunay_cells(points)[left_out:]
    assume(cavity)
    used = {v for cell in cavity for v in cell}
    found = list(refills(points, walls_of(cavity), inner=used))
    as_sets = {frozenset(map(frozenset, new)) for new in found}
    assert len(as_sets) == len(found)
    assert as_sets == by_oracle(points, cavity)


@settings(max_examples=60, deadline=None)
@given(CLOUDS, st.data())
def test_a_recovery_lowers_the_number_each_time(points: list, data: st.DataObject) -> None:
    cells = frozenset(delaunay_cells(points))
    a, b = data.draw(st.sampled_from(list(combinations(range(len(points)), 2))))
    left = len(in_the_way(points, cells, a, b))
    walls = walls_of(cells)
    for step in recovery_steps(points, cells, a, b, most=6):
        now = len(in_the_way(points, step.cells, a, b))
        assert now < left and walls_of(step.cells) == walls
        assert walls_of(step.cavity) == walls_of(step.refill)
        left = now
