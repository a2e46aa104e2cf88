"""Cavities with fixed cells: the sets of cells in Baker's form of constrained triangulation (12.2.5).

For a point P and a triangulation T, Γ(P) is the set of cells whose open circumballs contain P. Its
*principal component* Γ_P is the part that is connected through facets with the cell of P. With a set F of
fixed cells, Υ(P) = Γ(P) - F, and Υ_P is its part around P in the same sense; it exists if P is in no closed
cell of F. `unstruct.insert` replaces Γ_P or Υ_P; here the sets are computed for inspection. See the book,
2.2b and 2.5.

**In the plane P sees every edge of Γ_P and of Υ_P from within**, with or without fixed cells, and whether T
is Delaunay or not. The proof is by induction over the cells in the order in which they are reached. The
invariant is that for every edge u v on the boundary of the visited part, triangle P u v lies in that part.
This is true for the cell of P. If a neighbor u v w beyond u v has P in its circle, then P, u, w, v is a
convex quadrilateral, and P u w and P w v lie within the union of P u v and u v w. So the invariant remains
true, whichever cells are left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arrays import as_points
from ...base.errors import InputError
from ...mesh.mesh import Mesh
from ...predicates.batch import in_sphere, orient

__all__ = ["Cavities", "as_cells", "boundary_facets", "cavities", "held_by", "hidden_facets"]


@dataclass(frozen=True)
class Cavities:
    """The sets of cells that matter for an insertion, as sorted int32 arrays of cell numbers.

    Attributes
    ----------
    holders : the closed cells that contain the point
    gamma : Γ(P), all cells whose open circumballs contain the point
    gamma_component : Γ_P, the part of Γ(P) around the point
    upsilon : Υ(P), the part of Γ(P) that is not fixed
    upsilon_component : Υ_P, the part of Υ(P) around the point; empty if the point is refused
    refused_by : the fixed cells among the holders; if there are any, the point is refused
    """

    holders: NDArray[np.int32]
    gamma: NDArray[np.int32]
    gamma_component: NDArray[np.int32]
    upsilon: NDArray[np.int32]
    upsilon_component: NDArray[np.int32]
    refused_by: NDArray[np.int32]


def as_cells(mesh: Mesh, chosen: Any) -> NDArray[np.int32]:
    """Sorted cell numbers from the name of a cell marker, a mask or numbers; an empty array for None.

    Raises
    ------
    InputError
        For unknown names, masks of wrong length and numbers out of range.
    """
    if chosen is None:
        return np.empty(0, dtype=np.int32)
    if isinstance(chosen, str):
        values = mesh.markers.get(chosen)
        if values is None or values.ndim != 1:
            names = sorted(name for name, rows in mesh.markers.items() if rows.ndim == 1)
            raise InputError(f"no cell marker is called {chosen!r}; the mesh has {names}")
        return np.flatnonzero(values).astype(np.int32)
    array = np.asarray(chosen)
    if array.dtype == bool and array.shape == (mesh.size,):
        return np.flatnonzero(array).astype(np.int32)
    if array.ndim != 1 or (array.size and array.dtype.kind not in "iu"):
        raise InputError(
            f"fixed must be a marker, a mask of length {mesh.size} or cell numbers, not {array.dtype} "
            f"of shape {array.shape}"
        )
    bad = (array < 0) | (array >= mesh.size)
    if bad.any():
        i = int(np.argmax(bad))
        raise InputError(f"fixed[{i}] = {array[i]} is not a cell; the mesh has cells 0..{mesh.size - 1}")
    return np.unique(array).astype(np.int32)


def cavities(mesh: Mesh, point: ArrayLike, *, fixed: Any = None) -> Cavities:
    """Γ(P), Γ_P, Υ(P) and Υ_P of a point, by exact signs; nothing is changed.

    Parameters
    ----------
    mesh : Mesh
        Positively oriented cells in d dimensions, Delaunay or not.
    point : array_like, shape (d,)
        A point in the mesh.
    fixed : str or array_like, optional
        As for `unstruct.insert`.

    Returns
    -------
    Cavities

    Raises
    ------
    InputError
        For a point outside the mesh.

    Notes
    -----
    O(m), because every cell is tested: Γ(P) may consist of parts that are far apart. Source: T. J. Baker,
    Engineering with Computers 5 (1989) 161-175. Book: 2.5.
    """
    x = as_points(np.asarray(point, dtype=float)[None], "point")[0]
    held = as_cells(mesh, fixed)
    gamma = np.atleast_1d(in_sphere(mesh.corners, x)) > 0
    holders = np.ones(mesh.size, dtype=bool)
    for k in range(mesh.dimension + 1):
        moved = mesh.corners.copy()
        moved[:, k] = x
        holders &= np.asarray(orient(moved)) >= 0
    if not holders.any():
        raise InputError(f"point {x.tolist()} lies outside the mesh; choose a point in the mesh")
    free = gamma.copy()
    free[held] = False
    refused = np.intersect1d(np.flatnonzero(holders), held)
    nothing = np.zeros(mesh.size, dtype=bool)
    around = nothing if len(refused) else _component(mesh, free, holders & gamma)
    sets = (holders, gamma, _component(mesh, gamma, holders & gamma), free, around)
    held_in, all_, near, left, used = (np.flatnonzero(s).astype(np.int32) for s in sets)
    return Cavities(held_in, all_, near, left, used, refused.astype(np.int32))


def _component(mesh: Mesh, cells: NDArray[np.bool_], start: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The cells that can be reached from ``start`` through facets without leaving ``cells``."""
    reached, fresh = start.copy(), np.flatnonzero(start)
    while len(fresh):
        beyond = mesh.neighbors[fresh].ravel()
        beyond = np.unique(beyond[beyond >= 0])
        fresh = beyond[cells[beyond] & ~reached[beyond]]
        reached[fresh] = True
    return reached


