"""The scaled Jacobian: how far the corners of a cell are from those of the ideal one, in one number.

At a corner the edges that leave it, made unit vectors, have a determinant between -1 and 1; the scaled
Jacobian of a cell is the least over its corners, divided by the value of the ideal cell. It is 1 for the
ideal cell, 0 or less for a cell that is flat or turned at a corner. Sources: P. M. Knupp, *Algebraic mesh
quality metrics*, SIAM J. Sci. Comput. 23 (2001) 193-218; C. D. Stimpson and others, *The Verdict library
reference manual*, Sandia report SAND2007-1751.
"""

from __future__ import annotations

import numpy as np

from .edge_vectors import (
    angle_between,
    as_corners,
    content,
    cross,
    determinant,
    exponents,
    local_edges,
    quiet,
)

__all__ = ["frame_jacobians", "ring_angles", "ring_jacobian", "scaled_jacobian", "unit_scaled"]


@quiet
def scaled_jacobian(simplices: np.ndarray) -> np.ndarray:
    """The scaled Jacobian of simplices: 1 for regular ones, 0 when flat, negative when turned (k = d).

    Parameters
    ----------
    simplices : array_like, shape (..., k + 1, d)

    Returns
    -------
    ndarray, shape (...)
        The least of k! V over the product of the k edges at a corner, times sqrt(2^k / (k + 1)); V has
        no sign where k < d. 0 where corners coincide.
    """
    points = as_corners(simplices)
    rows, _ = local_edges(points)
    k, d = rows.shape[-2:]
    size = determinant(rows) if k == d else content(rows)
    local = np.concatenate([np.zeros_like(rows[..., :1, :]), rows], axis=-2)
    least = np.full(rows.shape[:-2], np.inf)
    for i in range(k + 1):
        edges = np.delete(local, i, axis=-2) - local[..., i : i + 1, :]
        least = np.minimum(least, _ratio(size, np.sqrt((edges**2).sum(axis=-1)).prod(axis=-1)))
    return least * np.sqrt(2.0**k / (k + 1))


def _ratio(size: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    return np.where(lengths > 0, size / np.where(lengths > 0, lengths, 1.0), 0.0)


def unit_scaled(corners: np.ndarray) -> np.ndarray:
    """Cells (m, c, d) moved to their first corners and scaled by powers of two to size 1."""
    half = np.ldexp(corners, -1)
    rows = half - half[:, :1]
    return np.ldexp(rows, -exponents(rows)[:, None, None])


@quiet
def frame_jacobians(x: np.ndarray, frames: np.ndarray) -> np.ndarray:
    """Determinants of unit edge vectors at corners of solids.

    Parameters
    ----------
    x : ndarray, shape (m, c, 3)
    frames : ndarray of int, shape (f, 4)
        Rows (v, a, b, c): a corner, and three others whose edges to it are positive in a good cell.

    Returns
    -------
    ndarray, shape (m, f)
        0 where an edge has no length.
    """
    edges = x[:, frames[:, 1:]] - x[:, frames[:, :1]]
    length = np.sqrt((edges**2).sum(axis=-1)).prod(axis=-1)
    return _ratio(determinant(edges), length)


@quiet
def ring_jacobian(x: np.ndarray) -> np.ndarray:
    """The scaled Jacobian of quadrilaterals and polygons: the least sine of an angle over the regular one's.

    Parameters
    ----------
    x : ndarray, shape (m, c, d)
        In the plane the sign is that of the turn; in space that against the mean normal.

    Returns
    -------
    ndarray, shape (m,)
    """
    sine, _, lengths = _turns(x)
    return _ratio(sine, lengths).min(axis=1) / np.sin(2 * np.pi / x.shape[1])


@quiet
def ring_angles(x: np.ndarray) -> np.ndarray:
    """Inner angles of quadrilaterals and polygons (m, c, d), 0 to 2 pi: (m, c); nan where corners coincide.

    The orientation does not matter: inside is where the area is.
    """
    sine, cosine, lengths = _turns(x)
    if x.shape[-1] > 3:
        return angle_between(np.roll(x, -1, axis=1) - x, np.roll(x, 1, axis=1) - x)
    if x.shape[-1] == 2:
        rows = x - x[:, :1]
        following = np.roll(rows, -1, axis=1)
        area = (rows[..., 0] * following[..., 1] - rows[..., 1] * following[..., 0]).sum(axis=1)
        sine = np.where(area < 0, -1.0, 1.0)[:, None] * sine
    angle = np.arctan2(sine, cosine)
    return np.where(lengths > 0, np.where(angle < 0, angle + 2 * np.pi, angle), np.nan)


def _turns(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sine and cosine of the angle at each corner, both times the two lengths, and the lengths' product."""
    after, before = np.roll(x, -1, axis=1) - x, np.roll(x, 1, axis=1) - x
    lengths = np.sqrt((after**2).sum(axis=-1)) * np.sqrt((before**2).sum(axis=-1))
    cosine = (after * before).sum(axis=-1)
    if x.shape[-1] == 2:
        return after[..., 0] * before[..., 1] - after[..., 1] * before[..., 0], cosine, lengths
    if x.shape[-1] > 3:
        square = (after**2).sum(axis=-1) * (before**2).sum(axis=-1) - cosine**2
        return np.sqrt(np.maximum(square, 0.0)), cosine, lengths
    normal = cross(after, before)
    rows = x - x[:, :1]
    mean = cross(rows, np.roll(rows, -1, axis=1)).sum(axis=1)
    side = np.where((normal * mean[:, None]).sum(axis=-1) < 0, -1.0, 1.0)
    return side * np.sqrt((normal**2).sum(axis=-1)), cosine, lengths
