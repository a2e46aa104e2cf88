"""Where circular arcs meet each other and straight pieces: the vertices at which `resolve` splits them.

Circles and lines are intersected as they are stored, by rational arithmetic with one root, so that each new
vertex is the rounded true point. Only the ends of arcs, which sines and cosines gave, are uncertain: a vertex
nearer to an arc than `NEAR` lies on it, and two pieces that touch, or overlap by less than a chord can show,
get one vertex in the middle. After a split both parts keep the center and the radius of their arc.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import floor, hypot, isqrt, pi
from typing import Any, NamedTuple

import numpy as np

from ...base.elementary import cosines, sines, turns
from ...geometry.boxes import BoxTree
from ...geometry.curves import Arc, CurveLike
from ...geometry.outline import Outline
from .corners import SHALLOW, crossings_at_corners, on_piece

__all__ = ["ArcMeeting", "arc_meetings", "arc_parts"]

# Both are in units of the largest coordinate. A vertex nearer than NEAR to an arc lies on it. Pieces with a
# gap of up to GAP between them touch, as do those that overlap by less than half of `SHALLOW`.
NEAR = 2.0**-44
GAP = 2.0**-49
FLATTEST = 2.0**-8  # where pieces cross at a smaller angle (its sine), it does not enlarge `NEAR` any more
Exact = tuple[Fraction, Fraction]
Places = list[tuple[float, float]]


class ArcMeeting(NamedTuple):
    """One place where an arc meets something.

    Attributes
    ----------
    kind : str
        "crossing", "vertex on an arc", or "duplicate points" for an end of an arc very near to a vertex.
    pieces : tuple of int
        The pieces to be split there.
    among : tuple of int
        The pieces that meet.
    vertex : int
        The vertex there; -1 for a new one, and for duplicate points the one that goes.
    place : (float, float)
    other : int
        For duplicate points the vertex that stays.
    """

    kind: str
    pieces: tuple[int, ...]
    among: tuple[int, ...]
    vertex: int
    place: tuple[float, float]
    other: int = -1


def arc_meetings(points: np.ndarray, ends: np.ndarray, curves: dict[int, CurveLike]) -> list[ArcMeeting]:
    """All meetings of arcs among themselves, with straight pieces and with vertices.

    Parameters
    ----------
    points : (n, 2) float64
        All different.
    ends : (m, 2) int32
        The vertices of the pieces; those of a piece are different.
    curves : dict of int to curve
        Those other than arcs are left out.

    Notes
    -----
    O((m + n) log k) for k arcs, besides the pairs whose boxes meet.
    """
    outline = Outline(points, ends, ends[:0], curves, {}, {})
    arcs = np.nonzero(outline.batch.kind == 1)[0]
    if len(arcs) == 0:
        return []
    scale = float(np.abs(points).max())
    low, high = _boxes(outline, arcs)
    tree = BoxTree(low - NEAR * scale, high + NEAR * scale)
    found = _at_vertices(outline, arcs, tree, scale)
    pairs, places = crossings_at_corners(outline)
    crossings = [(i, j, (x, y), 1.0) for (i, j), (x, y) in zip(pairs.tolist(), places.tolist())]
    for i, j in _apart(outline, arcs, tree, scale):
        at, sine = _intersections(outline, i, j, scale)
        crossings += [(i, j, place, sine) for place in at]
    return found + _with_vertices(outline, crossings, scale)


def _boxes(outline: Outline, arcs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Boxes of arcs: of their ends, and of those points among the highest, lowest, ... that they contain."""
    x, y, radius, start, sweep = outline.batch.arc[arcs].T
    ends = outline.points[outline.pieces[arcs]]
    low, high = ends.min(axis=1), ends.max(axis=1)
    for k in range(4):
        turned = np.mod(np.sign(sweep) * (k * np.pi / 2 - start) + 1e-9, 2 * np.pi)
        inside = turned <= np.abs(sweep) + 2e-9
        angle = np.full(len(arcs), k * np.pi / 2)
        far = np.column_stack([x + radius * cosines(angle), y + radius * sines(angle)])
        low[inside], high[inside] = np.minimum(low, far)[inside], np.maximum(high, far)[inside]
    return low, high


