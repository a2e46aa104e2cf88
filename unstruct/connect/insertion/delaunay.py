"""Delaunay triangulation of points, in any dimension: Bowyer and Watson's incremental construction."""

from __future__ import annotations

from numpy.typing import ArrayLike

from ...base.arguments import as_flags
from ...base.arrays import as_points, as_weights
from ...base.errors import InputError
from ...mesh.mesh import Mesh
from .triangulation import Triangulation
from .weighted import regular_triangulation

__all__ = ["Triangulation", "delaunay"]


def delaunay(points: ArrayLike, *, weights: ArrayLike | None = None, progress: bool = False) -> Mesh:
    """Delaunay triangulation of points, exact for any finite doubles, in any dimension.

    With weights: the regular triangulation, whose dual is the power diagram. It is the lower hull of the
    points lifted to the heights |p|^2 - w, as the Delaunay triangulation is for equal weights.

    Parameters
    ----------
    points : array_like, shape (n, d)
        Finite coordinates, d >= 1, at least d + 1 points that span the space.
    weights : array_like, shape (n,), optional
        A finite weight w for each point, in the units of a squared length: distances to p become
        ``|x - p|^2 - w``. Only their differences matter.
    progress : bool
        Show a progress bar.

    Returns
    -------
    Mesh
        ``points`` are the input, in input order. ``simplices`` are positively oriented, ``neighbors[t, k]``
        is the cell opposite vertex k, -1 outside the hull. Of several equal points the first is used; the
        others are in ``duplicates`` as rows (copy, kept) and in no cell. With ``weights``, which the mesh
        keeps, the heaviest of several equal points is used, and points whose power cells have no interior
        are in no cell and listed in ``hidden``.

    Raises
    ------
    InputError
        NaN, infinite or masked entries, wrong shape or type, too few points, not one weight for
        each point; the message names the first row.
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

    Equal weights give the same mesh as none, bit for bit. Insertion with weights takes about twice as long;
    which points are hidden does not depend on its order. Source: H. Edelsbrunner, N. R. Shah, Algorithmica 15
    (1996) 223-241. Book: 2.1.
    """
    as_flags(progress=progress)
    rows = as_points(points)
    n, d = rows.shape
    if n < d + 1:
        raise InputError(f"{n} points are too few: a triangulation in {d} dimensions needs at least {d + 1}")
    heavy = None if weights is None else as_weights(weights, n)
    if heavy is not None and (heavy != heavy[0]).any():
        return regular_triangulation(rows, heavy, progress=progress)
    mesh = Triangulation(rows, progress=progress).mesh()
    if heavy is None:
        return mesh
    return Mesh(
        mesh.points, mesh.simplices, neighbors=mesh.neighbors, duplicates=mesh.duplicates, weights=heavy
    )
