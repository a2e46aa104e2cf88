"""Measures of simplices, vectorized: size, circumsphere, angles, quality.

Every function takes an array of shape (..., k + 1, d): the k + 1 corners of simplices of dimension k in
d >= k coordinates, with any leading axes. All are plain floating-point measures, for statistics and
pictures; nothing here decides topology (see `unstruct.predicates` for that).

The coordinates of each simplex are first taken relative to one of its corners and scaled by a power of two,
so that tiny and huge simplices neither overflow nor lose digits. Flat simplices cause no errors and no
warnings: their volume is 0, their circumradius ``inf`` (circumcenter ``nan``), their inradius 0, and their
R/r, 2r/R, ... take the limits given with each function. See the book, chapter 1.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations
from math import factorial

import numpy as np

from ..base.errors import InputError
from .edge_vectors import (
    angle_between,
    as_corners,
    careful_radius,
    content,
    cross,
    determinant,
    exponents,
    lengths,
    local_edges,
    quiet,
)
from .scaled_jacobian import scaled_jacobian

__all__ = [
    "QUALITIES",
    "angles",
    "circumcenter",
    "circumradius",
    "dihedral_angles",
    "edge_lengths",
    "inradius",
    "measure",
    "quality",
    "solid_angles",
    "volume",
]


@quiet
def volume(simplices: np.ndarray) -> np.ndarray:
    """Signed length, area, volume, ..., positive for positively oriented cells.

    Parameters
    ----------
    simplices : array_like, shape (..., k + 1, d)

    Returns
    -------
    ndarray, shape (...)
        det(p_1 - p_0, ..., p_d - p_0) / d! if k = d; the unsigned `measure` if k < d. It is rounded, so
        its sign near zero may be wrong; `unstruct.predicates.orient` gives the exact sign.
    """
    rows, exponent = local_edges(simplices)
    k, d = rows.shape[-2:]
    return np.ldexp((determinant(rows) if k == d else content(rows)) / factorial(k), k * exponent)


@quiet
def measure(simplices: np.ndarray) -> np.ndarray:
    """Length, area, volume, ... without sign, for simplices of dimension k in d >= k dimensions.

    Parameters
    ----------
    simplices : array_like, shape (..., k + 1, d)

    Returns
    -------
    ndarray, shape (...)
        sqrt(det(E E^T)) / k! for the edge vectors E, computed by a determinant, a cross product or QR.
    """
    rows, exponent = local_edges(simplices)
    k = rows.shape[-2]
    return np.ldexp(content(rows) / factorial(k), k * exponent)


@quiet
def edge_lengths(simplices: np.ndarray) -> np.ndarray:
    """Lengths of the edges.

    Parameters
    ----------
    simplices : array_like, shape (..., k + 1, d)

    Returns
    -------
    ndarray, shape (..., k (k + 1) / 2)
        In the order of `itertools.combinations`: (0, 1), (0, 2), ...
    """
    points = as_corners(simplices)
    i, j = np.array(list(combinations(range(points.shape[-2]), 2))).T
    half = np.ldexp(points, -1)
    rows = half[..., j, :] - half[..., i, :]
    exponent = exponents(rows)
    rows = np.ldexp(rows, -exponent[..., None, None])
    return np.ldexp(lengths(rows), (exponent + 1)[..., None])


def _center(rows: np.ndarray) -> np.ndarray:
    """The circumcenter relative to corner 0, in units of the scaled rows; inf or nan for flat simplices.

    The center c of the sphere through 0 and the rows a_i lies in their span and satisfies
    a_i . c = |a_i|^2 / 2. With Q R = rows^T, the solution is c = Q y, where R^T y = |a|^2 / 2.
    """
    k, d = rows.shape[-2:]
    square = (rows**2).sum(axis=-1)
    if k == 1:
        return rows[..., 0, :] / 2
    if k == 2 and d == 2:
        a, b = rows[..., 0, :], rows[..., 1, :]
        x = square[..., 0] * b[..., 1] - square[..., 1] * a[..., 1]
        y = square[..., 1] * a[..., 0] - square[..., 0] * b[..., 0]
        return np.stack([x, y], axis=-1) / (2 * determinant(rows))[..., None]
    if k == 3 and d == 3:
        a, b, c = rows[..., 0, :], rows[..., 1, :], rows[..., 2, :]
        top = square[..., :1] * cross(b, c) + square[..., 1:2] * cross(c, a) + square[..., 2:] * cross(a, b)
        return top / (2 * determinant(rows))[..., None]
    if k == 2:
        a, b = rows[..., 0, :], rows[..., 1, :]
        along_a = square[..., 1] * (a * (a - b)).sum(axis=-1)
        along_b = square[..., 0] * (b * (b - a)).sum(axis=-1)
        top = along_a[..., None] * a + along_b[..., None] * b
        return top / (2 * content(rows) ** 2)[..., None]
    q, r = np.linalg.qr(np.swapaxes(rows, -1, -2))
    y = np.empty(square.shape)
    for i in range(k):  # forward substitution, which divides by zero for flat simplices and gives inf or nan
        y[..., i] = (square[..., i] / 2 - (r[..., :i, i] * y[..., :i]).sum(axis=-1)) / r[..., i, i]
    return (q * y[..., None, :]).sum(axis=-1)


@quiet
def circumcenter(simplices: np.ndarray) -> np.ndarray:
    """Center of the sphere through all corners, in their affine hull.

    Parameters
    ----------
    simplices : array_like, shape (..., k + 1, d)

    Returns
    -------
    ndarray, shape (..., d)
        ``nan`` for flat simplices, which have none. (If k < d and d > 3, rounding may hide that a simplex is
        flat; its computed center is then far away.)
    """
    points = as_corners(simplices)
    rows, exponent = local_edges(points)
    center = _center(rows)
    center = np.where(np.isfinite(center).all(axis=-1)[..., None], center, np.nan)
    return points[..., 0, :] + np.ldexp(center, exponent[..., None])


def _radius(rows: np.ndarray) -> np.ndarray:
    """Circumradius in scaled units; for triangles abc / 4A, which is accurate even if the center is far."""
    k = rows.shape[-2]
    if k == 2:
        a, b = rows[..., 0, :], rows[..., 1, :]
        radius = (lengths(a) * lengths(b)) * lengths(b - a) / (2 * content(rows))
    else:
        radius = np.sqrt((_center(rows) ** 2).sum(axis=-1))
    return np.where(np.isnan(radius) & np.isfinite(rows).all(axis=(-2, -1)), np.inf, radius)


@quiet
def circumradius(simplices: np.ndarray) -> np.ndarray:
    """Radius of the sphere through all corners.

    Parameters
    ----------
    simplices : array_like, shape (..., k + 1, d)

    Returns
    -------
    ndarray, shape (...)
        ``inf`` for flat simplices.
    """
    rows, exponent = local_edges(simplices)
    return careful_radius(as_corners(simplices), np.ldexp(_radius(rows), exponent))


def _facet_contents(rows: np.ndarray) -> np.ndarray:
    """(k - 1)! times the measures of the facets opposite corner 0, 1, ..., k, in scaled units."""
    if (k := rows.shape[-2]) == 1:
        return np.ones((*rows.shape[:-2], 2))
    first = content(rows[..., 1:, :] - rows[..., :1, :])
    others = [content(np.delete(rows, i, axis=-2)) for i in range(k)]
    return np.stack([first, *others], axis=-1)


def _inner(rows: np.ndarray) -> np.ndarray:
    """Inradius in scaled units: k V / (sum of the facets' measures); 0 if V = 0."""
    size = content(rows)
    return np.where(size == 0, 0.0, size / _facet_contents(rows).sum(axis=-1))


@quiet
def inradius(simplices: np.ndarray) -> np.ndarray:
    """Radius of the largest inscribed sphere.

    Parameters
    ----------
    simplices : array_like, shape (..., k + 1, d)

    Returns
    -------
    ndarray, shape (...)
        k V / (sum of the facets' measures); 0 for flat simplices.
    """
    rows, exponent = local_edges(simplices)
    return np.ldexp(_inner(rows), exponent)


@quiet
def angles(simplices: np.ndarray) -> np.ndarray:
    """Plane angles of all triangular faces, in radians.

    Parameters
    ----------
    simplices : array_like, shape (..., k + 1, d)

    Returns
    -------
    ndarray, shape (..., k + 1) for triangles: the angle at each corner;
        shape (..., C(k + 1, 3), 3) for k >= 3: by face, in the order of `itertools.combinations`.
        Flat triangles have angles of 0 and pi; ``nan`` where two corners coincide.
    """
    points = as_corners(simplices)
    if points.shape[-2] < 3:
        raise InputError("segments have no angles; pass simplices with at least three corners")
    triples = np.array(list(combinations(range(points.shape[-2]), 3)))
    half = np.ldexp(points, -1)
    triangles = np.ldexp(half, -exponents(half - half[..., :1, :])[..., None, None])[..., triples, :]
    result = np.stack(
        [
            angle_between(
                triangles[..., j, :] - triangles[..., i, :], triangles[..., k, :] - triangles[..., i, :]
            )
            for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        ],
        axis=-1,
    )
    return result[..., 0, :] if points.shape[-2] == 3 else result


@quiet
def dihedral_angles(simplices: np.ndarray) -> np.ndarray:
    """Angles between facets (dihedral angles), in radians, one for each pair of facets.

    Parameters
    ----------
    simplices : array_like, shape (..., k + 1, d)

    Returns
    -------
    ndarray, shape (..., k (k + 1) / 2)
        For each pair (i, j) of corners in the order of `itertools.combinations`, the angle between the
        facets opposite i and j, measured inside. For tetrahedra, the pair (i, j) thus belongs to the edge
        that does *not* contain i and j. For triangles it is the angle at the third corner. ``nan`` where
        a facet is flat.

    Notes
    -----
    A ridge is the intersection of two facets. The angle at a ridge is the angle between the two altitudes on
    it, the components of edge vectors orthogonal to the ridge. No normals are needed, so this works for any
    k <= d.
    """
    points = as_corners(simplices)
    corners = points.shape[-2]
    if corners < 3:
        raise InputError("segments have no dihedral angles; pass simplices with at least three corners")
    result = []
    for i, j in combinations(range(corners), 2):
        ridge = [v for v in range(corners) if v not in (i, j)]
        rows, _ = local_edges(points[..., [*ridge, i, j], :])
        a, b = rows[..., -2, :], rows[..., -1, :]
        if len(ridge) > 1:
            q = np.linalg.qr(np.swapaxes(rows[..., :-2, :], -1, -2))[0]
            for _ in range(2):  # the second pass removes what rounding left along the ridge
                a, b = (v - (q * (v[..., None, :] @ q)).sum(axis=-1) for v in (a, b))
        result.append(angle_between(a, b))
    return np.stack(result, axis=-1)


@quiet
def solid_angles(simplices: np.ndarray) -> np.ndarray:
    """Solid angles at the corners of tetrahedra in space, in steradians.

    Parameters
    ----------
    simplices : array_like, shape (..., 4, 3)

    Returns
    -------
    ndarray, shape (..., 4)
        0 or 2 pi for flat tetrahedra.

    Notes
    -----
    tan(omega / 2) = |det(a, b, c)| / (abc + (a.b) c + (b.c) a + (c.a) b), the formula of Van Oosterom and
    Strackee (IEEE Trans. Biomed. Eng. 30, 1983), evaluated with atan2.
    """
    points = as_corners(simplices)
    if points.shape[-2:] != (4, 3):
        raise InputError(f"solid angles are for tetrahedra in space, shape (..., 4, 3), not {points.shape}")
    result = []
    for i in range(4):
        rows, _ = local_edges(points[..., [i, *[j for j in range(4) if j != i]], :])
        unit = rows / np.sqrt((rows**2).sum(axis=-1))[..., None]
        a, b, c = unit[..., 0, :], unit[..., 1, :], unit[..., 2, :]
        below = 1 + (a * b).sum(axis=-1) + (b * c).sum(axis=-1) + (c * a).sum(axis=-1)
        result.append(2 * np.arctan2(np.abs(determinant(unit)), below))
    return np.stack(result, axis=-1)


@quiet
def _radius_ratio(simplices: np.ndarray) -> np.ndarray:
    """R / r, the chapter's mu: k for the regular simplex (2 for triangles), ``inf`` for flat simplices."""
    rows, _ = local_edges(simplices)
    ratio = _radius(rows) / _inner(rows)
    return np.where(np.isnan(ratio) & np.isfinite(rows).all(axis=(-2, -1)), np.inf, ratio)


@quiet
def _normalized_ratio(simplices: np.ndarray) -> np.ndarray:
    """k r / R (2r/R for triangles, 3r/R for tetrahedra): 1 for the regular simplex, 0 for flat simplices."""
    return (np.shape(simplices)[-2] - 1) / _radius_ratio(simplices)


@quiet
def _radius_edge(simplices: np.ndarray) -> np.ndarray:
    """R over the shortest edge: 1/sqrt(3) for the equilateral triangle, ``inf`` for flat simplices."""
    return circumradius(simplices) / edge_lengths(simplices).min(axis=-1)


@quiet
def _aspect(simplices: np.ndarray) -> np.ndarray:
    """Longest edge over inradius, relative to the regular simplex: 1 at best, ``inf`` for flat simplices."""
    k = np.shape(simplices)[-2] - 1
    regular = np.sqrt(2 * k * (k + 1))
    ratio = edge_lengths(simplices).max(axis=-1) / inradius(simplices) / regular
    return np.where(np.isnan(ratio) & np.isfinite(simplices).all(axis=(-2, -1)), np.inf, ratio)


def _extreme(function: Callable, pick: Callable) -> Callable:
    def extreme(simplices: np.ndarray) -> np.ndarray:
        values = function(simplices)
        axes = tuple(range(np.ndim(simplices) - 2, values.ndim))
        return np.degrees(pick(values, axis=axes))

    extreme.__doc__ = f"{pick.__name__} of the {function.__name__}, in degrees; nan where corners coincide."
    return extreme


QUALITIES: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "min_angle": _extreme(angles, np.min),
    "max_angle": _extreme(angles, np.max),
    "radius_ratio": _radius_ratio,
    **dict.fromkeys(("2r/R", "3r/R"), _normalized_ratio),
    "radius_edge": _radius_edge,
    "aspect": _aspect,
    "min_dihedral": _extreme(dihedral_angles, np.min),
    "max_dihedral": _extreme(dihedral_angles, np.max),
    "scaled_jacobian": scaled_jacobian,
}


def quality(name: str, simplices: np.ndarray) -> np.ndarray:
    """One number for the shape of each simplex.

    Parameters
    ----------
    name : str
        "min_angle", "max_angle" (degrees, over all triangular faces), "min_dihedral", "max_dihedral"
        (degrees), "radius_ratio" (R/r, the chapter's mu; k at best), "2r/R" or "3r/R" (k r/R; 1 at best),
        "radius_edge" (R over the shortest edge), "aspect" (longest edge over r, scaled to 1 at best),
        "scaled_jacobian" (k! V over the edges at a corner, scaled to 1 at best, negative where turned).
    simplices : array_like, shape (..., k + 1, d)

    Returns
    -------
    ndarray, shape (...)

    Raises
    ------
    InputError
        For a name that is not in `QUALITIES`, or an array of the wrong shape.
    """
    if name not in QUALITIES:
        raise InputError(f"no quality measure is called {name!r}; use one of {', '.join(QUALITIES)}")
    return QUALITIES[name](simplices)
