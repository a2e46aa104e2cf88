"""Is a surface triangulation Delaunay? Four meanings of the word, each decided exactly.

* *plane-centered*: the sphere through the corners of a triangle with its center in the triangle's plane,
which is the
  least sphere through them, has no vertex of the surface strictly inside. It need not be possible: the four
  faces of the tetrahedron (0,0,0), (4,0,0), (0,4,0), (1,1,1) are the only closed surface with these vertices,
  and (1,1,1) lies inside the sphere of the other three.
* *plane-centered at edges*: the same for the two corners that lie opposite an edge only.
* *intrinsic*: the two angles opposite an edge add up to at most pi. Flips can always reach this, if edges may
  be lines on the surface (`IntrinsicTriangulation`).
* *restricted*: some sphere through the corners with its center on the surface has no vertex strictly inside.
Each
  dense sample of a smooth surface has a triangulation with that property (`restricted_delaunay`).

In a plane the four agree, for convex point sets triangulated as a whole. On a folded edge they differ: let c
and d be the corners opposite edge ab, with d at the distance h from its line, and the center of a, b, c at
the height y above it on the side of c. If the triangles form the angle pi - t, the squared distance of d from
that center is that of a flat edge less 2 y h (1 - cos t). So an edge that is illegal intrinsically violates
the plane-centered criterion, too, if one of its angles is acute; and folding can break, or mend, the
plane-centered criterion where it does not matter to the intrinsic one.

Sources: P. L. George and H. Borouchaki, *Delaunay triangulation and meshing* (1998); N. Amenta and M. Bern,
*Surface reconstruction by Voronoi filtering*, DCG 22 (1999); A. I. Bobenko and B. A. Springborn (2007). Book:
2.7.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ...base.report import Report, problem
from ...geometry.kd_tree import Tree, distance2
from ...mesh.mesh import Mesh
from ...mesh.topology import FaceTable
from ...predicates.batch import power_of_two
from .given import surface_rows
from .restricted import on_surface
from .sphere_signs import cotangent_signs, exact_ball_signs, filter_ball, plane_ball_signs

__all__ = ["SurfaceCriteria", "surface_criteria"]

WIDER_BALL = 1.0 + 1e-5  # for the square of a radius, which is computed to six digits at least
THIN_BALL = 1e-9  # of the longest side squared: triangles with less area are compared with all vertices
DEEP_BALL = 256  # nodes that wait


@dataclass
class SurfaceCriteria:
    """Which triangles and edges of a surface are Delaunay, and in which sense.

    Attributes
    ----------
    plane_centered : (m,) bool
        Triangles whose plane-centered sphere has no vertex of the surface strictly inside.
    culprit : (m,) int32
        For the others a vertex inside, the nearest to the center up to rounding; -1 if there is none.
    restricted : (m,) bool
        Triangles that have an empty sphere with its center on the surface.
    edges : (e, 2) int32
        Edges of exactly two triangles.
    edge_triangles, opposite : (e, 2) int32
        These, and their corners opposite to the edge.
    intrinsic : (e,) bool
        Edges whose two opposite angles add up to at most pi.
    at_edges : (e,) bool
        Edges of which neither opposite corner lies strictly inside the plane-centered sphere of the other
        triangle.
    """

    mesh: Mesh
    plane_centered: NDArray[np.bool_]
    culprit: NDArray[np.int32]
    restricted: NDArray[np.bool_]
    edges: NDArray[np.int32]
    edge_triangles: NDArray[np.int32]
    opposite: NDArray[np.int32]
    intrinsic: NDArray[np.bool_]
    at_edges: NDArray[np.bool_]
    factor: float = field(repr=False)

    def culprits(self, triangle: int) -> NDArray[np.int32]:
        """All vertices strictly inside the plane-centered sphere of a triangle, exactly; O(n)."""
        rows = self.mesh.simplices
        used = np.setdiff1d(rows, rows[triangle])
        same = np.repeat(rows[triangle][None], len(used), axis=0)
        inside = plane_ball_signs(self.mesh.points, self.factor, same, used) < 0
        return used[inside].astype(np.int32)

    @property
    def counts(self) -> dict[str, int]:
        """How many triangles and edges there are, and how many fail each criterion, by name."""
        intrinsic = np.ones(len(self.mesh.simplices), dtype=bool)
        intrinsic[self.edge_triangles[~self.intrinsic]] = False
        return {
            "triangles": len(self.plane_centered),
            "plane-centered": int((~self.plane_centered).sum()),
            "restricted": int((~self.restricted).sum()),
            "inner edges": len(self.edges),
            "plane-centered at edges": int((~self.at_edges).sum()),
            "intrinsic": int((~self.intrinsic).sum()),
            "plane-centered, not intrinsic": int((self.plane_centered & ~intrinsic).sum()),
            "intrinsic, not plane-centered": int((intrinsic & ~self.plane_centered).sum()),
            "restricted, not plane-centered": int((self.restricted & ~self.plane_centered).sum()),
            "plane-centered, not restricted": int((self.plane_centered & ~self.restricted).sum()),
        }

    @property
    def report(self) -> Report:
        """The same as a `Report`, with the culprits of the plane-centered and of the other criteria."""
        found = Report(f"{len(self.plane_centered)} triangles on a surface")
        bad = ~self.plane_centered
        found.note(
            "plane-centered spheres are empty",
            problem("plane-centered", "spheres with vertices inside", np.flatnonzero(bad), self.culprit[bad]),
        )
        for name, text, good in (
            ("at edges", "corners inside the plane-centered sphere of the neighbor", self.at_edges),
            ("intrinsic", "edges whose opposite angles add up to more than pi", self.intrinsic),
        ):
            cells, ends = self.edge_triangles[~good].ravel(), self.edges[~good].ravel()
            found.note(f"{name}: no {text}", problem(name, text, cells, ends))
        text = "triangles without an empty sphere centered on the surface"
        found.note(f"no {text}", problem("restricted", text, np.flatnonzero(~self.restricted)))
        return found

    def __str__(self) -> str:
        c = self.counts
        lines = [f"{c['triangles']} triangles, {c['inner edges']} inner edges; not Delaunay are"]
        kinds = {"plane-centered": "triangles", "restricted": "triangles"}
        for name in ("plane-centered", "restricted", "plane-centered at edges", "intrinsic"):
            lines.append(f"  {c[name]:>8} {kinds.get(name, 'edges'):9} {name}")
        lines.append("  triangles that satisfy one criterion and not another:")
        lines += [f"  {value:>8} {name}" for name, value in c.items() if ", not " in name]
        return "\n".join(lines)


@kernel
def _plane_balls(xyz, rows, first, vertex, tree, culprit, doubt):
    """Find vertices inside plane-centered spheres, from triangle ``first`` on.

    (the triangle to go on with, pairs): pairs of triangles and vertices that only exact signs can decide are
    written to ``doubt`` where no vertex is surely inside; the kernel stops when there is no more room.
    """
    order, start, size, low, high = tree
    stack = np.empty(DEEP_BALL, dtype=np.int64)
    center = np.empty(3)
    count = 0
    for t in range(first, rows.shape[0]):
        a, b, c = rows[t, 0], rows[t, 1], rows[t, 2]
        for _ in range(2):  # the corner opposite the longest side comes first
            if _square(xyz, b, c) < max(_square(xyz, a, b), _square(xyz, c, a)):
                a, b, c = b, c, a
        radius = _center(xyz, a, b, c, center) * WIDER_BALL
        begin, best = count, np.inf
        stack[0], top = 0, 1
        while top > 0:
            top -= 1
            node = stack[top]
            if distance2(low, high, node, center) > radius:
                continue
            if 2 * node + 2 < start.shape[0]:
                stack[top], stack[top + 1] = 2 * node + 1, 2 * node + 2
                top += 2
                continue
            for i in range(start[node], start[node] + size[node]):
                p = vertex[order[i]]
                if p == a or p == b or p == c:
                    continue
                sign = filter_ball(xyz, a, b, c, p)
                if sign > 0:
                    continue
                if sign == 0:
                    if count == doubt.shape[0]:
                        return t, begin
                    doubt[count, 0], doubt[count, 1] = t, p
                    count += 1
                    continue
                away = 0.0
                for k in range(3):
                    away += (xyz[p, k] - center[k]) ** 2
                if not away >= best:
                    best, culprit[t] = away, p
                    radius = min(radius, away * WIDER_BALL)
        if culprit[t] >= 0:
            count = begin
    return rows.shape[0], count


@kernel
def _square(xyz, a, b):
    return (xyz[a, 0] - xyz[b, 0]) ** 2 + (xyz[a, 1] - xyz[b, 1]) ** 2 + (xyz[a, 2] - xyz[b, 2]) ** 2


@kernel
def _center(xyz, a, b, c, center):
    """Write the circumcenter of a triangle; its squared radius, infinite if the triangle is too thin."""
    ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    vx, vy, vz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    one, two = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    square = nx * nx + ny * ny + nz * nz
    far = _square(xyz, b, c)
    if not square > (2.0 * THIN_BALL * far) ** 2 or square < 1e-200:
        for k in range(3):
            center[k] = xyz[a, k]
        return np.inf
    s, t = one / (2.0 * square), two / (2.0 * square)
    x = s * (vy * nz - vz * ny) + t * (ny * uz - nz * uy)
    y = s * (vz * nx - vx * nz) + t * (nz * ux - nx * uz)
    z = s * (vx * ny - vy * nx) + t * (nx * uy - ny * ux)
    center[0], center[1], center[2] = xyz[a, 0] + x, xyz[a, 1] + y, xyz[a, 2] + z
    return x * x + y * y + z * z + 1e-12 * (xyz[a, 0] ** 2 + xyz[a, 1] ** 2 + xyz[a, 2] ** 2)


def plane_centered(points: NDArray[np.float64], rows: NDArray[np.int32]) -> NDArray[np.int32]:
    """A vertex strictly inside the plane-centered sphere of each triangle, -1 where there is none; exact.

    Notes
    -----
    O(m log n) for a surface of triangles that are not far larger than their surroundings; triangles that are
    thinner than a billionth of their length are compared with all vertices.
    """
    factor = power_of_two(points)
    xyz = np.ascontiguousarray(points * factor)
    used = np.unique(rows)
    kd = Tree.of(xyz[used])
    tree = (kd.order, kd.start, kd.size, kd.low, kd.high)
    culprit = np.full(len(rows), -1, dtype=np.int32)
    pairs, first = [], 0
    doubt = np.empty((4 * len(rows) + len(used) + 64, 2), dtype=np.int64)
    while first < len(rows):
        first, count = _plane_balls(xyz, rows, first, used, tree, culprit, doubt)
        pairs.append(doubt[:count].copy())
    t, p = np.concatenate([*pairs, np.empty((0, 2), dtype=np.int64)]).T
    inside = exact_ball_signs(points, rows[t], p) < 0
    culprit[t[inside]] = p[inside]
    return culprit


def inner_edges(rows: NDArray[np.int32]) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]:
    """Edges of exactly two triangles: their ends, the triangles, the opposite corners, each (e, 2)."""
    edges, number = FaceTable(rows).facets()
    order = np.argsort(number.ravel(), kind="stable")
    where = number.ravel()[order]
    count = np.bincount(where, minlength=len(edges))
    two = np.flatnonzero(count == 2)
    begin = (np.cumsum(count) - count)[two]
    places = np.stack([order[begin], order[begin + 1]], axis=1)
    return edges[two].astype(np.int32), (places // 3).astype(np.int32), rows.ravel()[places].astype(np.int32)


def surface_criteria(surface: Mesh) -> SurfaceCriteria:
    """Which triangles and edges of a surface are Delaunay, in four senses, each decided exactly.

    Parameters
    ----------
    surface : Mesh
        Triangles in space, none of them flat; they may have a boundary, and edges of more than two triangles.

    Returns
    -------
    SurfaceCriteria
        Prints as a table; ``report`` is a `Report` with culprits.

    Raises
    ------
    InputError
        For another thing than triangles in space.
    MeshError
        For flat triangles.

    Notes
    -----
    O(n log n) for surfaces that are sampled as densely as their surroundings. Book: 2.7.
    """
    points, rows = surface_rows(surface)
    factor = power_of_two(points)
    culprit = plane_centered(points, rows)
    edges, pairs, opposite = inner_edges(rows)
    legal = cotangent_signs(points, factor, edges, opposite) >= 0
    good = np.ones(len(edges), dtype=bool)
    for k in range(2):
        good &= plane_ball_signs(points, factor, rows[pairs[:, k]], opposite[:, 1 - k]) >= 0
    restricted = on_surface(points, rows, culprit < 0)
    return SurfaceCriteria(
        surface, culprit < 0, culprit, restricted, edges, pairs, opposite, legal, good, factor
    )
