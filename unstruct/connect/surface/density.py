"""How dense a sample of a surface is: local feature sizes, and the e of an e-sample."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arrays import as_numbers, as_points
from ...base.errors import InputError
from ...mesh.mesh import Mesh
from ..insertion.delaunay import delaunay
from .crossing import centers_of

__all__ = ["feature_sizes", "sampling_density"]

Array = NDArray[np.float64]


def feature_sizes(points: ArrayLike) -> Array:
    """The local feature size at sample points of a closed surface, estimated from the sample alone.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        Not all in one plane.

    Returns
    -------
    ndarray, shape (n,)
        For each point the distance from the nearest pole of all points. The two *poles* of a point are the
        farthest vertices of its Voronoi cell on either side of the surface; the outer one of points on the
        convex hull is infinitely far. In dense samples the poles lie near the medial axis.

    Notes
    -----
    O(n log n) and the Delaunay mesh. Source: N. Amenta and M. Bern, *Surface reconstruction by Voronoi
    filtering*, DCG 22 (1999).
    """
    from scipy.spatial import cKDTree

    x = as_points(points)
    if x.shape[1] != 3:
        raise InputError(f"points must be points in space, rows of three numbers, not of {x.shape[1]}")
    mesh = delaunay(x)
    tets = np.asarray(mesh.simplices)
    center, _ = centers_of(x, tets)
    owner, place = tets.ravel(), np.repeat(center, 4, axis=0)
    away = place - x[owner]
    far = (away * away).sum(axis=1)
    hull = np.unique(mesh.boundary)
    outward = np.zeros((len(x), 3))
    corner = x[np.asarray(mesh.boundary)]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    for k in range(3):
        np.add.at(outward, mesh.boundary[:, k], normal)
    first = _farthest(owner, far)
    axis = np.zeros((len(x), 3))
    axis[owner[first]] = away[first]
    axis[hull] = outward[hull]
    behind = np.flatnonzero((away * axis[owner]).sum(axis=1) < 0)
    second = behind[_farthest(owner[behind], far[behind])]
    bounded = np.ones(len(x), dtype=bool)
    bounded[hull] = False
    poles = np.concatenate([place[first[bounded[owner[first]]]], place[second]])
    return np.asarray(cKDTree(poles).query(x)[0], dtype=np.float64)


def _farthest(owner: NDArray[np.int32], far: Array) -> NDArray[np.intp]:
    """The entry with the greatest distance of each owner."""
    order = np.lexsort((far, owner))
    last = np.ones(len(order), dtype=bool)
    last[:-1] = owner[order][:-1] != owner[order][1:]
    return order[last]


def sampling_density(
    points: ArrayLike, surface: Mesh, feature_size: Callable[[Array], ArrayLike] | ArrayLike
) -> float:
    """The least e for which points are an e-sample of the vertices of a surface.

    Parameters
    ----------
    points : array_like, shape (n, 3)
    surface : Mesh
        A fine mesh of the surface: its vertices stand for all points of it.
    feature_size : function (k, 3) -> (k,), float or array_like
        The local feature size at the vertices of ``surface``.

    Returns
    -------
    float
        The largest ratio of the distance from the nearest point to the feature size: a lower bound of that
        over the whole surface.
    """
    from scipy.spatial import cKDTree

    x = as_points(points)
    if not isinstance(surface, Mesh) or surface.points.shape[1] != x.shape[1]:
        raise InputError("surface must be a Mesh in the space of the points")
    given = feature_size(surface.points) if callable(feature_size) else feature_size
    size = as_numbers(given, "feature_size")
    if size.shape not in ((), (len(surface.points),)):
        raise InputError(f"feature_size must be a number or one for each of {len(surface.points)} vertices")
    size = np.broadcast_to(size, (len(surface.points),))
    if not (size > 0).all():
        raise InputError("feature_size must be positive: a surface with creases has no dense sample")
    return float((cKDTree(x).query(surface.points)[0] / size).max(initial=0.0))
