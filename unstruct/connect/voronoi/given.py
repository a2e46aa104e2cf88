"""Is a mesh that is given the dual of a diagram? Exactly, and with the name of what is wrong."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.errors import MeshError
from ...mesh import topology
from ...mesh.embedding import RidgeFans
from ...mesh.mesh import Mesh
from ...predicates.batch import orient_rows
from .window import convex_corners

__all__ = ["not_delaunay", "refuse_others"]

REMEDY = "take delaunay(points), or swap_diagonals(mesh) first"


def not_delaunay(mesh: Mesh, cell: int, other: int) -> MeshError:
    """The error for two neighbors one of whose spheres contains the far corner of the other."""
    facet = sorted(set(mesh.simplices[cell].tolist()) & set(mesh.simplices[other].tolist()))
    (across,) = set(mesh.simplices[other].tolist()) - set(facet)
    return MeshError(
        f"the mesh is not Delaunay at facet {facet}, between cells {cell} and {other}: vertex {across} lies "
        f"inside the sphere of cell {cell}, so that the diagram would overlap itself; {REMEDY}"
    )


def refuse_others(mesh: Mesh) -> None:
    """Raise an error for a mesh that does not tile the convex hull of its points by positive cells.

    The local Delaunay property is left to `cospherical_groups`, which looks at each facet anyway. Positive
    cells whose facets match cover a generic point as often as their boundary winds around it; in the plane it
    is enough that the boundary is a convex polygon. O(m) there, otherwise O(m log m).
    """
    points, simplices = mesh.points, mesh.simplices
    turned = np.flatnonzero(orient_rows(points, simplices) <= 0)
    if len(turned):
        raise MeshError(f"cell {turned[0]} of the mesh is flat or turned; use mesh.oriented(), or {REMEDY}")
    count, label = topology.components(mesh.neighbors)
    if count > 1:
        t = int(np.flatnonzero(label > 0)[0])
        raise MeshError(f"the mesh has {count} pieces, cell {t} is not joined to cell 0; {REMEDY}")
    loose = _unused(mesh)
    if len(loose):
        raise MeshError(f"vertex {loose[0]} of the mesh is in no cell, and not a listed copy; {REMEDY}")
    if mesh.dimension == 1 or (mesh.dimension == 2 and _convex_boundary(mesh)):
        return
    fans = RidgeFans(points, simplices, mesh.neighbors)
    for rows, what in (
        (fans.overlaps(), "overlap"),
        (fans.concave(), "leave the hull of the points uncovered"),
    ):
        if len(rows):
            k = int(rows[0])
            at = f"facet {sorted([*fans.ridges[k].tolist(), int(fans.b[k])])}"
            raise MeshError(
                f"the cells of the mesh {what} at {at}; a diagram needs all of the hull: {REMEDY}"
            )


def _convex_boundary(mesh: Mesh) -> bool:
    """Whether the boundary of a planar mesh is one convex polygon."""
    edges = mesh.boundary
    ahead = np.full(len(mesh.points), -1, dtype=np.int64)
    ahead[edges[:, 0]] = edges[:, 1]
    ring = [int(edges[0, 0])]
    while len(ring) <= len(edges) and ahead[ring[-1]] != ring[0]:
        ring.append(int(ahead[ring[-1]]))
    return len(ring) == len(edges) and convex_corners(mesh.points[ring]) is not None


def _unused(mesh: Mesh) -> NDArray[np.int64]:
    """Vertices that are in no cell, and neither listed copies nor hidden."""
    used = np.zeros(len(mesh.points), dtype=bool)
    used[mesh.simplices] = True
    used[mesh.duplicates[:, 0]] = True
    used[mesh.hidden] = True
    return np.flatnonzero(~used)
