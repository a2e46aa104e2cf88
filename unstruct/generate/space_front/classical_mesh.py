"""From the cells that a front in space has made, in the order in which they were made, to a `DomainMesh`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...connect.spatial.flood import INWARD
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh
from ...mesh.grouping import group_rows
from ...mesh.mesh import Mesh
from ..bodies.dividing import Divided
from ..volume.filling import numbered_parts_of

__all__ = ["mesh_of_body", "quality_in_space"]

Rows = NDArray[np.int64]


def mesh_of_body(
    domain: Domain, parts: Divided | None, points: NDArray[np.float64], cells: Rows, **account: Any
) -> DomainMesh:
    """The cells as they were made, with the names of the body.

    Parameters
    ----------
    domain : Domain
        The body.
    parts : Divided, optional
        What its facets were divided into.
    points : (n, 3) float64
        First those of the divided body.
    cells : (m, 5) int64
        Positive cells that fill it, and the part of the body of each.
    **account
        ``unrefined``, ``reasons``, ``counts``, ``figures``, ``steps`` of the `DomainMesh`. Columns of
        ``steps`` named "face", "apex" and "vertex" contain vertices.

    Returns
    -------
    DomainMesh
        Its cell i is the one that was made as number i. Vertices without cells are left out.
    """
    body = domain if parts is None else parts.domain
    shell = body.triangulated
    used = flagged(len(points), cells[:, :4])
    place = np.where(used, np.cumsum(used) - 1, -1).astype(np.int32)
    simplices = place[cells[:, :4]]
    origin = np.full(len(points), -1, dtype=np.int32)
    origin[: len(domain.points)] = np.arange(len(domain.points))
    faces, piece = _faces_on(simplices, place[shell.triangles], np.asarray(shell.piece))
    ends, owner = place[shell.segments].reshape(-1, 2), np.asarray(shell.segment_piece)
    there = _are_edges(simplices, ends)
    ends, owner = ends[there], owner[there]
    span = np.tile([0.0, 1.0], (len(ends), 1))
    if parts is not None:
        span = parts.span[owner]
        piece, owner = parts.parent[piece], parts.parent[owner]
    bounding = piece < len(domain.facets)
    markers: dict[str, Any] = {"facets": faces[bounding], "inner": faces[~bounding]}
    markers["region"] = numbered_parts_of(domain, Mesh(points[used], simplices), cells[:, 4])
    for name, rows in domain.markers.items():
        named, edges = faces[np.isin(piece, rows)], ends[np.isin(owner, rows)]
        markers[name] = named if len(named) or not len(edges) else edges
    if account.get("steps") is not None:
        steps, known = dict(account["steps"]), np.append(place, -1)
        for column in ("face", "apex", "vertex"):
            if column in steps:
                steps[column] = known[steps[column]]
        account["steps"] = steps
    return DomainMesh(
        points[used], simplices, origin=origin[used], markers=markers,
        regions={name: k for k, name in enumerate(domain.regions)},
        segments=ends, piece=owner, span=span, faces=faces, face_piece=piece, **account,
    )  # fmt: skip


def _faces_on(
    simplices: NDArray[np.int32], triangles: NDArray[np.int32], piece: NDArray[np.int32]
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """The faces of cells that are triangles of the body, once each, and their pieces."""
    sides = simplices[:, INWARD].reshape(-1, 3)
    number, first = group_rows(np.sort(np.concatenate([triangles, sides]), axis=1))
    owner = np.full(len(first), -1, dtype=np.int64)
    owner[number[: len(triangles)]] = np.arange(len(triangles))
    rows = np.flatnonzero(owner[number[len(triangles) :]] >= 0)
    _, once = np.unique(number[len(triangles) + rows], return_index=True)
    rows = np.sort(rows[once])
    return sides[rows], piece[owner[number[len(triangles) + rows]]]


def _are_edges(simplices: NDArray[np.int32], ends: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Which pairs of vertices are edges of cells."""
    if len(ends) == 0:
        return np.zeros(0, dtype=bool)
    pairs = [(i, j) for i in range(4) for j in range(i + 1, 4)]
    edges = np.sort(simplices[:, pairs].reshape(-1, 2), axis=1).astype(np.int64)
    rows = np.sort(ends, axis=1).astype(np.int64)
    return np.isin(rows[:, 0] << 32 | rows[:, 1], edges[:, 0] << 32 | edges[:, 1])


def quality_in_space(mesh: Mesh) -> dict[str, float]:
    """Number of tetrahedra, the least dihedral angle in degrees, the least and the mean of 3 r / R."""
    if mesh.size == 0:
        return {"tetrahedra": 0.0}
    angle, ratio = mesh.quality("min_dihedral"), mesh.quality("3r/R")
    return {
        "tetrahedra": float(mesh.size), "minimum dihedral": float(angle.min()),
        "minimum 3r/R": float(ratio.min()), "mean 3r/R": float(ratio.mean()),
    }  # fmt: skip
