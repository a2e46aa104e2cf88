"""What can be wrong with the pieces of a region, found exactly, each fault with its culprits and place."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from .embedding import orient_rows
from .jit import inline, kernel
from .locate import BoxTree

if TYPE_CHECKING:
    from .domain import Domain

__all__ = ["Fault", "find_faults", "first_copies", "meetings", "vertices_on_segments"]

CROSSING, TOUCHING, OVERLAPPING = 1, 2, 3


@dataclass(frozen=True)
class Fault:
    """One fault: its kind, the pieces and vertices to blame, its place, and a sentence."""

    kind: str
    text: str
    place: tuple[float, float]
    pieces: tuple[int, ...] = ()
    vertices: tuple[int, ...] = ()


def first_copies(points: np.ndarray) -> np.ndarray:
    """For each point the lowest number of a point with equal coordinates (0.0 equals -0.0)."""
    order = np.lexsort((np.arange(len(points)), points[:, 1], points[:, 0]))
    head = np.ones(len(points), dtype=bool)
    head[1:] = (points[order[1:]] != points[order[:-1]]).any(axis=1)
    first = np.empty(len(points), dtype=np.int64)
    first[order] = order[np.maximum.accumulate(np.where(head, np.arange(len(points)), 0))]
    return first


def _before(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Lexicographic p < q; along a common line this is the order on it."""
    return (p[..., 0] < q[..., 0]) | ((p[..., 0] == q[..., 0]) & (p[..., 1] < q[..., 1]))


@inline
def _apart(ax, ay, bx, by, low, high):
    """Whether a box lies strictly on one side of the line ab, with room for rounding; if in doubt, no."""
    dx, dy = bx - ax, by - ay
    # The corners farthest to the left and to the right of the direction.
    left = dx * ((high[1] if dx > 0 else low[1]) - ay) - dy * ((low[0] if dy > 0 else high[0]) - ax)
    right = dx * ((low[1] if dx > 0 else high[1]) - ay) - dy * ((high[0] if dy > 0 else low[0]) - ax)
    reach = abs(dx) * (abs(low[1] - ay) + abs(high[1] - ay)) + abs(dy) * (
        abs(low[0] - ax) + abs(high[0] - ax)
    )
    slack = 1e-15 * reach + 1e-290
    return left < -slack or right > slack


@inline
def _beside(ax, ay, bx, by, other):
    """Whether both ends of a segment lie strictly on one side of the line ab; if in doubt, no."""
    ux, uy, vx, vy = other[0, 0] - bx, other[0, 1] - by, other[1, 0] - bx, other[1, 1] - by
    dx, dy = bx - ax, by - ay
    u, v = dx * uy - dy * ux, dx * vy - dy * vx
    bound = 1e-15 * (abs(dx) * (abs(uy) + abs(vy)) + abs(dy) * (abs(ux) + abs(vx))) + 1e-290
    return (u > bound and v > bound) or (u < -bound and v < -bound)


@kernel
def _close_pairs(ends, low, high, order, box_low, box_high, pairs):
    """Pairs (s, t), s < t, of segments neither of which lies on one side of the other; their number.

    Writes as many as fit. The tree is that of `BoxTree`, four boxes to a leaf.
    """
    leaves = low.shape[0] // 2
    stack = np.empty(128, dtype=np.int64)
    count = 0
    for s in range(ends.shape[0]):
        ax, ay, bx, by = ends[s, 0, 0], ends[s, 0, 1], ends[s, 1, 0], ends[s, 1, 1]
        x0, x1, y0, y1 = min(ax, bx), max(ax, bx), min(ay, by), max(ay, by)
        top = 1
        stack[0] = 1
        while top > 0:
            top -= 1
            node = stack[top]
            l, h = low[node], high[node]
            if l[0] > x1 or h[0] < x0 or l[1] > y1 or h[1] < y0 or _apart(ax, ay, bx, by, l, h):
                continue
            if node < leaves:
                stack[top] = 2 * node
                stack[top + 1] = 2 * node + 1
                top += 2
                continue
            first = (node - leaves) * 4
            for i in range(first, min(first + 4, order.shape[0])):
                t = order[i]
                l, h = box_low[t], box_high[t]
                if t <= s or l[0] > x1 or h[0] < x0 or l[1] > y1 or h[1] < y0:
                    continue
                if _beside(ax, ay, bx, by, ends[t]) or _beside(
                    ends[t, 0, 0], ends[t, 0, 1], ends[t, 1, 0], ends[t, 1, 1], ends[s]
                ):
                    continue
                if count < pairs.shape[0]:
                    pairs[count, 0], pairs[count, 1] = s, t
                count += 1
    return count


