"""Delaunay triangulation of points, in any dimension: Bowyer and Watson's incremental construction."""

from __future__ import annotations

from numpy.typing import ArrayLike

from ...base.arrays import as_points
from ...base.errors import InputError
from ...mesh.mesh import Mesh
from .triangulation import Triangulation

__all__ = ["Triangulation", "delaunay"]


def delaunay(points: ArrayLike, *, progress: bool = False) -> Mesh:
    """Delaunay triangulation of points, exact for any finite doubles, in any dimension.

    Parameters
    ----------
    points : array_like, shape (n, d)
        Finite coordinates, d >= 1, at least d + 1 points that span the space.
    progress : bool
        Show a progress bar.

    Returns
    -------
    Mesh
        ``points`` are the input, in input order. ``simplices`` are positively oriented, ``neighbors[t, k]``
        is the cell opposite vertex k, -1 outside the hull. Of several equal points the first is used; the
        others are in ``duplicates`` as rows (copy, kept) and in no cell.

    Raises
    ------
    InputError
        NaN, infinite or masked entries, wrong shape or type, too few points; the message names the first row.
    DegenerateInputError
        All points equal, collinear, coplanar, ...; ``dimension`` says which of these.

    Notes
    -----
    Points are inserted in a biased randomized order along a Hilbert curve: O(n) in practice for points
    that are spread out (2D and 3D), O(n log n) expected for any points of the plane. If points are
    cospherical, the result is one of the Delaunay triangulations, the same for the same input; no cell is
    ever flat. The code for two and three dimensions is compiled; the general code, in exact integers, inserts
    about two hundred points a second in four dimensions. Sources: A. Bowyer, The Computer Journal 24 (1981)
    162-166; D. F. Watson, ibid. 167-172. Book: 12.2.2, 12.2.4.
    """
    rows = as_points(points)
    n, d = rows.shape
    if n < d + 1:
        raise InputError(f"{n} points are too few: a triangulation in {d} dimensions needs at least {d + 1}")
    return Triangulation(rows, progress=progress).mesh()
