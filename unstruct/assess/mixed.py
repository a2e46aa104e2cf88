"""`unstruct.check` for meshes of quadrilaterals, polygons, solids of several faces, and mixtures.

The tests for simplices are applied to these cells too, and reported in the same words: the arrays are valid,
at most two cells share a facet and they lie on opposite sides of it, the cells around vertices and edges are
connected, and the Euler characteristic agrees with that of the boundary. The shape of cells is decided by the
exact sign of the Jacobian over the whole cell.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from ..base.report import Problem, Report, problem
from ..mesh.cells import cell_rows, incident_facets
from ..mesh.embedding import crossing_facets
from ..mesh.grouping import group_rows
from ..mesh.holding import PlanarCells
from ..mesh.manifold import fans_of_faces
from ..mesh.mesh import Mesh
from ..mesh.orientation import jacobian_signs
from ..mesh.split import simplices_of_cells

__all__ = ["array_faults", "check_mixed", "rows_as_triangles"]


def array_faults(mesh: Mesh) -> list[Problem | None]:
    """Numbers that are no vertices, and vertices that a cell has twice; arrays may have been changed."""
    indptr, corners = cell_rows(mesh.cells)
    n, owner = len(mesh.points), np.repeat(np.arange(mesh.size), np.diff(indptr))
    outside = owner[(corners < 0) | (corners >= n)]
    order = np.lexsort((corners, owner))
    twice = (np.diff(corners[order]) == 0) & (np.diff(owner[order]) == 0)
    return [
        problem("index", f"vertices outside 0..{n - 1}", cells=outside),
        problem("repeated vertex", "within one cell", cells=owner[order[1:]][twice]),
        Problem("empty", "the mesh has no cells") if mesh.size == 0 else None,
    ]


def check_mixed(mesh: Mesh, report: Report, pinches: np.ndarray) -> bool:
    """Test adjacency, orientation and shape of cells; return whether the mesh can be tested for overlap.

    Parameters
    ----------
    mesh : Mesh
    report : Report
    pinches : ndarray of int
        Vertices where the cells may form several fans.
    """
    rows, owner, group = incident_facets(mesh.cells)
    crowded = np.bincount(group)[group] > 2
    text = "shared by more than two cells"
    wrong = problem("facet", text, owner[crowded], _vertices(rows[crowded]))
    if not report.note("at most two cells at a facet", wrong):
        report.skipped.append("everything that needs valid adjacency, including the domain")
        return False
    pairs = _pairs(group)
    same, twisted = _sides(rows[pairs[:, 0]], rows[pairs[:, 1]])
    text = "two cells on the same side of a facet, or with different orientations"
    across = "two cells list its corners in different cyclic orders"
    valid = report.note(
        "coherent orientation: the two cells of a facet on opposite sides",
        problem("orientation", text, owner[pairs[same]].ravel(), _vertices(rows[pairs[same, 0]])),
        problem("facet", across, owner[pairs[twisted]].ravel(), _vertices(rows[pairs[twisted, 0]])),
    )
    if twisted.any():
        report.skipped.append("everything that needs valid adjacency, including the domain")
        return False
    _manifold(mesh, rows, owner[pairs], rows[pairs[:, 0]], report, pinches)
    if mesh.dimension < mesh.points.shape[1]:
        _surface(mesh, report)
        return False
    signs, undecided = jacobian_signs(mesh)
    zero = np.setdiff1d(np.nonzero(signs == 0)[0], undecided)
    text = "the Jacobian is not positive everywhere (polygons: sides cross or touch)"
    valid &= report.note(
        "every cell positively oriented: its Jacobian is positive everywhere (exact)",
        problem("negative cell", "turned inside out; Mesh.oriented() corrects it", np.nonzero(signs < 0)[0]),
        problem("negative cell", text, zero),
        problem("undecided", "whether the Jacobian is positive: it comes too close to zero", undecided),
    )
    if mesh.dimension == 2 and valid:
        return _plane(mesh, report)
    if not valid:
        report.skipped.append("overlap and domain, which need positively oriented cells")
    return valid


def _vertices(rows: np.ndarray) -> np.ndarray:
    return rows[rows >= 0]


def _pairs(group: np.ndarray) -> np.ndarray:
    """The two incidences of each inner facet: (p, 2)."""
    order = np.argsort(group, kind="stable")
    twin = np.nonzero(group[order[1:]] == group[order[:-1]])[0]
    return np.column_stack([order[twin], order[twin + 1]])


def _sides(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Facets that both cells list in the same direction, and facets whose lists agree in no direction."""
    sizes = (a >= 0).sum(axis=1)
    same, twisted = np.zeros(len(a), dtype=bool), np.zeros(len(a), dtype=bool)
    for size in np.unique(sizes).tolist():
        which = np.nonzero(sizes == size)[0]
        first, second = a[which, :size], b[which, :size]
        place = (second == first[:, :1]).argmax(axis=1)[:, None]
        step = np.arange(size)
        along = (np.take_along_axis(second, (place + step) % size, axis=1) == first).all(axis=1)
        against = (np.take_along_axis(second, (place - step) % size, axis=1) == first).all(axis=1)
        if size == 2:  # the direction of a segment is given by the vertex where it starts
            along, against = first[:, 0] == second[:, 0], first[:, 0] != second[:, 0]
        same[which], twisted[which] = along, ~along & ~against
    return same, twisted


