"""Sites of the plane on a common line, down to a single one: their cells are strips."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ...base.errors import MeshError
from ...predicates.batch import orient_rows
from .dual import Ridges

__all__ = ["chain_of_sites", "ridges_of_chain"]


def chain_of_sites(points: NDArray[np.float64], weights: NDArray[np.float64]) -> NDArray[np.int64]:
    """The sites on a line in their order along it, without those whose power cells are empty.

    Parameters
    ----------
    points : (n, 2) array
        Different points.
    weights : (n,) array

    Raises
    ------
    MeshError
        If they are not on a common line.

    Notes
    -----
    A coordinate x that differs is a parameter of the line. The cells that are not empty belong to the corners
    of the lower hull of (x, |p|^2 - w), which is found exactly. O(n log n). Source: A. M. Andrew, Information
    Processing Letters 9 (1979) 216-219.
    """
    sites = np.arange(len(points))
    if points.shape[1] != 2:
        raise MeshError("the mesh has no cells, so there is no diagram: take delaunay(points)")
    far = int(np.abs(points / 2 - points[0] / 2).max(axis=1).argmax())
    turned = orient_rows(points, np.stack([np.zeros_like(sites), np.full_like(sites, far), sites], axis=1))
    if turned.any():
        raise MeshError("the mesh has no cells, but its points are not on a line: take delaunay(points)")
    axis = int(np.ptp(points / 2, axis=0).argmax())
    order = sites[np.argsort(points[:, axis], kind="stable")]
    if (weights == weights[:1]).all():
        return order
    hull: list[tuple[int, Fraction, Fraction]] = []
    for v in order.tolist():
        p = [Fraction(x) for x in points[v].tolist()]
        x, z = p[axis], p[0] * p[0] + p[1] * p[1] - Fraction(float(weights[v]))
        while len(hull) > 1:
            (_, x0, z0), (_, x1, z1) = hull[-2:]
            if (x1 - x0) * (z - z0) > (z1 - z0) * (x - x0):
                break
            hull.pop()
        hull.append((v, x, z))
    return np.array([v for v, _, _ in hull], dtype=np.int64)


def ridges_of_chain(chain: NDArray[np.int64]) -> Ridges:
    """One ridge between each two successive sites: a line without vertices, which the list calls (-1, -1)."""
    pairs = np.stack([chain[:-1], chain[1:]], axis=1).astype(np.int32)
    r, none = len(pairs), np.empty(0, dtype=np.int64)
    return Ridges(
        pairs,
        np.arange(0, 2 * r + 1, 2),
        np.full(2 * r, -1, dtype=np.int32),
        np.zeros(r + 1, dtype=np.int64),
        none.astype(np.int32),
        none,
    )
