"""Columns of wedges: their limits by rational quadratics, and exactly which cells are not positive."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.generate.prisms.columns import bad, limits, scaled_columns
from unstruct.mesh.mesh import Mesh

ONE = np.array([(0, 1, 2)], dtype=np.int32)
Vector = list[Fraction]


def vector(row: Any) -> Vector:
    return [Fraction(x) for x in np.asarray(row, dtype=float).tolist()]


def less(a: Vector, b: Vector) -> Vector:
    return [x - y for x, y in zip(a, b)]


def det(a: Vector, b: Vector, c: Vector) -> Fraction:
    n = [a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3] for k in range(3)]
    return sum((x * y for x, y in zip(n, c)), Fraction(0))


def quadratics(low: np.ndarray, high: np.ndarray) -> list[tuple[Fraction, Fraction, Fraction]]:
    """a + b t + c t^2 of A(t) . v_i for a wedge, t from 0 to 1."""
    p, q = [vector(x) for x in low], [vector(x) for x in high]
    v = [less(b, a) for a, b in zip(p, q)]
    e, f = less(p[1], p[0]), less(p[2], p[0])
    u, w = less(v[1], v[0]), less(v[2], v[0])
    return [(det(e, f, x), det(e, w, x) + det(u, f, x), det(u, w, x)) for x in v]


def is_positive(a: Fraction, b: Fraction, c: Fraction) -> bool:
    """Whether a + b t + c t^2 > 0 on all of [0, 1]."""
    if a <= 0 or a + b + c <= 0:
        return False
    lowest = -b / (2 * c) if c > 0 else Fraction(-1)
    return not 0 < lowest < 1 or a - b * b / (4 * c) > 0


def is_good(places: np.ndarray, level: list[int]) -> bool:
    for step in range(len(places) - 1):
        for i, q in enumerate(quadratics(places[step], places[step + 1])):
            if step < level[i] and not is_positive(*q):
                return False
    return True


corner = st.tuples(*[st.integers(-3, 3)] * 3)


@settings(max_examples=300, deadline=None)
@given(st.lists(corner, min_size=6, max_size=6), st.tuples(*[st.integers(0, 1)] * 3), st.integers(-1, 1))
def test_signs_on_integers(corners: list[Any], level: tuple[int, ...], unit: int) -> None:
    """Small integers: zeros, double roots, cells that are positive at all corners alone."""
    places = np.array(corners, dtype=float).reshape(2, 3, 3) * 2.0 ** (90 * unit)
    for i in range(3):
        if not level[i]:
            places[1, i] = places[0, i]
    if any(level):
        found = bad(places, ONE, np.array(level, dtype=np.int32))
        assert (len(found) == 0) == is_good(places, list(level))


@settings(max_examples=150, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([1e-3, 1.0, 30.0]), st.sampled_from([0.0, 2.0**30]))
def test_signs_of_layers(seed: int, tall: float, away: float) -> None:
    """Several levels with shares of their own, near the limit, also far from the origin."""
    rng = np.random.default_rng(seed)
    base = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.3, 0.9, 0.0)])
    v = np.array([0.0, 0.0, 1.0]) + 0.7 * rng.standard_normal((3, 3))
    share = np.sort(rng.random((4, 3)), axis=0)
    share[0], share[-1] = 0.0, 1.0
    t = limits(base, v, ONE)[0]
    height = tall if not 0.0 < t < np.inf else t * float(rng.choice([0.5, 1 - 1e-14, 1 + 1e-14, 1.5]))
    places = base + away + share[:, :, None] * height * v
    assert (len(bad(places, ONE)) == 0) == is_good(places, [3, 3, 3])


@settings(max_examples=150, deadline=None)
@given(st.lists(corner, min_size=3, max_size=3), st.lists(corner, min_size=3, max_size=3))
def test_limits_are_the_least_roots(points: list[Any], rays: list[Any]) -> None:
    p, v = np.array(points, dtype=float), np.array(rays, dtype=float)
    t = float(limits(p, v, ONE)[0])
    rows = [q for q, x in zip(quadratics(p, p + v), v) if x.any()]
    if any(a <= 0 for a, _, _ in rows):
        assert t == 0.0
        return

    def good(s: Fraction) -> bool:
        return all(is_positive(a, b * s, c * s * s) for a, b, c in rows)

    if t == np.inf:
        assert good(Fraction(10**9))
    else:
        assert t > 0 and good(Fraction(t) * (1 - Fraction(1, 10**9)))
        assert not good(Fraction(t) * (1 + Fraction(1, 10**6)))


def test_six_positive_corners_are_not_enough() -> None:
    """Positive at all corners, negative inside: b0 = b2 > 0 and b1 < -b0 for one of the rays."""
    rng = np.random.default_rng(0)
    low = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
    found = 0
    for _ in range(20000):
        high = low + np.array([0.0, 0.0, 1.0]) + 1.5 * rng.standard_normal((3, 3))
        rows = quadratics(low, high) if found < 3 else []
        if (
            rows
            and all(a > 0 and a + b + c > 0 for a, b, c in rows)
            and not is_good(np.stack([low, high]), [1] * 3)
        ):
            found += 1
            assert len(bad(np.stack([low, high]), ONE)) == 1
    assert found == 3


def test_a_ray_that_moves_by_nothing_is_not_positive() -> None:
    """Rounded to the point itself, though it has a height: two vertices of the mesh would be equal."""
    low = np.array([(1.0, 0.0, 0.0), (2.0, 0.0, 0.0), (1.0, 1.0, 0.0)])
    high = low + np.array([0.0, 0.0, 1e-3])
    high[0] = low[0]
    assert len(bad(np.stack([low, high]), ONE)) == 1
    assert len(bad(np.stack([low, high]), ONE, np.array([0, 1, 1], dtype=np.int32))) == 0


def test_scaled_columns_are_those_of_the_mesh() -> None:
    rng = np.random.default_rng(1)
    places = rng.standard_normal((3, 30, 3))
    columns = np.arange(30, dtype=np.int32).reshape(10, 3)
    level = np.full(30, 2, dtype=np.int32)
    found = scaled_columns(places, columns, level)
    rows = np.concatenate(
        [np.concatenate([columns + 30 * k, columns + 30 * (k + 1)], axis=1) for k in range(2)]
    )
    wanted = (
        Mesh(places.reshape(-1, 3), None, cells={"wedge": rows}).quality("scaled_jacobian").reshape(2, 10)
    )
    assert found == pytest.approx(wanted.min(axis=0), abs=1e-12)
    level[0] = 1
    assert scaled_columns(places, columns, level)[0] == pytest.approx(wanted[0, 0])
    level[0] = 0
    assert scaled_columns(places, columns, level)[0] == np.inf
