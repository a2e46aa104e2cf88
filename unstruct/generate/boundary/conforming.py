"""Boundary-conforming Delaunay triangulation: every subsegment becomes an edge by midpoints.

A subsegment that is in no Delaunay triangulation of the vertices is called *missing*. It receives a new
vertex in its middle (for a curved piece on the true curve), and the same is done with its halves. A new
vertex can make subsegments missing, but never present. So each of these splits is needed in any order, and
the result depends on the domain only. It exists if at each vertex at most five pieces meet, or those that
meet leave a gap of 180 degrees. Otherwise midpoints may never end (see `fans`), and *concentric shells* help:
at an apex, a vertex where pieces meet at less than 60 degrees, pieces are split at distances that are powers
of two. Pieces of equal length never cut each other, and the first vertex on each piece keeps its distance
from the apex; therefore shells at all apices always end.

Sources: J. Ruppert, Journal of Algorithms 18 (1995) 548-585 (midpoints, shells, lower bounds on lengths); H.
Edelsbrunner, T. S. Tan, Discrete & Computational Geometry 10 (1993) 197-213 (how many points it may take).
Book: 2.4b.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import as_count, as_flags
from ...base.arrays import frozen
from ...base.elementary import turns
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...connect.planar.complex import PlanarComplex
from ...domain.domain import Domain, as_domain
from ...mesh.domain_mesh import DomainMesh, noticed
from .constrained import complex_of
from .fans import never_ends
from .midpoints import GABRIEL, MISSING, pick, split_all
from .pairs import paired

__all__ = ["Conforming", "conform", "conforming_delaunay"]

SHORTEST_PART = 2.0**-40  # of the extent: shorter subsegments are not split, as rounding would bend them
JUDGED_AHEAD = 5000  # sharp vertices that are judged in advance
DEEP = 12  # shells="auto" turns to shells where two pieces meet after this many halvings next to the vertex
FAN = 3  # with shells="auto" at least so many pieces that meet at a sharp angle get shells at once
LOOPING = 6  # where midpoints never end at least so many pieces meet (book, Theorem 2.4b.3)
SPLITS_A_CALL = 100_000  # splits in one kernel call, a fraction of a second
SHORT, SPENT, REFUSED, PRESCRIBED = 1, 2, 3, 4  # why a subsegment is not split
TOO_SHORT = "it is shorter than 2^-40 of the extent"
HELD_PIECE = "its piece has given points and gets no others"
TOO_CLOSE = "a split would touch or cross another piece"
# The cosine of 60 degrees, rounded up: pieces that meet at 60 degrees or more cannot cut each other for ever.
SHARP = 0.5000000000000001


class Conforming(DomainMesh):
    """A boundary-conforming Delaunay mesh, with the account of how it was made.

    Parameters
    ----------
    mesh : DomainMesh
        The mesh that was reached. The other parameters become the attributes below.

    Attributes
    ----------
    complete : bool
        Whether every subsegment passes the test; then the mesh is Delaunay.
    missing : (q,) int32
        Rows of ``segments`` that do not pass.
    why : (q,) array of str
        Why each of them was not split.
    rounds : (r,) int64
        How many points each round added.
    added : (f + g,) int64
        How many points were put on each piece of the domain, beyond those by which it was cut at first.
    apices : (k,) int32
        Vertices of the domain around which pieces were split on shells.
    endless : (k,) int32
        Vertices of the domain at which midpoints alone provably never end (`never_ends`). At most 5000
        vertices are tested.
    """

    def __init__(
        self,
        mesh: DomainMesh,
        *,
        missing: NDArray[np.int32],
        why: NDArray[np.str_],
        rounds: NDArray[np.int64],
        added: NDArray[np.int64],
        apices: NDArray[np.int32],
        endless: NDArray[np.int32],
    ):
        self.__dict__.update(vars(mesh))
        self.missing, self.why = frozen(missing), frozen(why)
        self.rounds, self.added = frozen(rounds), frozen(added)
        self.apices, self.endless = frozen(apices), frozen(endless)


def conforming_delaunay(
    domain: Domain,
    size: Any = None,
    *,
    test: Literal["missing", "gabriel"] = "missing",
    shells: bool | Literal["auto"] = "auto",
    budget: int | None = None,
    progress: bool = False,
) -> Conforming:
    """A Delaunay triangulation in which each piece of a domain is a chain of edges, by new points on pieces.

    Parameters
    ----------
    domain : Domain
    size : number, function, size field, or dict of region name to one of these, optional
        Cut the pieces by a size first; see `Domain.sampled`.
    test : {"missing", "gabriel"}
        Split subsegments that are in no Delaunay triangulation of the vertices; or, more cautiously, those
        with a vertex inside their diametral circle. After the second test all subsegments remain edges,
        whatever points are added later outside of their diametral circles.
    shells : bool or "auto"
        Whether pieces that meet at less than 60 degrees are split on concentric shells about their vertex
        instead of in the middle. "auto" does so where three or more pieces meet, since in a fan each midpoint
        makes others necessary (40 spokes within 90 degrees: 535 vertices with shells, 4791 with midpoints).
        Where two pieces meet midpoints need fewer vertices, and shells follow after 12 halvings.
    budget : int, optional
        The largest number of new points; by default 10,000 and 5 more for each subsegment.
    progress : bool
        Show the number of new points.

    Returns
    -------
    Conforming
        A `DomainMesh`. It is not ``complete`` if a subsegment could not be split: the budget was spent, the
        subsegment was shorter than 2^-40 of the extent, or another piece was too close. Then ``missing`` and
        ``why`` say where and why, ``unrefined`` lists the cells beside these subsegments, and the mesh is the
        constrained Delaunay triangulation.

    Raises
    ------
    InputError
        For an unknown test, a budget below zero, and as `constrained_delaunay` does.

    Notes
    -----
    Tests are exact. Points are rounded, and a split that would then touch or cross another piece is refused.
    If there are several Delaunay triangulations (ties), one in which the pieces are edges is taken. The time
    of a round is proportional to the subsegments that the round before touched. Termination is proved for
    straight pieces. Book: 2.4b.
    """
    as_flags(progress=progress)
    if not isinstance(test, str) or test not in ("missing", "gabriel"):
        raise InputError(f"test = {test!r} must be 'missing' or 'gabriel'")
    if not (isinstance(shells, bool | np.bool_) or (isinstance(shells, str) and shells == "auto")):
        raise InputError(f"shells = {shells!r} must be True, False or 'auto'")
    budget = None if budget is None else as_count(budget, "budget")
    domain = as_domain(domain)
    sampled = domain.sampled(size)
    complex_ = complex_of(domain, sampled)
    run = conform(domain, complex_, test=test, shells=shells, budget=budget, progress=progress)
    return noticed(paired(domain, run.mesh(sampled)))


def conform(
    domain: Domain,
    complex_: PlanarComplex,
    *,
    test: str = "missing",
    shells: bool | str = "auto",
    budget: int | None = None,
    progress: bool = False,
) -> ConformingRun:
    """`conforming_delaunay` in place, for a complex that has been made already."""
    run = ConformingRun(domain, complex_, test, shells, budget)
    with progress_bar(progress, "", desc="splits") as bar:
        while len(run.queue):
            bar.update(run.round())
    return run


class ConformingRun:
    """One run: the queue of subsegments to be looked at, and what has been found about them."""

    def __init__(
        self, domain: Domain, complex_: PlanarComplex, test: str, shells: bool | str, budget: int | None
    ):
        self.domain, self.complex = domain, complex_
        self.test = GABRIEL if test == "gabriel" else MISSING
        self.budget = 10_000 + 5 * complex_.segments if budget is None else budget
        self.curved = np.zeros(len(domain.pieces), dtype=bool)
        self.curved[list(domain.curves)] = True
        self.start, self.held = complex_.size, domain.held()
        self.queue = np.arange(complex_.segments, dtype=np.int32)
        self.why = np.zeros(complex_.segments, dtype=np.int8)  # why a failing subsegment was not split
        self.made: list[int] = []
        self.added = np.zeros(len(domain.pieces), dtype=np.int64)
        xy = complex_.xy[: self.start]
        self.floor = SHORTEST_PART * float(np.ptp(xy, axis=0).max())
        sharp, endless = _apices(domain, complex_, self.test == GABRIEL)
        self.endless = endless
        self.sharp = np.zeros(len(domain.points), dtype=bool)
        self.sharp[sharp] = True
        self.apex = np.zeros(len(domain.points), dtype=bool)  # where shells are in use
        if shells is True:
            self.apex |= self.sharp
        elif shells == "auto":
            self.apex |= self.sharp & (self._degree() >= FAN)
            self.apex[endless] = True
        self.auto = shells == "auto"
        self.depth = np.zeros(len(domain.points), dtype=np.int64)
        self.used = np.zeros(len(domain.points), dtype=bool)

    def round(self) -> int:
        """Split the subsegments of the queue that fail the test; those touched by it are the next queue."""
        c = self.complex
        chosen = np.empty(len(self.queue), dtype=np.int32)
        rows = chosen[: pick(c.xy, c.vertex, c.twin, c.where, self.queue, self.test, chosen)]
        rows = np.sort(rows)
        length = np.linalg.norm(c.xy[c.ends[rows, 0]] - c.xy[c.ends[rows, 1]], axis=1)
        left, held = self.budget - (c.size - self.start), self.held[c.piece[rows]]
        self.why = np.append(self.why, np.zeros(c.segments - len(self.why), dtype=np.int8))
        self.why[rows] = 0
        self.why[rows[length < self.floor]] = SHORT
        self.why[rows[held]] = PRESCRIBED
        rows = rows[(length >= self.floor) & ~held]
        self.why[rows[left:]] = SPENT
        self.queue = rows[:0]
        rows = rows[:left]
        if len(rows):
            self._split(rows)
        return len(rows)

    def _split(self, rows: NDArray[np.int32]) -> None:
        """Split these subsegments in chunks; Ctrl-C works between chunks."""
        c, before = self.complex, self.complex.size
        points, t = self._places(rows)
        c.reserve(c.size + len(rows), c.segments + len(rows))
        refused, seen = np.zeros(len(rows), dtype=bool), np.zeros(len(c.ends), dtype=bool)
        touched, count, plane, scratch = np.empty(len(c.ends), dtype=np.int32), 0, c.plane(), c.scratch()
        piece = c.piece[rows]
        for start in range(0, len(rows), SPLITS_A_CALL):
            part = slice(start, start + SPLITS_A_CALL)
            count += split_all(
                plane, scratch, rows[part], points[part], t[part], refused[part], seen, touched[count:]
            )
        self.why[rows[refused]] = REFUSED
        self.added += np.bincount(piece[~refused], minlength=len(self.added))
        self.made.append(c.size - before)
        self.queue = touched[:count].copy()

    def _places(self, rows: NDArray[np.int32]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Where to split: at the midpoint, or on a shell if an end is an apex; and the parameters there."""
        c, n = self.complex, len(self.domain.points)
        ends, span, piece = c.ends[rows], c.span[rows], c.piece[rows]
        a, b = c.xy[ends[:, 0]], c.xy[ends[:, 1]]
        points, t = (a + b) / 2, span.mean(axis=1)
        if self.auto:
            near = ends[(ends < n)]
            self.depth += np.bincount(near, minlength=n)
            self.apex |= self.sharp & (self.depth > DEEP * np.maximum(self._degree(), 1))
        at = np.where(ends < n, ends, 0)
        apex = self.apex[at] & (ends < n)
        shell = apex.any(axis=1)
        second = shell & ~apex[:, 0]
        own, far = np.where(second[:, None], b, a), np.where(second[:, None], a, b)
        length = np.linalg.norm(far - own, axis=1)
        radius = np.ldexp(1.0, np.frexp(2 * length / 3)[1] - 1)
        share = radius / length
        points[shell] = (own + (far - own) * share[:, None])[shell]
        t[shell] = (span[:, 0] + np.where(second, 1 - share, share) * (span[:, 1] - span[:, 0]))[shell]
        self.used[at[apex]] = True
        bent = self.curved[piece]
        if bent.any():
            t[bent & shell] = self._on_shell(
                piece[bent & shell], span[bent & shell], own[bent & shell], radius[bent & shell],
                second[bent & shell],
            )  # fmt: skip
            points[bent] = self.domain.points_at(piece[bent], t[bent]) * c.factor
        return points, t

    def _on_shell(
        self, piece: NDArray, span: NDArray, own: NDArray, radius: NDArray, second: NDArray
    ) -> NDArray[np.float64]:
        """Parameters within ``span`` at which curves have the distance ``radius`` from their apex."""
        near = np.where(second, span[:, 1], span[:, 0])
        far = np.where(second, span[:, 0], span[:, 1])
        for _ in range(60):
            middle = (near + far) / 2
            x = self.domain.points_at(piece, middle) * self.complex.factor
            inside = np.linalg.norm(x - own, axis=1) < radius
            near, far = np.where(inside, middle, near), np.where(inside, far, middle)
        return (near + far) / 2

    def _degree(self) -> NDArray[np.int64]:
        return np.bincount(self.domain.pieces.ravel(), minlength=len(self.domain.points))

    def failing(self) -> NDArray[np.int32]:
        """All subsegments that fail the test at present."""
        c = self.complex
        chosen = np.empty(c.segments, dtype=np.int32)
        every = np.arange(c.segments, dtype=np.int32)
        return np.sort(chosen[: pick(c.xy, c.vertex, c.twin, c.where, every, self.test, chosen)])

    def mesh(self, sampled: Any) -> Conforming:
        """The result, with its account."""
        c = self.complex
        failing = self.failing()
        text = {
            SHORT: TOO_SHORT,
            SPENT: f"the budget of {self.budget} points is spent",
            REFUSED: TOO_CLOSE,
            PRESCRIBED: HELD_PIECE,
        }
        why = np.array([text.get(code, "") for code in range(PRESCRIBED + 1)])[self.why[failing]]
        half = c.where[failing].astype(np.int64)
        slots = np.concatenate([half // 3, c.twin[half] // 3])
        reasons = np.tile(np.char.add("a subsegment beside it was not split: ", why), 2)
        kept = c.region[slots] >= 0
        slots, first = np.unique(slots[kept], return_index=True)
        counts = {"rounds": len(self.made), "splits": sum(self.made), "missing": len(failing)}
        base = c.mesh(
            facets=len(self.domain.facets), origin=sampled.origin, markers=self.domain.markers,
            points=sampled.points, unrefined=slots, reasons=reasons[kept][first], counts=counts,
        )  # fmt: skip
        half = c.where[: c.segments].astype(np.int64)
        inside = (c.region[half // 3] >= 0) | (c.region[c.twin[half] // 3] >= 0)
        row, seen = np.cumsum(inside, dtype=np.int32) - np.int32(1), inside[failing]
        return Conforming(
            base, missing=row[failing[seen]], why=why[seen],
            rounds=np.array(self.made, dtype=np.int64), added=self.added,
            apices=np.flatnonzero(self.used).astype(np.int32), endless=self.endless,
        )  # fmt: skip


def _apices(domain: Domain, c: PlanarComplex, encroached: bool) -> tuple[NDArray, NDArray]:
    """Vertices at which pieces meet at less than 60 degrees, and those at which midpoints never end."""
    n, ends = len(domain.points), c.ends[: c.segments]
    tail = np.concatenate([ends[:, 0], ends[:, 1]])
    head = np.concatenate([ends[:, 1], ends[:, 0]])
    head, tail = head[tail < n], tail[tail < n]
    d = c.xy[head] - c.xy[tail]
    angle = turns(d[:, 1], d[:, 0])
    order = np.lexsort([angle, tail])
    head, tail, d = head[order], tail[order], d[order]
    begin = np.flatnonzero(np.diff(tail, prepend=-1))
    size = np.diff(np.append(begin, len(tail)))
    following = np.arange(1, len(tail) + 1)
    following[begin + size - 1] = begin
    dot = (d * d[following]).sum(axis=1)
    length = np.linalg.norm(d, axis=1)
    sharp = (dot > SHARP * length * length[following]) & (following != np.arange(len(tail)))
    candidates = np.unique(tail[sharp]).astype(np.int32)
    # at a vertex with a gap of 180 degrees, or of few pieces, no subsegment stays missing for ever
    gap = d[:, 0] * d[following, 1] - d[:, 1] * d[following, 0] <= 0
    few = tail[begin[size < LOOPING]]
    suspects = candidates if encroached else np.setdiff1d(candidates, np.concatenate([tail[gap], few]))
    endless = []
    for v in suspects[:JUDGED_AHEAD].tolist():
        low, high = np.searchsorted(tail, [v, v + 1])
        if never_ends(c.xy[v], c.xy[head[low:high]], encroached=encroached):
            endless.append(v)
    return candidates, np.array(endless, dtype=np.int32)
