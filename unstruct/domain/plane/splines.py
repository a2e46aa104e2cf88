"""Cubic splines through points by chord length: closed, open, and closed with corners.

Source: C. de Boor, *A Practical Guide to Splines* (1978), chapter 4.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import radians
from typing import Any

import numpy as np

from ...base.arguments import as_number
from ...base.elementary import cosine
from ...base.errors import InputError
from ...geometry.curves import Bezier, CurveLike
from ..arguments import as_ring
from .shapes import Parts, ring_names, rings

__all__ = ["open_slopes", "smooth_rings"]


def smooth_rings(outer: Any, holes: Sequence[Any], corners: Any = None, corner_angle: Any = None) -> Parts:
    """Cubic splines by chord length through the vertices of rings; see `Domain.smooth`.

    Two derivatives are continuous except at corners. Toward a corner the second derivative becomes zero; an
    edge between two corners is straight.
    """
    parts = rings(outer, holes)
    sharp = _corners(corners, len(parts["points"]))
    curves: dict[int, CurveLike] = {}
    start = 0
    for name, given in zip(ring_names(holes), [outer, *holes]):
        ring = as_ring(given, name)
        n = len(ring)
        step = np.hypot(*(np.roll(ring, -1, axis=0) - ring).T)
        if not (step > 0).all():
            raise InputError(f"corner {int(np.argmin(step))} of {name} equals the next one; drop one of them")
        here = np.nonzero(sharp[start : start + n] | _turns(ring, step, corner_angle))[0]
        if len(here) == 0:
            ahead = step[:, None] / 3 * _closed_slopes(ring, step)
            behind = ahead * (np.roll(step, 1) / step)[:, None]  # for the same slope at the end of an edge
            controls = _controls(ring, np.roll(ring, -1, axis=0), ahead, np.roll(behind, -1, axis=0))
            curves |= {start + j: Bezier(piece) for j, piece in enumerate(controls)}
        for first, last in zip(here, [*here[1:], *(here[:1] + n)]):
            along = np.arange(first, last + 1) % n
            if len(along) > 2:
                points, steps = ring[along], step[along[:-1]]
                slopes, third = open_slopes(points, steps), steps[:, None] / 3
                controls = _controls(points[:-1], points[1:], third * slopes[:-1], third * slopes[1:])
                curves |= {start + j: Bezier(piece) for j, piece in zip(along.tolist(), controls)}
        start += n
    return {**parts, "curves": curves}


def _corners(corners: Any, many: int) -> np.ndarray:
    """Whether each vertex is named as a corner: (n,) bool."""
    sharp = np.zeros(many, dtype=bool)
    if corners is None:
        return sharp
    try:
        rows = np.atleast_1d(np.asarray(corners))
    except ValueError:  # ragged
        rows = np.empty((0, 0))
    if rows.ndim != 1 or (rows.size and rows.dtype.kind not in "iu"):
        raise InputError("corners must be a list of vertex numbers; for a bound on angles take corner_angle")
    wrong = rows[(rows < 0) | (rows >= many)]
    if len(wrong):
        raise InputError(f"corners names vertex {wrong[0]}: there are vertices 0..{many - 1} along the rings")
    sharp[rows.astype(np.int64)] = True
    return sharp


def _turns(ring: np.ndarray, step: np.ndarray, angle: Any) -> np.ndarray:
    """Whether the polygon turns by more than an angle in degrees at each vertex: (n,) bool."""
    if angle is None:
        return np.zeros(len(ring), dtype=bool)
    bound = as_number(angle, "corner_angle")
    if not 0 < bound < 180:
        raise InputError(f"corner_angle = {bound} must lie between 0 and 180 degrees")
    along = (np.roll(ring, -1, axis=0) - ring) / step[:, None]
    return (along * np.roll(along, 1, axis=0)).sum(axis=1) < cosine(radians(bound))


def _controls(first: np.ndarray, last: np.ndarray, ahead: np.ndarray, behind: np.ndarray) -> np.ndarray:
    """Control points (k, 4, 2) of pieces by their ends, and how far the inner ones are from these."""
    return np.stack([first, first + ahead, last - behind, last], axis=1)


def _closed_slopes(corners: np.ndarray, step: np.ndarray) -> np.ndarray:
    """The derivatives (n, 2) of the closed cubic spline at its corners; the parameter is chord length.

    Elimination needs no exchanges of rows, as the diagonal dominates. The first slope is kept as an unknown
    until the end.
    """
    n, before = len(corners), np.roll(step, 1)
    secant = (np.roll(corners, -1, axis=0) - corners) / step[:, None]
    right = 3 * (step[:, None] * np.roll(secant, 1, axis=0) + before[:, None] * secant)
    # row i: step[i] s[i - 1] + 2 (before[i] + step[i]) s[i] + before[i] s[i + 1] = right[i]
    known, first, diagonal = right.copy(), np.zeros(n), 2 * (before + step)
    first[1], first[-1] = -step[1], -before[-1]
    for i in range(2, n):
        ratio = step[i] / diagonal[i - 1]
        diagonal[i] -= ratio * before[i - 1]
        known[i] -= ratio * known[i - 1]
        first[i] -= ratio * first[i - 1]
    for i in range(n - 1, 0, -1):
        if i < n - 1:
            known[i] -= before[i] * known[i + 1]
            first[i] -= before[i] * first[i + 1]
        known[i] /= diagonal[i]
        first[i] /= diagonal[i]
    known[0] = (right[0] - step[0] * known[-1] - before[0] * known[1]) / (
        diagonal[0] + step[0] * first[-1] + before[0] * first[1]
    )
    known[1:] += first[1:, None] * known[0]
    return known


def open_slopes(points: np.ndarray, step: np.ndarray) -> np.ndarray:
    """The derivatives (k, 2) of the cubic spline whose second derivative is zero at both ends."""
    secant = np.diff(points, axis=0) / step[:, None]
    k = len(points)
    # row i: step[i] s[i-1] + 2 (step[i-1] + step[i]) s[i] + step[i-1] s[i+1] = right[i]
    below, diagonal, above = np.ones(k), np.full(k, 2.0), np.ones(k)
    below[1:-1], above[1:-1], diagonal[1:-1] = step[1:], step[:-1], 2 * (step[:-1] + step[1:])
    right = np.empty((k, 2))
    right[0], right[-1] = 3 * secant[0], 3 * secant[-1]
    right[1:-1] = 3 * (step[1:, None] * secant[:-1] + step[:-1, None] * secant[1:])
    for i in range(1, k):
        ratio = below[i] / diagonal[i - 1]
        diagonal[i] -= ratio * above[i - 1]
        right[i] -= ratio * right[i - 1]
    right[-1] /= diagonal[-1]
    for i in range(k - 2, -1, -1):
        right[i] = (right[i] - above[i] * right[i + 1]) / diagonal[i]
    return right