def _at_vertices(outline: Outline, arcs: np.ndarray, tree: BoxTree, scale: float) -> list[ArcMeeting]:
    """Vertices on arcs, and vertices that are nearly the ends of arcs."""
    points, near = outline.points, NEAR * scale
    vertex, hit = tree.pairs(points, points)
    piece = arcs[hit]
    own = (outline.pieces[piece] == vertex[:, None]).any(axis=1)
    x, y, radius = outline.batch.arc[piece, :3].T
    away = np.abs(np.hypot(points[vertex, 0] - x, points[vertex, 1] - y) - radius)
    keep = ~own & (away <= near)
    vertex, piece = vertex[keep], piece[keep]
    on = on_piece(outline, piece, points[vertex], near)
    found: list[ArcMeeting] = []
    gone: set[int] = set()
    for v, i in zip(vertex[on].tolist(), piece[on].tolist()):
        end = _nearest(points, outline.pieces[i].tolist(), points[v], near)
        place = float(points[v, 0]), float(points[v, 1])
        if end < 0:
            found.append(ArcMeeting("vertex on an arc", (i,), (i,), v, place))
        elif not {v, end} & gone:
            gone |= {v, end}
            found.append(ArcMeeting("duplicate points", (), (i,), max(v, end), place, min(v, end)))
    return found


def _nearest(points: np.ndarray, vertices: list[int], x: np.ndarray, reach: float) -> int:
    """The vertex nearest to a point, if it is nearer than ``reach``; -1 otherwise."""
    away = [hypot(*(points[v] - x)) for v in vertices]
    best = int(np.argmin(away))
    return vertices[best] if away[best] <= reach else -1


def _apart(outline: Outline, arcs: np.ndarray, tree: BoxTree, scale: float) -> list[list[int]]:
    """Pairs of an arc and another piece without a common vertex whose circles and lines may well meet."""
    kind, arc = outline.batch.kind, outline.batch.arc
    others = np.nonzero(kind <= 1)[0]
    ends = outline.points[outline.pieces[others]]
    low, high = ends.min(axis=1), ends.max(axis=1)
    curved = kind[others] == 1
    low[curved], high[curved] = _boxes(outline, others[curved])
    query, hit = tree.pairs(low, high)
    i, j = arcs[hit], others[query]
    keep = ((kind[j] == 0) | (i < j)) & (i != j)
    i, j = i[keep], j[keep]
    apart = ~(outline.pieces[i][:, :, None] == outline.pieces[j][:, None, :]).any(axis=(1, 2))
    i, j = i[apart], j[apart]
    x, y, r, s = arc[i, 0], arc[i, 1], arc[i, 2], arc[j, 2]
    a, b = outline.points[outline.pieces[j]].transpose(1, 0, 2)
    u, w = b - a, np.column_stack([x, y]) - a
    straight = kind[j] == 0
    with np.errstate(divide="ignore", invalid="ignore"):
        u /= np.hypot(*u.T)[:, None]  # first, as products of large or small coordinates may be no doubles
        distance = np.abs(w[:, 0] * u[:, 1] - w[:, 1] * u[:, 0])
    centers = np.hypot(arc[j, 0] - x, arc[j, 1] - y)
    depth = np.where(straight, r - distance, np.minimum(r + s - centers, centers - np.abs(r - s)))
    slack = 2 * GAP * scale + 2.0**-48 * (r + s + np.abs(x) + np.abs(y) + np.abs(arc[j, :2]).sum(axis=1))
    same = ~straight & (centers <= NEAR * scale) & (np.abs(r - s) <= NEAR * scale)  # parts of one circle
    meet = (depth >= -slack) & ~same
    return np.column_stack([i, j])[meet].tolist()


def _intersections(outline: Outline, i: int, j: int, scale: float) -> tuple[Places, float]:
    """Where an arc and another piece meet, rounded; and the sine of the angle between them there."""
    arc, straight = outline.batch.arc, outline.batch.kind[j] == 0
    if straight:
        a, b = outline.points[outline.pieces[j]]
        at, sine = _line_and_circle(arc[i], a, b, scale)
    else:
        at, sine = _two_circles(arc[i], arc[j], scale)
    if not at:
        return [], sine
    x = np.array(at)
    slack = NEAR * scale / max(sine, FLATTEST)
    on = on_piece(outline, np.full(len(x), i), x, slack) & on_piece(outline, np.full(len(x), j), x, slack)
    return [place for place, yes in zip(at, on.tolist()) if yes], sine


def _exact(x: np.ndarray) -> Exact:
    return Fraction(float(x[0])), Fraction(float(x[1]))


