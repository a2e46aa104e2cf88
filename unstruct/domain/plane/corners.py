"""Second crossings of arcs and straight pieces that share a vertex, found from circles and lines.

A circle through a vertex and another circle (or a line) through it meet once more, in the mirror image of the
vertex. For two circles the mirror is the line of centers, for a line the perpendicular to it through the
center. This second point may be so near the vertex that no sample of the arc falls between them. See the
book, chapter 2.6d.
"""

from __future__ import annotations

import numpy as np

from ...base.arrays import flagged
from ...base.elementary import turns
from ...geometry.outline import Outline

__all__ = ["SHALLOW", "crossings_at_corners", "on_piece"]

# Both are in units of the largest coordinate. A point nearer than this to a common vertex is that vertex.
SAME_VERTEX = 2.0**-36
# The area between two pieces, from the vertex to the second point, must be deeper than this to be more than
# an effect of rounding.
SHALLOW = 2.0**-46


def crossings_at_corners(outline: Outline) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of pieces with a common vertex, at least one of them an arc, that meet a second time.

    Parameters
    ----------
    outline : Outline
        Its arcs must start and end at their vertices. Curves other than arcs are left out.

    Returns
    -------
    pairs : (c, 2) int64
        The smaller number first, in order, each pair once.
    places : (c, 2) float64
        The second point where they meet.

    Notes
    -----
    O(k^2) for k such pieces at one vertex. Not reported are pieces that touch in their common vertex, arcs of
    one circle, and pieces that cannot be told from each other, up to rounding, as far as the second point.
    """
    pairs, at = _pairs(outline)
    if len(pairs) == 0:
        return np.empty((0, 2), dtype=np.int64), np.empty((0, 2))
    difference = np.hypot(*(_bends(outline, pairs[:, 0], at) - _bends(outline, pairs[:, 1], at)).T)
    place = _mirrored(outline, pairs, at)
    vertex, scale = outline.points[at], np.abs(outline.points).max()
    away = np.hypot(*(place - vertex).T)
    found = np.isfinite(place).all(axis=1) & (away > SAME_VERTEX * scale)
    found &= away * (away * difference) > 8 * SHALLOW * scale
    for column in (0, 1):
        found &= on_piece(outline, pairs[:, column], place, SAME_VERTEX * scale)
        for end in outline.pieces[pairs[:, column]].T:  # a second common end is not a crossing
            shared = (outline.pieces[pairs[:, 1 - column]] == end[:, None]).any(axis=1)
            near = np.hypot(*(place - outline.points[end]).T) <= _blur(away, difference, scale)
            found &= ~(shared & near)
    pairs, place = pairs[found], place[found]
    first = np.unique(pairs, axis=0, return_index=True)[1]
    return pairs[first], place[first]


def _blur(away: np.ndarray, difference: np.ndarray, scale: float) -> np.ndarray:
    """How far rounding may move the second point; the flatter the angle of the pieces, the farther."""
    with np.errstate(over="ignore"):
        farthest = 2 * SHALLOW * scale / np.maximum(away * difference, 1e-300)
    return np.maximum(SAME_VERTEX * scale, farthest)


def _pairs(outline: Outline) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of pieces with a common vertex, an arc among them and no other curve; the vertex of each pair."""
    kind, arc = outline.cuts()
    is_arc, other = kind == 1, kind == 2
    touched = flagged(len(outline.points), outline.pieces[is_arc])
    circle = arc[:, :3]
    if not touched[outline.pieces[kind == 0]].any() and (circle[is_arc] == circle[is_arc][:1]).all():
        return np.empty((0, 2), dtype=np.int64), np.empty(0, dtype=np.int64)  # a circle, and what is apart
    piece, column = np.nonzero(touched[outline.pieces] & ~other[:, None])
    vertex = outline.pieces[piece, column]
    order = np.lexsort((piece, vertex))
    piece, vertex = piece[order], vertex[order]
    rest = np.searchsorted(vertex, vertex, side="right") - np.arange(len(vertex)) - 1  # at the same vertex
    i = np.repeat(np.arange(len(vertex)), rest)
    j = i + 1 + np.arange(len(i)) - np.repeat(np.cumsum(rest) - rest, rest)
    keep = (is_arc[piece[i]] | is_arc[piece[j]]) & (piece[i] != piece[j])
    keep &= (circle[piece[i]] != circle[piece[j]]).any(axis=1)  # arcs of one circle do not meet again
    return np.column_stack([piece[i], piece[j]])[keep].astype(np.int64), vertex[i][keep].astype(np.int64)


def _bends(outline: Outline, piece: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Curvature vectors at a vertex, towards the center; zero for straight pieces."""
    kind, arc = outline.cuts()
    to_center = arc[piece, :2] - outline.points[at]
    radius = np.where(kind[piece] == 1, arc[piece, 2], np.inf)
    return to_center / radius[:, None] / radius[:, None]  # the square may not be a double


def _mirrored(outline: Outline, pairs: np.ndarray, at: np.ndarray) -> np.ndarray:
    """The mirror image of the vertex in the line of centers, or in the perpendicular to a straight piece."""
    kind, arc = outline.cuts()
    vertex = outline.points[at]
    center = [arc[pairs[:, k], :2] for k in (0, 1)]
    straight = [kind[pairs[:, k]] == 0 for k in (0, 1)]
    a, b = outline.points[outline.pieces[np.where(straight[0], pairs[:, 0], pairs[:, 1])]].transpose(1, 0, 2)
    line = (straight[0] | straight[1])[:, None]
    base = np.where(straight[0][:, None], center[1], center[0])
    along = np.where(line, b - a, center[1] - center[0])  # the line; or the line of centers
    across = np.where(line, along, np.column_stack([-along[:, 1], along[:, 0]]))  # across the mirror
    with np.errstate(divide="ignore", invalid="ignore"):
        unit = across / np.hypot(*across.T)[:, None]
        return vertex + 2 * ((base - vertex) * unit).sum(axis=1)[:, None] * unit


def on_piece(outline: Outline, piece: np.ndarray, x: np.ndarray, slack: float) -> np.ndarray:
    """Whether points on the line or circle of a piece lie on the piece itself, which includes its ends."""
    kind, arc = outline.cuts()
    a, b = outline.points[outline.pieces[piece]].transpose(1, 0, 2)
    length = np.hypot(*(b - a).T)
    along = ((x - a) * ((b - a) / np.where(length > 0, length, 1.0)[:, None])).sum(axis=1)
    on_line = (along >= -slack) & (along <= length + slack)
    cx, cy, radius, start, sweep = arc[piece].T
    turned = np.sign(sweep) * (turns(x[:, 1] - cy, x[:, 0] - cx) - start)
    room = slack / np.where(radius > 0, radius, 1.0)
    on_arc = np.mod(turned + room, 2 * np.pi) <= np.abs(sweep) + 2 * room
    return np.where(kind[piece] == 1, on_arc, on_line)