# ---------------------------------------------------------------------- manifold


def _manifold(
    mesh: Mesh, rows: np.ndarray, cells: np.ndarray, shared: np.ndarray, report: Report, pinches: np.ndarray
) -> None:
    """Test that cells around vertices and edges are connected, the links, and the Euler characteristic."""
    indptr, corners = cell_rows(mesh.cells)
    owner = np.repeat(np.arange(mesh.size), np.diff(indptr))
    facet, column = np.nonzero(shared >= 0)
    fans = fans_of_faces((owner, corners), cells[facet], shared[facet, column], len(mesh.points))
    bad = np.nonzero(fans > 1)[0]
    allowed = np.isin(bad, pinches)
    permitted = bool(allowed.any())
    text = f"up to {fans.max(initial=0)} separate fans of cells meet there"
    problems = [problem("pinched vertex", text, vertices=bad[~allowed])]
    if mesh.dimension == 3:
        pinched, most = _pinched_edges(mesh, rows, cells, shared)
        here = np.isin(pinched, pinches).all(axis=1)
        permitted |= bool(here.any())
        text = f"up to {most} separate fans of cells meet there"
        problems.append(problem("pinched edge", text, vertices=pinched[~here].ravel()))
    manifold = report.note("cells around every vertex are connected through facets", *problems)
    if manifold and mesh.dimension == 3:
        wrong = _bad_links(mesh, corners)
        here = np.isin(wrong, pinches)
        permitted |= bool(here.any())
        text = "the cells around the vertex form neither a ball nor a half-ball"
        manifold = report.note(
            "the link of every vertex is a sphere or a disk", problem("link", text, vertices=wrong[~here])
        )
    if manifold and permitted:
        report.skipped.append("the Euler characteristic, where facets of the domain meet at a vertex")
    elif manifold:
        _euler(mesh, report)


