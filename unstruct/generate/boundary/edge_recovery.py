"""Weatherill and Hassan's way to a boundary (12.2.5): recover missing edges, then remove the outside.

The vertices are triangulated first, without regard to the boundary. Then missing edges of the boundary are
inserted, and the triangles outside are deleted. In the plane edges can always be inserted without new points,
whatever the triangulation is, because the two polygons beside an edge have triangulations. See the book, 2.5.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.errors import InputError, MeshError
from ...connect.insertion.halfedges import GHOST
from ...connect.planar.complex import BUSY, COUNT, FREE, VERTICES, PlanarComplex
from ...connect.planar.flood import mark_regions
from ...connect.planar.inserting import insert_all
from ...connect.planar.segments import absent, fill_corners
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh
from ...mesh.marked import remaining_of
from ...mesh.mesh import Mesh, is_planar
from ...mesh.topology import as_simplices, twins
from ...predicates.batch import power_of_two, scaled

__all__ = ["complex_of_mesh", "recover_edges", "remove_outside"]


def recover_edges(mesh: Mesh, edges: ArrayLike) -> DomainMesh:
    """Insert edges into a planar triangulation, Delaunay or not, without new points.

    Parameters
    ----------
    mesh : Mesh
        Positively oriented triangles in the plane.
    edges : array_like of int, shape (s, 2)
        Pairs of vertices that are to be joined.

    Returns
    -------
    DomainMesh
        The same points. ``segments`` are the parts of the edges (a vertex that lies on an edge splits it),
        and ``piece`` contains the row of ``edges`` of each part; the parts are also the marker "recovered".
        ``counts``: "missing" is the number of edges that were not in the mesh, "crossed" that of the
        triangles that were replaced, and "split" that of the edges with vertices on them. ``steps``: which
        edges were "missing", and how many triangles each edge "crossed" when it was inserted (none, if an
        earlier edge had produced it). Markers of cells are dropped if any cell has changed. Marked edges are
        kept if they are still edges.

    Raises
    ------
    InputError
        For edges that cross or overlap, that leave the mesh, or that have an end in no triangle.
    MeshError
        If the mesh is no triangulation in the plane, or pinched at a vertex.

    Notes
    -----
    Exact. If the mesh was (constrained) Delaunay, the result is constrained Delaunay. Otherwise it is valid,
    but constrained Delaunay only in the polygons beside the new edges; `swap_diagonals` with
    ``constrained="recovered"`` makes it so everywhere. O(m), and for an edge across k triangles O(k log k) in
    practice. Source: N. P. Weatherill, O. Hassan, International Journal for Numerical Methods in
    Engineering 37 (1994) 2005-2039, in three dimensions. Book: 2.5.
    """
    rows = _edges(mesh, edges)
    complex_ = complex_of_mesh(mesh)
    span, missing = np.tile([0.0, 1.0], (len(rows), 1)), np.empty(len(rows), dtype=bool)
    corner = np.empty(len(mesh.points), dtype=np.int32)
    fill_corners(complex_.vertex, len(complex_.vertex), corner)
    absent(complex_.vertex, complex_.twin, corner, rows, missing)
    crossed = insert_all(complex_, rows, np.arange(len(rows), dtype=np.int32), span, facets=-1)
    m, parts = mesh.size, complex_.ends
    simplices = complex_.vertex[: 3 * m].reshape(-1, 3)
    neighbors = complex_.twin[: 3 * m].reshape(-1, 3) // 3
    neighbors[neighbors >= m] = -1
    changed = crossed.any()
    faces = {name: rows for name, rows in mesh.markers.items() if rows.ndim > 1}
    faces = remaining_of(faces, simplices)
    markers = {
        name: values if values.ndim == 1 else faces[name]
        for name, values in mesh.markers.items()
        if not (changed and values.ndim == 1)
    }
    return DomainMesh(
        mesh.points,
        simplices,
        neighbors=neighbors,
        origin=mesh.origin,
        duplicates=mesh.duplicates,
        markers={**markers, "recovered": parts},
        regions=mesh.regions if "region" in markers else None,
        periodic=mesh.periodic,
        segments=parts,
        piece=complex_.piece,
        span=complex_.span,
        counts={
            "missing": int(missing.sum()),
            "crossed": int(crossed.sum()),
            "split": int((np.bincount(complex_.piece, minlength=len(rows)) > 1).sum()),
        },
        steps={"missing": missing, "crossed": crossed},
    )


def remove_outside(mesh: Mesh, domain: Domain) -> DomainMesh:
    """Delete the triangles outside of a domain from a mesh that contains its boundary.

    Parameters
    ----------
    mesh : Mesh
        A connected mesh in which every piece of ``domain.sampled()`` is an edge or a chain of edges (see
        `recover_edges`). Its vertices are matched by their coordinates.
    domain : Domain

    Returns
    -------
    DomainMesh
        The cells inside by the even-odd rule. They are found by flooding from beyond the boundary; no point
        is tested, so nothing is rounded. Markers and regions are as in `unstruct.constrained_delaunay`.
        ``counts``: "removed cells", "removed vertices".

    Raises
    ------
    InputError
        If a vertex or an edge of the boundary is missing.
    MeshError
        As for `recover_edges`.
    """
    sampled, facets = domain.sampled(), len(domain.facets)
    if not facets:
        raise InputError("the domain has no facets, so nothing is inside: give facets")
    place = _match(mesh, sampled.points)
    lost = np.flatnonzero(place[sampled.ends].min(axis=1) < 0)
    if len(lost):
        raise InputError(
            f"{domain.name(int(sampled.piece[lost[0]]))} has an end that is no vertex of the mesh: "
            "triangulate the points of domain.sampled()"
        )
    complex_ = complex_of_mesh(mesh)
    crossed = insert_all(complex_, place[sampled.ends], sampled.piece, sampled.span, facets=facets)
    if crossed.any():
        piece = domain.name(int(sampled.piece[np.argmax(crossed > 0)]))
        raise InputError(
            f"{piece} is not an edge of the mesh, nor are {(crossed > 0).sum() - 1} other parts of the "
            "boundary: use recover_edges first"
        )
    mark_regions(complex_, facets, domain.regions, False)
    origin = np.full(len(mesh.points), -1, dtype=np.int32)
    origin[place[place >= 0]] = sampled.origin[place >= 0]
    kept = complex_.mesh(facets=facets, origin=origin, markers=domain.markers, points=mesh.points)
    kept.counts["removed cells"] = mesh.size - kept.size
    kept.counts["removed vertices"] = len(mesh.points) - len(kept.points)
    return kept


def complex_of_mesh(mesh: Mesh) -> PlanarComplex:
    """The half-edges of a mesh, with a ghost triangle beyond each edge of its boundary; no edge is marked.

    Parameters
    ----------
    mesh : Mesh
        Positively oriented triangles in the plane.

    Returns
    -------
    PlanarComplex
        Slot t is triangle t, for all triangles of the mesh.

    Raises
    ------
    MeshError
        For other meshes, and if triangles meet only in a vertex.
    InputError
        For coordinates whose exponents are too wide for one scale.
    """
    if not is_planar(mesh) or mesh.size == 0:
        raise MeshError(f"this needs triangles in the plane, not {mesh!r}")
    xy, exact = scaled(mesh.points)
    if not exact:
        raise InputError(
            "the exponents of the coordinates span too wide a range for one scale: round small ones to 0"
        )
    complex_ = PlanarComplex.__new__(PlanarComplex)
    vertex, twin = with_ghosts(mesh)
    count = len(vertex) // 3
    complex_.factor, complex_.xy = power_of_two(mesh.points), xy
    complex_.vertex, complex_.twin = vertex, twin
    complex_.mark, complex_.region = np.full(3 * count, -1, np.int32), np.full(count, -1, np.int32)
    complex_.ends, complex_.piece = np.empty((0, 2), np.int32), np.empty(0, np.int32)
    complex_.span, complex_.where = np.empty((0, 2)), np.empty(0, np.int32)
    complex_.state = np.zeros(16, dtype=np.int64)
    complex_.state[[COUNT, FREE, VERTICES, BUSY]] = count, -1, len(mesh.points), 0
    return complex_


def with_ghosts(mesh: Mesh) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """``vertex`` and ``twin`` as in `connect.insertion.plane`: the triangles of the mesh, then the ghosts."""
    m = mesh.size
    vertex = as_simplices(mesh.simplices, vertices=len(mesh.points)).ravel()
    twin = twins(mesh.neighbors)
    outer = np.flatnonzero(twin < 0)
    start, stop = (
        vertex[np.where(outer % 3 == 2, outer - 2, outer + 1)],
        vertex[np.where(outer % 3 == 0, outer + 2, outer - 1)],
    )
    twice = np.flatnonzero(np.bincount(start) > 1)
    if len(twice):
        raise MeshError(
            f"the mesh is pinched at vertex {twice[0]}: parts of it meet only there; select one part"
        )
    ghost = 3 * (m + np.arange(len(outer)))  # its edges: stop -> start, start -> infinity, infinity -> stop
    leaving = np.full(len(mesh.points), -1, dtype=np.int64)
    leaving[start] = ghost
    ring = np.empty((len(outer), 3), dtype=np.int64)
    ring[:, 0] = outer
    ring[:, 2] = leaving[stop] + 1
    ring[(leaving[stop] - 3 * m) // 3, 1] = ghost + 2
    twin[outer] = ghost
    ghosts = np.column_stack([np.full(len(outer), GHOST), stop, start])
    return (
        np.concatenate([vertex, ghosts.ravel()]).astype(np.int32),
        np.concatenate([twin, ring.ravel()]).astype(np.int32),
    )


def _edges(mesh: Mesh, edges: ArrayLike) -> NDArray[np.int32]:
    rows: Any = np.asarray(edges)
    if rows.size == 0:
        return np.empty((0, 2), dtype=np.int32)
    if rows.ndim != 2 or rows.shape[1] != 2 or rows.dtype.kind not in "iu":
        raise InputError(f"edges must be pairs of vertices, shape (s, 2), not {rows.dtype} of {rows.shape}")
    used = np.zeros(len(mesh.points), dtype=bool)
    used[mesh.simplices.ravel()] = True
    bad = ((rows < 0) | (rows >= len(mesh.points))).any(axis=1)
    bad[~bad] = ~used[rows[~bad]].all(axis=1)
    if bad.any():
        i = int(np.argmax(bad))
        raise InputError(f"edges[{i}] = {rows[i].tolist()} has an end that is a vertex of no triangle")
    return rows.astype(np.int32)


def _match(mesh: Mesh, points: NDArray[np.float64]) -> NDArray[np.int32]:
    """For each point the vertex of a triangle of the mesh at the same place, or -1."""
    used = np.unique(mesh.simplices)
    both = np.concatenate([mesh.points[used], points]) + 0.0  # no negative zeros
    _, group = np.unique(both, axis=0, return_inverse=True)
    group = group.ravel()
    vertex = np.full(group.max() + 1, -1, dtype=np.int32)
    vertex[group[: len(used)]] = used
    return vertex[group[len(used) :]]
