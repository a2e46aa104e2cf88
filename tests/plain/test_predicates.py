"""The rational predicates against definitions that need no determinant."""

from fractions import Fraction
from itertools import permutations

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.base.errors import UnstructError
from unstruct.plain.predicates import determinant, in_sphere, orient

small = st.integers(-4, 4)


def simplex_and_point(d):
    point = st.tuples(*[small] * d)
    return st.tuples(st.lists(point, min_size=d + 1, max_size=d + 1), point)


def by_distance(simplex, q):
    """Solve for the circumcenter in rationals and compare squared distances (orientation apart)."""
    p0 = sympy.Matrix(simplex[0])
    rows = [sympy.Matrix(p) - p0 for p in simplex[1:]]
    system = sympy.Matrix([(2 * r).T for r in rows])
    center = system.LUsolve(sympy.Matrix([r.dot(r) for r in rows]))
    offset = sympy.Matrix(q) - p0 - center
    return int(sympy.sign(center.dot(center) - offset.dot(offset)))


def test_signs_in_the_plane():
    triangle = [(0, 0), (1, 0), (0, 1)]
    assert orient(triangle) == 1
    assert orient(triangle[::-1]) == -1
    assert orient([(0, 0), (1, 1), (2, 2)]) == 0
    assert [in_sphere(triangle, q) for q in [(0.5, 0.5), (1, 1), (1.1, 1)]] == [1, 0, -1]
    assert in_sphere(triangle[::-1], (0.5, 0.5)) == -1


@pytest.mark.parametrize("d", [1, 2, 3, 4, 5])
def test_unit_simplex_in_any_dimension(d):
    simplex = [[0] * d] + [[int(i == j) for j in range(d)] for i in range(d)]
    assert orient(simplex) == 1
    assert in_sphere(simplex, [Fraction(1, 2)] * d) == 1
    assert in_sphere(simplex, [1] * d) == 0
    assert in_sphere(simplex, [2] * d) == -1


@given(st.integers(1, 4).flatmap(simplex_and_point))
@settings(max_examples=150, deadline=None)
def test_agrees_with_the_circumcenter(case):
    simplex, q = case
    sign = orient(simplex)
    if sign == 0:
        with pytest.raises(ValueError, match="flat"):
            in_sphere(simplex, q)
    else:
        assert in_sphere(simplex, q) == sign * by_distance(simplex, q)


@given(simplex_and_point(3), st.permutations(range(4)))
@settings(max_examples=100, deadline=None)
def test_a_permutation_turns_both_signs(case, order):
    simplex, q = case
    parity = orient([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) * int(
        sympy.combinatorics.Permutation(list(order)).signature()
    )
    moved = [simplex[i] for i in order]
    assert orient(moved) == parity * orient(simplex)
    if orient(simplex):
        assert in_sphere(moved, q) == parity * in_sphere(simplex, q)


@given(
    st.integers(1, 4).flatmap(
        lambda n: st.lists(st.lists(small, min_size=n, max_size=n), min_size=n, max_size=n)
    )
)
@settings(max_examples=100, deadline=None)
def test_determinant_is_leibniz(rows):
    n = len(rows)
    total = 0
    for p in permutations(range(n)):
        sign = int(sympy.combinatorics.Permutation(list(p)).signature())
        term = sign
        for i in range(n):
            term *= rows[i][p[i]]
        total += term
    assert determinant(rows) == total


def test_every_last_bit_and_every_exponent():
    """Doubles one unit in the last place apart, subnormals and huge numbers get their true sign."""
    up = np.nextafter(0.5, 1.0)
    assert orient([(0.0, 0.0), (1.0, 1.0), (0.5, up)]) == 1
    assert orient([(0.0, 0.0), (1e300, 1e300), (5e-324, 1e-323)]) == 1
    assert in_sphere([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)], (1.0, np.nextafter(1.0, 0.0))) == 1
    assert in_sphere([(0.0, 0.0), (1e300, 0.0), (0.0, 1e300)], (-5e-324, 0.0)) == -1


def test_numpy_integers_do_not_overflow():
    big = np.array([[0, 0], [2**62, 0], [0, 2**62]])
    assert orient(big) == 1
    assert in_sphere(big, np.array([2**62, 2**62])) == 0


def test_flat_raises_the_typed_error():
    for flat in [
        [(0, 0), (0, 0), (1, 0)],
        [(0, 0), (1, 1), (2, 2)],
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)],
    ]:
        with pytest.raises(UnstructError, match="flat"):
            in_sphere(flat, flat[0])
