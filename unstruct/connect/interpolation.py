"""Values between the vertices of a mesh: linear on its cells, or from natural neighbors in the plane."""

from __future__ import annotations

from fractions import Fraction
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arguments import as_number
from ..base.arrays import as_numbers, as_points
from ..base.errors import InputError, MeshError
from ..base.jit import inline, kernel
from ..mesh.mesh import Mesh, is_planar
from ..predicates.batch import scaled
from ..predicates.kernels import incircle
from .voronoi.centers import determinants, local_circumcenters
from .voronoi.complex import VoronoiComplex
from .walking import cells_at

__all__ = ["interpolate"]

Floats = NDArray[np.float64]

INTERPOLATIONS = ("linear", "natural", "laplace")
FLAT_CELL = 1e-6  # cells of a smaller relative volume are treated with rational arithmetic
ON_HULL = 1e-15  # points that are relatively nearer to an edge of the hull than this count as on it
CAVITIES_AT_ONCE = 50_000  # queries per kernel call: a fraction of a second, so that Ctrl-C takes effect


def interpolate(
    mesh: Mesh, values: ArrayLike, x: ArrayLike, method: str = "linear", *, fill_value: complex = np.nan
) -> Any:
    """Interpolate values given at the vertices of a mesh.

    Parameters
    ----------
    mesh : Mesh
        Simplices of full dimension, in any dimension, convex or not, with holes or not. For "natural" and
        "laplace" a Delaunay triangulation of planar points, as `unstruct.delaunay` makes them.
    values : array_like, shape (n,) or (n, k)
        One value, or a row of values, for each vertex; real or complex. Values at vertices that no cell uses
        (copies of others) do not count.
    x : array_like, shape (..., d)
        Where to interpolate.
    method : {"linear", "natural", "laplace"}
        "linear": barycentric coordinates in the cell. "natural": Sibson's coordinates, the areas that a new
        site at x would take from the Voronoi cells of its neighbors; derivatives are continuous except at
        the vertices. "laplace": lengths of the sides of the new cell over distances, instead of areas; the
        result is continuous. All three reproduce linear functions.
    fill_value : number
        The result outside of the mesh, and in its holes.

    Returns
    -------
    float or ndarray, shape (...) or (..., k)
        At a vertex the value there, exactly. On an edge of the hull all methods are linear between its ends.

    Raises
    ------
    InputError
        For values or queries of a wrong shape or type, queries that are not finite, unknown methods, and, but
        for "linear", coordinates whose exponents differ too much for one scale.
    MeshError
        For cells that are no simplices of full dimension. But for "linear": for a mesh that is not planar,
        has weights, is not Delaunay (the message names a facet), or does not fill the convex hull of its
        points.

    Notes
    -----
    Cells and neighbors are found by exact signs; O(log m) for a query, after O(m log m) for the first ones on
    a mesh. Sources: R. Sibson, Math. Proc. Cambridge Philos. Soc. 87 (1980) 151-155; N. H. Christ,
    R. Friedberg, T. D. Lee, Nuclear Physics B 202 (1982) 89-125 (Laplace's weights). Book: 2.1.

    Examples
    --------
    >>> import unstruct
    >>> mesh = unstruct.delaunay([(0, 0), (1, 0), (1, 1), (0, 1)])
    >>> unstruct.interpolate(mesh, [0.0, 1.0, 3.0, 2.0], [(0.25, 0.5), (0, 1), (2, 2)]).tolist()
    [1.25, 2.0, nan]
    """
    if not isinstance(method, str) or method not in INTERPOLATIONS:
        raise InputError(f"method must be one of {', '.join(INTERPOLATIONS)}, not {method!r}")
    fill_value = as_number(fill_value, "fill_value")
    if not isinstance(mesh, Mesh):
        raise InputError(f"mesh must be a Mesh, not {type(mesh).__name__}")
    d = mesh.points.shape[1]
    if not mesh.is_simplicial or mesh.dimension != d:
        raise MeshError(
            f"only simplices of full dimension can be interpolated on, not {', '.join(mesh.cells)}"
        )
    data = _values(mesh, values)
    if method != "linear":  # refuse other meshes also if no query is inside
        _prepared(mesh, method)
    rows, shape = _queries(x, d)
    cells = cells_at(mesh, rows)
    inside = np.flatnonzero(cells >= 0)
    result = np.full(
        (len(rows), *data.shape[1:]), fill_value, dtype=np.result_type(data, type(fill_value), 1.0)
    )
    if method == "linear":
        vertex = mesh.simplices[cells[inside]]
        weight = _barycentric(mesh.points[vertex], rows[inside])
        terms = _scaled_values(weight.ravel(), data[vertex.ravel()])
        result[inside] = terms.reshape((*vertex.shape, *data.shape[1:])).sum(axis=1)
    elif len(inside):
        result[inside] = _natural(mesh, data, rows[inside], cells[inside], method)
    found = result.reshape((*shape, *data.shape[1:]))
    return found[()] if found.ndim == 0 else found


