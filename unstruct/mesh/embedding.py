"""Does a complex lie in space without folds, overlaps or crossings? Exact, for `unstruct.check`.

The cells are positively oriented simplices of full dimension whose facets match. A *ridge* is a face of
codimension two: a vertex in the plane, an edge in space. Around a ridge the cells form a fan of wedges;
the mesh is locally one-to-one there when no half-plane lies in two wedges, and locally convex on the
boundary when the fan's angle is at most pi. See the book, chapters 1 and 2.0.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from ..base.arrays import surely_different
from ..geometry.boxes import BoxTree, bounding_boxes
from ..geometry.embedded import embedded
from ..geometry.triangle_pairs import edges_of, meetings_in_space, sides_index
from ..predicates.batch import orient_rows, scaled
from . import topology
from .complex import CellComplex
from .grouping import group_rows

__all__ = ["RidgeFans", "boundary_is_convex", "crossing_facets", "segments_meet"]


class RidgeFans:
    """All (ridge, cell) incidences of a mesh, each with its wedge from apex ``a`` to apex ``b``.

    The order of a and b is such that (ridge, a, b), the ridge sorted, is positively oriented. A mesh of m
    cells in d dimensions has m d (d + 1) / 2 incidences.
    """

    def __init__(self, points: np.ndarray, simplices: np.ndarray, neighbors: np.ndarray):
        self.points = points
        width = simplices.shape[1]
        ridges, a, b, open_a, open_b, cells = [], [], [], [], [], []
        for i, j in combinations(range(width), 2):
            columns = np.array([c for c in range(width) if c not in (i, j)])
            order = columns[np.argsort(simplices[:, columns], axis=1)]
            odd = _odd(order, i, j)
            first, second = np.where(odd, j, i), np.where(odd, i, j)
            row = np.arange(len(simplices))
            ridges.append(np.take_along_axis(simplices, order, axis=1))
            a.append(simplices[row, first])
            b.append(simplices[row, second])
            # The facet through the ridge and a lies opposite b. With no cell beyond it the fan starts there.
            open_a.append(neighbors[row, second] < 0)
            open_b.append(neighbors[row, first] < 0)
            cells.append(row)
        self.ridges, self.a, self.b = np.concatenate(ridges), np.concatenate(a), np.concatenate(b)
        self.starts, self.ends = np.concatenate(open_a), np.concatenate(open_b)
        self.cells = np.concatenate(cells)
        self.group, first_row = group_rows(self.ridges)
        # The fan of a boundary ridge begins with its first wedge, that of an inner ridge with any wedge.
        self.begin = first_row
        self.begin[self.group[self.starts]] = np.nonzero(self.starts)[0]

    def overlaps(self) -> np.ndarray:
        """Incidences, not the first of their fan, whose wedge contains the half-plane that begins the fan."""
        reference = self.a[self.begin][self.group]
        row = np.nonzero((self.a != reference) & (self.b != reference))[0]
        row = row[self._sign(row, self.a[row], reference[row]) >= 0]
        return row[self._sign(row, reference[row], self.b[row]) > 0]

    def concave(self) -> np.ndarray:
        """Boundary ridges with an angle above pi, as the last incidences of their fans (overlaps apart)."""
        row = np.nonzero(self.ends)[0]
        begin = self.begin[self.group[row]]
        sign = self._sign(row, self.a[begin], self.b[row])
        # Sign 0 means an angle of pi or 2 pi. In the second case the fan ends over pi after its second apex.
        straight = sign == 0
        sign[straight] = self._sign(row[straight], self.b[begin[straight]], self.b[row[straight]])
        return row[sign <= 0]

    def _sign(self, row: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return orient_rows(self.points, np.column_stack([self.ridges[row], a, b]))


def _odd(order: np.ndarray, i: int, j: int) -> np.ndarray:
    """Whether (order..., i, j) is an odd permutation of the columns 0, 1, ..."""
    full = np.column_stack([order, np.full((len(order), 2), [i, j])])
    odd = np.zeros(len(full), dtype=bool)
    for p, q in combinations(range(full.shape[1]), 2):
        odd ^= full[:, p] > full[:, q]
    return odd


def crossing_facets(points: np.ndarray, facets: np.ndarray) -> np.ndarray:
    """Pairs of facets (segments in the plane, triangles in space) that meet in more than a common face.

    Returns
    -------
    ndarray of int, shape (c, 2)
        Pairs of rows of ``facets``, the smaller first, in lexicographic order.
    """
    d = points.shape[1]
    if d == 2:
        first, second = _near_pairs(points, facets, facets)
        once = first < second
        first, second = first[once], second[once]
        hit = segments_meet(points, facets[first], facets[second])
        found = np.column_stack([first[hit], second[hit]])
    elif scaled(points)[1] and not _flat(points, facets).any():
        if surely_different(facets, as_sets=True) and embedded(points, facets):
            return np.empty((0, 2), dtype=np.int64)
        edges = edges_of(facets)
        met = meetings_in_space(points, facets, edges)
        key, owner = sides_index(facets)
        wanted = (edges[met.edge, 0].astype(np.int64) << 32) | edges[met.edge, 1]
        first = np.searchsorted(key, wanted)
        count = np.searchsorted(key, wanted, side="right") - first
        step = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        found = np.column_stack([owner[np.repeat(first, count) + step], np.repeat(met.triangle, count)])
    else:
        sides = np.array([(0, 1), (1, 2), (2, 0)])
        edges = np.sort(facets[:, sides].reshape(-1, 2), axis=1)
        edge, facet = _near_pairs(points, edges, facets)
        hit = _edges_meet_triangles(points, edges[edge], facets[facet])
        found = np.column_stack([edge[hit] // 3, facet[hit]])
    found = np.sort(found, axis=1)
    return np.unique(found[found[:, 0] != found[:, 1]], axis=0)


def _flat(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Whether triangles in space are flat: seen along each axis."""
    flat = np.ones(len(triangles), dtype=bool)
    for axes in ((0, 1), (1, 2), (2, 0)):
        rows = np.nonzero(flat)[0]
        if len(rows):
            flat[rows] = orient_rows(np.ascontiguousarray(points[:, axes]), triangles[rows]) == 0
    return flat


