"""A mesh of tetrahedra as the start of a refinement: its boundary and interfaces become facets of a body."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import frozen
from ...base.errors import InputError, MeshError
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh
from ...mesh.grouping import group_rows
from ...mesh.mesh import Mesh
from ...mesh.naming import names_by_number
from ...mesh.periodic import pairs_of, renumbered
from ...predicates.batch import orient
from ..boundary.kept import SplitBoundary
from ..volume_points.refining import refine_body
from .given_mesh import OWN_MARKERS, by_name, groups_of_cells, used_vertices
from .remeshing import carry

__all__ = ["refine_cells"]

SEEN_SIDES = np.array([[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]])  # opposite each vertex, seen from outside
VOLUME_ERROR = 1e-9  # relative: cells that overlap are far more


class _Faces(NamedTuple):
    """The faces that stay, once each, those of the boundary first."""

    rows: NDArray[np.int32]
    bounding: int
    cells: NDArray[np.bool_]  # (m, 4) which sides of cells they are


def refine_cells(
    mesh: Mesh,
    size: Any = None,
    *,
    max_volume: Any = None,
    split_boundary: SplitBoundary = True,
    **options: Any,
) -> DomainMesh:
    """`refine` for a mesh of tetrahedra; see there. All vertices that cells use are kept.

    Raises
    ------
    MeshError
        For cells that are no tetrahedra, not positive, or overlap, for faces of more than two cells, and for
        markers that name no face and no edge.
    """
    _judge(mesh)
    used, place = used_vertices(mesh)
    values, group = groups_of_cells(mesh)
    faces = _kept_faces(mesh, group)
    edges, named = _named_edges(mesh)
    markers = {name: np.flatnonzero(_among(faces.rows, rows)) for name, rows in _named(mesh, 3).items()}
    for name, rows in named.items():
        markers[name] = len(faces.rows) + rows
    inner = [*place[faces.rows[faces.bounding :]].tolist(), *place[edges].tolist()]
    try:
        domain = Domain(
            mesh.points[used],
            place[faces.rows[: faces.bounding]],
            inner=inner or None,
            markers=markers,
            regions=_seeds(mesh, group, faces.cells),
        )
    except InputError as error:
        raise MeshError(
            f"the faces of the mesh that must stay are no surface of a body; among those of the boundary, of "
            f"interfaces and of markers, and the vertices that are used, {error}"
        ) from error
    _compare(mesh, domain)
    called = names_by_number(mesh.regions)
    names: list[Any] = [""] * len(values)
    if "region" in mesh.markers:
        names = [called.get(row["region"], row["region"]) for row in values]
    result = refine_body(
        domain, by_name(mesh, size), max_volume=by_name(mesh, max_volume), split_boundary=split_boundary,
        held=_held(mesh, faces, len(edges)), names=names, **options,
    )  # fmt: skip
    origin = np.asarray(result.origin)
    result.origin = frozen(
        np.where(origin >= 0, mesh.origin[used[np.maximum(origin, 0)]], -1).astype(np.int32)
    )
    carry(mesh, values, renumbered(mesh.periodic, place), result)
    return result


def _judge(mesh: Mesh) -> None:
    if mesh.points.shape[1] != 3 or not mesh.is_simplicial or mesh.dimension != 3 or mesh.size == 0:
        raise MeshError(
            f"refine needs a Domain, a triangle mesh of the plane or a mesh of tetrahedra, not {mesh!r}"
        )
    turned = np.asarray(orient(mesh.corners)) <= 0
    if turned.any():
        t = int(np.argmax(turned))
        raise MeshError(
            f"simplices[{t}] = {mesh.simplices[t].tolist()} is not positively oriented: see mesh.oriented()"
        )


def _named(mesh: Mesh, width: int) -> dict[str, NDArray[np.int32]]:
    """The markers of faces or edges, but those that a mesh has by itself."""
    return {
        name: rows
        for name, rows in mesh.markers.items()
        if rows.ndim == 2 and rows.shape[1] == width and name not in OWN_MARKERS
    }


def _among(rows: NDArray[np.integer], wanted: NDArray[np.integer]) -> NDArray[np.bool_]:
    """Which rows of vertices are among others, in any order."""
    group, _ = group_rows(np.sort(np.concatenate([wanted, rows]), axis=1).astype(np.int32))
    return np.isin(group[len(wanted) :], group[: len(wanted)])


def _kept_faces(mesh: Mesh, group: NDArray[np.int64]) -> _Faces:
    """Boundary faces, faces between different groups of cells, and marked faces."""
    neighbors = mesh.neighbors
    sides = mesh.simplices[:, SEEN_SIDES]
    stay = (neighbors < 0) | (group[neighbors] != group[:, None])
    marked = {name: rows for name, rows in mesh.markers.items() if rows.ndim == 2 and rows.shape[1] == 3}
    if marked:
        every = np.concatenate(list(marked.values()))
        stay |= _among(sides.reshape(-1, 3), every).reshape(-1, 4)
        found = _among(every, sides.reshape(-1, 3))
        if not found.all():
            row = int(np.argmin(found))
            counts = np.cumsum([len(rows) for rows in marked.values()])
            name = list(marked)[int(np.searchsorted(counts, row, "right"))]
            raise MeshError(f"markers[{name!r}]: {every[row].tolist()} is not a face of the mesh: drop it")
    first = stay & ((neighbors < 0) | (neighbors > np.arange(mesh.size)[:, None]))
    cell, k = np.nonzero(first)
    order = np.argsort(neighbors[cell, k] >= 0, kind="stable")
    cell, k = cell[order], k[order]
    return _Faces(sides[cell, k].astype(np.int32), int((neighbors[cell, k] < 0).sum()), stay)


def _named_edges(mesh: Mesh) -> tuple[NDArray[np.int32], dict[str, NDArray[np.int64]]]:
    """The edges that stay, once each, and the rows of each marker."""
    named = _named(mesh, 2)
    parts = [*named.values(), *([mesh.segments] if isinstance(mesh, DomainMesh) else [])]
    if sum(map(len, parts)) == 0:
        return np.empty((0, 2), dtype=np.int32), {}
    every = np.sort(np.concatenate(parts), axis=1).astype(np.int32)
    found = _among(every, mesh.edges)
    if not found.all():
        row = int(np.argmin(found))
        raise MeshError(f"markers: {every[row].tolist()} is not an edge of the mesh: drop it")
    group, first = group_rows(every)
    ends = np.cumsum([len(rows) for rows in parts])
    rows = {name: np.unique(group[end - len(part) : end]) for (name, part), end in zip(named.items(), ends)}
    return every[first], rows


def _seeds(mesh: Mesh, group: NDArray[np.int64], stay: NDArray[np.bool_]) -> dict[str, NDArray[np.float64]]:
    """For each group of cells a point in each part of it."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    cell, k = np.nonzero(~stay)
    pairs = cell, mesh.neighbors[cell, k]
    graph = coo_matrix((np.ones(len(cell), dtype=bool), pairs), shape=(mesh.size, mesh.size))
    _, first = np.unique(connected_components(graph, directed=False)[1], return_index=True)
    centers = mesh.corners[first].mean(axis=1)
    return {str(g): centers[group[first] == g] for g in range(int(group.max()) + 1)}


def _compare(mesh: Mesh, domain: Domain) -> None:
    """Raise if cells overlap: then they have more volume than their boundary encloses."""
    cells, body = float(np.abs(mesh.volumes).sum()), float(domain.volume)
    if abs(cells - body) > VOLUME_ERROR * cells:
        raise MeshError(
            f"cells of the mesh overlap: their volume is {cells}, that of the body {body}; see unstruct.check"
        )


def _held(mesh: Mesh, faces: _Faces, edges: int) -> NDArray[np.bool_]:
    """The pieces that match others (``mesh.periodic``): they stay as they are."""
    paired = np.zeros(len(mesh.points), dtype=bool)
    if mesh.periodic:
        paired[pairs_of(mesh.periodic).ravel()] = True
    held: NDArray[np.bool_] = np.array(paired[faces.rows].all(axis=1))
    held[faces.bounding :] = False
    return np.append(held, np.zeros(edges, dtype=bool))
