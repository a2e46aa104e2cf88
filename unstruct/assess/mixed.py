"""`unstruct.check` for meshes of polygons, quadrilaterals, hexahedra and mixtures."""

from __future__ import annotations

import numpy as np

from ..base.report import Report, problem
from ..geometry.boxes import BoxTree
from ..mesh.cells import CELL_TYPES, incident_facets
from ..mesh.embedding import crossing_facets
from ..mesh.mesh import Mesh
from ..predicates.batch import orient_rows

__all__ = ["check_mixed"]


def check_mixed(mesh: Mesh, report: Report) -> None:
    """Facets, Euler characteristic; corners by exact signs; in the plane also crossings and overlaps."""
    used = np.zeros(len(mesh.points), dtype=bool)
    used[np.unique(mesh.edges)] = True
    copies = mesh.duplicates[:, 0]
    used[copies] = True
    report.note(
        "every vertex used, or listed as a duplicate",
        problem("unused vertex", "in no cell and no duplicate", vertices=np.nonzero(~used)[0]),
    )
    rows, owner, group = incident_facets(mesh.cells)
    crowded = np.bincount(group)[group] > 2
    text = "shared by more than two cells"
    vertices = rows[crowded].ravel()
    if not report.note(
        "at most two cells at a facet", problem("facet", text, owner[crowded], vertices[vertices >= 0])
    ):
        return
    same = _same_direction(rows, group)
    text = "two cells on the same side of a facet, or against its orientation"
    vertices = rows[same].ravel()
    report.note("coherent orientation", problem("orientation", text, owner[same], vertices[vertices >= 0]))
    solid = mesh.points.shape[1] == mesh.dimension
    if solid:
        bad = turned_corners(mesh)
        text = "turned, flat or crossed (polygons: of negative or no area)"
        report.note("every cell of positive shape (exact)", problem("negative cell", text, bad))
    if mesh.points.shape[1] == 2:
        _plane(mesh, report)
    else:
        report.skipped.append("overlap (decided for simplices, and in the plane)")


def _same_direction(rows: np.ndarray, group: np.ndarray) -> np.ndarray:
    """Facets that two cells see in the same cyclic direction."""
    same = np.zeros(len(rows), dtype=bool)
    order = np.argsort(group, kind="stable")
    twin = group[order[1:]] == group[order[:-1]]
    first, second = order[:-1][twin], order[1:][twin]
    for i, j in zip(first.tolist(), second.tolist()):
        a, b = ([v for v in rows[r].tolist() if v >= 0] for r in (i, j))
        if len(a) == 2:
            same[[i, j]] = a == b
        else:
            at = b.index(a[0])
            same[[i, j]] = b[(at + 1) % len(b)] == a[1] and len(a) > 2
    return same


def turned_corners(mesh: Mesh) -> np.ndarray:
    """Cells with a corner that is not positive: quadrilaterals and solids by corners, polygons by area.

    A quadrilateral with four left turns is convex. In space the corner of a hexahedron, wedge or pyramid
    is the tetrahedron of a vertex and its three neighbors (the apex of a pyramid is left out).
    """
    bad, start = [], 0
    for name, block in mesh.cells.items():
        if name == "polygon":
            bad += [start + i for i, row in enumerate(block) if not _positive_polygon(mesh.points, row)]
        elif name == "quad":
            corners = np.concatenate([np.roll(block, -i, axis=1)[:, :3] for i in range(4)])
            wrong = (orient_rows(mesh.points, corners) <= 0).reshape(4, -1).any(axis=0)
            bad += (start + np.nonzero(wrong)[0]).tolist()
        elif name in ("hexahedron", "wedge", "pyramid"):
            tetra = np.concatenate([block[:, corner] for corner in _solid_corners(name)])
            wrong = (orient_rows(mesh.points, tetra) <= 0).reshape(-1, len(block)).any(axis=0)
            bad += (start + np.nonzero(wrong)[0]).tolist()
        else:
            bad += (start + np.nonzero(orient_rows(mesh.points, block) <= 0)[0]).tolist()
        start += len(block)
    return np.array(bad, dtype=np.int64)


