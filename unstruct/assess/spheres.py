"""Whether the spheres of cells are empty, across each facet, by exact signs; weighted ones, too."""

from __future__ import annotations

import numpy as np

from ..base.report import Report, problem
from ..mesh import topology
from ..mesh.marked import marked_facets
from ..mesh.mesh import Mesh
from ..predicates.batch import SIGNS_AT_ONCE, in_sphere
from ..predicates.power import power_signs

__all__ = ["check_spheres"]


def check_spheres(mesh: Mesh, report: Report, *, opaque: bool) -> None:
    """Test each facet between two cells; with ``opaque`` not those that markers name."""
    simplices, neighbors = mesh.simplices, mesh.neighbors
    cells, corner = np.nonzero(neighbors > np.arange(mesh.size)[:, None])
    others = neighbors[cells, corner]
    name = "locally Delaunay across every facet (exact)"
    if opaque:
        name = "locally Delaunay across every facet that is not marked (exact)"
        closed = _marked(mesh, topology.oriented_facet(simplices, cells, corner))
        cells, corner, others = cells[~closed], corner[~closed], others[~closed]
    # The vertex across is that of the other cell which is not on the facet. Sums find it without a search.
    across = simplices[others].sum(axis=1) - simplices[cells].sum(axis=1) + simplices[cells, corner]
    inside = np.empty(len(cells), dtype=bool)
    for i in range(0, len(cells), SIGNS_AT_ONCE):
        part = slice(i, i + SIGNS_AT_ONCE)
        if mesh.weights is None:
            inside[part] = in_sphere(mesh.points[simplices[cells[part]]], mesh.points[across[part]]) > 0
        else:
            inside[part] = power_signs(mesh.points, mesh.weights, simplices[cells[part]], across[part]) > 0
    text = "spheres of cells that contain the vertex across a facet"
    report.note(name, problem("not Delaunay", text, cells[inside], across[inside]))
    if mesh.weights is not None:
        _hidden(mesh, report)


def _hidden(mesh: Mesh, report: Report) -> None:
    """Whether each hidden point lies, lifted, on or above the cell below which it would have to be."""
    assert mesh.weights is not None
    cells = np.asarray(mesh.find_simplex(mesh.points[mesh.hidden]))
    lost = mesh.hidden[cells < 0]
    vertices, cells = mesh.hidden[cells >= 0], cells[cells >= 0]
    low = power_signs(mesh.points, mesh.weights, mesh.simplices[cells], vertices) > 0
    report.note(
        "hidden points have no power cell (exact)",
        problem("hidden vertex", "its power cell is not empty", cells[low], vertices[low]),
        problem("hidden vertex", "it lies outside of the mesh", vertices=lost),
    )


def _marked(mesh: Mesh, facets: np.ndarray) -> np.ndarray:
    d = mesh.dimension
    named = [rows for rows in mesh.markers.values() if rows.ndim == 2 and rows.shape[1] == d]
    rows = np.concatenate([np.empty((0, d), dtype=np.int32), *named])
    return marked_facets(facets, rows, len(mesh.points))
