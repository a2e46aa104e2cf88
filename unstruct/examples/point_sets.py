"""Point sets to triangulate: a mapped structured grid, a clipped Cartesian lattice, letters (12.2.2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..base.errors import InputError
from ..base.optional import optional
from .running import inside_polygon, running_region

__all__ = ["clipped_lattice", "letter_outlines", "mapped_grid"]

Array = NDArray[np.float64]


def mapped_grid(around: int = 24, outward: int = 6) -> Array:
    """Points of a structured grid mapped onto half a ring, as (around + 1) (outward + 1) rows (x, y).

    Row (outward + 1) i + j is the image of (i / around, j / outward). The points of one ring are
    cocircular up to rounding.
    """
    if around < 2 or outward < 1:
        raise InputError(f"a grid of {around} by {outward} cells has no ring; use at least 2 by 1 cells")
    angle, radius = np.meshgrid(
        np.pi * np.arange(around + 1) / around, 1.0 + np.arange(outward + 1) / outward, indexing="ij"
    )
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1).reshape(-1, 2)
    return np.round(points * 2.0**40) / 2.0**40  # rounded, so that both ends lie exactly on the axis


def clipped_lattice(spacing: float) -> tuple[Array, NDArray[np.int32]]:
    """The boundary of the running region, and the points of a Cartesian lattice inside it, away from it.

    Parameters
    ----------
    spacing : float
        The spacing of the boundary points and of the lattice, in (0, 0.4].

    Returns
    -------
    points : (n, 2) float64
        First the boundary, then lattice points more than half a spacing away from all boundary points.
    segments : (b, 2) int32
        The boundary edges, with the region on their left.
    """
    from scipy.spatial import cKDTree

    boundary, segments = running_region(spacing)
    x, y = np.meshgrid(np.arange(0.0, 3.0, spacing), np.arange(0.0, 2.0, spacing))
    lattice = np.column_stack([x.ravel(), y.ravel()])
    away = cKDTree(boundary).query(lattice)[0] > spacing / 2
    return np.vstack([boundary, lattice[away & inside_polygon(lattice, boundary, segments)]]), segments


def letter_outlines(text: str, *, size: int = 64) -> tuple[Array, NDArray[np.int32]]:
    """The outlines of letters in DejaVu Sans (a font that comes with matplotlib) as points and segments.

    Parameters
    ----------
    text : str
    size : int
        The size of the font in units; coordinates are rounded to 1/64.

    Returns
    -------
    points : (n, 2) float64
        Corners and points of curves, one contour after another.
    segments : (n, 2) int32
        Edges of the contours, with the ink on their left.
    """
    fonts = optional("matplotlib.font_manager", "examples.letter_outlines")
    paths = optional("matplotlib.textpath", "examples.letter_outlines")
    if not text.strip():
        raise InputError(f"{text!r} has no outline; give a text with letters")
    path = paths.TextPath((0, 0), text, size=size, prop=fonts.FontProperties(family="DejaVu Sans"))
    points, segments, start = [], [], 0
    for contour in path.to_polygons():
        ring = np.round(np.asarray(contour)[:-1] * 64) / 64
        ring = ring[(ring != np.roll(ring, 1, axis=0)).any(axis=1)]
        index = start + np.arange(len(ring))
        points.append(ring[::-1])  # TrueType has the ink on the right
        segments.append(np.column_stack([index, np.roll(index, -1)]))
        start += len(ring)
    return np.vstack(points), np.vstack(segments).astype(np.int32)
