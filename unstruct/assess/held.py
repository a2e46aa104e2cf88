"""Which faces of a mesh lie on which pieces of a body, found by their places: for meshes read from files."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..domain.domain import Domain
from ..geometry.boxes import BoxTree, bounding_boxes
from ..mesh import topology
from ..mesh.domain_mesh import DomainMesh
from ..mesh.grouping import group_rows
from ..mesh.mesh import Mesh

__all__ = ["same_places", "with_pieces"]

NEARLY_ON = 2.0**-44  # of the largest coordinate: what is looked for; `check_body` judges what is found
BARYCENTRIC = 1e-9  # by how much barycentric coordinates of a point on a triangle may be negative
IN_A_FACE = np.array([[1, 1, 1], [2.4, 0.3, 0.3], [0.3, 2.4, 0.3], [0.3, 0.3, 2.4]]) / 3  # inside of a face


def with_pieces(mesh: Mesh, domain: Domain) -> DomainMesh:
    """The mesh with a record of the faces and edges that lie on pieces of a body.

    Parameters
    ----------
    mesh : Mesh
        Tetrahedra.
    domain : Domain
        In space. Vertices of the mesh are its points if all coordinates are equal.

    Returns
    -------
    DomainMesh
        With ``origin``, ``faces``, ``face_piece``, ``segments``, ``piece``, ``span``; what lies on no piece
        is left out. O(n log n).
    """
    shell = domain.triangulated
    scale = float(np.abs(domain.points).max(initial=0.0)) or 1.0
    points, corners = mesh.points / scale, domain.points[shell.triangles] / scale
    border = np.asarray(mesh.boundary)
    piece = _pieces_of(points[border], corners, shell.piece, IN_A_FACE[:1])
    on = (piece >= 0) & (piece < len(domain.facets))
    faces, face_piece = border[on], piece[on]
    if len(domain.inner) and (shell.piece >= len(domain.facets)).any():
        every = topology.faces(mesh.simplices, 2)
        group, _ = group_rows(np.sort(np.concatenate([border, every]), axis=1))
        inner = every[~np.isin(group[len(border) :], group[: len(border)])]
        piece = _pieces_of(points[inner], corners, shell.piece, IN_A_FACE)
        on = piece >= len(domain.facets)
        faces, face_piece = np.concatenate([faces, inner[on]]), np.concatenate([face_piece, piece[on]])
    edges, number, span = _on_segments(points, mesh.edges, domain.points[shell.segments] / scale)
    return DomainMesh(
        mesh.points,
        mesh.simplices,
        neighbors=mesh.neighbors,
        origin=same_places(mesh.points, domain.points),
        duplicates=mesh.duplicates,
        markers=mesh.markers,
        regions=mesh.regions,
        faces=faces,
        face_piece=face_piece,
        segments=edges,
        piece=shell.segment_piece[number],
        span=span,
    )


def same_places(points: np.ndarray, others: np.ndarray) -> NDArray[np.int32]:
    """For each point the number of the other one that is equal to it, or -1."""
    every = np.concatenate([others, points]) + 0.0  # zero has one sign
    order = np.lexsort((np.arange(len(every)), *every.T[::-1]))
    new = np.append(True, (every[order[1:]] != every[order[:-1]]).any(axis=1)) if len(order) else order
    head = np.empty(len(every), dtype=np.int64)
    head[order] = order[np.flatnonzero(new)][np.cumsum(new) - 1]
    found = head[len(others) :]
    return np.where(found < len(others), found, -1).astype(np.int32)


def _pieces_of(x: np.ndarray, corners: np.ndarray, piece: np.ndarray, places: np.ndarray) -> np.ndarray:
    """The piece on whose triangles all of some places of each face (f, 3, 3) lie, or -1."""
    tree = BoxTree(*_wider(*bounding_boxes(corners)))
    result = np.full(len(x), -1, dtype=np.int64)
    for i, weight in enumerate(places):
        q = weight[0] * x[:, 0] + weight[1] * x[:, 1] + weight[2] * x[:, 2]
        query, triangle = tree.pairs(q, q)
        height = _heights(q[query], corners[triangle])
        near = height <= NEARLY_ON
        query, triangle, height = query[near], triangle[near], height[near]
        order = np.lexsort((-height, query))  # of each query the nearest is last
        here = np.full(len(x), -1, dtype=np.int64)
        here[query[order]] = piece[triangle[order]]
        result = here if i == 0 else np.where(result == here, result, -1)
    return result


def _wider(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return low - NEARLY_ON, high + NEARLY_ON


def _heights(q: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """How far points are from the planes of triangles; infinite for those that are not above or below."""
    u, v, x = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], q - corners[:, 0]
    normal = np.cross(u, v)
    square = (normal * normal).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (np.cross(x, v) * normal).sum(axis=1) / square
        t = (np.cross(u, x) * normal).sum(axis=1) / square
        height = np.abs((x * normal).sum(axis=1)) / np.sqrt(square)
    return np.where((s >= -BARYCENTRIC) & (t >= -BARYCENTRIC) & (s + t <= 1 + BARYCENTRIC), height, np.inf)


def _on_segments(
    points: np.ndarray, edges: np.ndarray, ends: np.ndarray
) -> tuple[np.ndarray, NDArray[np.int64], np.ndarray]:
    """The edges that lie on segments, in their direction; their segments; the parameters of their ends."""
    if len(ends) == 0:
        return np.empty((0, 2), dtype=np.int32), np.empty(0, dtype=np.int64), np.empty((0, 2))
    tree = BoxTree(*_wider(*bounding_boxes(ends)))
    edge, segment = tree.pairs(*bounding_boxes(points[edges]))
    start, along = ends[segment, 0], ends[segment, 1] - ends[segment, 0]
    x = points[edges[edge]] - start[:, None]
    t = (x * along[:, None]).sum(axis=2) / (along * along).sum(axis=1)[:, None]
    off = np.abs(x - t[:, :, None] * along[:, None]).max(axis=(1, 2))
    on = (off <= NEARLY_ON) & (t.min(axis=1) >= -BARYCENTRIC) & (t.max(axis=1) <= 1 + BARYCENTRIC)
    rows, span, segment = edges[edge[on]], np.clip(t[on], 0.0, 1.0), segment[on]
    back = span[:, 0] > span[:, 1]
    rows, span = np.array(rows), np.array(span)
    rows[back], span[back] = rows[back][:, ::-1], span[back][:, ::-1]
    return rows, segment, span
