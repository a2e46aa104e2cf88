"""Normals and curvatures at the vertices of a surface.

Curvatures are positive where the surface bends away from its normals, as a sphere does whose normals point
outward.

Sources: M. Meyer, M. Desbrun, P. Schroeder and A. H. Barr, *Discrete differential-geometry operators for
triangulated 2-manifolds* (2003); A. I. Bobenko and B. A. Springborn, *A discrete Laplace-Beltrami operator
for simplicial surfaces*, DCG 38 (2007); J. Goldfeather and V. Interrante, *A novel cubic-order algorithm for
approximating principal direction vectors*, ACM Trans. Graphics 23 (2004); G. Thuermer and C. A. Wuethrich,
*Computing vertex normals from polygonal facets*, J. Graphics Tools 3 (1998). Book: 2.7.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError, MeshError
from ...mesh.manifold import incoherent_facets
from ...mesh.topology import FaceTable, vertex_neighbors
from .fitting import fit_surfaces
from .given import surface_rows
from .intrinsic import IntrinsicTriangulation

__all__ = ["Curvature", "curvature"]

Array = NDArray[np.float64]


class Curvature(NamedTuple):
    """Normals and curvatures of a surface at its vertices.

    All are nan at vertices that no triangle uses. Principal curvatures and directions are nan, and at the
    boundary so are the others, where fewer than five vertices are near or no quadric is determined by them.

    Attributes
    ----------
    normals : (n, 3) float64
        Unit normals: the sum of those of the triangles around, weighted by their angles or areas.
    gaussian, mean : (n,) float64
        At inner vertices integrated values over areas: 2 pi less the angles around, and the cotangent
        Laplacian of the position, both over the area of the vertex. At boundary vertices from the fitted
        surface.
    principal : (n, 2) float64
        The greater and the lesser principal curvature of a cubic surface that is fitted to the vertices up to
        two edges away; of a quadric, if these are too few or lie on one.
    directions : (n, 2, 3) float64
        Their unit directions, orthogonal to each other; where both are equal, any.
    areas : (n,) float64
        The area that belongs to each vertex; they add up to that of the surface. Circumcentric, and thirds of
        triangles where these would be negative at a boundary.
    boundary : (n,) bool
        Vertices where the surface ends, or is no surface.
    """

    normals: Array
    gaussian: Array
    mean: Array
    principal: Array
    directions: Array
    areas: Array
    boundary: NDArray[np.bool_]


def curvature(surface: Any, *, weights: str = "angle") -> Curvature:
    """Normals, Gaussian, mean and principal curvatures at the vertices of a surface.

    Parameters
    ----------
    surface : Mesh
        Triangles in space, none of them flat, neighbors turned in the same direction; it may have a boundary.
    weights : "angle" or "area"
        Of the triangles around a vertex in its normal.

    Returns
    -------
    Curvature
        In units of one over those of the coordinates (squared for the Gaussian curvature). Positive where the
        surface bends away from its normals.

    Raises
    ------
    InputError
        For another thing than triangles in space, and other weights.
    MeshError
        For flat triangles, for neighbors that are turned in opposite directions, and if triangles do not
        share their vertices, as in a file of STL.

    Notes
    -----
    Areas and squared curvatures that a double cannot hold, of coordinates beyond 1e150 or so, are inf or 0.
    `gaussian` times `areas` has the sum 2 pi times the Euler characteristic on a closed surface, up to
    rounding (Gauss and Bonnet), however coarse it is. Areas and the Laplacian are those of the intrinsic
    Delaunay triangulation: no weight is negative, and the values do not depend on bad triangles. Pointwise
    they need not converge where vertices are placed irregularly; `principal` does, for vertices exactly on a
    smooth surface: with the square of the edge length if the neighborhood is even or the fit is cubic, else
    with its first power. Across creases nothing converges. O(n). Book: 2.7.

    Examples
    --------
    >>> found = unstruct.curvature(sphere)
    >>> found.principal.mean(axis=0)            # 1 / radius twice
    """
    points, rows = surface_rows(surface)
    if not isinstance(weights, str) or weights not in ("angle", "area"):
        raise InputError(f'weights must be "angle" or "area", not {weights!r:.60}')
    turned, _ = incoherent_facets(FaceTable(rows))
    if len(turned):
        raise MeshError(
            f"the triangles at edge {turned[0].tolist()} are turned in opposite directions ({len(turned)} "
            "such edges): reverse one of each such pair"
        )
    if (
        len(rows) > 1
        and np.bincount(rows.ravel()).max() == 1
        and len(np.unique(points, axis=0)) < len(points)
    ):
        raise MeshError(
            "no two triangles share a vertex, but some have corners in the same place, as in a file of STL: "
            "merge equal points first, as unstruct.remesh and Domain.surface do"
        )
    found = IntrinsicTriangulation(surface)
    factor = found.factor
    xyz = points * factor
    angles, doubled, units = _triangles(xyz, rows)
    share = angles if weights == "angle" else doubled[:, None].repeat(3, axis=1)
    normals = _unit(_added(rows, share[:, :, None] * units[:, None, :], len(xyz)))
    around = np.bincount(rows.ravel(), angles.ravel(), len(xyz))
    found.delaunay()
    areas, bend = _laplacian(found, xyz)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = (bend * normals).sum(axis=1) / (2.0 * areas)
        gaussian = (2.0 * np.pi - around) / areas
    ends = _ends(found, rows, len(xyz))
    start, joined = vertex_neighbors(rows, len(xyz))
    principal, directions = fit_surfaces(xyz, normals, start, joined)
    gaussian[ends] = principal[ends, 0] * principal[ends, 1]
    mean[ends] = (principal[ends, 0] + principal[ends, 1]) / 2.0
    with np.errstate(over="ignore", under="ignore"):
        gaussian, areas = gaussian * factor * factor, areas / factor / factor
    return Curvature(normals, gaussian, mean * factor, principal * factor, directions, areas, ends)


def _triangles(xyz: Array, rows: NDArray[np.int32]) -> tuple[Array, Array, Array]:
    """Angles (m, 3), doubled areas (m,) and unit normals (m, 3)."""
    corner = xyz[rows]
    angles = np.empty(rows.shape)
    for k in range(3):
        u, v = corner[:, k - 2] - corner[:, k], corner[:, k - 1] - corner[:, k]
        normal = _cross(u, v)
        size = np.sqrt(_dot(normal, normal))
        angles[:, k] = np.arctan2(size, _dot(u, v))
    return angles, size, normal / np.where(size > 0.0, size, 1.0)[:, None]


def _dot(u: Array, v: Array) -> Array:
    return u[:, 0] * v[:, 0] + u[:, 1] * v[:, 1] + u[:, 2] * v[:, 2]


def _cross(u: Array, v: Array) -> Array:
    parts = [u[:, k - 2] * v[:, k - 1] - u[:, k - 1] * v[:, k - 2] for k in range(3)]
    return np.stack(parts, axis=1)


def _unit(x: Array) -> Array:
    size = np.sqrt(_dot(x, x))
    with np.errstate(invalid="ignore", divide="ignore"):
        return x / size[:, None]


def _added(rows: NDArray, values: Array, n: int) -> Array:
    """Sums over corners: values (m, 3, 3) for the corners of each row, added at their vertices."""
    flat = values.reshape(-1, 3)
    return np.stack([np.bincount(rows.ravel(), flat[:, k], n) for k in range(3)], axis=1)


def _laplacian(found: IntrinsicTriangulation, xyz: Array) -> tuple[Array, Array]:
    """The circumcentric area of each given vertex, and the integral of twice the mean curvature normal."""
    sides, n = found.sides, len(xyz)
    vertex = found.gluing.origin[sides.vertex]
    h = np.arange(len(vertex))
    after, before = np.where(h % 3 == 2, h - 2, h + 1), np.where(h % 3 == 0, h + 2, h - 1)
    square = sides.length[after] ** 2 + sides.length[before] ** 2 - sides.length[h] ** 2
    half = square / sides.content[h // 3] / 2.0  # half of the cotangent opposite
    a, b = vertex, vertex[after]
    away = (xyz[a] - xyz[b]) * half[:, None]
    areas = _vertex_areas(vertex, sides.length**2 * half / 4.0, sides.content / 4.0, n)
    bend = [np.bincount(a, away[:, k], n) - np.bincount(b, away[:, k], n) for k in range(3)]
    return areas, np.stack(bend, axis=1).astype(np.float64)


def _vertex_areas(vertex: NDArray[np.int32], part: Array, area: Array, n: int) -> Array:
    """Areas of vertices: circumcentric parts of triangles, thirds where one would not be positive.

    ``part`` is what each half-edge gives to either end. Parts may be negative at boundary edges opposite
    obtuse angles. Thirds are positive, so that this ends.
    """
    after = vertex.reshape(-1, 3)[:, [1, 2, 0]].ravel()
    used, thirds = np.bincount(vertex, minlength=n) > 0, np.zeros(len(area), dtype=bool)
    while True:
        mine = np.where(np.repeat(thirds, 3), 0.0, part)
        third = np.repeat(np.where(thirds, area / 3.0, 0.0), 3)
        found = np.bincount(vertex, mine + third, n) + np.bincount(after, mine, n)
        bad = used & ~(found > 0.0)
        if not bad.any() or thirds.all():
            return np.asarray(found, dtype=np.float64)
        thirds |= bad[vertex].reshape(-1, 3).any(axis=1)


def _ends(found: IntrinsicTriangulation, rows: NDArray[np.int32], n: int) -> NDArray[np.bool_]:
    """Vertices at edges without a twin, and those with several fans."""
    ends = np.zeros(n, dtype=bool)
    h = np.flatnonzero(found.gluing.twin < 0)
    flat = rows.ravel()
    ends[flat[h]] = True
    ends[flat[np.where(h % 3 == 2, h - 2, h + 1)]] = True
    ends[found.gluing.origin[n:]] = True
    return ends
