"""The lines by which a body is drawn: all edges; of many, the sharp ones and those at the outline."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.outline import Outline
from ...geometry.polygons import Polygons

__all__ = ["seen"]

# The directions right and up in the picture, and toward the reader, who looks from an azimuth of -55 and an
# elevation of 22 degrees, as in `view.view3d`.
RIGHTWARD = np.array([0.8191520442889918, 0.5735764363510462, 0.0])
UPWARD = np.array([-0.21486551488510408, 0.3068597568007795, 0.9271838545667874])
TOWARD = np.array([0.5318108111446446, -0.7595045499001312, 0.374606593415912])
ALL_EDGES = 1500  # with more edges than this, only some are drawn
SHARP_COSINE = np.cos(np.radians(30.0))


def seen(outline: Outline) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points in the plane of the picture (n, 2), lines between them (s, 2), and whether each is of a facet.

    Notes
    -----
    O(n log n). Lines that are hidden are not left out.
    """
    points = outline.points
    scale = np.abs(points).max(initial=0.0)
    unit = points / scale if scale > 0 else points
    flat = np.column_stack([unit @ RIGHTWARD, unit @ UPWARD]) if len(points) else np.empty((0, 2))
    facets, inner = Polygons.of(outline.facets), Polygons.of(outline.inner)
    ends = [_edges(unit, part) for part in (facets, inner)]
    of_facet = np.repeat([True, False], [len(part) for part in ends])
    return flat, np.concatenate(ends), of_facet


def _edges(points: np.ndarray, polygons: Polygons) -> NDArray[np.int32]:
    """The edges of polygons that are drawn, each once."""
    ends, owner = polygons.sides
    low, high = np.sort(ends, axis=1).astype(np.int64).T
    key, first, count = np.unique((low << 32) | high, return_index=True, return_counts=True)
    if len(key) <= ALL_EDGES:
        return ends[first]
    order = np.argsort((low << 32) | high, kind="stable")
    start = np.cumsum(count) - count
    normal = _normals(points, ends, owner, len(polygons))
    pair = count == 2
    one, two = order[start[pair]], order[start[pair] + 1]
    # facets that run along their common edge in the same direction are turned against each other
    turn = np.where(ends[one, 0] == ends[two, 0], -1.0, 1.0)[:, None]
    n, m = normal[owner[one]], normal[owner[two]] * turn
    sharp = (n * m).sum(axis=1) < SHARP_COSINE
    outline = (n @ TOWARD) * (m @ TOWARD) <= 0.0
    drawn = np.ones(len(key), dtype=bool)
    drawn[pair] = sharp | outline
    return ends[first[drawn]]


def _normals(points: np.ndarray, ends: np.ndarray, owner: np.ndarray, count: int) -> np.ndarray:
    """Unit normals of polygons, by Newell's sum about one of their vertices."""
    base = np.zeros((count, 3))
    base[owner] = points[ends[:, 0]]
    cross = np.cross(points[ends[:, 0]] - base[owner], points[ends[:, 1]] - base[owner])
    total = np.stack([np.bincount(owner, cross[:, k], minlength=count) for k in range(3)], axis=1)
    length = np.linalg.norm(total, axis=1)
    return total / np.where(length > 0.0, length, 1.0)[:, None]
