"""Signs of Jacobians over whole cells: against rationals, and against Jacobians taken at many places."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from mixed_cells import GOOD

from unstruct.geometry.jacobians import (
    COEFFICIENTS,
    content_signs,
    hexahedron_signs,
    integers,
    pyramid_signs,
    wedge_signs,
)

Vector = tuple[Fraction, ...]
SIDES = {"hexahedron": 8, "wedge": 6, "pyramid": 5}


def minus(a: Vector, b: Vector) -> Vector:
    return tuple(x - y for x, y in zip(a, b))


def blend(weights: list, places: list[Vector]) -> Vector:
    return tuple(sum((w * p[i] for w, p in zip(weights, places)), Fraction(0)) for i in range(3))


def det(a: Vector, b: Vector, c: Vector) -> Fraction:
    x = a[0] * (b[1] * c[2] - b[2] * c[1])
    return x - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])


def rational(corners: np.ndarray) -> list[Vector]:
    return [tuple(map(Fraction, row)) for row in np.asarray(corners, dtype=float).tolist()]


def jacobian(kind: str, p: list[Vector], u: Fraction, v: Fraction, w: Fraction) -> Fraction:
    """From the derivatives of the map itself; for pyramids divided by the square of 1 - w."""
    if kind == "wedge":
        return det(
            blend([w - 1, 1 - w, 0, -w, w, 0], p),
            blend([w - 1, 0, 1 - w, -w, 0, w], p),
            blend([u + v - 1, -u, -v, 1 - u - v, u, v], p),
        )
    base = [(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v]
    along_u, along_v = [v - 1, 1 - v, v, -v], [u - 1, -u, u, 1 - u]
    if kind == "pyramid":
        return det(blend(along_u, p), blend(along_v, p), minus(p[4], blend(base, p)))
    return det(
        blend([(1 - w) * x for x in along_u] + [w * x for x in along_u], p),
        blend([(1 - w) * x for x in along_v] + [w * x for x in along_v], p),
        blend([-x for x in base] + base, p),
    )


def places(kind: str, steps: int) -> list[tuple[Fraction, Fraction, Fraction]]:
    grid = [Fraction(i, steps) for i in range(steps + 1)]
    found = list(product(grid, grid, [Fraction(0)] if kind == "pyramid" else grid))
    return [x for x in found if kind != "wedge" or x[0] + x[1] <= 1]


def exact_wedge(p: list[Vector]) -> int:
    """Each quadratic has its least value at an end, or where its derivative vanishes."""
    signs = set()
    for u, v in ((0, 0), (1, 0), (0, 1)):
        at = [jacobian("wedge", p, Fraction(u), Fraction(v), Fraction(i, 2)) for i in range(3)]
        a, b = 2 * at[0] - 4 * at[1] + 2 * at[2], -3 * at[0] + 4 * at[1] - at[2]  # a t^2 + b t + at[0]
        values = [at[0], at[2]]
        if a != 0 and 0 < -b / (2 * a) < 1:
            values.append(at[0] - b * b / (4 * a))
        signs |= {(x > 0) - (x < 0) for x in values}
    return signs.pop() if len(signs) == 1 else 0


def random_cells(kind: str, count: int, size: float, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.array(GOOD[kind], dtype=float) + size * rng.normal(size=(count, SIDES[kind], 3))


coordinates = st.integers(-3, 3)


def corners_of(count: int) -> st.SearchStrategy[list[list[int]]]:
    return st.lists(st.tuples(coordinates, coordinates, coordinates), min_size=count, max_size=count)


# ---------------------------------------------------------------------- coefficients


@pytest.mark.parametrize("kind", SIDES)
def test_coefficients_are_those_of_the_jacobian(kind: str) -> None:
    """At the corners they are values; the mean of all is the mean of the Jacobian."""
    p = random_cells(kind, 1, 1.0, 3)
    rows = COEFFICIENTS[kind](integers(p))[0]
    factor = {"hexahedron": 8, "wedge": 2, "pyramid": 1}[kind]
    exact = rational(p[0])
    unit = next(Fraction(x) / y for x, y in zip(p[0].ravel().tolist(), integers(p)[0].ravel().tolist()) if y)
    if kind == "hexahedron":
        for u, v, w in product((0, 1), repeat=3):
            found = rows[2 * u, 2 * v, 2 * w] * unit**3 / factor
            assert found == jacobian(kind, exact, Fraction(u), Fraction(v), Fraction(w))
        at = Fraction(1, 3)
        basis = [Fraction(4, 9), Fraction(4, 9), Fraction(1, 9)]
        total = sum(basis[i] * basis[j] * basis[k] * rows[i, j, k] for i, j, k in product(range(3), repeat=3))
        assert total * unit**3 / factor == jacobian(kind, exact, at, at, at)
    elif kind == "wedge":
        for corner, (u, v) in enumerate(((0, 0), (1, 0), (0, 1))):
            for t in (Fraction(0), Fraction(1, 3), Fraction(1)):
                basis = [(1 - t) ** 2, 2 * t * (1 - t), t * t]
                total = sum(b * x for b, x in zip(basis, rows[corner]))
                assert total * unit**3 / factor == jacobian(kind, exact, Fraction(u), Fraction(v), t)
    else:
        for corner, (u, v) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1))):
            assert rows[corner] * unit**3 == jacobian(kind, exact, Fraction(u), Fraction(v), Fraction(0))
        third = Fraction(1, 3)
        basis = [(1 - third) ** 2, third * (1 - third), third**2, third * (1 - third)]
        total = sum(b * x for b, x in zip(basis, rows))
        assert total * unit**3 == jacobian(kind, exact, third, third, Fraction(0)), "bilinear"


def test_integers_are_exact() -> None:
    values = np.array([[[0.1, -1e300, 5e-324], [0.0, 3.0, 2.0**-1060]]])
    whole = integers(values)[0]
    ratio = Fraction(0.1) / whole[0, 0]
    assert all(Fraction(x) == ratio * y for x, y in zip(values.ravel().tolist(), whole.ravel().tolist()))


# ---------------------------------------------------------------------- wedges


@settings(max_examples=150, deadline=None)
@given(corners_of(6))
def test_wedges_on_a_lattice(corners: list) -> None:
    """Flat, turned and folded ones; ties are the rule."""
    x = np.array(corners, dtype=float)[None]
    for scale in (1.0, 0.1, 2.0**-600, 2.0**600):
        assert wedge_signs(x * scale)[0] == exact_wedge(rational(x[0] * scale))


@pytest.mark.parametrize("size", [0.5, 1.5, 4.0])
def test_random_wedges(size: float) -> None:
    x = random_cells("wedge", 150, size, 1)
    assert wedge_signs(x).tolist() == [exact_wedge(rational(p)) for p in x]


def test_positive_corners_are_not_enough() -> None:
    """Wedges whose Jacobian is positive at all six corners, and negative inside."""
    rng = np.random.default_rng(5)
    x = np.array(GOOD["wedge"], dtype=float) / 4 + rng.uniform(-1, 1, (20000, 6, 3))
    ends = COEFFICIENTS["wedge"](x)[:, :, ::2].reshape(len(x), 6)
    positive, signs = (ends > 1e-9).all(axis=1), wedge_signs(x)
    fooled = np.nonzero(positive & (signs != 1))[0]
    assert 0.001 < len(fooled) / positive.sum() < 0.2
    assert not (signs[~positive] == 1).any()
    for i in fooled[:10]:
        p = rational(x[i])
        assert exact_wedge(p) == 0
        values = [jacobian("wedge", p, *place) for place in places("wedge", 8)]
        assert min(values) < min(jacobian("wedge", p, *place) for place in places("wedge", 1))


def test_a_wedge_that_touches_zero_inside() -> None:
    """The upper triangle is the lower one shrunk and turned over: (1 - 3 t / 2)^2, up to a factor."""
    base = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0]], dtype=float)
    over = np.add(-base / 2, [0, 0, 4])
    assert wedge_signs(np.array([[*base, *over]])).tolist() == [0]
    nudged = np.add(over, [[0, 0, 0], [0, 2.0**-40, 0], [0, -(2.0**-40), 0]])
    x = np.array([[*base, *nudged]])
    assert wedge_signs(x)[0] == exact_wedge(rational(x[0]))


# ---------------------------------------------------------------------- pyramids and hexahedra


@settings(max_examples=100, deadline=None)
@given(corners_of(5))
def test_pyramids_on_a_lattice(corners: list) -> None:
    x = np.array(corners, dtype=float)
    values = [jacobian("pyramid", rational(x), *place) for place in places("pyramid", 4)]
    wanted = 1 if min(values) > 0 else -1 if max(values) < 0 else 0
    assert pyramid_signs(x[None])[0] == wanted


@settings(max_examples=60, deadline=None)
@given(corners_of(8))
def test_hexahedra_on_a_lattice(corners: list) -> None:
    x = np.array(corners, dtype=float)
    signs, undecided = hexahedron_signs(x[None])
    values = [jacobian("hexahedron", rational(x), *place) for place in places("hexahedron", 4)]
    if signs[0] != 0:
        assert not undecided[0] and all(value * int(signs[0]) > 0 for value in values)
    elif not undecided[0]:
        assert min(values) <= 0 <= max(values) or min(values) * max(values) > 0
        assume(min(values) * max(values) <= 0)  # else it is bad between the places looked at


@pytest.mark.parametrize("size", [0.3, 0.8, 1.2, 2.0])
def test_random_hexahedra(size: float) -> None:
    """Where the answer is 0 the Jacobian nearly vanishes, or is negative, at some place of a grid."""
    x = random_cells("hexahedron", 300, size, 2)
    signs, undecided = hexahedron_signs(x)
    assert not undecided.any()
    steps = np.linspace(0, 1, 17)
    u, v, w = (g.ravel() for g in np.meshgrid(steps, steps, steps, indexing="ij"))
    for p, sign in zip(x, signs.tolist()):
        values = jacobians_of_hexahedron(p, u, v, w)
        if sign:
            assert (values * sign > 0).all()
        else:
            assert values.min() < 0.02 * np.abs(values).max()


def jacobians_of_hexahedron(p: np.ndarray, u: np.ndarray, v: np.ndarray, w: np.ndarray) -> np.ndarray:
    base = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=1)
    du, dv = np.stack([v - 1, 1 - v, v, -v], axis=1), np.stack([u - 1, -u, u, 1 - u], axis=1)
    low, high = (1 - w)[:, None], w[:, None]
    rows = [np.hstack([low * du, high * du]) @ p, np.hstack([low * dv, high * dv]) @ p]
    rows.append(np.hstack([-base, base]) @ p)
    return np.linalg.det(np.stack(rows, axis=1))


def test_positive_corners_are_not_enough_for_hexahedra_either() -> None:
    x = random_cells("hexahedron", 4000, 1.1, 7)
    rows = COEFFICIENTS["hexahedron"](x)
    corners = (rows[:, ::2, ::2, ::2].reshape(len(x), 8) > 0).all(axis=1)
    every = (rows.reshape(len(x), 27) > 0).all(axis=1)
    signs, undecided = hexahedron_signs(x)
    assert (signs[every] == 1).all() and not undecided.any()
    halved = corners & ~every
    assert (signs[halved] == 1).any() and (signs[halved] == 0).any()


def test_hexahedra_that_touch_zero_inside() -> None:
    """Bases turned over on top: (1 - 2 t)^2 vanishes where halving looks, (1 - 3 t / 2)^2 elsewhere."""
    base = np.array([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], dtype=float)
    x = np.array([[*base, *(base * [-1, -1, 1] + [0, 0, 4])], [*base, *(base * [-0.5, -0.5, 1] + [0, 0, 4])]])
    signs, undecided = hexahedron_signs(x)
    assert signs.tolist() == [0, 0] and undecided.tolist() == [False, True]


@pytest.mark.parametrize("kind", SIDES)
def test_mirrored_cells_have_the_other_sign(kind: str) -> None:
    rules = {"wedge": wedge_signs, "pyramid": pyramid_signs, "hexahedron": lambda x: hexahedron_signs(x)[0]}
    decide = rules[kind]
    x = random_cells(kind, 500, 1.2, 4)
    assert (decide(x * [1, 1, -1]) == -decide(x)).all() and (decide(x) == 1).any()
    assert decide(np.empty((0, SIDES[kind], 3))).shape == (0,)


# ---------------------------------------------------------------------- contents


@settings(max_examples=100, deadline=None)
@given(st.sampled_from(sorted(SIDES)), corners_of(8))
def test_contents_on_a_lattice(kind: str, corners: list) -> None:
    """The volume by Simpson's rule, which is exact for quadratics."""
    x = np.array(corners[: SIDES[kind]], dtype=float)
    p = rational(x)
    simpson = [(Fraction(0), 1), (Fraction(1, 2), 4), (Fraction(1), 1)]
    total = Fraction(0)
    for (u, a), (v, b), (w, c) in product(simpson, simpson, simpson):
        if kind == "hexahedron":
            total += a * b * c * jacobian(kind, p, u, v, w)
        elif kind == "pyramid":
            total += a * b * jacobian(kind, p, u, v, Fraction(0)) if w == 0 else 0
        elif (u, v) == (0, 0):  # linear over the triangle: the mean of its corners
            for s, t in ((0, 0), (1, 0), (0, 1)):
                total += c * jacobian(kind, p, Fraction(s), Fraction(t), w)
    assert content_signs(kind, x[None])[0] == (total > 0) - (total < 0)


@settings(max_examples=100, deadline=None)
@given(
    st.lists(st.tuples(coordinates, coordinates), min_size=3, max_size=9), st.sampled_from([1.0, 0.1, 1e200])
)
def test_areas_on_a_lattice(corners: list, scale: float) -> None:
    x = np.array(corners, dtype=float) * scale
    p = [tuple(map(Fraction, row)) for row in x.tolist()]
    total = sum((a[0] * b[1] - a[1] * b[0] for a, b in zip(p, [*p[1:], p[0]])), Fraction(0))
    assert content_signs("polygon", x[None])[0] == (total > 0) - (total < 0)