def _near_pairs(points: np.ndarray, rows: np.ndarray, others: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return BoxTree(*bounding_boxes(points[others])).pairs(*bounding_boxes(points[rows]))


def segments_meet(points: np.ndarray, s: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Whether segments s = pq and t = ab (closed) meet in more than a common end."""
    p, q, a, b = s[:, 0], s[:, 1], t[:, 0], t[:, 1]
    signs = [orient_rows(points, np.column_stack(v)) for v in ((p, q, a), (p, q, b), (a, b, p), (a, b, q))]
    flat = (signs[0] == 0) & (signs[1] == 0)
    meet = (signs[0] * signs[1] <= 0) & (signs[2] * signs[3] <= 0)
    shared = (s[:, :, None] == t[:, None, :]).any(axis=2).sum(axis=1)
    meet[(shared == 1) & ~flat] = False
    meet[shared == 2] = False
    rows = np.nonzero(flat & (shared < 2))[0]  # collinear: compare along the line
    if len(rows):
        ends = np.sort(_ranks(points, np.concatenate([s[rows], t[rows]], axis=1)).reshape(-1, 2, 2), axis=2)
        low, high = ends[:, :, 0].max(axis=1), ends[:, :, 1].min(axis=1)
        meet[rows] = (low < high) | ((low == high) & (shared[rows] == 0))
    return meet


def _ranks(points: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """The rank of each vertex in the lexicographic order of places; equal places have equal ranks."""
    some = np.unique(vertices)
    order = some[np.lexsort(points[some].T[::-1])]
    step = (points[order[1:]] != points[order[:-1]]).any(axis=1)
    rank = np.empty(len(points), dtype=np.int64)
    rank[order] = np.concatenate([[0], np.cumsum(step)])
    return rank[vertices]


def _edges_meet_triangles(points: np.ndarray, edges: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Whether edges pq and triangles abc (closed) meet in more than a common vertex or edge."""
    shared = (edges[:, :, None] == triangles[:, None, :]).any(axis=2)
    (p, q), (a, b, c) = edges.T, triangles.T
    sp, sq = (orient_rows(points, np.column_stack([a, b, c, v])) for v in (p, q))
    sides = ((a, b), (b, c), (c, a))
    volumes = np.array([orient_rows(points, np.column_stack([p, q, u, v])) for u, v in sides])
    through = (volumes >= 0).all(axis=0) | (volumes <= 0).all(axis=0)
    plane = (sp == 0) & (sq == 0)
    meet = (sp * sq <= 0) & through & ~plane & (shared.sum(axis=1) == 0)
    rows = np.nonzero(plane & (shared.sum(axis=1) < 2))[0]
    meet[rows] = _meet_in_plane(points, edges[rows], triangles[rows])
    return meet


def _meet_in_plane(points: np.ndarray, edges: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The coplanar case, projected to a coordinate plane in which the triangle does not collapse."""
    meet = np.ones(len(edges), dtype=bool)  # this remains for a flat facet with a segment in its line
    rows = np.arange(len(edges))
    for axes in ((0, 1), (1, 2), (2, 0)):
        if len(rows) == 0:
            break
        shadow = np.ascontiguousarray(points[:, axes])
        sign = orient_rows(shadow, triangles[rows])
        solid = sign != 0
        here, rows = rows[solid], rows[~solid]
        corners = np.where((sign[solid] > 0)[:, None], triangles[here], triangles[here][:, [0, 2, 1]])
        meet[here] = _meets_positive(shadow, edges[here], corners)
    return meet


def _meets_positive(points: np.ndarray, edges: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Whether an end that is no corner lies inside, or an edge meets a side in more than a common end."""
    sides = [triangles[:, [k, (k + 1) % 3]] for k in range(3)]
    meet = np.zeros(len(edges), dtype=bool)
    for end in (0, 1):
        v = edges[:, end]
        inside = (triangles != v[:, None]).all(axis=1)
        for side in sides:
            inside[inside] = orient_rows(points, np.column_stack([side, v])[inside]) >= 0
        meet |= inside
    for side in sides:
        rows = np.nonzero(~meet)[0]
        meet[rows] = segments_meet(points, edges[rows], side[rows])
    return meet


def boundary_is_convex(mesh: CellComplex) -> bool:
    """Whether the cells tile the convex hull of the points, by exact signs (their adjacency is trusted)."""
    used = len(np.unique(mesh.simplices)) + len(mesh.duplicates)
    if mesh.size == 0 or used < len(mesh.points) or (orient_rows(mesh.points, mesh.simplices) <= 0).any():
        return False
    if topology.components(mesh.neighbors)[0] != 1:
        return False
    if mesh.dimension == 1:
        return True
    fans = RidgeFans(mesh.points, mesh.simplices, mesh.neighbors)
    return len(fans.overlaps()) == 0 and len(fans.concave()) == 0
