"""Inside and outside of a planar outline with its curves; its area and its bounding box."""

from __future__ import annotations

from math import fsum

import numpy as np

from ...base.jit import kernel
from ...geometry.outline import Outline
from ...geometry.parity import enclosed_area, even_odd, left_parity
from ...predicates.batch import power_of_two
from .lunes import areas_beyond_chords, lunes_hold
from .sample import Sampled

__all__ = ["area", "bounds", "contains"]


def contains(outline: Outline, sampled: Sampled, rows: np.ndarray) -> np.ndarray:
    """Whether points (k, 2) lie inside, by the even-odd rule: see `Domain.contains`."""
    facets = sampled.piece < len(outline.facets)
    bent = facets & np.isin(sampled.piece, list(outline.curves))
    odd, on = even_odd(sampled.points, sampled.ends[facets], rows)
    if bent.any():
        odd ^= lunes_hold(outline, sampled, np.nonzero(bent)[0], rows)
        on = even_odd(sampled.points, sampled.ends[facets & ~bent], rows)[1]
    return odd | on


def area(outline: Outline, sampled: Sampled) -> float:
    """The area inside: see `Domain.area`."""
    rows = np.nonzero(sampled.piece < len(outline.facets))[0]
    ends = sampled.ends[rows]
    left = left_parity(sampled.points, ends)
    factor = power_of_two(sampled.points)  # squares of very large or small coordinates are no doubles
    straight = enclosed_area(sampled.points * factor, np.where(left[:, None], ends, ends[:, ::-1]))
    beyond = areas_beyond_chords(outline, sampled, rows, left, factor)
    return fsum([straight, *beyond]) / factor / factor


def bounds(outline: Outline, sampled: Sampled) -> np.ndarray:
    """The corners of the bounding box of points and, approximately, of curves: see `Domain.bounds`."""
    found = np.array([[np.inf, np.inf], [-np.inf, -np.inf]])
    _widen(sampled.points, found)
    if outline.curves:
        piece, t = np.empty((len(outline.curves), 257), dtype=np.int64), np.empty((len(outline.curves), 257))
        piece[:], t[:] = np.fromiter(outline.curves, dtype=np.int64)[:, None], np.linspace(0, 1, 257)
        _widen(outline.points_at(piece.ravel(), t.ravel()), found)
    return found


@kernel
def _widen(points, box):
    """Widen a box, lower corner and upper corner, so that it contains points."""
    for i in range(len(points)):
        for k in range(2):
            box[0, k], box[1, k] = min(box[0, k], points[i, k]), max(box[1, k], points[i, k])