def _facet_sides(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The sides (lower vertex first) of facets in space, and which facet each belongs to."""
    sizes = (rows >= 0).sum(axis=1)
    sides, which = [], []
    for i in range(rows.shape[1]):
        some = np.nonzero(sizes > i)[0]
        sides.append(np.column_stack([rows[some, i], rows[some, (i + 1) % sizes[some]]]))
        which.append(some)
    return np.sort(np.concatenate(sides), axis=1), np.concatenate(which)


def _pinched_edges(
    mesh: Mesh, rows: np.ndarray, cells: np.ndarray, shared: np.ndarray
) -> tuple[np.ndarray, int]:
    # Each edge of a cell is a side of two of its facets, so it occurs twice here. This does no harm.
    own, facet = _facet_sides(rows)
    owner = incident_facets(mesh.cells)[1][facet]
    inner, which = _facet_sides(shared)
    number, first = group_rows(np.concatenate([own, inner]))
    fans = fans_of_faces((owner, number[: len(own)]), cells[which], number[len(own) :], len(first))
    edges = np.concatenate([own, inner])[first]
    return edges[fans > 1], int(fans.max(initial=0))


def _bad_links(mesh: Mesh, corners: np.ndarray) -> np.ndarray:
    """As `manifold.bad_vertex_links`: the link's Euler characteristic is 2 inside and 1 on the boundary."""
    n = len(mesh.points)
    link = np.bincount(mesh.edges.ravel(), minlength=n) - np.bincount(_vertices(mesh.facets), minlength=n)
    link += np.bincount(corners, minlength=n)
    wanted = np.full(n, 2)
    wanted[_vertices(mesh.boundary)] = 1
    used = np.zeros(n, dtype=bool)
    used[corners] = True
    return np.nonzero(used & (link != wanted))[0]


def _euler(mesh: Mesh, report: Report) -> None:
    """For every compact manifold of dimension k: chi(boundary) = (1 - (-1)^k) chi."""
    boundary = mesh.boundary
    inside, around = mesh.euler_characteristic, 0
    if len(boundary):
        around = len(np.unique(_vertices(boundary))) - len(boundary)
        if mesh.dimension == 3:
            around += 2 * len(boundary) - len(np.unique(_facet_sides(boundary)[0], axis=0))
    text = f"{inside} inside and {around} on the boundary contradict each other"
    wrong = None if around == (1 - (-1) ** mesh.dimension) * inside else Problem("Euler characteristic", text)
    report.note(f"Euler characteristic: {inside}, boundary {around}", wrong)


# ---------------------------------------------------------------------- geometry


def _surface(mesh: Mesh, report: Report) -> None:
    """Test that no cell of a surface is flat: some projection to two coordinate axes must not be flat."""
    flat = np.ones(mesh.size, dtype=bool)
    indptr, corners = cell_rows(mesh.cells)
    polygons = np.split(corners, indptr[1:-1])
    for axes in combinations(range(mesh.points.shape[1]), 2):
        rows = np.nonzero(flat)[0]
        shadow = np.ascontiguousarray(mesh.points[:, axes])
        flat[rows] = ~PlanarCells(shadow, [polygons[i] for i in rows.tolist()]).solid
    wrong = problem("flat cell", "its corners lie in a lower dimension", cells=np.nonzero(flat)[0])
    report.note("no flat cell", wrong)
    report.skipped.append("whether the surface meets itself")


def _plane(mesh: Mesh, report: Report) -> bool:
    """Test that no edges cross and no cell contains a vertex that is not its own: then no cells overlap."""
    points = mesh.points
    pairs = crossing_facets(points, mesh.edges)
    wrong = problem(
        "crossing", "edges meet in more than a common end", vertices=mesh.edges[pairs.ravel()].ravel()
    )
    if not report.note("no two edges cross", wrong):
        return False
    vertices = np.unique(mesh.edges)
    query, cells = mesh.holding(points[vertices])
    indptr, corners = cell_rows(mesh.cells)
    counts = np.diff(indptr)[cells]
    pair = np.repeat(np.arange(len(cells)), counts)
    place = np.arange(len(pair)) + np.repeat(indptr[cells] - (np.cumsum(counts) - counts), counts)
    own = np.bincount(pair, weights=corners[place] == vertices[query][pair], minlength=len(cells)) > 0
    wrong = problem("overlap", "cells that contain a vertex of others", cells[~own], vertices[query[~own]])
    return report.note("no cell contains a vertex that is not its own", wrong)


def rows_as_triangles(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles and quadrilaterals in rows of four as triangles, as `simplices_of_cells` cuts them."""
    quads = faces[:, 3] >= 0
    halves, owner = simplices_of_cells({"quad": faces[quads]})
    row = np.concatenate([np.flatnonzero(~quads), np.flatnonzero(quads)[owner]])
    return np.concatenate([faces[~quads, :3], halves]), row
