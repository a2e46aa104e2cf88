"""The power test against determinants of fractions, on ties, tiny differences and wide exponents."""

from fractions import Fraction

import numpy as np
import pytest

from unstruct.predicates import orient
from unstruct.predicates.power import power_signs


def determinant(m):
    if len(m) == 1:
        return m[0][0]
    minors = ([row[:k] + row[k + 1 :] for row in m[1:]] for k in range(len(m)))
    return sum((-1) ** k * m[0][k] * determinant(minor) for k, minor in enumerate(minors) if m[0][k])


def truth(points, weights, simplex, q):
    exact = [[Fraction(x) for x in row] for row in points.tolist()]
    heavy = [Fraction(x) for x in weights.tolist()]
    rows = [[a - b for a, b in zip(exact[i], exact[q])] for i in simplex]
    value = determinant(
        [[*row, sum(x * x for x in row) - heavy[i] + heavy[q]] for row, i in zip(rows, simplex)]
    )
    sign = (value > 0) - (value < 0)
    return sign if points.shape[1] % 2 == 0 else -sign


@pytest.mark.parametrize("d", [1, 2, 3, 4])
@pytest.mark.parametrize("kind", ["grid", "tiny", "nearly tied", "huge", "wide", "wide weights", "heavy"])
def test_signs(d, kind):
    rng = np.random.default_rng(d)
    n, m = 150, 80
    points, weights = rng.integers(-3, 4, (n, d)).astype(float), rng.integers(-3, 4, n).astype(float)
    if kind == "tiny":
        points, weights = points * 2.0**-300, weights * 2.0**-600
    elif kind == "nearly tied":
        points = rng.standard_normal((n, d))
        weights = (points**2).sum(axis=1) + rng.integers(-1, 2, n) * 1e-16
    elif kind == "huge":
        points, weights = points * 2.0**400, weights * 2.0**-300
    elif kind == "wide":
        points = points * np.exp2(rng.integers(-300, 300, (n, d)))
        weights = weights * np.exp2(rng.integers(-500, 500, n))
    elif kind == "wide weights":
        weights = weights * np.exp2(rng.integers(-1000, 900, n))
    elif kind == "heavy":
        weights = weights * 1e300
    simplices, queries = rng.integers(0, n, (m, d + 1)), rng.integers(0, n, m)
    positive = np.asarray(orient(points[simplices])) > 0
    simplices, queries = simplices[positive], queries[positive]
    expected = [truth(points, weights, s, q) for s, q in zip(simplices.tolist(), queries.tolist())]
    assert power_signs(points, weights, simplices, queries).tolist() == expected
    assert len(set(expected)) > 1
