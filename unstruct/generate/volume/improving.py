"""Rounder tetrahedra in any mesh of them. See `generate.volume.steps` for the kernels. Book: 2.8c."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import as_flag, as_seed
from ...base.errors import MeshError
from ...mesh.domain_mesh import DomainMesh
from ...mesh.mesh import Mesh
from ...predicates.batch import orient_rows
from .rounder import faces_of_cells, rounded

__all__ = ["improve", "improved"]


def improve(mesh: Mesh, *, seed: int = 0, progress: bool = False) -> DomainMesh:
    """Make the tetrahedra of a mesh rounder by refills of small cavities and by moving inner vertices.

    Parameters
    ----------
    mesh : Mesh
        Positively oriented tetrahedra, for example of `delaunay`, `tetrahedralize` or another program.
    seed : int
        Of the random numbers by which cavities are chosen.
    progress : bool
        Show the rounds.

    Returns
    -------
    DomainMesh
        The same vertices and markers; ``counts`` has the "refills" and "moves". The boundary, marked faces
        and edges, faces between cells of different markers, pieces of a domain, and all vertices on these,
        named by a marker or given with the domain stay.

    Raises
    ------
    MeshError
        For a mesh that is not made of positive tetrahedra that meet in whole faces.

    Notes
    -----
    The least quality 6 sqrt(2) V / (mean square edge)^1.5 around each change becomes better, by exact signs
    nothing becomes invalid. O(n) in practice. Source: L. A. Freitag, C. Ollivier-Gooch, Int. J. Numer.
    Methods Eng. 40 (1997) 3979-4002. For triangles in the plane see `smooth`. Book: 2.8c.
    """
    _refuse(mesh)
    return improved(mesh, mesh.points, as_seed(seed), as_flag(progress, "progress"))


def improved(mesh: Mesh, rows: NDArray[np.float64], seed: int, progress: bool) -> DomainMesh:
    """`improve`, where ``rows`` are the points, which may carry a metric in six columns; see `rounded`."""
    region, values = _classes(mesh)
    faces, edges, fixed = _staying(mesh)
    found = rounded(
        rows,
        (mesh.simplices, mesh.neighbors, region),
        faces_of_cells(mesh.simplices, faces, len(mesh.points)),
        edges,
        fixed,
        seed=seed,
        progress=progress,
    )
    markers = {name: rows for name, rows in mesh.markers.items() if rows.ndim == 2}
    markers |= {name: rows[found.region] for name, rows in values.items()}
    points = found.points
    points[mesh.duplicates[:, 0]] = points[mesh.duplicates[:, 1]]
    counts = {"refills": found.refills, "moves": found.moves}
    rest: dict[str, Any] = {}
    if isinstance(mesh, DomainMesh):
        rest = {name: getattr(mesh, name) for name in ("segments", "piece", "span", "faces", "face_piece")}
        rest |= _still_unrefined(mesh, found.simplices)
        counts = mesh.counts | counts
    return DomainMesh(
        points,
        found.simplices,
        neighbors=found.neighbors,
        origin=mesh.origin,
        duplicates=mesh.duplicates,
        markers=markers,
        regions=mesh.regions,
        periodic=mesh.periodic,
        counts=counts,
        **rest,
    )


def _refuse(mesh: Mesh) -> None:
    if not isinstance(mesh, Mesh) or list(mesh.cells) != ["tetra"] or mesh.points.shape[1] != 3:
        raise MeshError(f"improve needs tetrahedra in space, not {mesh!r}; smooth is for planar triangles")
    if mesh.size == 0:
        raise MeshError(f"there is nothing to improve: {mesh!r}")
    wrong = np.flatnonzero(orient_rows(mesh.points, mesh.simplices) <= 0)
    if len(wrong):
        raise MeshError(f"simplices[{wrong[0]}] is not positively oriented; see unstruct.check")


def _classes(mesh: Mesh) -> tuple[NDArray[np.int32], dict[str, NDArray]]:
    """A number for each cell, the same where all markers of cells are, and the values by these numbers."""
    named = {name: rows for name, rows in mesh.markers.items() if rows.ndim == 1}
    if not named:
        return np.zeros(mesh.size, dtype=np.int32), {}
    first, number = np.unique(
        np.stack(list(named.values()), axis=1), axis=0, return_index=True, return_inverse=True
    )[1:]
    return number.ravel().astype(np.int32), {name: values[first] for name, values in named.items()}


def _staying(mesh: Mesh) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.bool_]]:
    """The faces, the edges and the vertices that must stay."""
    fixed = np.zeros(len(mesh.points), dtype=bool)
    fixed[mesh.pairs.ravel()] = True
    faces, edges = [np.empty((0, 3), dtype=np.int32)], [np.empty((0, 2), dtype=np.int32)]
    for rows in mesh.markers.values():
        if rows.ndim == 2:
            fixed[rows[rows >= 0]] = True
            if rows.shape[1] in (2, 3):
                (edges if rows.shape[1] == 2 else faces).append(rows)
    if isinstance(mesh, DomainMesh):
        fixed |= mesh.origin >= 0
        faces.append(mesh.faces)
        edges.append(mesh.segments)
    return np.concatenate(faces), np.concatenate(edges), fixed


def _still_unrefined(mesh: DomainMesh, simplices: NDArray[np.int32]) -> dict[str, Any]:
    """The account of those cells that were listed and are still there."""
    old = np.sort(mesh.simplices[mesh.unrefined], axis=1)
    number = {tuple(row): k for k, row in enumerate(old.tolist())}
    rows = np.sort(simplices, axis=1).tolist() if number else []
    same = [(t, number[tuple(row)]) for t, row in enumerate(rows) if tuple(row) in number]
    return {"unrefined": [t for t, _ in same], "reasons": [mesh.reasons[k] for _, k in same]}
