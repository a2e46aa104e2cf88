"""The Dirichlet tessellation by half-planes: areas, sides and ties, all in fractions."""

import ast
import inspect
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import InputError
from unstruct.plain import voronoi as plain
from unstruct.plain.predicates import orient

grid = st.lists(st.tuples(*[st.integers(0, 6)] * 2), min_size=1, max_size=9, unique=True)
point = st.tuples(*[st.fractions(-2, 8, max_denominator=6)] * 2)


def square_of(p, q):
    return sum((Fraction(a) - b) ** 2 for a, b in zip(p, q))


def holds(cell, x):
    """Whether a closed counterclockwise cell holds x."""
    ring = [start for start, _ in cell]
    return all(orient([a, b, x]) >= 0 for a, b in zip(ring, ring[1:] + ring[:1]))


@settings(max_examples=100, deadline=None)
@given(grid, st.lists(point, min_size=1, max_size=5))
def test_cells_are_what_the_definition_says(sites, points):
    cells = plain.dirichlet(sites)
    for x in points:
        squares = [square_of(p, x) for p in sites]
        assert [holds(cell, x) for cell in cells] == [s == min(squares) for s in squares]


@settings(max_examples=60, deadline=None)
@given(grid)
def test_cells_fill_the_window_and_sides_match(sites):
    window = [(-1, -1), (8, -2), (9, 7), (3, 9)]
    cells = plain.dirichlet(sites, window)
    whole = plain.area(tuple((x, None) for x in plain.exact_sites(window)))
    assert sum((plain.area(cell) for cell in cells if cell), Fraction(0)) == whole
    for i, cell in enumerate(cells):
        for k, (start, beyond) in enumerate(cell):
            assert start != cell[k - 1][0], "a side of length zero"
            if beyond is not None:
                end = cell[(k + 1) % len(cell)][0]
                assert square_of(sites[i], start) == square_of(sites[beyond], start)
                assert square_of(sites[i], end) == square_of(sites[beyond], end)
                assert i in {j for _, j in cells[beyond]}, "the neighbor does not know"


def test_lattice():
    sites = list(product(range(3), repeat=2))
    cells = plain.dirichlet(sites)
    assert plain.corners(cells) == set(product((Fraction(1, 2), Fraction(3, 2)), repeat=2))
    assert len(plain.neighbors(cells)) == 12 and plain.area(cells[4]) == 1
    assert [beyond for _, beyond in cells[4]].count(None) == 0 and len(cells[4]) == 4


def test_one_two_and_collinear_sites():
    assert plain.neighbors(plain.dirichlet([(3, 4)])) == set()
    strips = plain.dirichlet([(0, 0), (1, 1), (3, 3)])
    assert plain.neighbors(strips) == {frozenset((0, 1)), frozenset((1, 2))}
    assert plain.corners(strips) == set()


def test_copies_have_equal_cells():
    cells = plain.dirichlet([(0, 0), (2, 0), (0, 0)])
    assert [start for start, _ in cells[0]] == [start for start, _ in cells[2]]


def test_a_cell_may_miss_the_window():
    cells = plain.dirichlet([(0, 0), (10, 0)], [(-1, -1), (1, -1), (1, 1), (-1, 1)])
    assert plain.area(cells[0]) == 4 and cells[1] == ()


def test_floats_are_taken_exactly():
    tiny = 2.0**-1074
    assert plain.exact_sites(np.array([[tiny, 0.1]])) == [(Fraction(1, 2**1074), Fraction(0.1))]
    cells = plain.dirichlet([(0.0, 0.0), (tiny, 0.0), (0.0, tiny), (tiny, tiny)])
    assert plain.corners(cells) == {(Fraction(1, 2**1075), Fraction(1, 2**1075))}


@pytest.mark.parametrize(
    "bad", [[], [(0, 0), (1, np.nan)], [(0, 0), (np.inf, 1)], [(0, 0), (1, 2, 3)], [(0, 0), 1]]
)
def test_bad_sites_are_named(bad):
    with pytest.raises(InputError, match=r"site 1|no sites"):
        plain.dirichlet(bad)


def test_functions_stay_readable():
    """30 lines or fewer each, docstrings apart."""
    for node in ast.walk(ast.parse(inspect.getsource(plain))):
        if isinstance(node, ast.FunctionDef):
            documented = len((ast.get_docstring(node) or "").splitlines())
            assert node.end_lineno - node.lineno + 1 - documented <= 30, node.name
