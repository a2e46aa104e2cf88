"""The predicates against rational arithmetic, over generators that are shown to reach every stage."""

from __future__ import annotations

import math
from collections import Counter
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st
from predicate_oracle import KINDS, STAGES, coordinates, oracle_in_sphere, oracle_orient, stage

from unstruct.base.errors import InputError
from unstruct.predicates import exact, filters
from unstruct.predicates.batch import in_sphere, orient, orient_at, power_of_two, scaled

DIMENSIONS = (1, 2, 3, 4, 5)
EXAMPLES = 500


def arrays(shape, kind):
    """Hypothesis strategy: an array of doubles of one of the nasty kinds."""
    return st.integers(0, 2**32 - 1).map(lambda s: coordinates(np.random.default_rng(s), kind, shape))


@pytest.mark.parametrize("d", DIMENSIONS)
@pytest.mark.parametrize("predicate", ["orient", "in_sphere"])
def test_signs_are_exact_and_every_stage_is_reached(d, predicate):
    """500 examples for each predicate and dimension; the counters tell which stages decided them."""
    seen: Counter = Counter()

    @seed(d)
    @settings(max_examples=EXAMPLES, deadline=None, database=None, suppress_health_check=list(HealthCheck))
    @given(st.sampled_from(KINDS).flatmap(lambda kind: arrays((d + 2, d), kind)))
    def run(points):
        simplex, q = points[:-1], points[-1]
        sign = oracle_orient(simplex)
        if predicate == "orient":
            assert orient(simplex) == sign
            seen[stage(simplex, None, sign)] += 1
        elif sign == 0:
            with pytest.raises(InputError, match="flat"):
                in_sphere(simplex, q)
            seen["flat"] += 1
        else:
            expected = oracle_in_sphere(simplex, q)
            assert in_sphere(simplex, q) == expected
            assert in_sphere(simplex[[1, 0, *range(2, d + 1)]], q) == -expected
            seen[stage(simplex, q, expected)] += 1

    run()
    assert sum(seen.values()) >= EXAMPLES
    # one difference of two doubles is zero or decided: on the line, orient needs no exact stage
    reachable = {"filter", "tie"} if (d, predicate) == (1, "orient") else set(STAGES)
    assert reachable <= set(seen), f"stages reached: {seen}"


@pytest.mark.parametrize("d", [2, 3, 4])
def test_batches_agree_with_single_calls(d):
    rng = np.random.default_rng(d)
    simplices = coordinates(rng, "lattice", (50, d + 1, d))
    queries = coordinates(rng, "lattice", (50, d))
    signs = orient(simplices)
    assert signs.dtype == np.int8 and signs.shape == (50,)
    assert [orient(s) for s in simplices] == signs.tolist()
    full = simplices[signs != 0]
    table = in_sphere(full[:, None], queries[None])
    assert table.shape == (len(full), 50)
    assert table[3, 7] == in_sphere(full[3], queries[7])


@pytest.mark.parametrize("d", [1, 2, 3, 4])
def test_indexed_forms_agree(d):
    points = scaled(coordinates(np.random.default_rng(7), "decimal", (12, d)))[0]
    rng = np.random.default_rng(8)
    for _ in range(30):
        v = rng.permutation(12)[: d + 1]
        assert orient_at(points, v) == oracle_orient(points[v])


def test_limb_arithmetic_against_python_integers():
    """Sums and products of signed numbers of many limbs, borrows through long runs of zeros included."""
    rng = np.random.default_rng(1)

    def load(w, n, s, value):
        w[s] = 0
        digits, rest = 0, abs(value)
        while rest:
            w[s, digits] = (rest & exact.MASK) * (1 if value > 0 else -1)
            rest >>= exact.BITS
            digits += 1
        exact._carry(w, n, s, digits)

    def read(w, n, s):
        return sum(int(w[s, i]) << (exact.BITS * i) for i in range(n[s]))

    w, n = np.zeros((3, 100), np.int64), np.zeros(3, np.int64)
    special = [
        0,
        1,
        -1,
        exact.BASE,
        -exact.BASE,
        exact.BASE - 1,
        1 - exact.BASE,
        2**780,
        -(2**780),
        1 - 2**780,
    ]
    values = special + [int(rng.integers(-(2**62), 2**62)) ** int(rng.integers(1, 12)) for _ in range(40)]
    for a in values:
        for b in values:
            load(w, n, 0, a)
            load(w, n, 1, b)
            assert read(w, n, 0) == a and exact.sign(w, n, 0) == (a > 0) - (a < 0)
            exact.add(w, n, 0, 1, 2)
            assert read(w, n, 2) == a + b
            exact.subtract(w, n, 0, 1, 2)
            assert read(w, n, 2) == a - b and exact.sign(w, n, 2) == (a > b) - (a < b)
            exact.multiply(w, n, 0, 1, 2)
            assert read(w, n, 2) == a * b