def _queries(x: ArrayLike, d: int) -> tuple[Floats, tuple[int, ...]]:
    """The queries as rows, and the shape without the last axis."""
    array = as_numbers(x, "x")
    if array.ndim == 0 or array.shape[-1] != d:
        raise InputError(f"x must have shape (..., {d}), not {array.shape}")
    return as_points(np.ascontiguousarray(array.reshape(-1, d)), "x"), array.shape[:-1]


def _values(mesh: Mesh, values: ArrayLike) -> NDArray[Any]:
    """The values as a real or complex array of one or two axes."""
    data = np.asarray(values)
    n = len(mesh.points)
    if data.ndim not in (1, 2) or len(data) != n:
        raise InputError(
            f"values must have shape ({n},) or ({n}, k), one row for each vertex, not {data.shape}"
        )
    if data.dtype.kind not in "fiubc":
        raise InputError(f"values must be numbers, not {data.dtype}")
    return data if data.dtype.kind == "c" else data.astype(np.float64)


def _scaled_values(weight: Floats, data: NDArray[Any]) -> NDArray[Any]:
    """Weights times values; nothing where the weight is zero, even if the value is not finite."""
    weight = weight.reshape(-1, *[1] * (data.ndim - 1))
    with np.errstate(invalid="ignore"):
        return np.where(weight == 0, 0.0, weight * data)


# --- linear ---------------------------------------------------------------------------------------


def _barycentric(corners: Floats, x: Floats) -> Floats:
    """Barycentric coordinates (q, d + 1) of points in closed simplices (q, d + 1, d); never negative.

    That of a corner is zero exactly if two other corners and x are equal, so at a corner they are 0 and 1.
    """
    rows = corners / 2 - x[:, None] / 2
    most = np.abs(rows).max(axis=(1, 2), keepdims=True)
    rows = rows / np.where(most > 0, most, 1.0)
    width = rows.shape[1]
    parts = [(-1) ** k * determinants(np.delete(rows, k, axis=1)) for k in range(width)]
    volume = np.stack(parts, axis=1)
    total = volume.sum(axis=1)
    volume = np.maximum(volume * np.where(total < 0, -1.0, 1.0)[:, None], 0.0)
    sum_ = volume.sum(axis=1, keepdims=True)
    weight = volume / np.where(sum_ > 0, sum_, 1.0)
    for q in np.flatnonzero(np.abs(total) < FLAT_CELL):
        weight[q] = _exact_barycentric(corners[q], x[q])
    return weight


def _exact_barycentric(corners: Floats, x: Floats) -> list[float]:
    exact = [[Fraction(a) - Fraction(b) for a, b in zip(p, x.tolist())] for p in corners.tolist()]
    parts = [(-1) ** k * _determinant(exact[:k] + exact[k + 1 :]) for k in range(len(exact))]
    return [float(part / sum(parts)) for part in parts]


def _determinant(rows: list[list[Fraction]]) -> Fraction:
    if not rows:
        return Fraction(1)
    minors = ([row[:k] + row[k + 1 :] for row in rows[1:]] for k in range(len(rows)))
    return sum(((-1) ** k * rows[0][k] * _determinant(minor) for k, minor in enumerate(minors)), Fraction(0))


