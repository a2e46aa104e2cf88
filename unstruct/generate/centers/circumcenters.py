"""Circumcenter insertion: the next point goes to the circumcenter of the maximal triangle.

This is the first strategy of the source chapter (the textbook chapter that this book follows), section
12.2.6, with its generalized choice of the triangle. The chapter does not say what to do where the boundary is
in the way; here the caller chooses. See the book, 2.6a and 2.6b. For guaranteed angles see `refine`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arguments import as_count, as_flags
from ...base.arrays import as_points
from ...base.codes import DONE, MORE, SPLIT
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...connect.insertion.delaunay import delaunay
from ...connect.planar.cavity import blocked_by, commit_split, find_split
from ...connect.planar.complex import PlanarComplex
from ...domain.domain import Domain, Sampled, as_domain
from ...domain.plane.by_region import size_by_region
from ...mesh.domain_mesh import DomainMesh, noticed
from ...sizing import as_size
from ...sizing.asked import asked_again
from ..boundary.constrained import complex_of
from ..boundary.kept import SplitBoundary, kept_pieces
from ..boundary.pairs import paired
from ..volume_points.methods import centers_in_body
from .steps import REASONS, SHORTEST_SPLIT, TOO_THIN, UNSPLIT, enter_slots, insert_centers, note
from .worst import CENTERS_A_CALL, NONE, Contest, Rule, make_rule, measures, put

__all__ = ["circumcenter_insertion"]

MOST_CENTERS = 1_000_000  # the default budget where a limit is given: a limit of shape may never be reached
# Where no budget is given: so many halvings that only the thinness of a gap asks for, for a piece and for
# each subsegment of it that the size makes. A gap of width w and length L would need L / w.
MOST_THIN, THIN_EACH = 1024, 16
STEP = 0.75  # of the size, for subsegments: rounded to a whole count they stay below 2 f = 1.155 sizes


def circumcenter_insertion(
    domain_or_points: Domain | ArrayLike,
    size: Any = None,
    *,
    priority: Any = None,
    limit: float | None = None,
    split_boundary: SplitBoundary = True,
    step: float = STEP,
    budget: int | None = None,
    history: bool = False,
    progress: bool = False,
) -> DomainMesh:
    """Insert the circumcenter of the worst triangle, again and again, until no triangle is bad.

    Parameters
    ----------
    domain_or_points : Domain, or array_like of shape (n, 2)
        What to mesh, a region or a body in space. The boundary of a set of points is its convex hull.
    size : float, function, SizeField, or dict of region name to one of these, optional
        The wanted edge length h; in a dict the key None stands for all regions that are not named. A triangle
        is bad if alpha = R / f(Q) >= 1, where f = h / sqrt(3), R is its circumradius, and Q its circumcenter.
        Beyond the bounding box of the domain f has the value at the nearest point of the box. Pieces of a
        Domain are first cut into subsegments of ``step`` sizes.
    priority : str, float, function or SizeField, optional
        Which bad triangle is the worst: the one with the largest "circumradius" (the default without a size),
        "alpha" (the default with one), "radius_edge", "radius_ratio" or "area", or with the smallest
        "min_angle". If a size g is given instead, the worst one has the largest sqrt(3) R / g(Q): this is the
        generalized choice.
    limit : float, optional
        A triangle is also bad if its measure by ``priority`` is greater than this ("min_angle": if it is
        less, in degrees).
    split_boundary : bool or "inner"
        What to do where the circumcenter lies beyond a boundary or inner edge, on it, or in its open
        diametral disk. True halves that edge instead, on the true curve, and looks again. False adds no
        vertex to any edge: it inserts circumcenters near edges, and leaves triangles whose circumcenters lie
        beyond an edge. "inner" halves edges on inner pieces only.
    step : float
        Length of the first subsegments, in sizes.
    budget : int, optional
        The largest number of points that are inserted; needed if there is neither a size nor a limit.
        Without a budget a piece is halved only some thousand times for the sake of gaps and wedges that are
        much thinner than the size (``reasons``: "narrow").
    history : bool
        Record the run in ``steps``.
    progress : bool
        Show a bar.

    Returns
    -------
    DomainMesh
        ``points`` are the first points, then the inserted ones in order: each state of the run is the
        (constrained) Delaunay triangulation of the first so many of them. Bad triangles that are left are
        listed in ``unrefined``, with ``reasons``. ``counts``: "circumcenters", "splits", "encroachments"
        (circumcenters that were put into a diametral disk; only with ``history``) and "duplicates" (input
        points that were left out). ``steps`` contains for each state, the last one included, "R", "l", "L",
        "mu" and "angle" (largest circumradius, shortest and longest edge, largest R / r, minimum angle in
        degrees). For each insertion it contains "chosen" (the circumradius), "value" (the measure),
        "triangle" (the vertices of the chosen triangle), "vertex" (the inserted one), "split" and
        "encroaching" (bool).

    Raises
    ------
    InputError
        For an unknown choice, for a size that is not positive, and where without a size, a limit and a budget
        the run would not end.

    Notes
    -----
    With a size of at least h_0 everywhere the run ends: each circumcenter is inserted at least h_0 / sqrt(3)
    away from all vertices that it sees. An edge is halved for a center in its disk only if it is longer than
    sqrt(2/3) h_0, and for a center beyond it only if the triangle on it is so flat that finitely many
    halvings suffice; without a budget these are counted. With a limit on shapes there is no such bound: then
    the budget (by default 10^6 points) ends a run that does not end by itself. Triangles with circumradii
    below about 2^-44 of the largest coordinate are refined only where a size asks for it. O(log n) to find
    the worst triangle, O(1) on average for its cavity. Sources: the source chapter, 12.2.6; L. P. Chew,
    Cornell TR 89-983 (1989); the split is the step of J. Ruppert, Journal of Algorithms 18 (1995) 548-585.
    Book: 2.6a, 2.6b.

    *In space* the point goes to the center of the maximal tetrahedron: f = sqrt(6) h / 4 is the circumradius
    of a regular one with edges h. ``priority`` is "alpha" or "circumradius", or a size g: then the worst cell
    has the largest R / g(Q). There is no ``limit`` and no ``step``. Segments longer than 2 f are halved and
    triangles of facets with circumradii of more than f divided, as `refine` does; a center that sees one of
    them under 120 degrees or more divides that instead, unless it must stay or is very short. What is said of
    narrow gaps and of limits on the number of points in `refine` holds here, too. Four points near a circle
    make slivers, flat tetrahedra whose circumradius is not large: `statistics` counts them, and `improve`
    cures them. Only positive cells, by exact signs. Book: 2.8c.
    """
    as_flags(history=history, progress=progress)
    if isinstance(domain_or_points, Domain) and domain_or_points.dimension == 3:
        if limit is not None or not isinstance(step, float) or step != STEP:
            raise InputError("limit and step are for the plane; in space give a size and a priority")
        body = domain_or_points

        def made(size: Any) -> DomainMesh:
            return centers_in_body(
                body, size, priority=priority, split_boundary=split_boundary, budget=budget, history=history,
                progress=progress,
            )  # fmt: skip

        return noticed(asked_again(made, size))
    if size is None and limit is None and budget is None:
        raise InputError("without a size or a limit every triangle is bad: give a size, a limit or a budget")
    if not isinstance(size, Mapping):
        size = None if size is None else as_size(size)
    domain, origin, dropped = _as_domain(domain_or_points)
    sampled = domain.sampled(size if origin is None else None, step=step)
    complex_ = complex_of(domain, sampled)
    field = size_by_region(complex_, size, domain.regions)
    rule = make_rule(field, priority, limit, tuple(domain.bounds), complex_.factor)
    most = MOST_CENTERS if limit is not None else int(np.iinfo(np.int32).max)
    most = most if budget is None else as_count(budget, "budget")
    kept = kept_pieces(split_boundary, len(domain.facets), len(domain.pieces), domain.held())
    run = CircumcenterRun(complex_, domain, rule, kept, history)
    if budget is None:
        run.save()
    run.advance(most, progress)
    counts = {**run.counts(), "duplicates": dropped}
    result = complex_.mesh(
        facets=len(domain.facets),
        origin=sampled.origin if origin is None else origin,
        markers=domain.markers,
        points=sampled.points,
        counts=counts,
        steps=run.steps() if history else None,
        **run.unrefined(),
    )
    return noticed(paired(domain, result))


def _as_domain(given: Any) -> tuple[Domain, NDArray[np.int32] | None, int]:
    """The domain; for points also their numbers in the input, and how many of them repeat others."""

    if isinstance(given, Domain | Sampled):
        return as_domain(given), None, 0
    rows = as_points(given)
    if rows.shape[1] != 2:
        raise InputError(
            f"points have {rows.shape[1]} coordinates; circumcenter_insertion works in the plane"
        )
    mesh = delaunay(rows)
    if len(mesh.duplicates) == 0:
        return Domain(rows, mesh.boundary), mesh.origin, 0
    kept = np.setdiff1d(np.arange(len(rows)), mesh.duplicates[:, 0])
    place = np.full(len(rows), -1, dtype=np.int32)
    place[kept] = np.arange(len(kept))
    return Domain(rows[kept], place[mesh.boundary]), kept.astype(np.int32), len(mesh.duplicates)


class CircumcenterRun(Contest):
    """A run over a complex: the tournament, the record, and the splits."""

    def __init__(
        self, complex_: PlanarComplex, domain: Domain, rule: Rule, kept: NDArray[np.uint8], history: bool
    ):
        super().__init__(rule, history, 7)
        self.complex, self.domain, self.kept = complex_, domain, kept
        self.first = complex_.size
        self.splits = 0
        self.end = MORE
        self.why = np.zeros(0, dtype=np.int8)
        self.ask = np.zeros(3, dtype=np.int64)
        self.thin: NDArray[np.int64] | None = None  # halvings for thin gaps that are left to each piece
        self._reserve(self.first + 64)
        self._enter(np.arange(complex_.triangles))

    def _reserve(self, vertices: int) -> None:
        k = self.complex
        k.reserve(vertices, k.segments + vertices - k.size)
        slots = len(k.region)
        if slots != len(self.why):
            self.why = np.concatenate([self.why, np.zeros(slots - len(self.why), dtype=np.int8)])
            self.scratch = k.scratch()
        self.make_room(slots, len(k.xy) - self.first)

    def save(self) -> None:
        """Limit the number of halvings that only the thinness of a gap asks for."""
        k = self.complex
        made = np.bincount(k.piece[: k.segments], minlength=len(self.kept))
        self.thin = MOST_THIN + THIN_EACH * made

    def _enter(self, slots: NDArray) -> None:
        enter_slots(self.complex.plane(), self.entries(), np.asarray(slots, dtype=np.int64), self.why)

    def advance(self, budget: int, progress: bool) -> None:
        """Insert points until no bad triangle is left that can be improved, or the budget is spent."""
        k, last = self.complex, self.first + budget
        bar = progress_bar(progress, " points")
        while self.end != DONE and k.size < last:
            before = k.size
            stop = min(last, before + CENTERS_A_CALL, 2 * before)  # so that little memory stays unused
            self._reserve(stop)
            self.end = insert_centers(
                k.plane(), self.scratch, self.entries(), self.why, self.kept, stop, self.first, self.ask
            )
            if self.end == SPLIT:
                self._reserve(k.size + 1)
                self._split(int(self.ask[0]), int(self.ask[1]))
            bar.update(k.size - before)
        bar.close()

    def _split(self, e: int, t: int) -> None:
        """Halve the subsegment on half-edge e, on its curve; if that is impossible, give up triangle t."""
        k = self.complex
        plane, scratch = k.plane(), self.scratch
        s = int(k.mark[e])
        a, b = k.xy[k.ends[s]]
        thin, piece, middle, p = self.thin, int(k.piece[s]), float(k.span[s].mean()), k.size
        if thin is not None and self.ask[2] and thin[piece] <= 0:
            self._give_up(t, TOO_THIN)
            return
        if piece in self.domain.curves:
            point = self.domain.at(piece, [middle])[0] * k.factor
        else:
            point = (a + b) / 2
        m, n, h = find_split(plane, scratch, e, *point)
        short = np.hypot(*(b - a)) < SHORTEST_SPLIT
        if short or m <= 0 or n <= 0 or blocked_by(k.xy, k.vertex, scratch.rim, n, *point) >= 0:
            self._give_up(t, UNSPLIT)
            return
        if thin is not None:
            thin[piece] += -1 if self.ask[2] else THIN_EACH
        if len(self.watch):
            radius = measures(*k.xy[k.vertex[3 * t : 3 * t + 3]].ravel())[0]
            note(self.entries(), k.vertex, t, p - self.first, radius, 1.0, 0.0)
        k.xy[p] = point
        commit_split(plane, scratch, e, m, n, h, p, middle)
        self.splits += 1
        self._enter(scratch.fresh[:n])

    def _give_up(self, t: int, why: int) -> None:
        self.why[t] = why
        put(self.tree, t, NONE)

    # ------------------------------------------------------------------ results

    def counts(self) -> dict[str, int]:
        inserted = self.complex.size - self.first
        counts = {"circumcenters": inserted - self.splits, "splits": self.splits}
        if len(self.watch):
            counts["encroachments"] = int(self.events[:inserted, 6].sum())
        return counts

    def unrefined(self) -> dict[str, Any]:
        """The slots of the bad triangles that are left, and the reasons."""
        k = self.complex
        slots = np.flatnonzero((self.waiting(k.triangles) | (self.why[: k.triangles] > 0)) & k.kept())
        return {"unrefined": slots, "reasons": [REASONS[int(code)] for code in self.why[slots]]}

    def steps(self) -> dict[str, NDArray]:
        k = self.complex
        inserted = k.size - self.first
        events = self.events[:inserted]
        used = np.zeros(k.size, dtype=bool)
        used[k.vertex[: 3 * k.triangles].reshape(-1, 3)[k.kept()].ravel()] = True
        place = np.where(used, np.cumsum(used) - 1, -1).astype(np.int32)
        return {
            **self.story(0, inserted, k.factor),
            "triangle": place[events[:, 2:5].astype(np.int64)],
            "vertex": place[np.arange(self.first, k.size)],
            "split": events[:, 5] > 0,
            "encroaching": events[:, 6] > 0,
        }
