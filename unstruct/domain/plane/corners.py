"""Do arcs and straight pieces that share a vertex cross once more? Told by circles and lines, not by samples.

A circle through a vertex and a line, or another circle, through it meet once more: at the mirror image of the
vertex in the line of centers (for a line: in its perpendicular through the center). That may be so near the
vertex that no sample of the arc falls between. See the book, chapter 2.6d.
"""

from __future__ import annotations

import numpy as np

from ...base.elementary import turns
from ...geometry.outline import Outline

__all__ = ["crossings_at_corners"]

SAME_VERTEX = 2.0**-36  # in units of the largest coordinate: nearer to a common vertex, a point is it
SHALLOW = 2.0**-46  # the same: what two pieces enclose between it and the point is deeper than rounding


def crossings_at_corners(outline: Outline) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of pieces with a common vertex, one of them an arc at least, that meet once more on both.

    Parameters
    ----------
    outline : Outline
        Its arcs must start and end at their vertices. Curves other than arcs are left out.

    Returns
    -------
    pairs : (c, 2) int64
        The smaller number first, in order, each pair once.
    places : (c, 2) float64
        Where they meet.

    Notes
    -----
    O(k^2) for k such pieces at one vertex. Pieces that touch in their common vertex, arcs of one circle, and
    pieces that lie within rounding of each other up to the second point are not told.
    """
    pairs, at = _pairs(outline)
    if len(pairs) == 0:
        return np.empty((0, 2), dtype=np.int64), np.empty((0, 2))
    difference = np.hypot(*(_bends(outline, pairs[:, 0], at) - _bends(outline, pairs[:, 1], at)).T)
    place = _mirrored(outline, pairs, at)
    vertex, scale = outline.points[at], np.abs(outline.points).max()
    away = np.hypot(*(place - vertex).T)
    told = np.isfinite(place).all(axis=1) & (away > SAME_VERTEX * scale)
    told &= away * away * difference > 8 * SHALLOW * scale
    for column in (0, 1):
        told &= _on_piece(outline, pairs[:, column], place, SAME_VERTEX * scale)
        for end in outline.pieces[pairs[:, column]].T:  # the other end of both is no second meeting
            shared = (outline.pieces[pairs[:, 1 - column]] == end[:, None]).any(axis=1)
            told &= ~(shared & (np.hypot(*(place - outline.points[end]).T) <= _blur(away, difference, scale)))
    pairs, place = pairs[told], place[told]
    first = np.unique(pairs, axis=0, return_index=True)[1]
    return pairs[first], place[first]


def _blur(away: np.ndarray, difference: np.ndarray, scale: float) -> np.ndarray:
    """How far rounding may move the second point: more, the flatter the angle at which the pieces meet."""
    return np.maximum(SAME_VERTEX * scale, 2 * SHALLOW * scale / np.maximum(away * difference, 1e-300))


def _pairs(outline: Outline) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of pieces with a common vertex, an arc among them and no other curve; the vertex of each."""
    kind = outline.cuts().kind
    is_arc, other = kind == 1, kind == 2
    touched = np.zeros(len(outline.points), dtype=bool)
    touched[outline.pieces[is_arc].ravel()] = True
    piece, column = np.nonzero(touched[outline.pieces] & ~other[:, None])
    vertex = outline.pieces[piece, column]
    order = np.lexsort((piece, vertex))
    piece, vertex = piece[order], vertex[order]
    rest = np.searchsorted(vertex, vertex, side="right") - np.arange(len(vertex)) - 1  # at the same vertex
    i = np.repeat(np.arange(len(vertex)), rest)
    j = i + 1 + np.arange(len(i)) - np.repeat(np.cumsum(rest) - rest, rest)
    keep = (is_arc[piece[i]] | is_arc[piece[j]]) & (piece[i] != piece[j])
    return np.column_stack([piece[i], piece[j]])[keep].astype(np.int64), vertex[i][keep].astype(np.int64)


def _bends(outline: Outline, piece: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Vectors of curvature at a vertex, towards the center; zero for straight pieces."""
    kind, arc = outline.cuts()
    to_center = arc[piece, :2] - outline.points[at]
    radius = np.where(kind[piece] == 1, arc[piece, 2], np.inf)
    return to_center / (radius * radius)[:, None]


def _mirrored(outline: Outline, pairs: np.ndarray, at: np.ndarray) -> np.ndarray:
    """The vertex mirrored in the line of centers, or in the perpendicular to the straight one."""
    kind, arc = outline.cuts()
    vertex = outline.points[at]
    center = [arc[pairs[:, k], :2] for k in (0, 1)]
    straight = [kind[pairs[:, k]] == 0 for k in (0, 1)]
    a, b = outline.points[outline.pieces[np.where(straight[0], pairs[:, 0], pairs[:, 1])]].transpose(1, 0, 2)
    line = (straight[0] | straight[1])[:, None]
    base = np.where(straight[0][:, None], center[1], center[0])
    along = np.where(line, b - a, center[1] - center[0])  # of the line; or the line of centers
    across = np.where(line, along, np.column_stack([-along[:, 1], along[:, 0]]))  # the way of the mirroring
    with np.errstate(divide="ignore", invalid="ignore"):
        unit = across / np.hypot(*across.T)[:, None]
        return vertex + 2 * ((base - vertex) * unit).sum(axis=1)[:, None] * unit


def _on_piece(outline: Outline, piece: np.ndarray, x: np.ndarray, slack: float) -> np.ndarray:
    """Whether points of the line or circle of a piece lie on the piece itself, its ends included."""
    kind, arc = outline.cuts()
    a, b = outline.points[outline.pieces[piece]].transpose(1, 0, 2)
    length = np.hypot(*(b - a).T)
    along = ((x - a) * (b - a)).sum(axis=1) / np.where(length > 0, length, 1.0)
    on_line = (along >= -slack) & (along <= length + slack)
    cx, cy, radius, start, sweep = arc[piece].T
    turned = np.sign(sweep) * (turns(x[:, 1] - cy, x[:, 0] - cx) - start)
    room = slack / np.where(radius > 0, radius, 1.0)
    on_arc = np.mod(turned + room, 2 * np.pi) <= np.abs(sweep) + 2 * room
    return np.where(kind[piece] == 1, on_arc, on_line)