def boundary_facets(mesh: Mesh, cells: ArrayLike) -> NDArray[np.int64]:
    """The boundary of a set of cells, as rows (cell, k): the facet opposite corner k of a cell of the set."""
    numbers = as_cells(mesh, np.asarray(cells, dtype=np.int64))
    within = np.zeros(mesh.size + 1, dtype=bool)  # the last entry is for "no neighbor"
    within[numbers] = True
    rows, k = np.nonzero(~within[mesh.neighbors[numbers]])
    return np.column_stack([numbers[rows], k])


def hidden_facets(mesh: Mesh, cells: ArrayLike, point: ArrayLike) -> NDArray[np.int64]:
    """Those `boundary_facets` of a set of cells that a point does not see strictly from within.

    Parameters
    ----------
    mesh : Mesh
    cells : array_like of int
    point : array_like, shape (d,)

    Returns
    -------
    ndarray of int64, shape (k, 2)
        Rows (cell, k). If there are none, the set is star-shaped around the point. (A facet on the boundary
        of the mesh that is coplanar with the point does not count as hidden, because it is divided at the
        point.)
    """
    facets = boundary_facets(mesh, cells)
    moved = mesh.corners[facets[:, 0]].copy()
    moved[np.arange(len(facets)), facets[:, 1]] = np.asarray(point, dtype=float)
    sign = np.asarray(orient(moved)).reshape(-1)
    return facets[(sign < 0) | ((sign == 0) & (mesh.neighbors[facets[:, 0], facets[:, 1]] >= 0))]


def held_by(mesh: Mesh, points: ArrayLike, cells: Any) -> NDArray[np.int32]:
    """For each point, one of the given closed cells that contains it, or -1.

    Parameters
    ----------
    mesh : Mesh
    points : array_like, shape (k, d)
    cells : str or array_like
        A marker, a mask or numbers of cells.

    Returns
    -------
    ndarray of int32, shape (k,)
        Since fixed cells never change, the points with -1 are those that `unstruct.insert` accepts, in any
        order, if these cells are given as ``fixed``.
    """
    rows = as_points(points)
    chosen = np.zeros(mesh.size, dtype=bool)
    chosen[as_cells(mesh, cells)] = True
    query, owner = mesh.holding(rows)
    found = np.full(len(rows), -1, dtype=np.int32)
    inside = chosen[owner]
    found[query[inside]] = owner[inside]
    return found
