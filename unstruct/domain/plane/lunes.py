"""The regions between curves and their chords: which of them contain a point, and their areas."""

from __future__ import annotations

from math import fsum

import numpy as np

from ...base.elementary import sine
from ...geometry.boxes import BoxTree
from ...geometry.curves import Arc, CurveLike
from ...geometry.outline import Outline
from ...predicates.batch import orient
from .sample import Sampled, fine_chains

__all__ = ["areas_beyond_chords", "in_lunes", "lune_area", "lunes_hold"]

DEPTH = 48  # after so many halvings of a curve a point that is still near is on the curve, up to rounding


# ---------------------------------------------------------------------- curves


def lunes_hold(outline: Outline, sampled: Sampled, rows: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Whether points lie in an odd number of the regions between the chords ``rows`` and their curves."""
    query, _, inside = in_lunes(outline, sampled, rows, x)
    return np.bincount(query[inside], minlength=len(x)) % 2 == 1


def in_lunes(
    outline: Outline, sampled: Sampled, rows: np.ndarray, x: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pairs (point, place in ``rows``) that are near, and whether the point lies between chord and curve.

    By the even-odd rule the region between chord and curve consists of the triangle of the chord and the
    middle of the curve, and of the two smaller regions beside it. Halving ends when the point is outside of a
    box around the part of the curve.
    """
    piece, span = sampled.piece[rows], sampled.span[rows]
    first, last = sampled.points[sampled.ends[rows]].transpose(1, 0, 2)
    chains = fine_chains(outline, sampled, rows)
    low, high = chains.min(axis=1), chains.max(axis=1)
    reach = 0.25 * (high - low).max(axis=1, keepdims=True)
    query, row = BoxTree(low - reach, high + reach).pairs(x, x)
    found, odd, pair = (query, row), np.zeros(len(query), dtype=bool), np.arange(len(query))
    piece, span, first, last = piece[row], span[row], first[row], last[row]
    for _ in range(DEPTH):
        if len(query) == 0:
            break
        t = span.mean(axis=1)
        middle = outline.points_at(piece, t)
        corners = np.stack([first, middle, last], axis=1)
        np.logical_xor.at(odd, pair, _in_triangles(corners, x[query]))
        away = np.hypot(*(middle - (first + last) / 2).T)
        query, piece, pair = np.repeat(query, 2), np.repeat(piece, 2), np.repeat(pair, 2)
        span = np.stack([span[:, 0], t, t, span[:, 1]], axis=1).reshape(-1, 2)
        first, last = np.stack([corners[:, :2], corners[:, 1:]], axis=2).reshape(-1, 2, 2).transpose(1, 0, 2)
        # The next sagitta is about a quarter of this one, so that this one is a generous margin.
        margin = np.repeat(away, 2)[:, None]
        near = (x[query] >= np.minimum(first, last) - margin) & (x[query] <= np.maximum(first, last) + margin)
        keep = near.all(axis=1) & (span[:, 0] < span[:, 1])
        query, piece, span, first, last = query[keep], piece[keep], span[keep], first[keep], last[keep]
        pair = pair[keep]
    return *found, odd


def _in_triangles(corners: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Whether points are in triangles, by exact signs; as sides are half open, neighbors share no point."""
    crossings = np.zeros(len(x), dtype=np.int64)
    for i in range(3):
        a, b = corners[:, i], corners[:, (i + 1) % 3]
        swap = (a[:, 1] > b[:, 1])[:, None]
        a, b = np.where(swap, b, a), np.where(swap, a, b)
        over = (a[:, 1] <= x[:, 1]) & (x[:, 1] < b[:, 1])
        left = orient(np.stack([a, b, x], axis=1)) > 0 if len(x) else over
        crossings += over & left
    return crossings % 2 == 1


def areas_beyond_chords(
    outline: Outline, sampled: Sampled, rows: np.ndarray, left: np.ndarray, factor: float
) -> list[float]:
    """For each curved facet the area between its chords and the curve, positive if it adds to the inside.

    ``rows`` are the subsegments of facets; ``left`` says whether each has the inside on its left. Coordinates
    are multiplied by ``factor``, a power of two.
    """
    parts = []
    for piece, curve in outline.curves.items():
        mine = np.nonzero(sampled.piece[rows] == piece)[0]
        if len(mine) == 0:
            continue
        a, b = factor * outline.points[outline.pieces[piece]]
        (x, y), (u, v) = (factor * sampled.points[sampled.ends[rows[mine], k]].T - a[:, None] for k in (0, 1))
        chords = fsum(0.5 * (x * v - y * u))
        parts.append((lune_area(curve, a, b, factor) - chords) * (1 if left[mine[0]] else -1))
    return parts


def lune_area(curve: CurveLike, first: np.ndarray, last: np.ndarray, factor: float = 1.0) -> float:
    """Signed area between a curve and its chord: positive if the curve runs on the right of the chord.

    The curve is multiplied by ``factor``; its ends ``first`` and ``last`` are so already.

    For an arc there is a formula. Otherwise areas of polygons on the curve, of up to 2^15 sides, are
    extrapolated (Romberg).
    """
    if isinstance(curve, Arc):
        return 0.5 * (factor * curve.radius) ** 2 * (curve.sweep - sine(curve.sweep))
    areas: list[list[float]] = []
    for level in range(4, 16):
        chain = factor * curve.point(np.linspace(0, 1, 2**level + 1))
        chain[0], chain[-1] = first, last
        (x, y), (dx, dy) = (chain[:-1] - first).T, np.diff(chain, axis=0).T
        row = [fsum(0.5 * (x * dy - y * dx))]
        for k in range(min(len(areas), 4)):
            row.append(row[k] + (row[k] - areas[-1][k]) / (4.0 ** (k + 1) - 1))
        if areas and abs(row[-1] - areas[-1][-1]) <= 1e-15 * abs(row[-1]):
            return row[-1]
        areas.append(row)
    return areas[-1][-1]
