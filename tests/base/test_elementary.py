"""The library's own sines, arctangents and exponentials, against numbers of two hundred bits."""

from __future__ import annotations

import math
from collections.abc import Callable

import mpmath
import numpy as np
import pytest

from unstruct.base import elementary

RNG = np.random.default_rng(0)
ANGLES = [RNG.uniform(-1, 1, 500), RNG.uniform(-7, 7, 500), RNG.uniform(-1e3, 1e3, 500)]
ANGLES += [
    RNG.uniform(-8e5, 8e5, 500),
    np.arange(-240, 241) * (np.pi / 12),
    np.ldexp(1.0, np.arange(-60, 10)),
]
X = np.concatenate(ANGLES)
POWERS = np.concatenate([RNG.uniform(-700, 700, 500), RNG.uniform(-1, 1, 500), np.arange(-20.0, 21.0)])
LENGTH, TURN = 10.0 ** RNG.uniform(-8, 8, (2, 800)), RNG.uniform(-np.pi, np.pi, 800)
XY = LENGTH * np.stack([np.cos(TURN), np.sin(TURN)])


def units(found: np.ndarray, function: Callable, *arguments: np.ndarray) -> float:
    """The largest error in units in the last place."""
    with mpmath.workprec(200):
        right = [function(*map(mpmath.mpf, row)) for row in zip(*(x.tolist() for x in arguments))]
        return max(
            float(abs(x - y)) / math.ulp(float(y)) for x, y in zip(map(mpmath.mpf, found.tolist()), right)
        )


def test_sines_and_cosines() -> None:
    assert units(elementary.sines(X), mpmath.sin, X) < 0.8
    assert units(elementary.cosines(X), mpmath.cos, X) < 0.8
    shape = X[:12].reshape(3, 2, 2)
    assert elementary.sines(shape).tolist() == elementary.sines(X[:12]).reshape(3, 2, 2).tolist()
    assert (
        elementary.sine(X[3]) == elementary.sines(X)[3]
        and elementary.cosine(X[3]) == elementary.cosines(X)[3]
    )


def test_enormous_angles_are_in_the_circle() -> None:
    far = 10.0 ** np.arange(6, 300, 7)
    s, c = elementary.sines(far), elementary.cosines(far)
    assert np.allclose(s * s + c * c, 1.0, rtol=1e-14)
    near = far[far < 1e9]
    assert np.allclose(elementary.sines(near), np.sin(near), atol=1e-6)


def test_exponentials() -> None:
    assert units(elementary.exponentials(POWERS), mpmath.exp, POWERS) < 0.9
    rows = elementary.exponentials([-np.inf, -800.0, 0.0, 709.7, 709.8, np.inf])
    assert rows[[0, 1, 2, 4, 5]].tolist() == [0.0, 0.0, 1.0, np.inf, np.inf] and np.isfinite(rows[3])
    assert elementary.exponentials(-745.0) == 5e-324


def test_angles_of_vectors() -> None:
    x, y = XY
    assert units(elementary.turns(y, x), mpmath.atan2, y, x) < 1.9
    special = np.array([0.0, -0.0, 1.0, -1.0, np.inf, -np.inf, 5e-324, -1e308, 1e308, 1e-310])
    y, x = (side.ravel() for side in np.meshgrid(special, special))
    found, wanted = elementary.turns(y, x), np.arctan2(y, x)
    assert np.allclose(found, wanted, rtol=1e-15, atol=0) and (np.signbit(found) == np.signbit(wanted)).all()


def test_arcsines() -> None:
    x = np.concatenate([RNG.uniform(-1, 1, 500), [-1.0, -0.5, 0.5, 1.0]])
    found = np.array([elementary.arcsine(value) for value in x.tolist()])
    assert units(found, mpmath.asin, x) < 2


@pytest.mark.parametrize("function", [elementary.sines, elementary.cosines, elementary.exponentials])
def test_what_is_not_a_number_stays_so(function: Callable) -> None:
    assert np.isnan(function([np.nan])).all()
    assert np.isnan(elementary.turns([np.nan, 0.0], [0.0, np.nan])).all()
    assert len(function([])) == 0


def test_logarithms() -> None:
    """Within two units in the last place of the C library's, from the least double to the largest."""
    rng = np.random.default_rng(0)
    wide, near = np.exp(rng.uniform(-700, 700, 2000)), rng.uniform(0.5, 2.0, 2000)
    for x in [*wide.tolist(), *near.tolist(), 5e-324, 1.7e308, 1.0]:
        true = math.log(x)
        assert abs(elementary.logarithm(x) - true) <= 2 * math.ulp(true)
