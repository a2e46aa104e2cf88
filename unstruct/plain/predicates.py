"""Exact signs in any dimension by rational arithmetic: the oracle for :mod:`unstruct.predicates`.

Every finite double is a rational number. Multiplied by their common denominator the coordinates
become integers, which changes no sign below, and Bareiss' elimination stays among integers.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import lcm
from typing import Any

from unstruct.base.errors import InputError

__all__ = ["determinant", "in_sphere", "orient"]


def orient(simplex: Sequence[Sequence[Any]]) -> int:
    """Sign of the determinant of the rows p_i - p_0, i = 1..d.

    Parameters
    ----------
    simplex : d + 1 points of d numbers (int, float, Fraction or NumPy scalars)

    Returns
    -------
    int
        1 (counterclockwise in the plane), -1, or 0 where the points lie in a hyperplane.
    """
    p0, *others = _integers(simplex)
    return _sign(determinant([_minus(p, p0) for p in others]))


def in_sphere(simplex: Sequence[Sequence[Any]], q: Sequence[Any]) -> int:
    """1 where q is strictly inside the sphere through a positively oriented simplex, 0 on it, -1 outside.

    The sign turns with the orientation of the simplex. It says on which side of the hyperplane
    through the lifted simplex the lifted q lies: p is lifted to (p, |p - p_0|^2).

    Raises
    ------
    InputError
        Where the simplex is flat: it then has no circumsphere.
    """
    if orient(simplex) == 0:
        raise InputError(f"a flat simplex has no circumsphere: {list(simplex)}; test orient() first")
    p0, *others = _integers([*simplex, q])
    rows = [_minus(p, p0) for p in others]
    return -_sign(determinant([[*r, sum(x * x for x in r)] for r in rows]))


def determinant(rows: Sequence[Sequence[int]]) -> int:
    """Determinant of a square matrix of integers by Bareiss' fraction-free elimination, O(n^3) products.

    After step k each entry is a minor of order k + 2, hence an integer: the division is exact.
    (E. H. Bareiss, Mathematics of Computation 22, 1968.)
    """
    a = [list(row) for row in rows]
    n, sign, last = len(a), 1, 1
    for k in range(n - 1):
        pivot = next((i for i in range(k, n) if a[i][k]), None)
        if pivot is None:
            return 0
        if pivot != k:
            a[k], a[pivot], sign = a[pivot], a[k], -sign
        for i in range(k + 1, n):
            for j in range(k + 1, n):
                a[i][j] = (a[k][k] * a[i][j] - a[i][k] * a[k][j]) // last
        last = a[k][k]
    return sign * a[-1][-1]


def _integers(points: Sequence[Sequence[Any]]) -> list[list[int]]:
    """The points times the least common denominator of all their coordinates."""
    exact = [[Fraction(x.item() if hasattr(x, "item") else x) for x in p] for p in points]
    scale = lcm(*(x.denominator for p in exact for x in p))
    return [[int(x * scale) for x in p] for p in exact]


def _minus(p: Sequence[int], q: Sequence[int]) -> list[int]:
    return [x - y for x, y in zip(p, q, strict=True)]


def _sign(x: int) -> int:
    return (x > 0) - (x < 0)