def close_pairs(points: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """Candidates for `meetings`: all pairs that meet, and few that do not."""
    ends = points[segments]
    tree = BoxTree(ends.min(axis=1), ends.max(axis=1))
    boxes = (tree.low, tree.high, tree.order, tree.box_low, tree.box_high)
    pairs = np.empty((4 * len(segments) + 16, 2), dtype=np.int64)
    count = _close_pairs(ends, *boxes, pairs)
    if count > len(pairs):
        pairs = np.empty((count, 2), dtype=np.int64)
        _close_pairs(ends, *boxes, pairs)
    return pairs[:count]


def meetings(points: np.ndarray, segments: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of segments that meet in more than a common end vertex, by exact signs.

    Parameters
    ----------
    points : (n, 2) float64
        No two equal among those used.
    segments : (s, 2) int
        None of zero length.

    Returns
    -------
    pairs : (c, 2) int64
        Rows of ``segments``, the smaller first, in lexicographic order.
    kind : (c,) int8
        1 crossing inside both, 2 an end of one inside the other, 3 overlapping along a line (or equal).
    """
    pairs = close_pairs(points, segments)
    s, t = segments[pairs[:, 0]], segments[pairs[:, 1]]
    (p, q), (a, b) = s.T, t.T
    signs = np.stack(
        [orient_rows(points, np.column_stack(v)) for v in ((p, q, a), (p, q, b), (a, b, p), (a, b, q))]
    )
    kind = np.zeros(len(pairs), dtype=np.int8)
    across, back = signs[0] * signs[1], signs[2] * signs[3]
    shared = (s[:, :, None] == t[:, None, :]).any(axis=(1, 2))
    kind[(across < 0) & (back < 0)] = CROSSING
    kind[(across <= 0) & (back <= 0) & (kind == 0) & ~shared] = TOUCHING
    flat = np.nonzero((signs == 0).all(axis=0))[0]
    if len(flat):
        p, q = _ordered(*points[s[flat]].transpose(1, 0, 2))
        a, b = _ordered(*points[t[flat]].transpose(1, 0, 2))
        start, end = np.where(_before(p, a)[:, None], a, p), np.where(_before(q, b)[:, None], q, b)
        kind[flat] = np.where(_before(start, end), OVERLAPPING, 0)
    found = np.nonzero(kind)[0]
    order = found[np.lexsort((pairs[found, 1], pairs[found, 0]))]
    return pairs[order], kind[order]


def _ordered(p: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    swap = _before(q, p)[:, None]
    return np.where(swap, q, p), np.where(swap, p, q)


def vertices_on_segments(points: np.ndarray, vertices: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """Rows (vertex, segment) with the vertex strictly between the ends of the segment; exact."""
    ends, at = points[segments], points[vertices]
    query, hit = BoxTree(ends.min(axis=1), ends.max(axis=1)).pairs(at, at)
    v, rows = vertices[query], segments[hit]
    own = (rows == v[:, None]).any(axis=1)
    v, rows, hit = v[~own], rows[~own], hit[~own]
    flat = orient_rows(points, np.column_stack([rows, v])) == 0
    return np.column_stack([v[flat], hit[flat]])


def crossing_place(points: np.ndarray, s: np.ndarray, t: np.ndarray) -> tuple[float, float]:
    """Where the lines of two crossing segments meet: rational arithmetic, rounded once."""
    (px, py), (qx, qy), (ax, ay), (bx, by) = (
        tuple(map(Fraction, points[v].tolist())) for v in (*s.tolist(), *t.tolist())
    )
    ux, uy, wx, wy = qx - px, qy - py, bx - ax, by - ay
    ratio = ((ax - px) * wy - (ay - py) * wx) / (ux * wy - uy * wx)
    return float(px + ratio * ux), float(py + ratio * uy)


# ---------------------------------------------------------------------- all faults of a domain


def find_faults(domain: Domain) -> list[Fault]:
    """Every fault of the straight structure, in stages: later ones are looked for if there are none before.

    Curved pieces are left to the sampling, but for their vertices.
    """
    for stage in (_indices, _duplicates, _zero_length, _repeated, _crossings, _open_vertices):
        faults = stage(domain)
        if faults:
            return faults
    return []


def _place(point: np.ndarray) -> tuple[float, float]:
    return float(point[0]), float(point[1])


def _at(place: tuple[float, float]) -> str:
    return f"at ({place[0]:.17g}, {place[1]:.17g})"


def _indices(domain: Domain) -> list[Fault]:
    n = len(domain.points)
    bad = np.nonzero(((domain.pieces < 0) | (domain.pieces >= n)).any(axis=1))[0]
    return [
        Fault(
            "index out of range",
            f"{domain.name(i)} = {domain.pieces[i].tolist()} refers to points outside 0..{n - 1}; mend the "
            "index, or let resolve=True drop the segment",
            (float("nan"), float("nan")),
            (i,),
        )
        for i in bad.tolist()
    ]


def _duplicates(domain: Domain) -> list[Fault]:
    first = first_copies(domain.points)
    result = []
    for copy in np.nonzero(first != np.arange(len(first)))[0].tolist():
        kept, place = int(first[copy]), _place(domain.points[copy])
        text = (
            f"points {kept} and {copy} are equal, {_at(place)}; use one of them, or resolve=True merges them"
        )
        result.append(Fault("duplicate points", text, place, vertices=(kept, copy)))
    return result


def _zero_length(domain: Domain) -> list[Fault]:
    result = []
    for i in np.nonzero(domain.pieces[:, 0] == domain.pieces[:, 1])[0].tolist():
        v = int(domain.pieces[i, 0])
        place = _place(domain.points[v])
        remedy = "put a second vertex on the curve" if i in domain.curves else "drop it, or resolve=True does"
        text = f"{domain.name(i)} = [{v}, {v}] has zero length, {_at(place)}; {remedy}"
        result.append(Fault("zero length", text, place, (i,), (v,)))
    return result


def _straight(domain: Domain) -> np.ndarray:
    """The straight pieces."""
    return np.setdiff1d(np.arange(len(domain.pieces)), list(domain.curves), assume_unique=True)


def _repeated(domain: Domain) -> list[Fault]:
    rows = _straight(domain)
    key = np.sort(domain.pieces[rows], axis=1)
    order = np.lexsort((rows, key[:, 1], key[:, 0]))
    same = (key[order[1:]] == key[order[:-1]]).all(axis=1)
    result = []
    for one, two in zip(rows[order[:-1][same]].tolist(), rows[order[1:][same]].tolist()):
        a, b = domain.points[domain.pieces[one]]
        place = _place((a + b) / 2)
        text = (
            f"{domain.name(one)} and {domain.name(two)} join the same points {domain.pieces[one].tolist()}, "
            f"{_at(place)}; drop one, or resolve=True (two equal facets then cancel: even-odd)"
        )
        result.append(Fault("repeated segment", text, place, (one, two)))
    return result


def _overlap_place(s: np.ndarray, t: np.ndarray) -> tuple[float, float]:
    """The middle of the common part of two segments on a line."""
    ends = np.concatenate([s, t])
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    return _place(ends[order[1]] / 2 + ends[order[2]] / 2)


def _crossings(domain: Domain) -> list[Fault]:
    rows = _straight(domain)
    segments = domain.pieces[rows]
    pairs, kinds = meetings(domain.points, segments)
    result = []
    for (i, j), kind in zip(pairs.tolist(), kinds.tolist()):
        one, two = int(rows[i]), int(rows[j])
        names = f"{domain.name(one)} = {segments[i].tolist()} and {domain.name(two)} = {segments[j].tolist()}"
        if kind == CROSSING:
            place = crossing_place(domain.points, segments[i], segments[j])
            text = f"{names} cross {_at(place)}; put a vertex there, or resolve=True splits both"
            result.append(Fault("crossing", text, place, (one, two)))
        elif kind == OVERLAPPING:
            place = _place(
                (domain.points[segments[i]].max(axis=0) + domain.points[segments[j]].min(axis=0)) / 2
            )
            text = f"{names} overlap near ({place[0]:.6g}, {place[1]:.6g}); shorten one, or resolve=True does"
            result.append(Fault("overlap", text, place, (one, two)))
    for v, i in vertices_on_segments(domain.points, np.arange(len(domain.points)), segments).tolist():
        place = _place(domain.points[v])
        text = (
            f"point {v} lies on {domain.name(int(rows[i]))} = {segments[i].tolist()}, {_at(place)}; "
            "split the segment there, or resolve=True does"
        )
        result.append(Fault("vertex on a segment", text, place, (int(rows[i]),), (v,)))
    return result


def _open_vertices(domain: Domain) -> list[Fault]:
    degree = np.bincount(domain.facets.ravel(), minlength=len(domain.points))
    result = []
    for v in np.nonzero(degree % 2)[0].tolist():
        touching = tuple(np.nonzero((domain.facets == v).any(axis=1))[0].tolist())
        place = _place(domain.points[v])
        text = (
            f"the boundary is open: {degree[v]} facet{'s meet' if degree[v] > 1 else ' ends'} at point {v}, "
            f"{_at(place)} (facets {', '.join(map(str, touching))}); an even number must meet. Close the "
            "chain, give what shall not bound as inner, or let resolve=True do so"
        )
        result.append(Fault("open boundary", text, place, touching, (v,)))
    return result