def test_bareiss_against_fractions():
    rng = np.random.default_rng(5)
    for size in range(1, 7):
        for _ in range(30):
            matrix = rng.integers(-2, 3, (size, size)).tolist()
            oracle = oracle_determinant([[Fraction(x) for x in row] for row in matrix])
            assert exact.determinant_sign(matrix) == (oracle > 0) - (oracle < 0)


def oracle_determinant(matrix):
    if not matrix:
        return Fraction(1)
    minors = ([row[:j] + row[j + 1 :] for row in matrix[1:]] for j in range(len(matrix)))
    return sum((-1) ** j * matrix[0][j] * oracle_determinant(minor) for j, minor in enumerate(minors))


def test_a_naive_sign_is_wrong_where_the_predicate_is_right():
    """Points on the line y = x, moved by last bits: the classic picture of wrong orientations."""
    wrong = 0
    for i in range(32):
        for j in range(32):
            p = (0.5 + i * 2.0**-53, 0.5 + j * 2.0**-53)
            simplex = np.array([p, (12.0, 12.0), (24.0, 24.0)])
            (ax, ay), (bx, by), (cx, cy) = simplex.tolist()
            naive = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
            assert orient(simplex) == oracle_orient(simplex)
            wrong += int(np.sign(naive)) != oracle_orient(simplex)
    assert wrong > 100


@pytest.mark.parametrize("value", [0.0, 1.0, 3.0, 1e308, 5e-324, 1e-310, np.finfo(float).max])
def test_power_of_two_brings_the_largest_coordinate_near_one(value):
    factor = power_of_two(np.array([[value, -value / 3]]))
    assert math.frexp(factor)[0] == 0.5
    assert abs(value * factor) < 1
    assert value == 0 or value < 1e-300 or abs(value * factor) >= 0.5


def test_scaled_tells_when_bits_would_be_lost():
    assert scaled(np.array([[1.0, 1e-200]]))[1]
    assert not scaled(np.array([[1e300, 1e-300]]))[1]
    kept, exactly = scaled(np.array([[np.finfo(float).max, 1.0]]))
    assert exactly and 0.5 <= kept.max() < 1


@pytest.mark.parametrize(
    ("simplex", "q", "message"),
    [
        ([[0, 0], [1, 0]], None, "shape"),
        ([[0.0], [np.nan]], None, "not finite at index"),
        ([["a", "b"], ["c", "d"], ["e", "f"]], None, "real numbers"),
        ([0.0, 1.0], None, "shape"),
        ([[0, 0], [1, 0], [0, 1]], [0, 0, 0], "q has shape"),
        ([[0, 0], [1, 0], [0, 1]], 1.0, "q has shape"),
        ([[0, 0], [1, 0], [0, 1]], [np.inf, 0], "q has a coordinate that is not finite"),
        ([[0, 0], [1, 1], [2, 2]], [0, 5], "flat"),
        ([[[0, 0], [1, 0], [0, 1]]] * 2, np.zeros((3, 2)), "broadcast"),
    ],
)
def test_bad_input_is_named(simplex, q, message):
    with pytest.raises(InputError, match=message):
        orient(simplex) if q is None else in_sphere(simplex, q)


def test_filters_never_decide_a_tie():
    """A decided sign is a proof: on exact ties the filters must say that they do not know."""
    square = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0]
    assert filters.filter_incircle(*square) == filters.UNDECIDED
    assert filters.filter_orient2(0.1, 0.1, 0.2, 0.2, 0.4, 0.4) == filters.UNDECIDED
    cube = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], float)
    assert filters.filter_insphere(*cube.ravel()) == filters.UNDECIDED
    assert filters.filter_in_sphere(cube[:4], cube[4]) == filters.UNDECIDED