def _solid_corners(name: str) -> list[list[int]]:
    """(v, a, b, c) with a, b, c the neighbors of corner v such that a good cell is positive there."""
    reference = {
        "hexahedron": [
            (0, 0, 0),
            (1, 0, 0),
            (1, 1, 0),
            (0, 1, 0),
            (0, 0, 1),
            (1, 0, 1),
            (1, 1, 1),
            (0, 1, 1),
        ],
        "wedge": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)],
        "pyramid": [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (1, 1, 1)],
    }[name]
    result = []
    for v in range(len(reference)):
        around = [b if a == v else a for a, b in CELL_TYPES[name][2] if v in (a, b)]
        if len(around) == 3:
            a, b, c = (np.subtract(reference[w], reference[v]) for w in around)
            if np.dot(a, np.cross(b, c)) < 0:
                around[0], around[1] = around[1], around[0]
            result.append([v, *around])
    return result


def _positive_polygon(points: np.ndarray, row: np.ndarray) -> bool:
    """Simple and counterclockwise: no two sides cross, and the lowest corner turns left."""
    k = len(row)
    sides = np.column_stack([row, np.roll(row, -1)])
    if len(crossing_facets(points, sides)):
        return False
    lowest = min(range(k), key=lambda i: tuple(points[row[i]].tolist()))
    # Skip collinear neighbors: in a simple polygon the extreme corner may be flat only with equal points.
    return bool(orient_rows(points, row[[lowest - 1, lowest, (lowest + 1) % k]][None])[0] > 0)


def _plane(mesh: Mesh, report: Report) -> None:
    """No two edges cross and no vertex lies in a foreign cell: then the cells do not overlap."""
    points = mesh.points
    pairs = crossing_facets(points, mesh.edges)
    wrong = problem(
        "crossing", "edges meet in more than a common end", vertices=mesh.edges[pairs.ravel()].ravel()
    )
    if not report.note("no two edges cross", wrong):
        return
    rows, owner, _ = incident_facets(mesh.cells)
    order = np.argsort(owner, kind="stable")
    rows, owner = rows[order], owner[order]
    firsts = np.searchsorted(owner, np.arange(mesh.size + 1))
    low = np.minimum.reduceat(points[rows].min(axis=1), firsts[:-1])
    high = np.maximum.reduceat(points[rows].max(axis=1), firsts[:-1])
    vertices = np.unique(mesh.edges)
    query, cells = BoxTree(low, high).pairs(points[vertices], points[vertices])
    # Crossings of a ray to the right: sides a b with a below and b not, on the right of the vertex.
    counts = np.diff(firsts)[cells]
    pair = np.repeat(np.arange(len(cells)), counts)
    side = np.arange(len(pair)) - np.repeat(np.cumsum(counts) - counts, counts) + firsts[cells][pair]
    v, a, b = vertices[query][pair], rows[side, 0], rows[side, 1]
    own = np.bincount(pair, weights=(v == a), minlength=len(cells)) > 0
    y, ya, yb = points[v, 1], points[a, 1], points[b, 1]
    up, down = (ya <= y) & (y < yb), (yb <= y) & (y < ya)
    turn = np.zeros(len(pair), dtype=np.int64)
    some = np.nonzero(up | down)[0]
    turn[some] = orient_rows(points, np.column_stack([v, a, b])[some])
    winding = np.bincount(
        pair, weights=(up & (turn > 0)).astype(int) - (down & (turn < 0)), minlength=len(cells)
    )
    inside = (winding != 0) & ~own
    wrong = problem("overlap", "cells that hold a vertex of others", cells[inside], vertices[query[inside]])
    report.note("no cell holds a foreign vertex", wrong)
