"""Restricted Delaunay triangulation: triangles that have an empty sphere with its center on a surface.

A triangle of the Delaunay mesh of points belongs to it if its Voronoi edge meets the surface. If each point x
of a smooth closed surface has a sample point within e times its *local feature size*, which is its distance
from the medial axis, and e is small (0.3 is proved to do for closed balls; see the sources), the triangles
are a surface homeomorphic to the given one. With too few points it may be anything; `RestrictedDelaunay` says
what it is.

Sources: H. Edelsbrunner and N. R. Shah, *Triangulating topological spaces*, IJCGA 7 (1997); N. Amenta and
M. Bern, *Surface reconstruction by Voronoi filtering*, DCG 22 (1999); J.-D. Boissonnat and S. Oudot,
*Provably good sampling and meshing of surfaces*, Graphical Models 67 (2005). Book: 2.7.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arrays import as_numbers, as_points
from ...base.asking import asked_at
from ...base.errors import DegenerateInputError, InputError
from ...base.report import Report, problem
from ...geometry.boxes import BoxTree, bounding_boxes
from ...geometry.simplex import circumcenter
from ...mesh import topology
from ...mesh.manifold import crowded_facets, incoherent_facets, pinched_faces
from ...mesh.mesh import Mesh
from ..insertion.delaunay import delaunay
from .crossing import Duals, centers_of, dual_crossings, in_triangle, plane_center, unit_normals
from .given import surface_rows
from .sphere_signs import as_integers, signs_of
from .tied import tied_triangles

__all__ = ["RestrictedDelaunay", "on_surface", "restricted_delaunay"]

Array = NDArray[np.float64]
Implicit = Callable[[Array], ArrayLike]
FAR_RAY = 8.0  # how far rays are followed, in units of the size of everything
DUAL_BISECTIONS = 60


@dataclass
class RestrictedDelaunay:
    """The restricted Delaunay triangulation, and what it is.

    Attributes
    ----------
    mesh : Mesh
        The triangles, on all points, each turned as the surface is at the center of its ball.
    centers : (m, 3) float64
        The center of a ball through the corners of each triangle that lies on the surface and has no point
        strictly inside: where the Voronoi edge meets the surface, nearest to the triangle's plane.
    radii : (m,) float64
    crossings : (m,) int64
        How many triangles of the surface the Voronoi edge meets (1 for a function).
    tetrahedra : Mesh
        The Delaunay mesh of the points.
    """

    mesh: Mesh
    centers: Array
    radii: Array
    crossings: NDArray[np.int64]
    tetrahedra: Mesh

    @property
    def report(self) -> Report:
        """Whether the triangles are a closed surface, and which edges and vertices are against it."""
        rows = self.mesh.simplices
        found = Report(f"{len(rows)} triangles with empty balls centered on the surface")
        table = topology.FaceTable(rows)
        edges, number = table.facets()
        count = np.bincount(number.ravel(), minlength=len(edges))
        open_, (many, _) = edges[count == 1], crowded_facets(table)
        turned, _ = incoherent_facets(table)
        found.note(
            "each edge belongs to two triangles",
            problem("open", "edges of one triangle", vertices=open_.ravel()),
            problem("crowded", "edges of more than two triangles", vertices=many.ravel()),
        )
        found.note(
            "neighbors are turned in the same direction",
            problem(
                "turned", "edges that two triangles run through in one direction", vertices=turned.ravel()
            ),
        )
        unused = np.setdiff1d(np.arange(len(self.mesh.points)), rows)
        found.note("all points are used", problem("unused", "points without a triangle", vertices=unused))
        if len(many) == 0:
            pinched = pinched_faces(table, table.neighbors())[0][0]
            found.note(
                "the triangles around a vertex are one fan",
                problem("pinched", "vertices with several fans", vertices=pinched.ravel()),
            )
        else:
            found.skipped.append("fans around vertices, because of crowded edges")
        return found

    @property
    def manifold(self) -> bool:
        """Whether the triangles are a closed surface that uses all points."""
        return bool(self.report) and len(self.mesh.simplices) > 0

    @property
    def euler_characteristic(self) -> int:
        """Vertices less edges plus triangles: 2 for a sphere, 0 for a torus."""
        return self.mesh.euler_characteristic

    @property
    def components(self) -> int:
        """How many pieces the triangles form, connected through vertices."""
        edges = topology.edges(self.mesh.simplices)
        used, rows = np.unique(edges, return_inverse=True)
        parent = np.arange(len(used))
        for a, b in rows.reshape(-1, 2).tolist():
            while parent[a] != a:
                a = parent[a]
            while parent[b] != b:
                b = parent[b]
            parent[max(a, b)] = min(a, b)
        return int((parent == np.arange(len(used))).sum())

    def __str__(self) -> str:
        kind = "a closed surface" if self.manifold else "no closed surface"
        return (
            f"{len(self.mesh.simplices)} triangles, {kind}: Euler characteristic "
            f"{self.euler_characteristic}, {self.components} component(s)"
        )


def duals_of(points: Array, mesh: Mesh, far: float) -> Duals:
    """The Voronoi edges of a Delaunay mesh; rays are cut at the distance ``far`` from their beginning."""
    tets, beyond = np.asarray(mesh.simplices), np.asarray(mesh.neighbors)
    center, off = centers_of(points, tets)
    t, i = np.nonzero((beyond < 0) | (beyond > np.arange(len(tets))[:, None]))
    other = beyond[t, i]
    faces = topology.oriented_facet(tets, t, i).astype(np.int32)
    outward = unit_normals(points[faces])
    start, inner = center[t], other >= 0
    end = np.where(inner[:, None], center[np.maximum(other, 0)], start + far * outward)
    blur = np.maximum(off[t], np.where(inner, off[np.maximum(other, 0)], off[t] + 1e-8 * far))
    return Duals(faces, np.stack([t, other], axis=1).astype(np.int32), start, end, blur)


def restricted_delaunay(points: ArrayLike, surface: Mesh | Implicit) -> RestrictedDelaunay:
    """The triangles of points on a surface that have an empty ball with its center on the surface.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        On the surface or near it, not all in one plane.
    surface : Mesh or function
        Triangles in space, none of them flat; or a function (k, 3) -> (k,) that is negative inside of the
        surface and positive outside.

    Returns
    -------
    RestrictedDelaunay

    Raises
    ------
    InputError
        For points that are none in space, and a surface that is neither.
    DegenerateInputError
        If all points lie in a plane: their planar Delaunay triangulation is then what is meant.

    Notes
    -----
    Of triangles, all crossings are found, exactly. A function is only looked at where Voronoi edges end: a
    Voronoi edge counts that ends on different sides; one that meets the surface twice does not. Where five
    or more points lie on a sphere, the Delaunay mesh is one of several, and so is this one. O(n log n) for
    samples of surfaces, as long as the Delaunay mesh has O(n) tetrahedra.
    """
    x = as_points(points)
    if x.shape[1] != 3:
        raise InputError(f"points must be points in space, rows of three numbers, not of {x.shape[1]}")
    if not isinstance(surface, Mesh) and not callable(surface):
        raise InputError("surface must be a Mesh of triangles in space, or a function of points")
    mesh = delaunay(x)
    span = float(np.ptp(x, axis=0).max())
    if isinstance(surface, Mesh):
        other, rows = surface_rows(surface)
        corner = other[rows]
        span = float(np.ptp(np.concatenate([x, other]), axis=0).max())
        duals = duals_of(x, mesh, _far(x, mesh, span))
        pairs = dual_crossings(x, np.asarray(mesh.simplices), duals, corner)
        return _from_triangles(mesh, duals, pairs, corner)
    duals = duals_of(x, mesh, _far(x, mesh, span))
    return _from_function(mesh, duals, surface)


def _far(x: Array, mesh: Mesh, span: float) -> float:
    """A length of rays beyond everything: centers of slivers at the hull may be far on the other side."""
    center, _ = centers_of(x, np.asarray(mesh.simplices)[(np.asarray(mesh.neighbors) < 0).any(axis=1)])
    middle = (x.max(axis=0) + x.min(axis=0)) / 2
    return FAR_RAY * span + float(np.sqrt(((center - middle) ** 2).sum(axis=1)).max(initial=0.0))


def _from_triangles(mesh: Mesh, duals: Duals, pairs: NDArray[np.int64], corner: Array) -> RestrictedDelaunay:
    f, t = pairs.T
    one, two, n = duals.start[f], duals.end[f], unit_normals(corner[t])
    h1, h2 = ((one - corner[t, 0]) * n).sum(axis=1), ((two - corner[t, 0]) * n).sum(axis=1)
    part = np.clip(np.where(h1 != h2, h1 / np.where(h1 != h2, h1 - h2, 1.0), 0.5), 0.0, 1.0)
    place = one + part[:, None] * (two - one)
    corners = mesh.points[duals.faces[f]]
    radius = np.sqrt(((place - corners[:, 0]) ** 2).sum(axis=1))
    order = np.lexsort((radius, f))
    head = np.ones(len(order), dtype=bool)
    head[1:] = f[order][1:] != f[order][:-1]
    best = order[head]
    rows = duals.faces[f[best]].copy()
    facing = (unit_normals(mesh.points[rows]) * n[best]).sum(axis=1)
    rows[facing < 0] = rows[facing < 0][:, [0, 2, 1]]
    count = np.bincount(f, minlength=1)[f[best]]
    return RestrictedDelaunay(Mesh(mesh.points, rows), place[best], radius[best], count, mesh)


def _values(function: Implicit, x: Array) -> Array:
    takes = "points (k, 3) and returns k numbers, negative inside"
    raw = asked_at(function, x, "the function surface", takes)
    found = as_numbers(raw, "values of the function surface")
    if found.shape != (len(x),):
        raise InputError(f"surface must return one number for each of {len(x)} points, not {found.shape}")
    wrong = np.flatnonzero(np.isnan(found))
    if len(wrong):
        place = x[wrong[0]].tolist()
        raise InputError(f"the function surface returned nan at {place}: it must have a sign everywhere")
    return found


def _from_function(mesh: Mesh, duals: Duals, function: Implicit) -> RestrictedDelaunay:
    first, last = _values(function, duals.start), _values(function, duals.end)
    f = np.flatnonzero((first < 0) != (last < 0))
    low, high, below = duals.start[f].copy(), duals.end[f].copy(), first[f] < 0
    for _ in range(DUAL_BISECTIONS):
        middle = low + (high - low) / 2
        same = (_values(function, middle) < 0) == below
        low[same], high[~same] = middle[same], middle[~same]
    rows = duals.faces[f].copy()
    rows[~below] = rows[~below][:, [0, 2, 1]]  # faces are turned from the first cell to the second
    radius = np.sqrt(((low - mesh.points[rows[:, 0]]) ** 2).sum(axis=1))
    return RestrictedDelaunay(Mesh(mesh.points, rows), low, radius, np.ones(len(f), np.int64), mesh)


def on_surface(points: Array, rows: NDArray[np.int32], empty: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether triangles of a surface have an empty sphere with its center on the surface, exactly.

    Parameters
    ----------
    points : (n, 3)
    rows : (m, 3)
        The triangles, none of them flat.
    empty : (m,) bool
        Whether their plane-centered spheres are empty: then this is one if the center is in the triangle.

    Notes
    -----
    Others must be faces of the Delaunay mesh whose Voronoi edge meets the surface, or of another Delaunay
    mesh where more than four vertices lie on an empty sphere (`tied_triangles`).
    """
    found = empty & _center_inside(points, rows)
    used, number = np.unique(rows, return_inverse=True)
    x, local = np.ascontiguousarray(points[used]), number.reshape(-1, 3)
    try:
        mesh = delaunay(x) if len(x) > 3 else None
    except DegenerateInputError:
        mesh = None
    if mesh is None:  # all in one plane, where centers must lie in the plane of the triangles
        return found | empty & _center_anywhere(points, rows)
    kept = np.arange(len(x))
    kept[mesh.duplicates[:, 0]] = mesh.duplicates[:, 1]
    span = float(np.ptp(x, axis=0).max())
    duals = duals_of(x, mesh, _far(x, mesh, span))
    keys = np.sort(kept[local], axis=1)
    faces = np.sort(duals.faces, axis=1)
    count = np.int64(len(x))
    packed = (faces[:, 0] * count + faces[:, 1]) * count + faces[:, 2]
    wanted = (keys[:, 0] * count + keys[:, 1]) * count + keys[:, 2]
    order = np.argsort(packed)
    at = np.minimum(np.searchsorted(packed[order], wanted), len(order) - 1)
    face = np.where(packed[order][at] == wanted, order[at], -1)
    open_ = np.flatnonzero((face >= 0) & ~found)
    if len(open_):
        some = face[open_]
        part = Duals(
            duals.faces[some], duals.cells[some], duals.start[some], duals.end[some], duals.blur[some]
        )
        pairs = dual_crossings(x, np.asarray(mesh.simplices), part, x[local])
        found[open_[np.unique(pairs[:, 0])]] = True
    others = np.flatnonzero((face < 0) & ~found)
    found[others] = tied_triangles(mesh, kept[local[others]], x[local])
    return found