# --- natural neighbors ----------------------------------------------------------------------------


class Dual(NamedTuple):
    """A planar Delaunay mesh, scaled, with the circumcenters of its triangles relative to corners."""

    xy: Floats
    simplices: NDArray[np.int32]
    neighbors: NDArray[np.int32]
    base: NDArray[np.int32]
    offset: Floats


_DUALS: WeakKeyDictionary[Mesh, tuple[Dual, float]] = WeakKeyDictionary()


def _prepared(mesh: Mesh, method: str) -> tuple[Dual, float]:
    """The dual of the mesh and its scale; or an error that says why there is none."""
    if mesh not in _DUALS:
        if not is_planar(mesh):
            raise MeshError(f"method {method!r} needs a planar mesh of triangles; use 'linear'")
        if mesh.weights is not None:
            raise MeshError(f"method {method!r} needs a mesh without weights; use 'linear'")
        xy, exact = scaled(mesh.points)
        if not exact:
            raise InputError("the exponents of the coordinates differ too much for one scale; use 'linear'")
        VoronoiComplex(mesh)  # refuses what is not Delaunay, or not all of the hull
        base, offset = local_circumcenters(xy, mesh.simplices, 1.0)
        factor = float(np.abs(xy).max() / np.abs(mesh.points).max())
        _DUALS[mesh] = Dual(xy, mesh.simplices, mesh.neighbors, base, offset), factor
    return _DUALS[mesh]


def _natural(
    mesh: Mesh, data: NDArray[Any], rows: Floats, cells: NDArray[np.int32], method: str
) -> NDArray[Any]:
    dual, factor = _prepared(mesh, method)
    mark = np.full(mesh.size, -1, dtype=np.int64)
    room = 64
    parts = []
    i = 0
    while i < len(rows):
        stop = min(len(rows), i + CAVITIES_AT_ONCE)
        vertex = np.empty(16 * (stop - i) + room, dtype=np.int64)
        weight, start = np.empty(len(vertex)), np.zeros(stop - i + 1, dtype=np.int64)
        queries = rows[i:stop] * factor
        done = neighbors_of(dual, queries, cells[i:stop], mark, np.empty(room, np.int64), method == "natural",
                            (vertex, weight, start))  # fmt: skip
        if done == 0:
            room *= 4
        else:
            terms = _scaled_values(weight[: start[done]], data[vertex[: start[done]]])
            parts.append(np.add.reduceat(terms, start[:done], axis=0))
        mark[:] = -1
        i += done
    return np.concatenate(parts)


@inline
def _center(ax, ay, bx, by):
    """The circumcenter of the origin, a and b, which turn left."""
    area = 2 * (ax * by - ay * bx)
    a, b = ax * ax + ay * ay, bx * bx + by * by
    return (by * a - ay * b) / area, (ax * b - bx * a) / area


@kernel
def neighbors_of(dual, queries, cells, mark, cavity, by_area, found):
    """Write the natural neighbors of each query, from a cell that contains it, and their weights, of sum 1.

    The triangles whose circles contain x form the cavity; the corners of its boundary are the neighbors.

          c           The boundary of the cavity is followed counterclockwise. At b, between its edges
         / \\          a b and b c, the cells of x and b share a side, from the center of (x, a, b) to that of
        /   b         (x, b, c). What x takes from b lies between it and the centers of the triangles of the
       / x / \\        cavity around b.
           a
    Returns how many queries are done before there was no room.
    """
    vertex, weight, start = found
    xy, simplices = dual.xy, dual.simplices
    used = 0
    for q in range(queries.shape[0]):
        x, y, t = queries[q, 0], queries[q, 1], cells[q]
        size = 0
        for k in range(3):
            v = simplices[t, k]
            if xy[v, 0] == x and xy[v, 1] == y:
                size = -1
                if used + 2 > vertex.shape[0]:
                    return q
                vertex[used], weight[used] = v, 1.0
        if size == 0:
            size = _find_cavity(dual, t, x, y, mark, cavity, q)
            if size < 0 or used + size + 3 > vertex.shape[0]:
                return q
            used = _follow(dual, (x, y), mark, q, cavity[:size], by_area, (vertex, weight, used))
        else:
            used += 1
        start[q + 1] = used
    return queries.shape[0]