def _root(x: Fraction) -> Fraction:
    """The square root, with more than a hundred correct bits."""
    shift = max(0, 240 - (x.numerator.bit_length() - x.denominator.bit_length()))
    shift += shift % 2
    return Fraction(isqrt((x.numerator << shift) // x.denominator), 1 << (shift // 2))


def _line_and_circle(arc: np.ndarray, a: np.ndarray, b: np.ndarray, scale: float) -> tuple[Places, float]:
    (cx, cy), r = _exact(arc), Fraction(float(arc[2]))
    (ax, ay), (bx, by) = _exact(a), _exact(b)
    ux, uy = bx - ax, by - ay
    square = ux * ux + uy * uy
    foot = ((cx - ax) * ux + (cy - ay) * uy) / square
    fx, fy = ax + foot * ux, ay + foot * uy
    away = (fx - cx) ** 2 + (fy - cy) ** 2
    half, depth = r * r - away, float(r - _root(away))
    if depth < -GAP * scale:
        return [], 0.0
    if depth <= SHALLOW / 2 * scale:
        return [(float(fx), float(fy))], 0.0
    step = _root(half / square)
    at = [(float(fx + s * ux), float(fy + s * uy)) for s in (-step, step)]
    return at, float(_root(half) / r)


def _two_circles(one: np.ndarray, two: np.ndarray, scale: float) -> tuple[Places, float]:
    (x, y), r, s = _exact(one), Fraction(float(one[2])), Fraction(float(two[2]))
    vx, vy = _exact(two)[0] - x, _exact(two)[1] - y
    square = vx * vx + vy * vy
    if square == 0:  # one center: the circles are different, as equal ones are left out
        return [], 0.0
    between = _root(square)
    depth = float(min(r + s - between, between - abs(r - s)))
    if depth < -GAP * scale:
        return [], 0.0
    share = (square + r * r - s * s) / (2 * square)
    if depth <= SHALLOW / 2 * scale:
        along = (r if share > 0 else -r) / between
        return [(float(x + along * vx), float(y + along * vy))], 0.0
    half = r * r - share * share * square
    step = _root(half / square)
    bx, by = x + share * vx, y + share * vy
    at = [(float(bx - t * vy), float(by + t * vx)) for t in (-step, step)]
    return at, float(_root(half) * between / (r * s))


def _with_vertices(
    outline: Outline, crossings: list[tuple[int, int, tuple[float, float], float]], scale: float
) -> list[ArcMeeting]:
    """Crossings at ends of pieces and at other vertices, or at new vertices; near places get one vertex."""
    if not crossings:
        return []
    points, near = outline.points, NEAR * scale
    at = np.array([place for _, _, place, _ in crossings])
    low, high = at - near, at + near
    around: dict[int, list[int]] = {}
    for query, vertex in zip(*(rows.tolist() for rows in BoxTree(points, points).pairs(low, high))):
        around.setdefault(query, []).append(vertex)
    fresh: dict[tuple[int, int], tuple[float, float]] = {}
    found = []
    for k, (i, j, place, sine) in enumerate(crossings):
        reach = near / max(sine, FLATTEST)
        one, two = (_nearest(points, outline.pieces[p].tolist(), at[k], reach) for p in (i, j))
        if one >= 0 and two >= 0:  # pieces with ends so near each other do not cross there
            continue
        vertex = max(one, two)
        if vertex < 0 and k in around:
            vertex = _nearest(points, around[k], at[k], 2 * near)
        if vertex >= 0:
            split = tuple(p for p, end in ((i, one), (j, two)) if end < 0)
            place = float(points[vertex, 0]), float(points[vertex, 1])
        else:
            split, place = (i, j), _gathered(fresh, place, 4 * near)
        found.append(ArcMeeting("crossing", split, (i, j), vertex, place))
    return found


def _gathered(
    fresh: dict[tuple[int, int], tuple[float, float]], place: tuple[float, float], side: float
) -> tuple[float, float]:
    """The place itself, or one seen before that is very near: in the same square cell or one beside it."""
    x, y = floor(place[0] / side), floor(place[1] / side)
    for cell in [(x + k, y + l) for k in (-1, 0, 1) for l in (-1, 0, 1)]:
        old = fresh.get(cell)
        if old is not None and hypot(old[0] - place[0], old[1] - place[1]) <= side / 4:
            return old
    return fresh.setdefault((x, y), place)


def arc_parts(
    arc: Any, points: np.ndarray, first: int, between: list[int], last: int
) -> tuple[list[int], list[Arc]]:
    """The vertices on an arc in order, and its parts: they keep its center and its radius."""
    x, y = (points[between] - arc.center).T
    turned = np.mod(np.sign(arc.sweep) * (turns(y, x) - arc.start), 2 * pi)
    turned = np.where(turned > abs(arc.sweep), np.where(turned > abs(arc.sweep) / 2 + pi, 0, turned), turned)
    order = np.argsort(turned, kind="stable")
    turns_at = [0.0, *(np.sign(arc.sweep) * turned[order]).tolist(), arc.sweep]
    parts = [Arc(arc.center, arc.radius, arc.start + s, t - s) for s, t in pairwise(turns_at)]
    return [first, *(between[k] for k in order.tolist()), last], parts
