"""Sizes from the surface of a body: from the lengths of its edges, and from its curvature.

See the book, chapters 2.3 and 2.8c.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.arguments import as_number, finite
from ..base.arrays import distinct
from ..base.elementary import cosine, turns
from ..base.errors import InputError
from ..geometry.edge_vectors import lengths
from ..geometry.outline import Outline
from ..predicates.batch import power_of_two
from .field import SizeField
from .source_sizes import sources

__all__ = ["bends_of", "from_facets"]

Array = NDArray[np.float64]
SHARP_EDGE = math.radians(40.0)  # where facets turn by more is an edge of the body, which is not curved
ENDS = ((0, 1), (1, 2), (2, 0))


def from_facets(
    domain: Outline, factor: float = 1.0, *, growth: float = 0.3, far: float | None = None
) -> SizeField:
    """The lengths of the edges of a body's own surface, growing inward.

    Parameters
    ----------
    domain : Domain
        In space. Polygons are taken as the triangles of `domain.triangulated`.
    factor : float
        The size at an edge over its length.
    growth : float
        The growth of the size per unit of distance from the edges, as for `sources`.
    far : float, optional
        The cut-off, an upper bound of the size.

    Returns
    -------
    SizeField
        On an edge that lies near a shorter one, it may be less than its length.

    Raises
    ------
    InputError
        For a domain of the plane, whose pieces are cut by the size itself; for numbers that are not positive.
    """
    if not (as_number(factor, "factor") > 0 and np.isfinite(factor)):
        raise InputError(f"factor must be positive, not {factor!r}")
    cap = np.inf if far is None else as_number(far, "far")
    if not cap > 0:
        raise InputError(f"far must be positive, not {far!r}")
    points, triangles = _shell(domain)
    pairs = np.sort(triangles[:, ENDS].reshape(-1, 2), axis=1).astype(np.int64)
    ends = np.stack(np.divmod(distinct(pairs @ np.array([len(points), 1])), len(points)), axis=1)
    size = factor * lengths(points[ends[:, 1]] - points[ends[:, 0]])
    return sources(
        points[ends], np.minimum(size, cap), growth=finite(growth, "growth"), far=far, name="edges of facets"
    )


def _shell(domain: Any) -> tuple[Array, NDArray[np.int32]]:
    """The points and the triangles of the facets of a body."""
    if not isinstance(domain, Outline):
        raise InputError(f"domain must be a Domain, not {type(domain).__name__}")
    if domain.points.shape[1] != 3:
        raise InputError("the domain is planar: its pieces are cut by the size itself, so they give none")
    shell: Any = getattr(domain, "triangulated")  # noqa: B009  (an `Outline` has none, a `Domain` does)
    if len(shell.bounding) == 0:
        raise InputError("the domain has no facets, so there is nothing to take sizes from")
    return shell.points, shell.bounding


def bends_of(domain: Any) -> tuple[Array, Array]:
    """Edges of the facets of a body, and the curvature of the surface along each.

    Parameters
    ----------
    domain : Domain
        In space.

    Returns
    -------
    edges : ndarray, shape (e, 2, 3)
        Three for each triangle.
    curvature : ndarray, shape (e,)
        The normal curvature along the edge as seen from both ends, the larger one: 2 |n (b - a)| / |b - a|^2,
        where n is a normal at an end. It is exact on spheres, and around cylinders, if n is.

    Notes
    -----
    The normal at a corner of a triangle is the mean of those of the triangles around it, up to edges at which
    facets turn by more than 40 degrees, each weighted by its angle there. Source for the formula: G. Taubin,
    *Estimating the tensor of curvature of a surface from a polyhedral approximation* (1995). O(n log n).
    """
    points, triangles = _shell(domain)
    factor = power_of_two(points)  # products of lengths may be beyond the doubles
    x = points[triangles] * factor
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    length = np.linalg.norm(normal, axis=1)
    normal = normal / np.where(length > 0, length, 1.0)[:, None]
    corner = _corner_normals(x, normal, _groups(triangles, normal))
    along = np.stack([x[:, j] - x[:, i] for i, j in ENDS], axis=1)
    square = (along**2).sum(axis=2)
    seen = [
        np.abs((corner[:, [i, j]] * along[:, k, None]).sum(axis=2)).max(axis=1)
        for k, (i, j) in enumerate(ENDS)
    ]
    bend = 2.0 * np.stack(seen, axis=1) / np.where(square > 0, square, np.inf)
    return points[triangles[:, ENDS]].reshape(-1, 2, 3), bend.ravel() * factor


def _groups(triangles: NDArray[np.int32], normal: Array) -> NDArray[np.int32]:
    """Numbers of the corners of triangles (m, 3), the same where the surface is smooth around a vertex."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    many = len(triangles)
    pairs = triangles[:, ENDS].reshape(-1, 2).astype(np.int64)
    key = np.sort(pairs, axis=1) @ np.array([int(triangles.max()) + 1, 1])
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order][1:] == key[order][:-1])
    one, two = order[same], order[same + 1]
    smooth = (normal[one // 3] * normal[two // 3]).sum(axis=1) > cosine(SHARP_EDGE)
    one, two = one[smooth], two[smooth]
    rows, columns = [], []
    for k in range(2):  # the two ends of the common edge
        for j in range(2):
            equal = pairs[one, k] == pairs[two, j]
            rows.append((3 * (one // 3) + (one % 3 + k) % 3)[equal])
            columns.append((3 * (two // 3) + (two % 3 + j) % 3)[equal])
    ends = np.concatenate(rows), np.concatenate(columns)
    graph = coo_array((np.ones(len(ends[0]), dtype=np.int8), ends), shape=(3 * many, 3 * many))
    return connected_components(graph, directed=False)[1].reshape(-1, 3)


def _corner_normals(x: Array, normal: Array, group: NDArray[np.int32]) -> Array:
    """The mean normal of the group of each corner, (m, 3, 3)."""
    weight = np.empty(x.shape[:2])
    for k in range(3):
        u, v = x[:, (k + 1) % 3] - x[:, k], x[:, (k + 2) % 3] - x[:, k]
        weight[:, k] = turns(np.linalg.norm(np.cross(u, v), axis=1), (u * v).sum(axis=1))
    total = np.stack(
        [np.bincount(group.ravel(), (weight * normal[:, i, None]).ravel()) for i in range(3)], axis=1
    )
    length = np.linalg.norm(total, axis=1)
    return (total / np.where(length > 0, length, 1.0)[:, None])[group]