@kernel
def _find_cavity(dual, t, x, y, mark, cavity, q):
    """The triangles whose open disks contain (x, y), which lies in t; -1 if there is no room."""
    xy, simplices, neighbors = dual.xy, dual.simplices, dual.neighbors
    cavity[0], mark[t] = t, q
    size, head = 1, 0
    while head < size:
        t = cavity[head]
        head += 1
        for k in range(3):
            u = neighbors[t, k]
            if u < 0 or mark[u] == q:
                continue
            a, b, c = simplices[u, 0], simplices[u, 1], simplices[u, 2]
            if incircle(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1], x, y) > 0:
                if size == cavity.shape[0]:
                    return -1
                cavity[size], mark[u] = u, q
                size += 1
    return size


@kernel
def _follow(dual, place, mark, q, cavity, by_area, found):
    """Follow the boundary of the cavity and write a weight for each of its corners; see `neighbors_of`."""
    xy, simplices, neighbors, base, offset = dual
    x, y = place
    vertex, weight, first = found
    t, k = cavity[0], 0
    for s in cavity:
        for j in range(3):
            u = neighbors[s, j]
            if u < 0 or mark[u] != q:
                t, k = s, j
            if u < 0:  # on an edge of the hull?
                a, b = simplices[s, (j + 1) % 3], simplices[s, (j + 2) % 3]
                ax, ay, bx, by = xy[a, 0] - x, xy[a, 1] - y, xy[b, 0] - x, xy[b, 1] - y
                if (
                    ax * by - ay * bx <= ON_HULL * (abs(ax) + abs(ay)) * (abs(bx) + abs(by))
                    and ax * bx + ay * by <= 0.0
                ):
                    reach, other = max(abs(ax), abs(ay)), max(abs(bx), abs(by))
                    vertex[first], weight[first] = a, other / (reach + other)
                    vertex[first + 1], weight[first + 1] = b, reach / (reach + other)
                    return first + 2
    used, total = first, 0.0
    t0, k0 = t, k
    a, b = simplices[t, (k + 1) % 3], simplices[t, (k + 2) % 3]
    px, py = _center(xy[a, 0] - x, xy[a, 1] - y, xy[b, 0] - x, xy[b, 1] - y)
    while True:
        b = simplices[t, (k + 2) % 3]
        lx, ly, area = px, py, 0.0
        k = (k + 1) % 3  # the edge after, which begins at b
        while True:  # turn around b through the cavity
            g = base[t]
            gx, gy = (xy[g, 0] - x) + offset[t, 0], (xy[g, 1] - y) + offset[t, 1]
            area += (lx - px) * (gy - py) - (ly - py) * (gx - px)
            lx, ly = gx, gy
            u = neighbors[t, k]
            if u < 0 or mark[u] != q:
                break
            t = u
            k = 0
            while simplices[t, k] != b:
                k += 1
            k = (k + 2) % 3  # of the two edges at b, the one that begins there
        c = simplices[t, (k + 2) % 3]
        nx, ny = _center(xy[b, 0] - x, xy[b, 1] - y, xy[c, 0] - x, xy[c, 1] - y)
        area += (lx - px) * (ny - py) - (ly - py) * (nx - px)
        vertex[used] = b
        if by_area:
            weight[used] = abs(area)
        else:
            dx, dy = xy[b, 0] - x, xy[b, 1] - y
            weight[used] = np.sqrt(((nx - px) ** 2 + (ny - py) ** 2) / (dx * dx + dy * dy))
        total += weight[used]
        used += 1
        px, py = nx, ny
        if t == t0 and k == k0:
            break
    for i in range(first, used):
        weight[i] /= total
    return used
