"""`Domain(..., resolve=True)` in space: a surface is repaired, and every change is reported.

Copies of points are merged; facets without area go; an even number of equal facets cancels, by the even-odd
rule, unless the surface is closed only with one of them. Facets are split at vertices that lie on them, and
along edges in their plane; where facets overlap in a plane, what an even number of them covers goes. All
this is exact. What would need rounded vertices is refused: facets that cross, and overlaps whose sides cross
where there is no double. Flat sheets that end at open edges become inner pieces; other open surfaces are
refused, because nobody knows what was meant to close them. At last all facets are turned to face outward.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple, NoReturn

import numpy as np

from ...base.errors import InputError
from ...geometry.embedded import flat_rows
from ...geometry.outline import Outline
from ...geometry.polygons import Polygons
from ...geometry.triangle_pairs import PIERCES, Meetings, edges_of, meetings_in_space, unit_points
from ..plane.account import Place, Repair
from ..plane.faults import Fault, refuse
from ..plane.name_sets import name_sets
from .closing import join_seams, set_sheets_apart, turn_outward
from .cutting import Shell, cut, place
from .faults import NO_PLACE, crossing_faults, first_copies, meeting_faults
from .same_facets import same_facets
from .splitting import Splitting
from .tangled import cleaned, untangled, without_area
from .welding import with_hint

__all__ = ["NAMES_SHOWN", "SpaceRepairer"]

REPAIR_ROUNDS_IN_SPACE = 30

NAMES_SHOWN = 8


class Standing(Outline):
    """The pieces as they stand during a repair; messages call them as in the input."""

    def __init__(self, repairer: SpaceRepairer):
        polygons, facets = repairer.polygons, int(repairer.facet.sum())
        rows = np.arange(len(polygons))
        parts = polygons.select(rows[:facets]), polygons.select(rows[facets:])
        super().__init__(repairer.points, *parts, {}, {}, {})
        self.given, self.origin_of = repairer.outline, repairer.piece.copy()

    def name(self, piece: int) -> str:
        """The name of the piece of the input."""
        return self.given.name(int(self.origin_of[piece]))


class Met(NamedTuple):
    """What met what in a round."""

    standing: Standing
    shell: Shell
    edges: np.ndarray
    met: Meetings


class SpaceRepairer:
    """The pieces during their repair by `run`: one row of arrays for each, facets first.

    Points keep their numbers until the end; new ones are appended.

    Attributes
    ----------
    points : (n, 3) float64
    polygons : Polygons
    piece : (m,) int64
        The piece of the input.
    facet : (m,) bool
    label : (m,) int64
        The number of its set of names in ``sets``.
    repairs : list of Repair
    """

    def __init__(self, outline: Outline) -> None:
        self.outline, self.points, self.given = outline, outline.points, len(outline.points)
        self.polygons: Polygons = outline.pieces
        many = len(self.polygons)
        self.piece = np.arange(many)
        self.facet = self.piece < len(outline.facets)
        self.label, self.sets = name_sets(outline.markers, many)
        self.gone = np.zeros(self.given, dtype=bool)  # copies of other points
        self.used = np.zeros(self.given, dtype=bool)  # vertices that have had pieces; others stay loose
        self.repairs: list[Repair] = []
        self.first: Met | None = None  # what met what at the beginning, and in the end
        self.met: Met | None = None

    def run(self) -> None:
        """Repair until nothing changes; raise for what cannot be repaired."""
        self._drop_missing()
        self._merge_points()
        self.used[self.polygons.vertices] = True
        for _ in range(REPAIR_ROUNDS_IN_SPACE):
            self._clean()
            self._cancel_repeated()
            if not self._split() and not join_seams(self):
                break
        else:
            self._refuse_meetings(self.met)
            raise InputError(
                f"the surface could not be repaired in {REPAIR_ROUNDS_IN_SPACE} rounds; correct the facets "
                "yourself"
            )
        self._refuse_nothing()
        set_sheets_apart(self)
        turn_outward(self)

    # ------------------------------------------------------------------ the account

    def called(self, row: int) -> str:
        """What the piece of a row is called in the input."""
        return self.outline.name(int(self.piece[row]))

    def called_all(self, rows: Sequence[int]) -> str:
        """The different names of rows, at most `NAMES_SHOWN` of them."""
        pieces = sorted({int(self.piece[r]) for r in rows})
        names = ", ".join(self.outline.name(i) for i in pieces[:NAMES_SHOWN])
        return names + (f" and {len(pieces) - NAMES_SHOWN} more" if len(pieces) > NAMES_SHOWN else "")

    def point(self, vertex: int) -> str:
        """What a vertex is called."""
        return f"point {vertex}" if vertex < self.given else "a new point"

    def account(self, kind: str, text: str, where: Place, rows: Any = (), at: Any = ()) -> None:
        """Report a repair of these rows and vertices."""
        pieces = tuple(sorted({int(self.piece[r]) for r in rows}))
        vertices = tuple(int(v) for v in at if v < self.given)
        self.repairs.append(Repair(kind, text, where, pieces, vertices))

    def _at(self, vertex: int) -> Place:
        return place(self.points[vertex])

    def refuse(self, found: list[Fault], standing: Standing | None = None) -> NoReturn:
        """Raise for faults of the pieces as they stand, or stood, with the numbers of the input."""
        piece = self.piece if standing is None else standing.origin_of
        here = [
            replace(
                fault,
                pieces=tuple(sorted({int(piece[i]) for i in fault.pieces})),
                vertices=tuple(v for v in fault.vertices if v < self.given),
            )
            for fault in found
        ]
        refuse(self.outline, with_hint(self.outline, here))
        raise AssertionError("nothing to refuse")

    # ------------------------------------------------------------------ rows

    def exchange(
        self, gone: np.ndarray, rings: list[Any], sources: list[int], labels: dict[int, int] | None = None
    ) -> None:
        """Drop rows (a mask) and append polygons, which take the attributes of their sources.

        ``labels`` gives those new ones that have another set of names.
        """
        keep, source = np.flatnonzero(~gone), np.array(sources, dtype=np.int64)
        self.polygons = Polygons.joined(self.polygons.select(keep), Polygons.of_rings(rings))
        rows = np.concatenate([keep, source])
        self.piece, self.facet, label = self.piece[rows], self.facet[rows], self.label[rows]
        for k, number in (labels or {}).items():
            label[len(keep) + k] = number
        self.label = label
        self.sort()

    def sort(self) -> None:
        """Facets first, each kind by the numbers of the input."""
        order = np.lexsort((self.piece, ~self.facet))
        if (order != np.arange(len(order))).any():
            self.polygons = self.polygons.select(order)
            self.piece, self.facet, self.label = self.piece[order], self.facet[order], self.label[order]

    def named(self, rows: Sequence[int]) -> int:
        """The number of the set of all names of these rows."""
        labels = {int(self.label[r]) for r in rows}
        if len(labels) == 1:
            return labels.pop()
        self.sets.append(frozenset().union(*(self.sets[k] for k in labels)))
        return len(self.sets) - 1

    def standing(self) -> Standing:
        """The pieces as they stand, for messages."""
        return Standing(self)

    def shell(self) -> tuple[Shell, list[Fault]]:
        """The triangles of the pieces, and what is wrong with their rings."""
        return cut(self.points, self.polygons, int(self.facet.sum()))

    # ------------------------------------------------------------------ points and rings

    def _drop_missing(self) -> None:
        n, flat = self.given, self.polygons.vertices
        bad = (flat < 0) | (flat >= n)
        if not bad.any():
            return
        owner = np.repeat(np.arange(len(self.polygons)), self.polygons.corners)[bad]
        for i, v in dict(zip(owner.tolist(), flat[bad].tolist())).items():
            text = f"{self.called(i)} names points outside 0..{n - 1}, such as {v}; it was dropped"
            self.account("index out of range", text, NO_PLACE, [i])
        gone = np.zeros(len(self.polygons), dtype=bool)
        gone[owner] = True
        self.exchange(gone, [], [])

    def _merge_points(self) -> None:
        first = first_copies(self.points)
        self.gone = first != np.arange(len(first))
        copies = np.flatnonzero(self.gone)
        if len(copies) > NAMES_SHOWN:  # as where each facet has its own corners
            text = (
                f"{len(copies)} points equal others (point {copies[0]}, for example, point "
                f"{first[copies[0]]}); they were merged, which leaves {len(first) - len(copies)} points"
            )
            at = np.flatnonzero(np.isin(np.arange(len(first)), first[copies]) | self.gone)
            self.account("duplicate points", text, self._at(int(copies[0])), at=at)
            copies = copies[:0]
        for copy in copies.tolist():
            kept = int(first[copy])
            text = f"point {copy} equals point {kept}; they were merged"
            self.account("duplicate points", text, self._at(kept), at=(kept, copy))
        if self.gone.any():
            self.polygons = self.polygons.renumbered(first.astype(np.int32))

    def _clean(self) -> None:
        """Mend rings, and drop what has no area."""
        self._clean_repeated_vertices()
        shell, faults = self.shell()
        if faults:
            self._cut_rings(faults)
            shell, faults = self.shell()
            if faults:
                self.refuse([replace(f, text=f.text.format(name=self.called(f.pieces[0]))) for f in faults])
        gone = np.zeros(len(self.polygons), dtype=bool)
        for t in flat_rows(self.points, shell.triangles).tolist():
            row = int(shell.piece[t])
            gone[row] = True
            self._no_area(row, shell.triangles[t].tolist())
        if gone.any():
            self.exchange(gone, [], [])

    def _no_area(self, row: int, vertices: list[int]) -> None:
        what = "length" if self.polygons.corners[row] == 2 else "area"
        text = f"{self.called(row)} has no {what}; it was dropped"
        self.account(f"zero {what}", text, self._at(vertices[0]), [row], dict.fromkeys(vertices))

    def _clean_repeated_vertices(self) -> None:
        polygons = self.polygons
        owner = np.repeat(np.arange(len(polygons)), polygons.corners)
        order = np.lexsort((polygons.vertices, owner))
        same = (np.diff(owner[order]) == 0) & (np.diff(polygons.vertices[order]) == 0)
        rows = np.unique(owner[order[1:][same]]).tolist()
        if not rows:
            return
        gone = np.zeros(len(polygons), dtype=bool)
        rings: list[Any] = []
        sources: list[int] = []
        xyz = unit_points(self.points)
        for i in rows:
            gone[i] = True
            old = polygons.vertices_of(i).tolist()
            least = 2 if len(old) == 2 else 3
            kept = [ring for ring in (cleaned(r.tolist()) for r in polygons.rings(i)) if len(ring) >= least]
            twice = next(v for k, v in enumerate(old) if v in old[:k])
            if not kept:
                self._no_area(i, old)
                continue
            flat = [v for ring in kept for v in ring]
            if len(set(flat)) == len(flat):
                rings.append(kept)
                sources.append(i)
                did = f"it has {len(flat)} vertices now"
            else:
                found = untangled(xyz, kept)
                if found is None:
                    self._refuse_ring(i, twice)
                rings += [[t] for t in found]
                sources += [i] * len(found)
                did = f"it was cut into {len(found)} triangles"
            text = f"{self.called(i)} has {self.point(twice)} twice; {did}"
            self.account("repeated vertex", text, self._at(twice), [i], [twice])
        self.exchange(gone, rings, sources)

    def _refuse_ring(self, row: int, vertex: int) -> NoReturn:
        text = (
            f"{self.called(row)} crosses itself, near point {vertex}; give its vertices in order, or cut it "
            "into facets that are simple"
        )
        self.refuse([Fault("crossing itself", text, self._at(vertex), (row,), (vertex,))])

    def _cut_rings(self, faults: list[Fault]) -> None:
        """Cut polygons that are not flat, or touch themselves, into triangles; drop those without area."""
        gone = np.zeros(len(self.polygons), dtype=bool)
        rings: list[Any] = []
        sources: list[int] = []
        xyz = unit_points(self.points)
        for fault in faults:
            row, vertices = fault.pieces[0], self.polygons.vertices_of(fault.pieces[0])
            if without_area(xyz, vertices):
                gone[row] = True
                self._no_area(row, vertices.tolist())
                continue
            found = untangled(xyz, self.polygons.rings(row))
            if found is None:
                continue
            gone[row] = True
            rings += [[t] for t in found]
            sources += [row] * len(found)
            why = "is not flat" if fault.kind == "not flat" else "touches itself"
            text = f"{self.called(row)} {why}; it was cut into {len(found)} triangles"
            self.account(fault.kind, text, fault.place, [row], fault.vertices)
        self.exchange(gone, rings, sources)

    # ------------------------------------------------------------------ equal facets, touching facets

    def _cancel_repeated(self) -> None:
        gone = np.zeros(len(self.polygons), dtype=bool)
        for rows, kept in same_facets(self.polygons, self.facet):
            gone[rows] = True
            vertices = self.polygons.vertices_of(rows[0])
            if kept >= 0:
                gone[kept] = False
                self.label[kept] = self.named(rows)
            did = f"only {self.called(kept)} was kept" if kept >= 0 else "all were dropped"
            text = (
                f"{self.called_all(rows)} have the same vertices; {did} (by the even-odd rule two facets "
                "cancel, unless the surface is closed only with one of them)"
            )
            middle = place(self.points[vertices].mean(axis=0))
            self.account("repeated facet", text, middle, rows, vertices.tolist())
        if gone.any():
            self.exchange(gone, [], [])

    def _split(self) -> bool:
        """Split pieces where others touch them in their plane; return whether there were any."""
        shell, _ = self.shell()
        edges = np.concatenate([edges_of(shell.triangles), shell.segments]).astype(np.int32)
        met = meetings_in_space(self.points, shell.triangles, edges)
        self.met = Met(self.standing(), shell, edges, met)
        self.first = self.first or self.met
        if (met.kind == PIERCES).any():
            self._refuse_meetings(self.met)
        if Splitting(self, shell, edges, met).run():
            return True
        self._refuse_meetings(self.met)
        return False

    def _refuse_meetings(self, now: Met | None) -> None:
        """Raise if pieces meet now: for crossings of the input, if there were any, which has its numbers."""
        if now is None:
            return
        found = meeting_faults(*now) + crossing_faults(now.standing, now.shell)
        if not found:
            return
        for here in (self.first or now, now):
            if here is now:
                faults = found
            else:
                faults = meeting_faults(*here) + crossing_faults(here.standing, here.shell)
            crossings = [fault for fault in faults if fault.kind == "crossing"]
            if crossings:
                self.refuse(crossings, here.standing)
        self.refuse([replace(fault, text=_not_exact(fault)) for fault in found], now.standing)

    def _refuse_nothing(self) -> None:
        if len(self.outline.facets) and not self.facet.any():
            raise InputError(
                f"no facet is left that bounds a body after {len(self.repairs)} repairs, the last of them: "
                f"{self.repairs[-1].text}. Give facets that enclose a volume"
            )


def _not_exact(fault: Fault) -> str:
    """What is said of a fault that only rounded vertices would mend."""
    what = fault.text.partition(";")[0]
    return (
        f"{what}; sides cross there at places that are no doubles, so that this cannot be mended exactly: "
        "unite the bodies first"
    )
