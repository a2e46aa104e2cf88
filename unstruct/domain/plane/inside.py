"""Inside and outside of a planar outline with its curves; its area and its bounding box."""

from __future__ import annotations

from math import fsum

import numpy as np

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
    points = [sampled.points]
    if outline.curves:
        piece = np.repeat(list(outline.curves), 257)
        points.append(outline.points_at(piece, np.tile(np.linspace(0, 1, 257), len(outline.curves))))
    x, y = np.concatenate(points).T
    return np.array([[x.min(), y.min()], [x.max(), y.max()]])
