"""Curved pieces of a boundary: points by parameter, so that a piece is split at a point of the true curve.

A curve is any object with a method ``point(t)``. It takes parameters t in [0, 1] as an array (k,) and returns
points (k, 2). The curve should be smooth and injective in the open interval; where it is not, put a vertex
there and give two curves. See the book, chapter 2.6d.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import all_finite, as_numbers
from ..base.elementary import angle_of, cosine, cosines, sine, sines
from ..base.errors import InputError
from ..base.jit import kernel

__all__ = ["Arc", "Batch", "Bezier", "Curve", "CurveLike"]

Array = NDArray[np.float64]


@runtime_checkable
class CurveLike(Protocol):
    """Any object that gives the points of a curve by parameter."""

    def point(self, t: Array) -> Array:
        """Points (k, 2) for parameters (k,) in [0, 1]."""
        ...


def _pair(value: Any, name: str) -> tuple[float, float]:
    array = as_numbers(value, name)
    if array.shape != (2,) or not np.isfinite(array).all():
        raise InputError(f"{name} must be two finite numbers, not {value!r}")
    return float(array[0]), float(array[1])


def _number(value: Any, name: str) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name} must be a number, not {value!r}") from None
    if not math.isfinite(number):
        raise InputError(f"{name} = {number} must be finite")
    return number


class Arc:
    """A circular arc.

    Parameters
    ----------
    center : (2,) array_like
    radius : float
        Positive.
    start : float
        Angle of the first point, in radians.
    sweep : float
        Angle from the first point to the last, in radians, at most a full turn; positive is counterclockwise.

    Raises
    ------
    InputError
        For a radius that is not positive, a sweep that is zero or more than a full turn, and for values that
        are not numbers.
    """

    def __init__(self, center: ArrayLike, radius: float, start: float, sweep: float):
        self.center = _pair(center, "center")
        self.radius, self.start = _number(radius, "radius"), _number(start, "start")
        self.sweep = _number(sweep, "sweep")
        if not self.radius > 0:
            raise InputError(f"radius = {self.radius} must be positive")
        if not 0 < abs(self.sweep) <= 2 * math.pi * (1 + 1e-15):
            raise InputError(f"sweep = {self.sweep} must not be 0 or more than a full turn (2 pi)")

    @classmethod
    def through(cls, first: ArrayLike, middle: ArrayLike, last: ArrayLike) -> Arc:
        """The arc from ``first`` through ``middle`` to ``last``; the three points must not be collinear."""
        (ax, ay), (bx, by), (cx, cy) = _pair(first, "first"), _pair(middle, "middle"), _pair(last, "last")
        ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
        exponent = math.frexp(max(abs(ux), abs(uy), abs(vx), abs(vy)))[1]
        ux, uy, vx, vy = (math.ldexp(x, -exponent) for x in (ux, uy, vx, vy))
        double = 2 * (ux * vy - uy * vx)
        if double == 0:
            raise InputError("first, middle and last lie on a line; leave the piece straight")
        u2, v2 = ux * ux + uy * uy, vx * vx + vy * vy
        x, y = (vy * u2 - uy * v2) / double, (ux * v2 - vx * u2) / double
        start = angle_of(-y, -x)
        sweep = (angle_of(vy - y, vx - x) - start) % (2 * math.pi)
        x, y = math.ldexp(x, exponent), math.ldexp(y, exponent)
        return cls((ax + x, ay + y), math.hypot(x, y), start, sweep if double > 0 else sweep - 2 * math.pi)

    def point(self, t: Array) -> Array:
        """Points (k, 2) for parameters (k,); equal steps of t give equal lengths of arc."""
        return arc_points(*self.center, self.radius, self.start, self.sweep, np.asarray(t, dtype=float))

    def __repr__(self) -> str:
        return f"Arc({self.center}, {self.radius:g}, {self.start:g}, {self.sweep:g})"


class Curve:
    """A parametric curve.

    Parameters
    ----------
    function : callable, (k,) -> (k, 2)
        Gives points for an array of parameters. It must return the same points at every call. (The last bits
        of numpy's sines and exponentials depend on the processor, and so does a mesh along such a curve.)
    t0, t1 : float
        The parameters of the function at the first and at the last end; t0 > t1 reverses the direction.

    Raises
    ------
    InputError
        For t0 = t1; on evaluation, if the function returns another shape or points that are not finite.
    """

    def __init__(self, function: Callable[[Array], ArrayLike], t0: float = 0.0, t1: float = 1.0):
        if not callable(function):
            raise InputError(f"function must be callable, not {type(function).__name__}")
        self.function, self.t0, self.t1 = function, _number(t0, "t0"), _number(t1, "t1")
        if self.t0 == self.t1:
            raise InputError(f"t0 = t1 = {self.t0}: the curve is a single point; t0 and t1 must differ")

    def point(self, t: Array) -> Array:
        """Points (k, 2) for parameters (k,) in [0, 1]."""
        t = np.asarray(t, dtype=float)
        return _evaluated(self.function, self.t0 * (1 - t) + self.t1 * t)  # exact at both ends

    def __repr__(self) -> str:
        return f"Curve({getattr(self.function, '__name__', 'function')}, {self.t0:g}, {self.t1:g})"


def _evaluated(function: Callable[[Array], ArrayLike], inner: Array) -> Array:
    """The points that a curve's function returns for parameters of its own."""
    result = np.asarray(function(inner), dtype=float)
    if result.shape != (*inner.shape, 2):
        raise InputError(
            f"a curve's function must return shape {(*inner.shape, 2)} for parameters {inner.shape}, "
            f"not {result.shape}"
        )
    if result.ndim == 2 and result.flags.carray and all_finite(result):
        return result
    if not np.isfinite(result).all():
        where = float(inner[np.argmin(np.isfinite(result).all(axis=-1))])
        raise InputError(f"a curve's function is not finite at parameter {where}")
    return result


class Bezier:
    """A Bezier curve of any degree, as used in font outlines.

    Parameters
    ----------
    controls : (degree + 1, 2) array_like
        At least two control points; the first and the last are the ends.
    """

    def __init__(self, controls: ArrayLike):
        self.controls = as_numbers(controls, "controls")
        if self.controls.ndim != 2 or self.controls.shape[1] != 2 or len(self.controls) < 2:
            raise InputError(
                f"controls must have shape (degree + 1, 2) with degree >= 1, not {self.controls.shape}"
            )
        if not np.isfinite(self.controls).all():
            raise InputError("controls must be finite")

    def point(self, t: Array) -> Array:
        """Points (k, 2) for parameters (k,), by de Casteljau's repeated interpolation."""
        t = np.asarray(t, dtype=float)
        return bezier_points(np.broadcast_to(self.controls, (len(t), *self.controls.shape)), t)

    def __repr__(self) -> str:
        return f"Bezier({self.controls.tolist()})"


def arc_points(x: Any, y: Any, radius: Any, start: Any, sweep: Any, t: Array) -> Array:
    """Points (k, 2) of one arc or of k, whose numbers are arrays then, for parameters (k,)."""
    angle = start + t * sweep
    return np.stack([x + radius * cosines(angle), y + radius * sines(angle)], axis=-1)


def bezier_points(controls: Array, t: Array) -> Array:
    """Points (k, 2) of k Bezier curves of one degree, controls (k, degree + 1, 2), for parameters (k,)."""
    level, t = controls, t[:, None, None]
    while level.shape[1] > 1:
        level = (1 - t) * level[:, :-1] + t * level[:, 1:]
    return np.ascontiguousarray(level[:, 0])


@kernel
def _arcs(kind, arc, piece, t, x):
    """Write the points of those pieces that are arcs."""
    for i in range(len(t)):
        p = piece[i]
        if kind[p] == 1:
            angle = arc[p, 3] + t[i] * arc[p, 4]
            x[i, 0], x[i, 1] = arc[p, 0] + arc[p, 2] * cosine(angle), arc[p, 1] + arc[p, 2] * sine(angle)


@kernel
def _of_one(group, g, span, piece, t, rows, own):
    """Write the rows whose pieces are of one group, and the parameters of their functions; how many."""
    many = 0
    for i in range(len(t)):
        p = piece[i]
        if group[p] == g:
            rows[many], own[many] = i, span[p, 0] * (1 - t[i]) + span[p, 1] * t[i]
            many += 1
    return many


class Batch:
    """Many curves that are asked at once: arcs together, Bezier curves degree by degree, others one by one.

    Curves of one function, such as both sides of an airfoil, count as one.

    Parameters
    ----------
    curves : dict of int to curve
        By piece.
    pieces : int
        How many there are, straight ones included.
    """

    def __init__(self, curves: dict[int, CurveLike], pieces: int):
        self.kind = np.zeros(pieces, dtype=np.int64)  # 0 straight, 1 arc, 2 other, 3 and on: Bezier
        self.arc = np.zeros((pieces, 5))
        self.row = np.zeros(pieces, dtype=np.int64)  # among the controls of its degree
        self.group = np.full(pieces, -1, dtype=np.int64)  # of others: those that are asked together
        self.span = np.zeros((pieces, 2))  # the parameters at the ends of these
        self.controls: dict[int, Array] = {}
        self.arcs = False  # whether there are any
        self.functions: list[Callable[[Array], Array]] = []
        arcs: list[tuple[float, ...]] = []
        beziers: dict[int, list[tuple[int, Array]]] = {}
        known: dict[int, int] = {}
        for piece, curve in curves.items():
            if isinstance(curve, Arc) and type(curve).point is Arc.point:
                arcs.append((piece, *curve.center, curve.radius, curve.start, curve.sweep))
            elif isinstance(curve, Bezier) and type(curve).point is Bezier.point:
                beziers.setdefault(len(curve.controls) + 1, []).append((piece, curve.controls))
            else:
                self.kind[piece], self.span[piece] = 2, (0.0, 1.0)
                asked, key = curve.point, id(curve)
                if isinstance(curve, Curve) and type(curve).point is Curve.point:
                    self.span[piece] = curve.t0, curve.t1
                    asked, key = partial(_evaluated, curve.function), id(curve.function)
                self.group[piece] = known.setdefault(key, len(self.functions))
                if self.group[piece] == len(self.functions):
                    self.functions.append(asked)
        self.arcs = bool(arcs)
        if arcs:
            table = np.array(arcs)
            at = table[:, 0].astype(np.int64)
            self.kind[at], self.arc[at] = 1, table[:, 1:]
        for kind, found in beziers.items():
            at = np.array([piece for piece, _ in found])
            self.kind[at], self.row[at] = kind, np.arange(len(at))
            self.controls[kind] = np.stack([controls for _, controls in found])

    def fill(self, piece: NDArray[np.int64], t: Array, x: Array) -> None:
        """Write the points of the rows that lie on curves, by parameter."""
        if self.arcs:
            _arcs(self.kind, self.arc, piece, t, x)
        if not (self.functions or self.controls):
            return
        rows, own = np.empty(len(t), dtype=np.int64), np.empty(len(t))
        for k, controls in self.controls.items():
            many = _of_one(self.kind, k, self.span, piece, t, rows, own)
            if many:
                some = rows[:many]
                x[some] = bezier_points(controls[self.row[piece[some]]], t[some])
        for g, asked in enumerate(self.functions):
            many = _of_one(self.group, g, self.span, piece, t, rows, own)
            if many:
                x[rows[:many]] = asked(own[:many].copy())
