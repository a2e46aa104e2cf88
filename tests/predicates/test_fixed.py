"""Determinants in integers of fixed length: signs as by rational arithmetic, at ties and beside them."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.predicates import close, fixed
from unstruct.predicates.close import close_incircle, close_orient2
from unstruct.predicates.kernels import incircle, orient2, orient3

MOST = 2**57 - 1
STEPS = (0.1, 1 / 3, 0.7, 1e-3, np.pi)


def sign(value):
    return (value > 0) - (value < 0)


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def rational(points):
    """The sign of `orient2` or `incircle` for three or four points of doubles."""
    *rows, last = [[Fraction(float(x)) for x in p] for p in points]
    rows = [(p[0] - last[0], p[1] - last[1]) for p in rows]
    return lifted(*rows) if len(rows) == 3 else sign(cross(*rows))


def lifted(a, b, c):
    return sign(
        (a[0] ** 2 + a[1] ** 2) * cross(b, c)
        + (b[0] ** 2 + b[1] ** 2) * cross(c, a)
        + (c[0] ** 2 + c[1] ** 2) * cross(a, b)
    )


def agree(points):
    """Both predicates, with and without the filter, are rational arithmetic; the sign of `incircle`."""
    points = np.ascontiguousarray(points, dtype=float)
    flat = [float(x) for x in points.ravel()]
    expected = rational(points)
    assert close_incircle(*flat) == expected == incircle(*flat)
    turn = rational(points[:3])
    assert close_orient2(*flat[:6]) == turn == orient2(*flat[:6])
    return expected


def plainly(monkeypatch):
    """The stages as plain Python, in which integers are of any length."""
    for module in (fixed, close):
        for key, value in list(vars(module).items()):
            if hasattr(value, "py_func"):
                monkeypatch.setattr(module, key, value.py_func)


# --- the integers -------------------------------------------------------------------------------

digits = st.one_of(
    st.integers(-MOST, MOST),
    st.integers(-3, 3),
    st.sampled_from(
        [s * (x + e) for s in (1, -1) for x in (2**28, 2**29, 2**56, MOST - 1) for e in (-1, 0, 1)]
    ),
)


def volume(a, b, c):
    return sign(a[0] * cross(b[1:], c[1:]) + a[1] * cross(b[2::-2], c[2::-2]) + a[2] * cross(b[:2], c[:2]))


@settings(max_examples=400, deadline=None)
@given(st.tuples(*[digits] * 9))
def test_digits_in_space_are_integers_of_any_length(v):
    assert fixed.fixed_orient3(*v) == volume(v[:3], v[3:6], v[6:])
    assert (
        fixed.fixed_orient3(*v[:6], *[x + y for x, y in zip(v[:3], v[3:6])]) == 0 or max(map(abs, v)) > 2**55
    )


def test_the_largest_integers_in_space():
    for code in range(3**9):
        v = [(code // 3**i % 3 - 1) * (MOST - (i * code) % 2) for i in range(9)]
        assert fixed.fixed_orient3(*v) == volume(v[:3], v[3:6], v[6:])


def ball(v):
    """The sign of the determinant of four rows (a, |a|^2), along its last column."""
    rows = [v[3 * k : 3 * k + 3] for k in range(4)]
    total = 0
    for k in range(4):
        a, b, c = rows[:k] + rows[k + 1 :]
        minor = a[0] * cross(b[1:], c[1:]) + a[1] * cross(b[2::-2], c[2::-2]) + a[2] * cross(b[:2], c[:2])
        total += (-1) ** (k + 1) * minor * sum(x * x for x in rows[k])
    return sign(total)


@settings(max_examples=400, deadline=None)
@given(st.tuples(*[digits] * 12))
def test_digits_of_balls_are_integers_of_any_length(v):
    assert fixed.fixed_insphere(np.array(v)) == ball(v)
    tied = np.array([*v[:9], *v[6:9]])
    assert fixed.fixed_insphere(tied) == 0


def test_the_largest_integers_of_balls():
    for code in range(3**12 - 1, 0, -97):
        v = [(code // 3**i % 3 - 1) * (MOST - (i * code) % 2) for i in range(12)]
        assert fixed.fixed_insphere(np.array(v)) == ball(v)


def test_cospherical_points_need_few_limbs():
    """Corners of turned boxes and of lattices with steps that are not exact, and neighbors of ties."""
    rng = np.random.default_rng(6)
    signs = []
    for k in range(400):
        corners = np.array([[i, j, m] for i in (0, 1) for j in (0, 1) for m in (0, 1)], dtype=float)
        points = rng.permutation(corners)[:5] * rng.uniform(0.1, 0.3, 3) * 2.0 ** -(k % 30)
        if k % 2:
            turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
            points = (points[:, :, None] * turn[None]).sum(axis=1)
        else:
            points = np.round(points * 64) * STEPS[k % 5] / 64
        rows = [[Fraction(float(x)) - Fraction(float(y)) for x, y in zip(p, points[4])] for p in points[:4]]
        signs.append(close.close_insphere(np.ascontiguousarray(points.ravel())))
        assert signs[-1] == ball([x for row in rows for x in row])
    assert set(signs) == {-1, 0, 1}


def test_points_of_turned_planes_need_few_limbs():
    """Near ties in space: with and without the filter they are rational arithmetic."""
    rng = np.random.default_rng(5)
    signs = []
    for k in range(600):
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        flat = rng.uniform(-0.5, 0.5, (4, 3)) * (1, 1, 0) + (0, 0, 0.3)
        points = (flat[:, :, None] * turn[None]).sum(axis=1) * 2.0 ** -(k % 40)
        if k % 3 == 0:
            points[3] = points[0] + (points[1] - points[0]) / 2
        rows = [[Fraction(float(x)) - Fraction(float(y)) for x, y in zip(p, points[3])] for p in points[:3]]
        expected = volume(*rows)
        signs.append(close.close_orient3(tuple(points.ravel().tolist())))
        assert signs[-1] == expected == -orient3(*points.ravel().tolist())
    assert set(signs) >= {-1, 1}


@settings(max_examples=400, deadline=None)
@given(st.tuples(*[digits] * 6))
def test_digits_are_integers_of_any_length(v):
    a, b, c = (v[0], v[1]), (v[2], v[3]), (v[4], v[5])
    assert fixed.fixed_incircle(*v) == lifted(a, b, c)
    assert fixed.fixed_orient2(*v[:4]) == sign(cross(a, b))


def test_the_largest_integers():
    """All columns at their largest in magnitude, in each combination of signs; ties and their neighbors."""
    for code in range(3**6):
        v = [(code // 3**i % 3 - 1) * (MOST - (i * code) % 2) for i in range(6)]
        assert fixed.fixed_incircle(*v) == lifted(v[:2], v[2:4], v[4:])
        assert fixed.fixed_orient2(*v[:4]) == sign(cross(v[:2], v[2:4]))


def test_nothing_is_too_long_for_64_bits(monkeypatch):
    """Each intermediate result in plain Python, for the largest differences."""

    class Watched(int):
        def _made(self, name, other):
            value = Watched(getattr(int, name)(self, other))
            assert abs(value) < 2**63
            return value

        def __neg__(self):
            return Watched(-int(self))

    for name in ("__add__", "__sub__", "__mul__", "__and__", "__or__", "__rshift__"):
        setattr(Watched, name, lambda self, other, name=name: self._made(name, other))
    plainly(monkeypatch)
    for code in range(2**6):
        for x in (MOST, 2**57 - 2**28 - 1, 2**56 + 2**29 - 1):
            v = [Watched(x if code >> i & 1 else -x) for i in range(6)]
            assert fixed.fixed_incircle(*v) == lifted(*[(int(v[i]), int(v[i + 1])) for i in (0, 2, 4)])
    for code in range(2**12):
        v = [Watched(MOST if code >> i & 1 else -MOST) for i in range(12)]
        assert fixed.fixed_insphere(v) == ball([int(x) for x in v])


# --- the coordinates ----------------------------------------------------------------------------


def lattice(rng, step):
    """Corners of a rectangle of a lattice: a tie, if the coordinates of each line are equal."""
    x = np.arange(300) * step
    x *= 2.0 ** -np.frexp(x[-1])[1]
    i, j = rng.integers(0, 290, 2)
    k, l = rng.integers(1, 9, 2)
    return np.array([(x[i], x[j]), (x[i + k], x[j]), (x[i + k], x[j + l]), (x[i], x[j + l])])


def mirrored(rng, step):
    x, y = rng.uniform(0.25, 1, 2) * step / 16
    return np.array([(x, y), (-x, y), (-x, -y), (x, -y)])


def octagon(rng, step):
    """Four of the eight points (+-x, +-y), (+-y, +-x)."""
    x, y = rng.uniform(0.25, 1, 2) * step / 16
    points = [(s * u, t * v) for s in (1, -1) for t in (1, -1) for u, v in ((x, y), (y, x))]
    return np.array(points)[rng.permutation(8)[:4]]


@pytest.mark.parametrize("make", [lattice, mirrored, octagon])
@pytest.mark.parametrize("step", STEPS)
def test_ties_and_the_neighbors_of_ties(make, step):
    """Also with one coordinate moved by a few units in the last place, or by powers of two."""
    rng = np.random.default_rng(7)
    signs = set()
    for _ in range(40):
        points = make(rng, step)
        assert agree(points[rng.permutation(4)]) == 0
        near = points.copy()
        i, j = rng.integers(0, 4), rng.integers(0, 2)
        for _ in range(rng.integers(1, 4)):
            near[i, j] = np.nextafter(near[i, j], rng.choice((-1, 1)))
        signs.add(agree(near))
        points[i, j] += rng.choice((-1, 1)) * 2.0 ** -rng.integers(20, 120)
        agree(points)
    assert {-1, 1} <= signs


@pytest.mark.parametrize("make", [lattice, mirrored, octagon])
def test_ties_need_no_limbs(make, monkeypatch):
    """In plain Python, with the stages behind taken away."""
    plainly(monkeypatch)
    monkeypatch.setattr(close, "exact_incircle", lambda *_: None)
    monkeypatch.setattr(close, "exact_orient2", lambda *_: None)
    monkeypatch.setattr(close, "two_product", lambda *_: None)
    rng = np.random.default_rng(3)
    for step in STEPS:
        for _ in range(20):
            points = make(rng, step)
            assert close.close_incircle(*points.ravel()) == 0
            assert close.close_orient2(*points[:3].ravel()) == rational(points[:3])


coordinates = st.one_of(
    st.floats(-1, 1),
    st.integers(-4, 4).map(lambda i: i / 4),
    st.integers(-9, 9).map(lambda i: i * 0.1),
    st.integers(-5, 5).map(lambda i: 0.3 + i * 2.0**-54),
    st.tuples(st.integers(-(2**53), 2**53), st.integers(53, 75)).map(lambda v: v[0] * 2.0 ** -v[1]),
    st.tuples(st.integers(-3, 3), st.integers(2, 1000)).map(lambda v: v[0] * 2.0 ** -v[1]),
)


@settings(max_examples=600, deadline=None)
@given(st.lists(st.tuples(coordinates, coordinates), min_size=4, max_size=4))
def test_any_coordinates(points):
    agree(points)


@settings(max_examples=200, deadline=None)
@given(st.lists(st.tuples(coordinates, coordinates), min_size=4, max_size=4), st.integers(100, 230))
def test_any_coordinates_much_smaller(points, power):
    """Around the least differences that are taken; products of what is smaller would not be doubles."""
    agree([(x * 2.0**-power, y * 2.0**-power) for x, y in points])


@pytest.mark.parametrize("bits", range(50, 62))
def test_where_the_length_ends(bits):
    """Differences of up to 61 bits: exact also where two digits do not hold them."""
    rng = np.random.default_rng(bits)
    for _ in range(60):
        big, small = rng.integers(2**52, 2**53, (4, 2)) * 2.0**-53, rng.integers(-9, 10, (4, 2)) * 2.0**-bits
        points = np.where(rng.random((4, 2)) < 0.5, big, small)
        agree(points)
        points[3] = points[0] + rng.integers(-1, 2, 2) * 2.0**-54
        agree(points)
