"""`Domain(..., resolve=True)`: a region is repaired, and every change is reported.

Crossing pieces are split at their common point, rounded to doubles, and pieces are split at vertices that lie
on them; this holds for straight pieces and circular arcs, not for other curves. Copies of points are merged,
and pieces of zero length are dropped. An even number of equal facets cancels, by the even-odd rule. A rounded
point may lie on the other side of a third piece; so all this is repeated until the exact check finds nothing.
After six rounds crossings are rounded to a grid, which becomes coarser from round to round. Vertices whose
pieces have all gone go with them.

An open boundary bounds nothing; `open_boundary` closes it or makes its pieces inner ones.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import frexp, hypot, ldexp
from typing import Any

import numpy as np

from ...base.errors import InputError
from ...geometry.curves import Arc, CurveLike
from ...geometry.outline import Outline, piece_name
from ...geometry.segment_pairs import CROSSING, OVERLAPPING, meetings, vertices_on_segments
from .account import Place, Repair
from .arc_meetings import arc_meetings, arc_parts
from .faults import crossing_place, first_copies, not_ends, overlap_place
from .name_sets import name_sets
from .open_boundary import Chain, open_chains

__all__ = ["Repair", "Repairer"]

REPAIR_ROUNDS = 60
NEAREST_ROUNDS = 6  # in the first so many rounds crossings are rounded to the nearest doubles
SAME_ARC = (
    2.0**-42
)  # arcs with the same ends are equal if their middles are nearer (unit: largest coordinate)


class Repairer:
    """The pieces during their repair by `run`: one row of arrays for each.

    Attributes
    ----------
    points, origin : ndarray
        The vertices, and their numbers in the input.
    ends : (m, 2) int64
    piece : (m,) int64
        The piece of the input; -1 for one that closes a gap.
    facet : (m,) bool
    label : (m,) int64
        The number of its set of names in ``sets``.
    curve : (m,) int64
        Its number in ``curves``; -1 for straight pieces.
    repairs : list of Repair
    """

    def __init__(self, outline: Outline) -> None:
        many = len(outline.pieces)
        self.points, self.origin = outline.points, np.arange(len(outline.points))
        self.ends, self.piece = outline.pieces.astype(np.int64), np.arange(many)
        self.facets = len(outline.facets)
        self.facet = self.piece < self.facets
        self.label, self.sets = name_sets(outline.markers, many)
        self.curves: list[CurveLike] = list(outline.curves.values())
        self.curve = np.full(many, -1)
        self.curve[list(outline.curves)] = np.arange(len(self.curves))
        self.used = np.zeros(len(self.points), dtype=bool)  # loose vertices of the input stay
        self.by_x: np.ndarray | None = None
        self.round = 0
        self.repairs: list[Repair] = []

    def run(self) -> None:
        """Repair until nothing changes."""
        self._drop_missing()
        self.used[self.ends.ravel()] = True
        for self.round in range(REPAIR_ROUNDS):
            self._merge_points(first_copies(self.points))
            self._drop_short()
            self._cancel_repeated()
            if not self._split() and not self._close():
                self._drop_vertices()
                return self._refuse_nothing()
        raise InputError(
            f"the region could not be repaired in {REPAIR_ROUNDS} rounds; correct the pieces yourself"
        )

    # ------------------------------------------------------------------ the account

    def _name(self, row: int) -> str:
        piece = int(self.piece[row])
        return "a closing facet" if piece < 0 else piece_name(piece, self.facets)

    def _point(self, vertex: int) -> str:
        return f"point {self.origin[vertex]}" if self.origin[vertex] >= 0 else "a new point"

    def _place(self, vertex: int) -> Place:
        return float(self.points[vertex, 0]), float(self.points[vertex, 1])

    def _account(self, kind: str, text: str, place: Place, rows: Any = (), at: Any = ()) -> None:
        pieces = tuple(sorted({int(self.piece[r]) for r in rows if self.piece[r] >= 0}))
        vertices = tuple(int(self.origin[v]) for v in at if self.origin[v] >= 0)
        self.repairs.append(Repair(kind, text, place, pieces, vertices))

    # ------------------------------------------------------------------ what goes

    def _keep(self, rows: np.ndarray) -> None:
        """Keep these rows (a mask, or row numbers with repetitions)."""
        self.ends, self.piece, self.facet = self.ends[rows], self.piece[rows], self.facet[rows]
        self.label, self.curve = self.label[rows], self.curve[rows]

    def _drop_missing(self) -> None:
        n = len(self.points)
        there = (self.ends[:, 0] >= 0) & (self.ends[:, 1] >= 0) & (self.ends.max(axis=1, initial=-1) < n)
        for row in np.nonzero(~there)[0].tolist():
            a, b = self.ends[row].tolist()
            text = f"{self._name(row)} = [{a}, {b}] names points outside 0..{n - 1}; it was dropped"
            self._account("index out of range", text, (float("nan"),) * 2, [row])
        if not there.all():
            self._keep(there)

    def _merge_points(self, first: np.ndarray) -> None:
        """Let the vertices ``first``, which are their own first, stand for all."""
        keep = first == np.arange(len(first))
        if keep.all():
            return
        for copy in np.nonzero(~keep)[0].tolist():
            kept = int(first[copy])
            equal = "equals" if (self.points[copy] == self.points[kept]).all() else "nearly equals"
            text = f"{self._point(copy)} {equal} {self._point(kept)}; they were merged"
            self._account("duplicate points", text, self._place(kept), at=(kept, copy))
        loose = np.zeros(len(first), dtype=bool)
        np.logical_or.at(loose, first, ~self.used)
        self.ends = (np.cumsum(keep) - 1)[first][self.ends]
        self.points, self.origin, self.used = self.points[keep], self.origin[keep], ~loose[keep]

    def _drop_short(self) -> None:
        short = (self.ends[:, 0] == self.ends[:, 1]) & (self.curve < 0)
        for row in np.nonzero(short)[0].tolist():
            vertex = int(self.ends[row, 0])
            text = f"{self._name(row)} has zero length; it was dropped"
            self._account("zero length", text, self._place(vertex), [row], [vertex])
        if short.any():
            self._keep(~short)

    def _cancel_repeated(self) -> None:
        low, high = np.sort(self.ends, axis=1).T
        key = low * len(self.points) + high
        order = np.argsort(key, kind="stable")
        again = np.nonzero(key[order[1:]] == key[order[:-1]])[0]
        if len(again) == 0:
            return
        groups: dict[int, list[int]] = {}
        for row in np.unique(np.concatenate([order[again], order[again + 1]])).tolist():
            groups.setdefault(int(key[row]), []).append(row)
        gone = np.zeros(len(self.ends), dtype=bool)
        for rows in groups.values():
            for same in self._same(rows):
                self._cancel(same, gone)
        if gone.any():
            self._keep(~gone)

    def _same(self, rows: list[int]) -> list[list[int]]:
        """Those rows with the same ends that are the same: straight, or arcs with the same middle."""
        straight = [row for row in rows if self.curve[row] < 0]
        arcs = [row for row in rows if self.curve[row] >= 0 and isinstance(self._curve(row), Arc)]
        near = SAME_ARC * float(np.abs(self.points).max())
        classes: list[tuple[np.ndarray, list[int]]] = []
        for row in arcs:
            middle = self._curve(row).point(np.array([0.5]))[0]
            for other, known in classes:
                if hypot(*(middle - other)) <= near:
                    known.append(row)
                    break
            else:
                classes.append((middle, [row]))
        return [same for same in (straight, *(known for _, known in classes)) if len(same) > 1]

    def _cancel(self, rows: list[int], gone: np.ndarray) -> None:
        facets, inner = [r for r in rows if self.facet[r]], [r for r in rows if not self.facet[r]]
        keep = facets[0] if len(facets) % 2 else (inner[0] if inner else None)
        gone[rows] = True
        if keep is not None:
            gone[keep] = False
            self.sets.append(frozenset().union(*(self.sets[self.label[r]] for r in rows)))
            self.label[keep] = len(self.sets) - 1
        names = ", ".join(self._name(r) for r in rows)
        kept = f"only {self._name(keep)} was kept" if keep is not None else "all were dropped"
        text = f"{names} join the same points; {kept} (by the even-odd rule two facets cancel)"
        a, b = self.ends[rows[0]]
        middle = self.points[a] / 2 + self.points[b] / 2
        self._account("repeated segment", text, (float(middle[0]), float(middle[1])), rows, (a, b))

    def _drop_vertices(self) -> None:
        """Drop vertices that had pieces and have none any more."""
        bare = self.used.copy()
        bare[self.ends.ravel()] = False
        if not bare.any():
            return
        for vertex in np.nonzero(bare & (self.origin >= 0))[0].tolist():
            text = f"{self._point(vertex)} is not on any piece that is left; it was dropped"
            self._account("vertex without pieces", text, self._place(vertex), at=[vertex])
        self.ends = (np.cumsum(~bare) - 1)[self.ends]
        self.points, self.origin, self.used = self.points[~bare], self.origin[~bare], self.used[~bare]

    def _refuse_nothing(self) -> None:
        if self.facets and not self.facet.any():
            first = next(r for r in reversed(self.repairs) if r.kind != "vertex without pieces")
            raise InputError(
                f"no facet is left that bounds a region after {len(self.repairs)} repairs, the last of "
                f"facets: {first.text}. Give rings that enclose an area; or, to mesh the convex hull, give "
                "all segments as inner and no facets"
            )

    # ------------------------------------------------------------------ crossings

    def _curve(self, row: int) -> CurveLike:
        return self.curves[self.curve[row]]

    def _split(self) -> bool:
        """Split pieces at crossings and at vertices that lie on them; return whether there were any."""
        cuts: dict[int, set[int]] = {}
        fresh: dict[Place, int] = {}
        self.by_x = None
        merged = self._split_arcs(cuts, fresh)
        self._split_straight(cuts, fresh)
        if fresh:
            places = np.array(list(fresh))
            self.points = np.concatenate([self.points, places])
            self.origin = np.concatenate([self.origin, np.full(len(places), -1)])
            self.used = np.concatenate([self.used, np.ones(len(places), dtype=bool)])
        self._cut(cuts)
        if merged:
            first = np.arange(len(self.points))
            first[list(merged)] = list(merged.values())
            self._merge_points(first)
        return bool(cuts or merged)

    def _split_straight(self, cuts: dict[int, set[int]], fresh: dict[Place, int]) -> None:
        rows = np.nonzero(self.curve < 0)[0]
        segments = self.ends[rows]
        pairs, kinds = meetings(self.points, segments)
        suspects = np.union1d(segments[np.unique(pairs)], not_ends(self.points, segments))
        on = vertices_on_segments(self.points, suspects, segments)
        for (i, j), kind in zip(rows[pairs].tolist(), kinds.tolist()):
            if kind == CROSSING:
                place = self._rounded(crossing_place(self.points, self.ends[i], self.ends[j]))
                self._crossing((i, j), place, self._vertex(place, fresh), cuts)
            elif kind == OVERLAPPING:
                place = overlap_place(self.points[self.ends[i]], self.points[self.ends[j]])
                names = f"{self._name(i)} and {self._name(j)}"
                text = f"{names} overlap; they were split at each other's ends, and then compared"
                self._account("overlap", text, place, [i, j])
        for v, s in on.tolist():
            self._touch(int(rows[s]), v, cuts)

    def _split_arcs(self, cuts: dict[int, set[int]], fresh: dict[Place, int]) -> dict[int, int]:
        """Find where arcs are to be split; the vertices that go, and those that stand for them."""
        bent = np.nonzero(self.curve >= 0)[0]
        arcs = [row for row in bent.tolist() if isinstance(self._curve(row), Arc)]
        if not arcs:
            return {}
        for row in arcs:
            if self.ends[row, 0] == self.ends[row, 1]:  # a full circle
                x, y = self._curve(row).point(np.array([0.5]))[0].tolist()
                cuts[row] = {self._vertex((x, y), fresh)}
                text = f"{self._name(row)} is closed; it was split at a new vertex"
                self._account("closed curve", text, (x, y), [row])
        if cuts:
            return {}
        merged = {}
        curves = {row: self._curve(row) for row in bent.tolist()}
        for kind, pieces, among, v, place, other in arc_meetings(
            self.points, self.ends.astype(np.int32), curves
        ):
            if kind == "duplicate points":
                merged[v] = other
            elif len(pieces) > 1:
                self._crossing(among, place, self._vertex(place, fresh) if v < 0 else v, cuts)
            else:
                self._touch(pieces[0], v, cuts)
        return merged

    def _touch(self, row: int, vertex: int, cuts: dict[int, set[int]]) -> None:
        """Split a piece at a vertex on it, and account for it."""
        inside = cuts.setdefault(row, set())
        if vertex not in inside:
            inside.add(vertex)
            kind = "vertex on a segment" if self.curve[row] < 0 else "vertex on an arc"
            text = f"{self._point(vertex)} lies on {self._name(row)}, which was split there"
            self._account(kind, text, self._place(vertex), [row], [vertex])

    def _crossing(self, rows: tuple[int, ...], place: Place, vertex: int, cuts: dict[int, set[int]]) -> None:
        """Split two pieces at a vertex, and account for it."""
        for row in rows:
            cuts.setdefault(row, set()).add(vertex)
        names = " and ".join(self._name(row) for row in rows)
        rule = "; inside is what an odd number of facets encloses" if self.facet[list(rows)].all() else ""
        text = f"{names} cross; both were split at ({place[0]:.17g}, {place[1]:.17g}){rule}"
        self._account("crossing", text, place, rows)

    def _vertex(self, place: Place, fresh: dict[Place, int]) -> int:
        """The number of the vertex at a place, which is a new one unless there is one already."""
        if place not in fresh:
            if self.by_x is None:
                self.by_x = np.argsort(self.points[:, 0], kind="stable")
            x = self.points[:, 0]
            first, last = (int(np.searchsorted(x, place[0], side, self.by_x)) for side in ("left", "right"))
            for vertex in self.by_x[first:last].tolist():
                if self.points[vertex, 1] == place[1]:
                    return vertex
            fresh[place] = len(self.points) + len(fresh)
        return fresh[place]

    def _rounded(self, place: Place) -> Place:
        """The crossing as it is in the first rounds; later on a grid whose spacing doubles with each round.

        If the coordinates of the input have few digits left in one direction, every split may bend segments
        so that they cross again. A coarser grid has fewer places for crossings.
        """
        if self.round < NEAREST_ROUNDS:
            return place
        spacing = ldexp(1.0, frexp(float(np.abs(self.points).max()))[1] - 53 + self.round - NEAREST_ROUNDS)
        x, y = (round(c / spacing) * spacing for c in place)
        return x, y

    def _cut(self, cuts: dict[int, set[int]]) -> None:
        chains = {}
        for row, vertices in cuts.items():
            inside = vertices - set(self.ends[row].tolist())
            if inside:
                chains[row] = self._along(row, inside)
        times = np.ones(len(self.ends), dtype=np.int64)
        for row, (along, _) in chains.items():
            times[row] = len(along) - 1
        self._keep(np.repeat(np.arange(len(times)), times))
        start = np.cumsum(times) - times
        for row, (along, arcs) in chains.items():
            for k, pair in enumerate(pairwise(along)):
                self.ends[start[row] + k] = pair
                if arcs:
                    self.curve[start[row] + k] = len(self.curves)
                    self.curves.append(arcs[k])

    def _along(self, row: int, vertices: set[int]) -> tuple[list[int], list[Arc]]:
        """The vertices of a piece in order, with its ends; for an arc the parts between them."""
        a, b = self.ends[row].tolist()
        if self.curve[row] >= 0:
            return arc_parts(self._curve(row), self.points, a, list(vertices), b)
        if len(vertices) == 1:
            return [a, *vertices, b], []
        (ax, ay), (bx, by) = (tuple(map(Fraction, self._place(v))) for v in (a, b))

        def share(v: int) -> tuple[Fraction, int]:
            x, y = map(Fraction, self._place(v))
            return (x - ax) * (bx - ax) + (y - ay) * (by - ay), v

        return [a, *sorted(vertices, key=share), b], []

    # ------------------------------------------------------------------ open boundary

    def _close(self) -> bool:
        """Make every vertex even; return whether a facet was added, which may cross others."""
        added = False
        for chain in open_chains(self.points, self.ends, self.facet):
            added |= self._mend(chain)
        return added

    def _mend(self, chain: Chain) -> bool:
        names = ", ".join(dict.fromkeys(self._name(row) for row in chain.rows))
        place = self._place(chain.ends[0])
        if chain.closing:
            text = (
                f"the chain of {names} had a gap no longer than its longest piece; a facet was added that "
                "closes it"
            )
            self._account("open boundary", text, place, chain.rows, chain.ends)
            self.ends = np.concatenate([self.ends, [chain.ends]])
            self.piece, self.facet = np.append(self.piece, -1), np.append(self.facet, True)
            self.label, self.curve = np.append(self.label, 0), np.append(self.curve, -1)
            return True
        self.facet[chain.rows] = False
        text = f"{names} cannot be a boundary (an odd number of facets meet at the ends), and became inner"
        self._account("open boundary", text, place, chain.rows, chain.ends)
        return False
