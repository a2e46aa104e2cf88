"""The plain filling: the lattice, inside by parity, shapes, and refills that make the worst cell better."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, product

import numpy as np
import pytest

import unstruct
from unstruct.plain.filling import flood, improve_once, inside, lattice, shape, worst_of
from unstruct.plain.refilling import walls_of

BOX = list(product((0, 4), repeat=3))
SQUARES = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
FACETS = [(a, b, c) for s in SQUARES for a, b, c in ((s[0], s[1], s[2]), (s[0], s[2], s[3]))]


def test_the_lattice() -> None:
    points = lattice((0, 0, 0), (3, 3, 3), 1)
    assert len(points) == 64 + 27 and points[64] == (Fraction(1, 2),) * 3
    mesh = unstruct.delaunay(np.array(points, float))
    middle = [c.tolist() for c in mesh.simplices if (abs(mesh.points[c] - 1.5) <= 1).all()]
    assert middle and {shape(points, c) for c in middle} == {2 * Fraction(1, 2) ** 2 / Fraction(5, 6) ** 3}


def test_inside_by_parity_is_the_even_odd_rule() -> None:
    inner = [tuple(1 + x // 2 for x in p) for p in BOX]  # a box within the box: a cavity
    points = BOX + inner
    facets = FACETS + [tuple(v + 8 for v in face) for face in FACETS]
    for place in product((Fraction(-1, 3), Fraction(1, 2), 2, Fraction(7, 2)), repeat=3):
        in_box = all(0 < x < 4 for x in place)
        in_cavity = all(1 < x < 3 for x in place)
        assert inside(points, facets, place) == (in_box and not in_cavity)
    assert inside(points, facets, (Fraction(1, 2), 2, 2))  # many edges are met from here


def test_the_flood_agrees_with_paths() -> None:
    """The facets bound some of the cells, which need not hang together."""
    points = np.random.default_rng(2).integers(0, 50, (20, 3)).tolist()
    cells = [tuple(c) for c in unstruct.delaunay(np.array(points, float)).simplices.tolist()]
    chosen = [cell for k, cell in enumerate(cells) if k % 3 != 1]
    facets = [face for face in walls_of(chosen)]
    parity = flood(cells, facets)
    assert {cell for cell, odd in parity.items() if odd} == set(chosen) and len(parity) == len(cells)
    for cell in cells[:30]:
        middle = tuple(sum(Fraction(points[v][i]) for v in cell) / 4 for i in range(3))
        assert inside(points, facets, middle) == bool(parity[cell])


def test_facets_that_are_not_closed() -> None:
    points = np.array([*BOX, (2, 2, 2)], float)
    cells = [tuple(c) for c in unstruct.delaunay(points).simplices.tolist()]
    with pytest.raises(AssertionError, match="not closed"):
        flood(cells, [tuple(sorted(cells[0]))[:3]])


@pytest.mark.parametrize("many", range(1, 4))
def test_one_cell_with_some_of_its_facets(many: int) -> None:
    """A cell with several faces on the hull: each of them says whether it is inside."""
    cell, faces = (0, 1, 2, 3), list(combinations(range(4), 3))
    for some in combinations(faces, many):
        with pytest.raises(AssertionError, match="not closed"):
            flood([cell], some)
    assert flood([cell], faces) == {cell: 1} and flood([cell], []) == {cell: 0}


def test_shape() -> None:
    assert shape([(0, 0, 0), (1, 1, 0), (1, 0, 1), (0, 1, 1)], (0, 1, 2, 3)) == 1
    assert shape([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], (0, 1, 2, 3)) == 0
    rows = np.random.default_rng(1).integers(-9, 9, (4, 3))
    volume = abs(np.linalg.det(rows[1:] - rows[0])) / 6
    square = np.mean([((p - q) ** 2).sum() for p, q in combinations(rows, 2)])
    assert np.isclose(float(shape(rows.tolist(), (0, 1, 2, 3))), (6 * 2**0.5 * volume / square**1.5) ** 2)


def test_the_worst_cell_becomes_better_until_none_can() -> None:
    rng = np.random.default_rng(3)
    points = rng.integers(0, 20, (9, 3)).tolist()
    cells = frozenset(tuple(c) for c in unstruct.delaunay(np.array(points, float)).simplices.tolist())
    walls, worst, steps = walls_of(cells), worst_of(points, cells), 0
    while (better := improve_once(points, cells)) is not None:
        assert worst_of(points, better) >= worst and walls_of(better) == walls
        cells, worst, steps = better, worst_of(points, better), steps + 1
    assert 1 <= steps < 60