def _center_inside(points: Array, rows: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Whether triangles have no obtuse angle, exactly: the center is then in the closed triangle."""
    result = np.ones(len(rows), dtype=bool)
    for k in range(3):
        a, b, c = rows[:, k], rows[:, k - 2], rows[:, k - 1]
        u, v = points[b] - points[a], points[c] - points[a]
        value = u[:, 0] * v[:, 0] + u[:, 1] * v[:, 1] + u[:, 2] * v[:, 2]
        size = np.abs(u[:, 0] * v[:, 0]) + np.abs(u[:, 1] * v[:, 1]) + np.abs(u[:, 2] * v[:, 2])
        sure = np.abs(value) > 2.0**-49 * size
        sign = signs_of(value)
        left = np.flatnonzero(~sure)
        if len(left):
            p, q, r = as_integers(points, a[left], b[left], c[left])
            exact = ((q - p) * (r - p)).sum(axis=1)
            sign[left] = signs_of(exact)
        result &= sign >= 0
    return result


def _center_anywhere(points: Array, rows: NDArray[np.int32]) -> NDArray[np.bool_]:
    """For triangles in one plane: whether the circumcenter of each lies in any of them, exactly."""
    corner = points[rows]
    center = circumcenter(corner)
    reach = 1e-6 * (np.abs(center - corner[:, 0]) + np.abs(corner[:, 0])).max(axis=1)[:, None]
    thin = ~np.isfinite(center).all(axis=1)
    center[thin], reach[thin] = 0.0, np.inf
    which, other = BoxTree(*bounding_boxes(corner)).pairs(center - reach, center + reach)
    found = np.zeros(len(rows), dtype=bool)
    known: dict[int, list[Fraction]] = {}
    for t, s in zip(which.tolist(), other.tolist()):
        if t not in known:
            known[t] = plane_center(corner[t])
        found[t] = found[t] or in_triangle(known[t], corner[s])
    return found
