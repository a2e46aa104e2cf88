"""Sizes from a solution: from an estimate of its error, or from its second derivatives.

See the book, chapter 2.3.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arguments import as_flags, finite
from ..base.arrays import as_numbers
from ..base.errors import InputError, MeshError
from ..geometry.edge_vectors import lengths
from ..mesh.mesh import Mesh
from .background_mesh import Background, background, fills_its_space

__all__ = ["from_error", "from_hessian", "hessian", "mesh_size", "to_vertices"]

Array = NDArray[np.float64]
ENOUGH = {
    2: 10,
    3: 16,
}  # vertices of a patch; quadratics have 6 and 10 coefficients, more points smooth noise
RANK = 1e-7  # a fit is not determined if a pivot is smaller than this, relative to the largest
FITS_AT_ONCE = 1 << 14  # how many fits are computed at a time, to bound the memory


def _solid(mesh: Mesh) -> None:
    if not fills_its_space(mesh) or mesh.size == 0:
        raise MeshError("sizes from a solution need triangles in the plane or tetrahedra in space")


def _numbers(values: ArrayLike, count: int, what: str) -> Array:
    array = as_numbers(values, "values")
    if array.shape != (count,):
        raise InputError(f"give one number per {what}, shape ({count},), not {array.shape}")
    if not np.isfinite(array).all():
        row = int(np.argmin(np.isfinite(array)))
        raise InputError(f"the value of {what} {row} is {float(array[row])!r}; it must be finite")
    return array


def to_vertices(mesh: Mesh, values: ArrayLike, *, largest: bool = False) -> Array:
    """Numbers at the vertices from numbers of the cells.

    Parameters
    ----------
    mesh : Mesh
        A mesh of simplices.
    values : array_like, shape (m,)
        One number per cell.
    largest : bool
        Take the largest number among the cells of a vertex instead of their mean weighted by volume.

    Returns
    -------
    ndarray, shape (n,)
        NaN at vertices that no cell uses.
    """
    as_flags(largest=largest)
    if not isinstance(mesh, Mesh):
        raise InputError(f"mesh must be a Mesh, not {type(mesh).__name__}")
    array = _numbers(values, mesh.size, "cell")
    corners = mesh.simplices
    if largest:
        result = np.full(len(mesh.points), -np.inf)
        np.maximum.at(result, corners, array[:, None])
        return np.where(np.isfinite(result), result, np.nan)
    weight = np.abs(mesh.volumes)
    flat, times = corners.ravel(), corners.shape[1]
    total = np.bincount(flat, np.repeat(weight, times), len(mesh.points))
    summed = np.bincount(flat, np.repeat(weight * array, times), len(mesh.points))
    return np.divide(summed, total, out=np.full(len(total), np.nan), where=total > 0)


def mesh_size(mesh: Mesh) -> Array:
    """The actual size of a mesh: the mean length of the edges at each vertex; NaN where there are none.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    ndarray, shape (n,)
    """
    i, j = mesh.edges.T
    length = lengths(mesh.points[i] - mesh.points[j])
    n = len(mesh.points)
    count = np.bincount(i, minlength=n) + np.bincount(j, minlength=n)
    total = np.bincount(i, length, n) + np.bincount(j, length, n)
    return np.divide(total, count, out=np.full(n, np.nan), where=count > 0)


def from_error(
    mesh: Mesh,
    error: ArrayLike,
    target: float,
    *,
    order: float = 2.0,
    finer: float = 4.0,
    coarser: float = 2.0,
) -> Background:
    """A new size from an estimate of the error at the vertices of a mesh.

    Parameters
    ----------
    mesh : Mesh
        Triangles in the plane or tetrahedra in space, on which the error was estimated.
    error : array_like, shape (n,) or (m,)
        An estimate of at least 0 for each vertex, or for each cell; a vertex then takes the largest of its
        cells. (If n = m, the numbers are taken as those of vertices.)
    target : float
        The error that is wanted everywhere.
    order : float
        How the error falls with the size: error ~ size**order. For linear elements it is 2 for the pointwise
        interpolation error and for the energy norm over one triangle, and 1 for the gradient at a point.
    finer, coarser : float
        The largest factors, at least 1, by which the size may shrink or grow in one step, because an estimate
        is reliable only for sizes near those of its mesh.

    Returns
    -------
    Background
        size * (target / error)**(1 / order), where size is the mean length of the edges at the vertex.

    Raises
    ------
    InputError, MeshError
        For errors that are negative or not finite, with their vertex; for a target that is not positive.

    Notes
    -----
    Source: equidistribution, as in Zienkiewicz and Zhu, *A simple error estimator and adaptive procedure*
    (1987), section 5. See the book, chapter 2.3.
    """
    _solid(mesh)
    for name, number, least in (("target", target, 0), ("order", order, 0)):
        if not finite(number, name) > least:
            raise InputError(f"{name} must be positive, not {number!r}")
    for name, number in (("finer", finer), ("coarser", coarser)):
        if not finite(number, name) >= 1:
            raise InputError(f"{name} must be at least 1, not {number!r}")
    array = as_numbers(error, "error")
    used = np.unique(mesh.simplices)
    if array.shape == (mesh.size,) != (len(mesh.points),):
        array = to_vertices(mesh, array, largest=True)
    elif array.shape != (len(mesh.points),):
        raise InputError(
            f"give one error per vertex ({len(mesh.points)},) or per cell ({mesh.size},), "
            f"not shape {array.shape}"
        )
    bad = ~(array[used] >= 0) | ~np.isfinite(array[used])
    if bad.any():
        row = int(used[np.argmax(bad)])
        raise InputError(f"error is {float(array[row])!r} at vertex {row}; it must be finite and at least 0")
    with np.errstate(divide="ignore"):
        ratio = np.clip((target / array) ** (1.0 / order), 1.0 / finer, coarser)
    return background(mesh, mesh_size(mesh) * ratio)


def hessian(mesh: Mesh, values: ArrayLike) -> Array:
    """Second derivatives at the vertices, recovered from values at the vertices.

    Parameters
    ----------
    mesh : Mesh
        Triangles in the plane, or tetrahedra in space.
    values : array_like, shape (n,)
        A function at the vertices.

    Returns
    -------
    ndarray, shape (n, d, d)
        Symmetric matrices; zero at vertices that no cell uses.

    Raises
    ------
    MeshError
        If the mesh has too few vertices (six that are not on one conic are needed, in space ten that are not
        on one quadric).

    Notes
    -----
    At each vertex a quadratic polynomial is fitted by least squares to the vertices within two edges. If
    these are fewer than ten (in space sixteen) or do not determine it, the vertices within three edges are
    taken, and so on. A vertex at r times the smallest distance has the weight 1 / (1 + r^2). The result is
    exact for quadratic functions on any mesh, also at the boundary. For other functions the error falls with
    the size of the patch, and in the interior of regular meshes with its square.

    Source: polynomial preserving recovery, Zhang and Naga, *A new finite element gradient recovery method*
    (2005); here the second derivatives of the fitted polynomial are used. See the book, chapter 2.3.
    """
    from scipy.sparse import csr_array, eye_array

    _solid(mesh)
    u = _numbers(values, len(mesh.points), "vertex")
    indptr, indices = mesh.vertex_neighbor_vertices
    n = len(u)
    near = csr_array((np.ones(len(indices)), indices, indptr), shape=(n, n)) + eye_array(n, format="csr")
    d = mesh.dimension
    result = np.zeros((n, d, d))
    todo = np.unique(mesh.simplices)
    reach = near[todo]
    while len(todo):
        before = reach.nnz
        reach = reach @ near
        count = np.diff(reach.indptr)
        full = reach.nnz == before  # all patches are whole components of the mesh
        ready = np.nonzero((count >= ENOUGH[d]) | full)[0]
        done = []
        for i in range(0, len(ready), FITS_AT_ONCE):
            rows = ready[i : i + FITS_AT_ONCE]
            second, determined = _fit(mesh.points, u, todo[rows], reach[rows])
            result[todo[rows[determined]]] = second[determined]
            done.append(rows[determined])
        left = np.setdiff1d(np.arange(len(todo)), np.concatenate([[], *done]).astype(int))
        if full and len(left):
            raise MeshError(
                f"too few vertices around vertex {todo[left[0]]} for second derivatives; refine first"
            )
        todo, reach = todo[left], reach[left]
    return result


def _fit(points: Array, u: Array, centers: NDArray, patch: Any) -> tuple[Array, NDArray[np.bool_]]:
    """Second derivatives (k, d, d) of the quadratic fits around ``centers``; and which are determined.

    ``patch`` is a sparse matrix; the columns stored in row i are the vertices of the patch of center i.
    """
    d = points.shape[1]
    pairs = [(i, j) for i in range(d) for j in range(i, d)]
    count = np.diff(patch.indptr)
    column = np.arange(max(count.max(), 1 + d + len(pairs)))
    present = column < count[:, None]  # short rows are filled up with the center itself, with weight 0
    other = np.repeat(centers[:, None], len(column), axis=1)
    other[present] = patch.indices
    away = points[other] - points[centers][:, None]
    scale = np.abs(away).max(axis=(1, 2))
    x = np.moveaxis(away / scale[:, None, None], -1, 0)
    square = (x * x).sum(axis=0)
    nearest = np.where(square > 0, square, np.inf).min(axis=1, keepdims=True)
    weight = np.where(present, 1.0 / (1.0 + square / nearest), 0.0)
    products = [x[i] * x[j] / (2 if i == j else 1) for i, j in pairs]
    columns = np.stack([np.ones_like(square), *x, *products], axis=-1)
    q, r = np.linalg.qr(columns * weight[..., None])
    pivots = np.abs(np.diagonal(r, axis1=1, axis2=2))
    determined = pivots.min(axis=1) > RANK * pivots.max(axis=1)
    right = np.einsum("ijk,ij->ik", q[determined], (weight * u[other])[determined])
    a = np.linalg.solve(r[determined], right[..., None])[..., 0]
    second = np.zeros((len(centers), d, d))
    for k, (i, j) in enumerate(pairs, start=1 + d):
        second[determined, i, j] = second[determined, j, i] = a[:, k]
    return second / scale[:, None, None] ** 2, determined


def from_hessian(mesh: Mesh, second: ArrayLike, error: float, *, lower: float, upper: float) -> Background:
    """The size at which linear interpolation of a function has no more than a wanted error.

    Parameters
    ----------
    mesh : Mesh
        Triangles in the plane, or tetrahedra in space.
    second : array_like, shape (n, d, d)
        Second derivatives at the vertices, for example from `hessian`.
    error : float
        The largest pointwise error that is allowed.
    lower, upper : float
        Bounds of the size, because second derivatives may vanish or be very large.

    Returns
    -------
    Background
        sqrt(6 error / k) in the plane and sqrt(16 error / (3 k)) in space, clipped to the bounds, where k is
        the largest absolute eigenvalue.

    Notes
    -----
    On an equilateral triangle of edge h, a function with second derivatives of at most k in every direction
    differs from its linear interpolant by at most k R**2 / 2 = k h**2 / 6, where R = h / sqrt(3) is the
    circumradius; on a regular tetrahedron R**2 = 3 h**2 / 8. The function k |x|**2 / 2 reaches this bound at
    the center. Source: Waldron, *The error in
    linear interpolation at the vertices of a simplex* (1998). See the book, chapter 2.3.
    """
    _solid(mesh)
    array = second_derivatives(mesh, second, error, lower, upper)
    steep = np.abs(np.linalg.eigvalsh(array)).max(axis=1)
    with np.errstate(divide="ignore"):
        # a regular simplex of d dimensions and edges h has R^2 = h^2 d / (2 (d + 1))
        of_error = 4.0 * (mesh.dimension + 1) / mesh.dimension
        return background(mesh, np.clip(np.sqrt(of_error * error / steep), lower, upper))


def second_derivatives(
    mesh: Mesh, second: ArrayLike, error: float, lower: float, upper: float
) -> NDArray[np.float64]:
    """Second derivatives at the vertices (n, d, d), after a check of these, of an error and of bounds."""
    array, d = as_numbers(second, "second"), mesh.dimension
    if array.shape != (len(mesh.points), d, d):
        raise InputError(f"second must have shape ({len(mesh.points)}, {d}, {d}), not {array.shape}")
    bad = ~np.isfinite(array).all(axis=(1, 2))
    if bad.any():
        row = int(np.argmax(bad))
        raise InputError(f"the second derivatives at vertex {row} are not finite: {array[row].tolist()}")
    if not finite(error, "error") > 0:
        raise InputError(f"error must be positive, not {error!r}")
    if not 0 < finite(lower, "lower") <= finite(upper, "upper"):
        raise InputError(f"bounds must be 0 < lower <= upper, not {lower!r}, {upper!r}")
    return array
