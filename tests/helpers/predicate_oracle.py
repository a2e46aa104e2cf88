"""Rational signs, nasty coordinates, and the stage that decides: shared by tests and the long run.

python -m tests.predicate_oracle 100000      # that many cases for each predicate and dimension
"""

from __future__ import annotations

import sys
from collections import Counter
from fractions import Fraction

import numpy as np

from unstruct.predicates import filters
from unstruct.predicates.batch import in_sphere, orient, power_of_two

STAGES = ("filter", "exact", "tie", "wide")
KINDS = (
    "uniform",
    "lattice",
    "cube",
    "cube, last bits",
    "last bits",
    "offset",
    "decimal",
    "wide",
    "subnormal",
    "huge",
)


def determinant(matrix: list[list[Fraction]]) -> Fraction:
    """Gaussian elimination in the rationals (shares nothing with Bareiss' integers or the minors)."""
    rows, value = [row[:] for row in matrix], Fraction(1)
    for k in range(len(rows)):
        pivot = next((i for i in range(k, len(rows)) if rows[i][k]), None)
        if pivot is None:
            return Fraction(0)
        if pivot != k:
            rows[k], rows[pivot] = rows[pivot], rows[k]
            value = -value
        value *= rows[k][k]
        for i in range(k + 1, len(rows)):
            factor = rows[i][k] / rows[k][k]
            rows[i] = [a - factor * b for a, b in zip(rows[i], rows[k])]
    return value


def sign(value: Fraction) -> int:
    return (value > 0) - (value < 0)


def oracle_orient(simplex: np.ndarray) -> int:
    p = [[Fraction(float(x)) for x in row] for row in simplex]
    return sign(determinant([[a - b for a, b in zip(row, p[0])] for row in p[1:]]))


def oracle_in_sphere(simplex: np.ndarray, q: np.ndarray) -> int:
    """On the paraboloid: q is inside a positively oriented simplex iff it lies below the lifted one."""
    points = [[Fraction(float(x)) for x in row] for row in [*simplex, q]]
    return -sign(determinant([[Fraction(1), *p, sum(x * x for x in p)] for p in points]))


def coordinates(rng: np.random.Generator, kind: str, shape: tuple[int, ...]) -> np.ndarray:
    """Coordinates of one of the kinds on which naive predicates fail."""
    small = rng.integers(-3, 4, shape)
    if kind == "uniform":
        return rng.random(shape)
    if kind == "lattice":
        return small.astype(float)
    if kind == "last bits":  # thirds, moved by a few units in the last place
        return small / 3.0 * (1 + rng.integers(-2, 3, shape) * 2.0**-52)
    if kind == "cube":  # all cospherical
        return rng.integers(0, 2, shape).astype(float)
    if kind == "cube, last bits":  # nearly so
        return rng.integers(0, 2, shape) * 0.7 + rng.integers(-2, 3, shape) * 2.0**-53
    if kind == "offset":
        return 1e8 + small * 1e-6
    if kind == "decimal":
        return small / 10.0
    if kind == "wide":
        return np.ldexp(rng.standard_normal(shape), rng.integers(-1070, 1020, shape))
    if kind == "subnormal":
        return small * 5e-324
    return small * 3e307  # "huge": sums and products overflow


def stage(simplex: np.ndarray, q: np.ndarray | None, value: int) -> str:
    """Which stage decides: filter, exact, an exact tie, or exact with exponents beyond 64-bit integers."""
    points = simplex if q is None else np.vstack([simplex, q])
    factor = power_of_two(points)
    s = simplex * factor
    decided = filters.filter_orient(s) if q is None else filters.filter_in_sphere(s, q * factor)
    if decided != filters.UNDECIDED:
        return "filter"
    exponents = np.frexp(points[points != 0])[1]
    if exponents.size and np.ptp(exponents) > 62:
        return "wide"
    return "tie" if value == 0 else "exact"


def long_run(count: int) -> Counter:
    """``count`` seeded cases for each predicate in dimensions 1 to 4; returns how many each stage decided."""
    seen: Counter = Counter()
    for d in (1, 2, 3, 4):
        rng = np.random.default_rng(d)
        for case in range(count):
            points = coordinates(rng, KINDS[case % len(KINDS)], (d + 2, d))
            simplex, q = points[:-1], points[-1]
            expected = oracle_orient(simplex)
            assert orient(simplex) == expected, (d, simplex.tolist())
            seen[d, "orient", stage(simplex, None, expected)] += 1
            if expected:
                inside = oracle_in_sphere(simplex, q)
                assert in_sphere(simplex, q) == inside, (d, simplex.tolist(), q.tolist())
                seen[d, "in_sphere", stage(simplex, q, inside)] += 1
    return seen


if __name__ == "__main__":
    for key, number in sorted(long_run(int(sys.argv[1]) if len(sys.argv) > 1 else 1000).items()):
        print(*key, number)
