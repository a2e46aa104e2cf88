"""One step of Rebay's insertion: the formulas, their exceptional cases, and the map of p / f."""

from fractions import Fraction
from math import asin, hypot, isclose, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from unstruct import InputError
from unstruct.geometry.simplex import circumcenter, circumradius
from unstruct.plain import rebay_step as rs
from unstruct.plain.predicates import in_sphere, orient

GRID = st.tuples(st.integers(-9, 9), st.integers(-9, 9))
SIZES = st.floats(0.05, 40.0)


@given(GRID, GRID, GRID, GRID, SIZES)
def test_the_new_point(a, b, c, d, f):
    """On the bisector of AB, beyond M on the side of D, not beyond F, on the circle that (12.4) asks for."""
    assume(orient([a, b, d]) * orient([a, b, c]) < 0)
    got = rs.step(a, b, d, f, c)
    a, b, c, d = (np.array(v, dtype=float) for v in (a, b, c, d))
    size = 1e-9 * (1 + abs(got.q) + got.p)
    assert np.allclose(got.middle, (a + b) / 2) and isclose(got.p, np.linalg.norm(b - a) / 2)
    assert np.allclose(got.center, circumcenter(np.array([a, b, d])), atol=size)
    assert np.allclose(got.accepted_center, circumcenter(np.array([a, b, c])), atol=size)
    if got.point is None:
        assert got.q <= 0
        return
    x, r_far = np.array(got.point), circumradius(np.array([a, b, d]))
    assert got.distance <= got.q * (1 + 1e-12)
    assert isclose(np.linalg.norm(x - a), np.linalg.norm(x - b), rel_tol=1e-9)
    cross = lambda p: (b - a)[0] * (p - a)[1] - (b - a)[1] * (p - a)[0]  # noqa: E731
    assert cross(x) * cross(d) > 0
    if not (got.capped or got.beyond):
        assert isclose(got.radius, max(f, got.p)) and got.distance >= got.p
        assert isclose(circumradius(np.array([a, b, x])), got.radius, rel_tol=1e-6)
        assert np.linalg.norm(x - a) >= sqrt(2) * f * (1 - 1e-12)  # |AX|^2 = 2 R d
    else:
        assert np.allclose(x, got.center, atol=size) and isclose(np.linalg.norm(x - a), r_far, rel_tol=1e-6)


@given(GRID, GRID, GRID, SIZES)
def test_beyond_the_center_exactly_if_q_is_less_than_p(a, b, d, f):
    assume(orient([a, b, d]) != 0)
    got = rs.step(a, b, d, f)
    inner = sum((u - v) * (w - v) for u, v, w in zip(a, d, b))  # DA . DB = |DA||DB| cos D
    area = abs(orient([a, b, d]))
    doubled = abs((b[0] - a[0]) * (d[1] - a[1]) - (b[1] - a[1]) * (d[0] - a[0]))
    assert area == 1 and (got.q > 1e-12) == (inner > 0)
    assert got.beyond == (0 < inner < doubled)  # 45 degrees < angle D < 90 degrees


def test_the_unclamped_point_of_the_ledger_lies_beyond_the_center():
    """A=(-4,0), B=(4,0), D=(3,-7), f=3: p=4, q=3, and (12.5) gives d=4."""
    got = rs.step((-4, 0), (4, 0), (3, -7), 3.0, (0, 4), clamp=False)
    assert (got.p, got.q, got.distance, got.beyond) == (4, 3, 4, True)
    assert rs.step((-4, 0), (4, 0), (3, -7), 3.0).point == (0.0, -3.0)


def test_the_accepted_triangle_may_lose_its_edge():
    """A=(-4,0), B=(4,0), C=(0,2), D=(0,-12), f=3.5: X=(0,-4) is in circle ABC."""
    got = rs.step((-4, 0), (4, 0), (0, -12), 3.5, (0, 2))
    assert got.point == (0.0, -4.0) and got.accepted_center == (0.0, -3.0)
    assert in_sphere([(-4, 0), (4, 0), (0, 2)], tuple(map(Fraction, got.point))) > 0


@given(st.floats(0.01, 10), st.floats(0.01, 10), SIZES)
def test_the_radius_is_never_below_p(p, q, f):
    assert rs.cap(p, q) >= p * (1 - 1e-15)
    assert p * (1 - 1e-15) <= rs.radius(f, p, q) <= rs.cap(p, q)


@given(st.floats(1e-6, 1.0))
def test_the_angle_law(x):
    """One step multiplies apex - 60 degrees by -1/2, exactly but for rounding."""
    a = rs.apex(x)
    assert isclose(sin(rs.next_apex(a)), rs.next_ratio(x), rel_tol=1e-12)
    assert isclose(rs.next_apex(a) - pi / 3, -(a - pi / 3) / 2, abs_tol=1e-15)


def test_every_start_converges_for_constant_size():
    for x in np.linspace(0.001, 3, 300):
        for _ in range(60):
            x = rs.next_ratio(x)
        assert isclose(x, sqrt(3) / 2, rel_tol=1e-12) and abs(rs.epsilon(x, 1.0)) < 1e-12


@pytest.mark.parametrize("growth", [0.75, 0.9, 1.0, 1.3])
def test_the_fixed_point(growth):
    a = 2 * asin(1 / (2 * growth))
    assert isclose(rs.next_ratio(sin(a), growth), sin(a), rel_tol=1e-12)


def test_the_step_is_the_map():
    a, b, f, d = (0.0, 0.0), (1.0, 0.0), 0.7, (0.4, 50.0)
    x = rs.step(a, b, d, f).point
    assert isclose(hypot(*x) / 2 / f, rs.next_ratio(0.5 / f), rel_tol=1e-12)


@pytest.mark.parametrize(
    "call",
    [
        lambda: rs.step((0, 0), (1, 0), (2, 0), 1.0),
        lambda: rs.step((0, 0), (1, 0), (0, 1), 0.0),
        lambda: rs.step((0, 0), (1, 0), (0, 1), float("nan")),
        lambda: rs.next_ratio(0.0),
        lambda: rs.next_ratio(1.0, -1.0),
    ],
)
def test_bad_input(call):
    with pytest.raises(InputError):
        call()
