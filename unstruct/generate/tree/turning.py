"""By how much the boundary turns within a cell: the rule that finds curves, rounded bodies and edges.

See the book, chapter 4a.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.elementary import cosine
from ...base.jit import kernel
from ...geometry.box_contact import pieces_in_boxes
from ...sizing.surface import SHARP_EDGE, bends_of
from .contacts import Boundary
from .criteria import Level, Rule

__all__ = ["Bending", "bending_of", "by_turning"]

Array = NDArray[np.float64]


class Bending(NamedTuple):
    """How the pieces of a boundary lie.

    Attributes
    ----------
    normals : (m, d) float64
        Of length 1.
    curvature : (m,) float64
        In space: that of the surface which the triangles approximate. In the plane: infinite, since the
        normals of chords tell all.
    edges : (m, 3) bool
        In space: whether side k of a triangle, from its corner k on, is an edge of the body.
    """

    normals: Array
    curvature: Array
    edges: NDArray[np.bool_]


def bending_of(boundary: Boundary, domain: Any) -> Bending:
    """The record for the pieces of a boundary; a body in space is asked for its curvature."""
    x = boundary.points[boundary.pieces]
    first = x[:, 1] - x[:, 0]
    many, d = len(x), x.shape[2]
    if d == 2:
        normals = _unit(np.stack([first[:, 1], -first[:, 0]], axis=1))
        return Bending(normals, np.full(many, np.inf), np.zeros((many, 3), dtype=bool))
    normals = _unit(np.cross(first, x[:, 2] - x[:, 0]))
    curvature = bends_of(domain)[1].reshape(-1, 3).max(axis=1)
    return Bending(normals, curvature, _sharp(boundary.pieces, normals))


def _unit(rows: Array) -> Array:
    rows = rows / np.abs(rows).max(axis=1)[:, None]
    return rows / np.sqrt((rows * rows).sum(axis=1))[:, None]


def _sharp(triangles: NDArray[np.int64], normals: Array) -> NDArray[np.bool_]:
    """The sides of triangles at which the surface turns by more than `SHARP_EDGE`, or has no neighbor."""
    pairs = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    order = np.lexsort((pairs[:, 1], pairs[:, 0]))
    pairs = pairs[order]
    same = (pairs[1:] == pairs[:-1]).all(axis=1)
    alone = np.append(True, ~same) & np.append(~same, True)
    sharp = np.zeros(len(pairs), dtype=bool)
    sharp[alone] = True
    at = np.flatnonzero(same)
    one, other = normals[order[at] // 3], normals[order[at + 1] // 3]
    turned = at[(one * other).sum(axis=1) < cosine(SHARP_EDGE)]
    sharp[turned] = sharp[turned + 1] = True
    found = np.empty(len(pairs), dtype=bool)
    found[order] = sharp
    return found.reshape(-1, 3)


@kernel
def _farthest(normals, piece, begin, end, start):
    """The least cosine between the normal of a piece and those of others, and which has it."""
    least, which = 2.0, begin
    for i in range(begin, end):
        c = 0.0
        for a in range(normals.shape[1]):
            c += normals[piece[i], a] * normals[start, a]
        if c < least:
            least, which = c, i
    return least, which


@kernel
def _spread(normals, node, piece, bound, turned):
    """Mark nodes in which normals differ, by a cosine less than `bound`.

    Two are compared: one that is farthest from the first, and one that is farthest from that.
    """
    begin = 0
    while begin < len(node):
        end = begin
        while end < len(node) and node[end] == node[begin]:
            end += 1
        c, which = _farthest(normals, piece, begin, end, piece[begin])
        if c >= bound and end - begin > 2:
            c, which = _farthest(normals, piece, begin, end, piece[which])
        turned[node[begin]] = c < bound
        begin = end


def by_turning(bending: Bending, boundary: Boundary, angle: float) -> Rule:
    """Nodes in which normals of the boundary differ by more than `angle` radians.

    Of a body only those count that an edge of it meets, or for whose extent the curvature of its surface is
    too large: where triangles stand for a smooth surface, cells need not become smaller than these.
    """
    bound = -2.0 if angle > np.pi else cosine(angle)

    def rule(nodes: Level) -> NDArray[np.bool_]:
        assert nodes.contacts is not None
        node, piece = nodes.contacts.node, nodes.contacts.piece
        turned = np.zeros(len(nodes), dtype=bool)
        low, high = nodes.boxes
        _spread(bending.normals, node, piece, bound, turned)
        counts = np.zeros(len(nodes), dtype=bool)
        counts[node[bending.curvature[piece] * nodes.side > angle]] = True
        rows = np.flatnonzero((turned & ~counts)[node])
        for k in range(3):
            at = rows[bending.edges[piece[rows], k]]
            if not len(at):
                continue
            ends = boundary.pieces[piece[at]][:, [k, (k + 1) % boundary.pieces.shape[1]]]
            f, i = boundary.factor, np.arange(len(at))
            meet = pieces_in_boxes(boundary.points, ends, i, low[node[at]] * f, high[node[at]] * f)
            counts[node[at[meet]]] = True
        return turned & counts

    return rule
