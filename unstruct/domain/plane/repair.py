"""`Domain(..., resolve=True)`: a region is repaired, and every change is reported.

Only straight pieces are repaired. Crossing pieces are split at their common point, rounded to doubles, and
pieces are split at vertices that lie on them. Copies of points are merged, and pieces of zero length are
dropped. An even number of equal facets cancels, by the even-odd rule. A rounded point may lie on the other
side of a third piece; so all this is repeated until the exact check finds nothing. After six rounds crossings
are rounded to a grid, which becomes coarser from round to round.

An open boundary bounds nothing, and what was meant is unknown. Two cases are repaired. If a chain that is a
single path has a gap no longer than its longest piece, a facet closes the gap. Otherwise short chains of
facets between odd vertices (ends of an odd number of facets) become inner pieces. So a slit, an inner wall,
or a loose end that was given as a facet appears in the mesh and bounds nothing.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import frexp, hypot, ldexp
from typing import Any

import numpy as np

from ...base.errors import InputError
from ...geometry.curves import CurveLike
from ...geometry.segment_pairs import CROSSING, OVERLAPPING, meetings, vertices_on_segments
from .faults import crossing_place, first_copies, overlap_place

__all__ = ["Repair", "Repairer"]

REPAIR_ROUNDS = 60
NEAREST_ROUNDS = 6  # in the first so many rounds crossings are rounded to the nearest doubles


@dataclass(frozen=True)
class Repair:
    """One repair.

    Attributes
    ----------
    kind : str
        "index out of range", "duplicate points", "zero length", "repeated segment", "crossing", "overlap",
        "vertex on a segment" or "open boundary".
    text : str
        What was found and what was done. Pieces and points have the numbers of the input; new points are
        named by their coordinates.
    place : (float, float)
        Coordinates; NaN if there are none.
    pieces, vertices : tuple of int
        Pieces and points of the input that had the fault.
    """

    kind: str
    text: str
    place: tuple[float, float]
    pieces: tuple[int, ...] = ()
    vertices: tuple[int, ...] = ()

    def __str__(self) -> str:
        return f"{self.kind}: {self.text}"


@dataclass
class _Piece:
    a: int
    b: int
    origin: int  # piece of the input; -1 for one that closes a gap
    facet: bool
    curve: CurveLike | None
    names: frozenset[str]


class Repairer:
    """The pieces during their repair by `run`; the attributes are the parts of a `Domain`."""

    def __init__(
        self, points: np.ndarray, facets: np.ndarray, inner: np.ndarray, curves: Any, markers: Any
    ) -> None:
        self.points = points
        self.origin = np.arange(len(points))
        self.round = 0
        self.facets = len(facets)
        self.repairs: list[Repair] = []
        names: dict[int, set[str]] = {}
        for name, pieces in markers.items():
            for piece in pieces.tolist():
                names.setdefault(piece, set()).add(name)
        self.marker_names = list(markers)
        rows = [*facets.tolist(), *inner.tolist()]
        self.pieces = [
            _Piece(a, b, i, i < len(facets), curves.get(i), frozenset(names.get(i, ())))
            for i, (a, b) in enumerate(rows)
        ]

    def run(self) -> None:
        """Repair until nothing changes."""
        self._drop_missing()
        for self.round in range(REPAIR_ROUNDS):
            self._merge_points()
            self._drop_short()
            self._cancel_repeated()
            if not self._split() and not self._close():
                return
        raise InputError(
            f"the region could not be repaired in {REPAIR_ROUNDS} rounds; correct the pieces yourself"
        )

    def _name(self, piece: _Piece) -> str:
        if piece.origin < 0:
            return "a closing facet"
        return (
            f"facet {piece.origin}"
            if piece.origin < self.facets
            else f"inner segment {piece.origin - self.facets}"
        )

    def _place(self, vertex: int) -> tuple[float, float]:
        return float(self.points[vertex, 0]), float(self.points[vertex, 1])

    def _account(
        self, kind: str, text: str, place: tuple[float, float], pieces: Any = (), at: Any = ()
    ) -> None:
        origins = tuple(sorted({piece.origin for piece in pieces if piece.origin >= 0}))
        vertices = tuple(int(self.origin[v]) for v in at if self.origin[v] >= 0)
        self.repairs.append(Repair(kind, text, place, origins, vertices))

    def _drop_missing(self) -> None:
        n, kept = len(self.points), []
        for piece in self.pieces:
            if 0 <= piece.a < n and 0 <= piece.b < n:
                kept.append(piece)
            else:
                text = (
                    f"{self._name(piece)} = [{piece.a}, {piece.b}] names points outside 0..{n - 1}; it was "
                    "dropped"
                )
                self._account("index out of range", text, (float("nan"),) * 2, [piece])
        self.pieces = kept

    def _merge_points(self) -> None:
        first = first_copies(self.points)
        copies = np.nonzero(first != np.arange(len(first)))[0]
        if len(copies) == 0:
            return
        for copy in copies.tolist():
            kept = int(first[copy])
            text = f"point {self.origin[copy]} equals point {self.origin[kept]}; they were merged"
            self._account("duplicate points", text, self._place(kept), at=(kept, copy))
        keep = first == np.arange(len(first))
        number = (np.cumsum(keep) - 1)[first]
        for piece in self.pieces:
            piece.a, piece.b = int(number[piece.a]), int(number[piece.b])
        self.points, self.origin = self.points[keep], self.origin[keep]

    def _drop_short(self) -> None:
        kept = []
        for piece in self.pieces:
            if piece.a != piece.b or piece.curve is not None:
                kept.append(piece)
            else:
                text = f"{self._name(piece)} has zero length; it was dropped"
                self._account("zero length", text, self._place(piece.a), [piece], [piece.a])
        self.pieces = kept

    def _cancel_repeated(self) -> None:
        equal: dict[tuple[int, int], list[_Piece]] = {}
        for piece in self.pieces:
            if piece.curve is None:
                equal.setdefault((min(piece.a, piece.b), max(piece.a, piece.b)), []).append(piece)
        gone: set[int] = set()
        for (a, b), group in equal.items():
            if len(group) == 1:
                continue
            facets, inner = [p for p in group if p.facet], [p for p in group if not p.facet]
            keep = facets[0] if len(facets) % 2 else (inner[0] if inner else None)
            for other in group:
                if other is not keep:
                    gone.add(id(other))
            if keep is not None:
                keep.names = frozenset().union(*(p.names for p in group))
            names = ", ".join(self._name(p) for p in group)
            kept = f"only {self._name(keep)} was kept" if keep else "all were dropped"
            text = f"{names} join the same points; {kept} (by the even-odd rule two facets cancel)"
            middle = self.points[a] / 2 + self.points[b] / 2
            self._account("repeated segment", text, (float(middle[0]), float(middle[1])), group, (a, b))
        self.pieces = [p for p in self.pieces if id(p) not in gone]

    # ------------------------------------------------------------------ crossings

    def _split(self) -> bool:
        """Split pieces at crossings and at vertices that lie on them; return whether there were any."""
        straight = [p for p in self.pieces if p.curve is None]
        segments = np.array([(p.a, p.b) for p in straight], dtype=np.int64).reshape(-1, 2)
        pairs, kinds = meetings(self.points, segments)
        used = np.unique(segments[np.unique(pairs)]) if len(pairs) else np.empty(0, dtype=np.int64)
        loose = np.setdiff1d(np.arange(len(self.points)), [v for p in self.pieces for v in (p.a, p.b)])
        on = vertices_on_segments(self.points, np.union1d(used, loose), segments)
        cuts: dict[int, set[int]] = {}
        where = {self._place(v): v for v in range(len(self.points))} if (kinds == CROSSING).any() else {}
        fresh: list[tuple[float, float]] = []
        for (i, j), kind in zip(pairs.tolist(), kinds.tolist()):
            names = f"{self._name(straight[i])} and {self._name(straight[j])}"
            if kind == CROSSING:
                place = self._rounded(crossing_place(self.points, segments[i], segments[j]))
                vertex = where.setdefault(place, len(self.points) + len(fresh))
                if vertex == len(self.points) + len(fresh):
                    fresh.append(place)
                for s in (i, j):
                    cuts.setdefault(s, set()).add(vertex)
                text = f"{names} cross; both were split at ({place[0]:.17g}, {place[1]:.17g})"
                self._account("crossing", text, place, [straight[i], straight[j]])
            elif kind == OVERLAPPING:
                place = overlap_place(self.points[segments[i]], self.points[segments[j]])
                text = f"{names} overlap; they were split at each other's ends, and then compared"
                self._account("overlap", text, place, [straight[i], straight[j]])
        for v, s in on.tolist():
            cuts.setdefault(s, set()).add(v)
            point = f"point {self.origin[v]}" if self.origin[v] >= 0 else "a new point"
            text = f"{point} lies on {self._name(straight[s])}, which was split there"
            self._account("vertex on a segment", text, self._place(v), [straight[s]], [v])
        if fresh:
            self.points = np.concatenate([self.points, np.array(fresh)])
            self.origin = np.concatenate([self.origin, np.full(len(fresh), -1)])
        self._cut(straight, cuts)
        return bool(cuts)

    def _rounded(self, place: tuple[float, float]) -> tuple[float, float]:
        """The crossing as it is in the first rounds; later on a grid whose spacing doubles with each round.

        If the coordinates of the input have few digits left in one direction, every split may bend segments
        so that they cross again. A coarser grid has fewer places for crossings.
        """
        if self.round < NEAREST_ROUNDS:
            return place
        spacing = ldexp(1.0, frexp(float(np.abs(self.points).max()))[1] - 53 + self.round - NEAREST_ROUNDS)
        x, y = (round(c / spacing) * spacing for c in place)
        return x, y

    def _cut(self, straight: list[_Piece], cuts: dict[int, set[int]]) -> None:
        at = {id(straight[s]): vertices for s, vertices in cuts.items()}
        result = []
        for piece in self.pieces:
            inside = at.get(id(piece), set()) - {piece.a, piece.b}
            chain = [piece.a, *self._along(piece, inside), piece.b]
            for a, b in pairwise(chain):
                result.append(_Piece(a, b, piece.origin, piece.facet, piece.curve, piece.names))
        self.pieces = result

    def _along(self, piece: _Piece, vertices: set[int]) -> list[int]:
        if len(vertices) < 2:
            return list(vertices)
        (ax, ay), (bx, by) = (tuple(map(Fraction, self._place(v))) for v in (piece.a, piece.b))

        def share(v: int) -> tuple[Fraction, int]:
            x, y = map(Fraction, self._place(v))
            return (x - ax) * (bx - ax) + (y - ay) * (by - ay), v

        return sorted(vertices, key=share)

    # ------------------------------------------------------------------ open boundary

    def _close(self) -> bool:
        """Make every vertex even; return whether a facet was added, which may cross others."""
        facets = [p for p in self.pieces if p.facet]
        at: dict[int, list[_Piece]] = {}
        for piece in facets:
            for v in (piece.a, piece.b):
                at.setdefault(v, []).append(piece)
        odd = sorted(v for v, touching in at.items() if len(touching) % 2)
        join: dict[int, _Piece] = {}
        waiting = set(odd)
        for v in odd:
            if v in waiting:
                end, path = _nearest(self.points, at, v, waiting)
                waiting -= {v, end}
                for piece in path:
                    if join.pop(id(piece), None) is None:
                        join[id(piece)] = piece
        forest = _without_cycles(list(join.values()), set(odd))
        join = {id(piece): piece for piece in forest}
        added = False
        for chain in _connected(forest):
            added |= self._mend_chain(chain, at, join)
        return added

    def _mend_chain(self, chain: list[_Piece], at: dict[int, list[_Piece]], join: dict[int, _Piece]) -> bool:
        ends = [v for v, k in _degrees(chain).items() if k % 2]
        whole = all(id(piece) in join for v in _degrees(chain) for piece in at[v])
        path = whole and len(ends) == 2 and max(_degrees(chain).values()) == 2 and len(chain) > 1
        names = ", ".join(dict.fromkeys(self._name(piece) for piece in chain))
        if path:
            gap = hypot(*(self.points[ends[0]] - self.points[ends[1]]))
            longest = max(hypot(*(self.points[p.a] - self.points[p.b])) for p in chain)
            if gap <= longest:
                self.pieces.append(_Piece(ends[0], ends[1], -1, True, None, frozenset()))
                text = (
                    f"the chain of {names} had a gap no longer than its longest piece; a facet was added "
                    "that closes it"
                )
                self._account("open boundary", text, self._place(ends[0]), chain, ends)
                return True
        for piece in chain:
            piece.facet = False
        text = f"{names} cannot be a boundary (an odd number of facets meet at the ends), and became inner"
        self._account("open boundary", text, self._place(ends[0]), chain, ends)
        return False


def _degrees(chain: list[_Piece]) -> dict[int, int]:
    degrees: dict[int, int] = {}
    for piece in chain:
        for v in (piece.a, piece.b):
            degrees[v] = degrees.get(v, 0) + 1
    return degrees


def _connected(pieces: list[_Piece]) -> list[list[_Piece]]:
    parent: dict[int, int] = {}

    def root(v: int) -> int:
        while parent.setdefault(v, v) != v:
            parent[v] = parent[parent[v]]
            v = parent[v]
        return v

    for piece in pieces:
        parent[root(piece.a)] = root(piece.b)
    groups: dict[int, list[_Piece]] = {}
    for piece in pieces:
        groups.setdefault(root(piece.a), []).append(piece)
    return list(groups.values())


def _without_cycles(pieces: list[_Piece], odd: set[int]) -> list[_Piece]:
    """Those pieces of a spanning forest that have an odd number of odd vertices on either side."""
    at: dict[int, list[_Piece]] = {}
    for piece in pieces:
        for v in (piece.a, piece.b):
            at.setdefault(v, []).append(piece)
    order: list[tuple[int, int, _Piece]] = []  # vertex, its parent, the piece between, parents first
    seen: set[int] = set()
    for root in at:
        if root in seen:
            continue
        seen.add(root)
        stack = [root]
        while stack:
            v = stack.pop()
            for piece in at[v]:
                other = piece.b if piece.a == v else piece.a
                if other not in seen:
                    seen.add(other)
                    order.append((other, v, piece))
                    stack.append(other)
    below = {v: v in odd for v in at}
    kept = []
    for v, parent, piece in reversed(order):
        if below[v]:
            kept.append(piece)
            below[parent] = not below[parent]
    return kept


def _nearest(
    points: np.ndarray, at: dict[int, list[_Piece]], start: int, waiting: set[int]
) -> tuple[int, list[_Piece]]:
    """The nearest odd vertex along facets, and the path to it (Dijkstra).

    There is one, because each connected part has an even number of odd vertices.
    """
    done: dict[int, tuple[int, _Piece | None]] = {}
    queue: list[tuple[float, int, int, _Piece | None]] = [(0.0, start, start, None)]
    while queue:
        length, v, before, piece = heapq.heappop(queue)
        if v in done:
            continue
        done[v] = before, piece
        if v != start and v in waiting:
            path = []
            end = v
            while done[v][1] is not None:
                path.append(done[v][1])
                v = done[v][0]
            return end, path  # type: ignore[return-value]
        for side in at[v]:
            other = side.b if side.a == v else side.a
            if other not in done:
                step = hypot(*(points[side.a] - points[side.b]))
                heapq.heappush(queue, (length + step, other, v, side))
    raise AssertionError("a graph with a single odd vertex")
