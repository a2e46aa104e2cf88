"""Curved pieces of a boundary: points by parameter, so that a piece is split at a point of the true curve.

A curve is any object with a method ``point(t)``. It takes parameters t in [0, 1] as an array (k,) and returns
points (k, 2). The curve should be smooth and injective in the open interval; where it is not, put a vertex
there and give two curves. See the book, chapter 2.6d.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import as_numbers
from ..base.elementary import angle_of, cosines, sines
from ..base.errors import InputError

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
        inner = self.t0 * (1 - t) + self.t1 * t  # exact at both ends
        result = np.asarray(self.function(inner), dtype=float)
        if result.shape != (*t.shape, 2):
            raise InputError(
                f"a curve's function must return shape {(*t.shape, 2)} for parameters {t.shape}, "
                f"not {result.shape}"
            )
        if not np.isfinite(result).all():
            where = float(inner[np.argmin(np.isfinite(result).all(axis=-1))])
            raise InputError(f"a curve's function is not finite at parameter {where}")
        return result

    def __repr__(self) -> str:
        return f"Curve({getattr(self.function, '__name__', 'function')}, {self.t0:g}, {self.t1:g})"


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


class Batch:
    """Many curves that are asked at once: arcs together, Bezier curves degree by degree, others one by one.

    Parameters
    ----------
    curves : dict of int to curve
        By piece.
    pieces : int
        How many there are, straight ones included.
    """

    def __init__(self, curves: dict[int, CurveLike], pieces: int):
        self.curves = curves
        self.kind = np.zeros(pieces, dtype=np.int64)  # 0 straight, 1 arc, 2 other, 3 and on: Bezier
        self.arc = np.zeros((pieces, 5))
        self.row = np.zeros(pieces, dtype=np.int64)  # among the controls of its degree
        self.controls: dict[int, Array] = {}
        arcs: list[tuple[float, ...]] = []
        beziers: dict[int, list[tuple[int, Array]]] = {}
        for piece, curve in curves.items():
            if isinstance(curve, Arc) and type(curve).point is Arc.point:
                arcs.append((piece, *curve.center, curve.radius, curve.start, curve.sweep))
            elif isinstance(curve, Bezier) and type(curve).point is Bezier.point:
                beziers.setdefault(len(curve.controls) + 1, []).append((piece, curve.controls))
            else:
                self.kind[piece] = 2
        if arcs:
            table = np.array(arcs)
            at = table[:, 0].astype(np.int64)
            self.kind[at], self.arc[at] = 1, table[:, 1:]
        for kind, found in beziers.items():
            at = np.array([piece for piece, _ in found])
            self.kind[at], self.row[at] = kind, np.arange(len(at))
            self.controls[kind] = np.stack([controls for _, controls in found])

    def points(self, piece: NDArray[np.integer], t: Array) -> tuple[NDArray[np.int64], Array]:
        """Which of the rows lie on curves, and their points by parameter."""
        kind = self.kind[piece]
        rows, blocks = [], []
        for k in (1, *self.controls):
            some = np.flatnonzero(kind == k)
            if len(some):
                rows.append(some)
                which = piece[some]
                if k == 1:
                    x, y, radius, start, sweep = self.arc[which].T
                    blocks.append(arc_points(x, y, radius, start, sweep, t[some]))
                else:
                    blocks.append(bezier_points(self.controls[k][self.row[which]], t[some]))
        others = np.flatnonzero(kind == 2)
        if len(others):
            others = others[np.argsort(piece[others], kind="stable")]
            heads = np.flatnonzero(np.diff(piece[others], prepend=-1))
            for some in np.split(others, heads[1:]):
                rows.append(some)
                blocks.append(self.curves[int(piece[some[0]])].point(t[some]))
        if not rows:
            return np.empty(0, dtype=np.int64), np.empty((0, 2))
        return (rows[0], blocks[0]) if len(rows) == 1 else (np.concatenate(rows), np.concatenate(blocks))
