"""A level set: a function that is positive inside, called on many points at once, and its zeros on edges.

See the book, chapter 4c.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.asking import asked_at
from ...base.errors import InputError

__all__ = ["CALLED_AT_ONCE", "LevelSet"]

Array = NDArray[np.float64]
CALLED_AT_ONCE = 1 << 18  # points in one call, to bound its memory
MOST_ZERO_STEPS = 100  # of the search for zeros; halving alone would take 53


class LevelSet:
    """The set where a function of points (k, 3) -> (k,) is positive.

    Points outside of the box (2, 3) are moved to its boundary before the function is asked. If the body is
    `capped`, what is outside of the box does not belong to it.

    Attributes
    ----------
    called : int
        The number of points at which the function has been asked.
    """

    def __init__(self, function: Callable[[Array], Any], box: Array, capped: bool = False):
        self.function, self.box, self.capped = function, box, capped
        self.called = 0

    def __call__(self, x: Array) -> Array:
        """Values at points (k, 3).

        Raises
        ------
        InputError
            If the function raises an error, or returns anything but k finite numbers.
        """
        result = np.empty(len(x))
        for i in range(0, len(x), CALLED_AT_ONCE):
            part = np.clip(x[i : i + CALLED_AT_ONCE], self.box[0], self.box[1])
            values = self._values(part)
            if self.capped:
                there = x[i : i + CALLED_AT_ONCE]
                gap = np.minimum(there - self.box[0], self.box[1] - there).min(axis=1)
                values = np.minimum(values, gap)
            result[i : i + CALLED_AT_ONCE] = values
        self.called += len(x)
        return result

    def _values(self, points: Array) -> Array:
        values = asked_at(
            lambda x: np.asanyarray(self.function(x.copy())), points, "the function of the body",
            "points (k, 3) and returns k numbers, positive inside",
        )  # fmt: skip
        if values.shape != (len(points),):
            raise InputError(
                f"the function of the body must return shape ({len(points)},) for {len(points)} points, not "
                f"{values.shape}"
            )
        if values.dtype.kind not in "fiu" or np.ma.isMaskedArray(values):
            raise InputError(
                f"the function of the body must return plain real numbers, not {type(values).__name__} of "
                f"{values.dtype}"
            )
        values = values.astype(np.float64)
        if not np.isfinite(values).all():
            row = int(np.argmin(np.isfinite(values)))
            raise InputError(
                f"the function of the body is {values[row]} at {points[row].tolist()}; it must be finite "
                "everywhere in the box"
            )
        return values

    def zeros(self, inner: Array, outer: Array, high: Array, low: Array, tolerance: float | None) -> Array:
        """Where the function changes its sign between points inside and outside.

        Parameters
        ----------
        inner, outer : (e, 3) float64
        high, low : (e,) float64
            The values there, which are positive and negative.
        tolerance : float or None
            The length of the final brackets, as a share of the edge; None: the zeros of the linear
            interpolation, without further calls.

        Returns
        -------
        (e,) float64
            0 at the inner point, 1 at the outer one.

        Notes
        -----
        Inverse quadratic interpolation where it is safe, and halving (T. R. Chandrupatla, Adv. Eng. Softw.
        28, 1997, 145-149). Of several zeros on an edge, one is found.
        """
        if tolerance is None:
            return _linear(high, low)
        e = len(inner)
        a, b, fa, fb = np.ones(e), np.zeros(e), low.copy(), high.copy()
        c, fc = a.copy(), fa.copy()
        step = _linear(high, low)
        where = np.where(np.abs(fa) < np.abs(fb), a, b)
        active = np.arange(e)
        for _ in range(MOST_ZERO_STEPS):
            if not len(active):
                break
            k = active
            x = a[k] + step[k] * (b[k] - a[k])
            f = self(inner[k] + x[:, None] * (outer[k] - inner[k]))
            same = np.sign(f) == np.sign(fa[k])
            c[k], fc[k] = np.where(same, a[k], b[k]), np.where(same, fa[k], fb[k])
            b[k], fb[k] = np.where(same, b[k], a[k]), np.where(same, fb[k], fa[k])
            a[k], fa[k] = x, f
            first = np.abs(fa[k]) < np.abs(fb[k])
            where[k] = np.where(first, a[k], b[k])
            width = np.abs(b[k] - a[k])
            margin = 0.5 * tolerance / np.maximum(width, tolerance)
            step[k] = np.clip(_step(a[k], b[k], c[k], fa[k], fb[k], fc[k]), margin, 1.0 - margin)
            active = k[(width > tolerance) & (fa[k] != 0.0)]
        return where


def _linear(high: Array, low: Array) -> Array:
    """The zero of the linear function with these values at 0 and 1; the quotient cannot overflow."""
    scale = np.maximum(high, -low)
    one, two = high / scale, low / scale
    return one / (one - two)


def _step(a: Array, b: Array, c: Array, fa: Array, fb: Array, fc: Array) -> Array:
    """The next place in the bracket, 0 at a and 1 at b: by interpolation where that is safe, else one
    half."""
    with np.errstate(all="ignore"):
        xi = (a - b) / (c - b)
        phi = (fa - fb) / (fc - fb)
        safe = (phi * phi < xi) & ((1.0 - phi) ** 2 < 1.0 - xi)
        step = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
    return np.where(safe & np.isfinite(step), step, 0.5)
