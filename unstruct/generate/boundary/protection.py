"""Boundaries that stay: points that would break an edge are rejected, or rows of points protect the edges.

These are two remedies besides midpoints. `insert_without_breaking` rejects points that would remove an edge
of the boundary. This always keeps the boundary, but triangles along it may stay too large: they are called
*starved*, and the account lists them. `skeleton_points` puts an equilateral triangle on each subsegment, on
each side that is inside. It uses two facts. An edge whose open diametral disk contains no vertex is Delaunay,
whatever there is outside of the disk. And every point of the disk of an edge of length l is within
l / sqrt(3) of an end of the edge, or of the tip of the triangle on its side; so points that keep a larger
distance from all vertices leave the edge alone. Book: 2.4b.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arguments import as_flags, finite
from ...base.arrays import as_points
from ...base.codes import HIDDEN, INSERTED, OUTSIDE
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...connect.insertion.engine import LAST
from ...connect.planar.complex import PlanarComplex
from ...domain.domain import Domain, as_domain
from ...geometry.simplex import circumradius
from ...mesh.domain_mesh import DomainMesh
from ...sizing import as_size
from .conforming import conform
from .constrained import complex_of
from .guarded import BREAKS, CROWDED, REPEATED, guard_all, hit_all

__all__ = ["Guarded", "Skeleton", "insert_without_breaking", "skeleton_points"]

POINTS_A_CALL = 50_000  # points in one kernel call, a fraction of a second: Ctrl-C works between calls
HEIGHT = np.sqrt(0.75)  # of an equilateral triangle on a side of length 1


@dataclass(frozen=True)
class Guarded:
    """The result of inserting points that must not break the boundary.

    Attributes
    ----------
    mesh : DomainMesh
        The Delaunay mesh of the domain with the inserted points. ``unrefined`` lists the *starved* cells: a
        rejected point would have replaced them (and, if a size was given, they are too large).
    vertex : (k,) int32
        For each given point its vertex in the mesh; -1 if it was rejected.
    rejected : (r,) int32
        The given points that were rejected.
    why : (r,) array of str
        The reason for each of them: what it would break, that it lies outside, or which vertex it repeats.
    edge : (r,) int32
        The subsegment that it would break, a row of ``mesh.segments``; -1 for other reasons.
    largest : float
        The largest circumradius of a starved cell; 0 if there is none.
    """

    mesh: DomainMesh
    vertex: NDArray[np.int32]
    rejected: NDArray[np.int32]
    why: NDArray[np.str_]
    edge: NDArray[np.int32]
    largest: float


def insert_without_breaking(
    domain: Domain, points: ArrayLike, *, size: Any = None, progress: bool = False
) -> Guarded:
    """Insert points into the Delaunay triangulation of a domain, except those that would break its boundary.

    Parameters
    ----------
    domain : Domain
        Its triangulation is first made boundary-conforming by extra points (`conforming_delaunay`).
    points : array_like, shape (k, 2)
        They are inserted in this order. A point that is rejected is not tried again.
    size : number, function or size field, optional
        The wanted edge length. Then only cells with a circumradius above size / sqrt(3) count as starved.
    progress : bool
        Show a bar.

    Returns
    -------
    Guarded

    Notes
    -----
    Exact. A point breaks an edge if it lies in the open circles of both triangles beside it, or on the edge.
    A point is located by a walk from the one before; this is fast if the two are near each other. Book: 2.4b.
    """
    as_flags(progress=progress)
    rows = as_points(points)
    if rows.shape[1] != 2:
        raise InputError(f"points have {rows.shape[1]} coordinates; a planar domain needs 2")
    field = None if size is None else as_size(size)
    domain = as_domain(domain)
    sampled = domain.sampled()
    complex_ = complex_of(domain, sampled)
    conform(domain, complex_)
    boundary = complex_.size
    verdict, culprit = _guard(complex_, rows, progress=progress)
    out = np.flatnonzero(verdict != INSERTED).astype(np.int32)
    slots = _starved(complex_, rows[out[np.isin(verdict[out], (BREAKS, HIDDEN))]], field)
    used = _used(complex_)
    segment_row, place = _rows(complex_), np.cumsum(used) - 1
    why = _reasons(domain, complex_, verdict[out], culprit[out], place)
    counts = {"inserted": len(rows) - len(out), "rejected": len(out), "starved": len(slots)}
    mesh = complex_.mesh(
        facets=len(domain.facets), origin=sampled.origin, markers=domain.markers, points=sampled.points,
        unrefined=slots, reasons=np.full(len(slots), "a point inserted here would break the boundary"),
        counts=counts | {"boundary": boundary - len(sampled.points)},
    )  # fmt: skip
    vertex = np.where(verdict == INSERTED, place[np.where(verdict == INSERTED, culprit, 0)], -1)
    edge = np.where(
        verdict[out] == BREAKS, segment_row[np.where(verdict[out] == BREAKS, culprit[out], 0)], -1
    )
    radii = circumradius(mesh.points[mesh.simplices[mesh.unrefined]])
    return Guarded(
        mesh, vertex.astype(np.int32), out, why, edge.astype(np.int32), float(radii.max(initial=0.0))
    )


def _guard(
    c: PlanarComplex,
    rows: NDArray[np.float64],
    *,
    parts: NDArray[np.int32] | None = None,
    gaps: NDArray[np.float64] | None = None,
    discs: bool = False,
    progress: bool = False,
) -> tuple[NDArray[np.int8], NDArray[np.int64]]:
    """Run the kernel over all points; return the verdicts and culprits."""
    count = len(rows)
    scaled = rows * c.factor
    if not np.array_equal(scaled / c.factor, rows):
        raise InputError(
            "the exponents of the points span too wide a range for the scale of the domain: round small "
            "coordinates to 0, or leave out points far away"
        )
    parts = np.full(count, -1, dtype=np.int32) if parts is None else parts
    gaps = np.zeros(count) if gaps is None else gaps * c.factor
    verdict, culprit = np.empty(count, dtype=np.int8), np.full(count, -1, dtype=np.int64)
    with progress_bar(progress, " points", total=count) as bar:
        for start in range(0, count, POINTS_A_CALL):
            stop = min(start + POINTS_A_CALL, count)
            c.reserve(c.size + stop - start, c.segments)
            part = slice(start, stop)
            guard_all(
                c.plane(), c.scratch(), scaled[part], parts[part], gaps[part], discs, verdict[part],
                culprit[part],
            )  # fmt: skip
            bar.update(stop - start)
    return verdict, culprit


def _starved(c: PlanarComplex, rows: NDArray[np.float64], field: Any) -> NDArray[np.int64]:
    """Slots of the triangles that these points would replace; with a size, only those that are too large."""
    hit = np.zeros(c.triangles, dtype=bool)
    hit_all(c.plane(), c.scratch(), c.state[LAST], rows * c.factor, hit)
    slots = np.flatnonzero(hit & (c.region[: c.triangles] >= 0))
    if field is not None and len(slots):
        corners = c.xy[c.vertex[: 3 * c.triangles].reshape(-1, 3)[slots]] / c.factor
        slots = slots[circumradius(corners) * np.sqrt(3.0) > field(corners.mean(axis=1))]
    return slots


def _used(c: PlanarComplex) -> NDArray[np.bool_]:
    """Which vertices are in the mesh of the complex: the corners of triangles inside."""
    used = np.zeros(c.size, dtype=bool)
    used[c.vertex[: 3 * c.triangles].reshape(-1, 3)[c.kept()].ravel()] = True
    return used


def _rows(c: PlanarComplex) -> NDArray[np.int64]:
    """For each subsegment its row in ``mesh.segments``."""
    half = c.where[: c.segments].astype(np.int64)
    return np.cumsum((c.region[half // 3] >= 0) | (c.region[c.twin[half] // 3] >= 0)) - 1


def _reasons(
    domain: Domain, c: PlanarComplex, verdict: NDArray, culprit: NDArray, place: NDArray
) -> NDArray[np.str_]:
    """For each rejected point the reason, in words."""

    def word(code: int, who: int) -> str:
        if code == BREAKS:
            return f"it would break {domain.name(int(c.piece[who]))}"
        return {
            OUTSIDE: "it lies outside of the domain",
            REPEATED: f"it equals vertex {place[who]}",
            CROWDED: f"vertex {place[who]} is too near",
            HIDDEN: "an edge lies between it and a part of its cavity",
        }[code]

    return np.array([word(int(a), int(b)) for a, b in zip(verdict, culprit)], dtype=str)


# ---------------------------------------------------------------------- skeleton


@dataclass(frozen=True)
class Skeleton:
    """Points in a row along the boundary, and the sides where no point could be put.

    Attributes
    ----------
    mesh : DomainMesh
        The Delaunay mesh of the domain with the skeleton. If ``complete``, the open diametral disks of its
        ``segments`` are empty.
    points : (k, 2) float64
        The skeleton.
    vertex : (k,) int32
        Its vertices in the mesh.
    segment : (k,) int32
        The subsegment that each point protects, a row of ``mesh.segments``.
    side : (k,) int8
        1 if the point is on the left of its subsegment, -1 on the right.
    bare : (b, 2) int32
        Rows (segment, side): sides inside the domain that have no tip of their own.
    why : (b,) array of str
        The reason for each of them.
    complete : bool
        Whether midpoints could make all diametral disks empty at first.
    """

    mesh: DomainMesh
    points: NDArray[np.float64]
    vertex: NDArray[np.int32]
    segment: NDArray[np.int32]
    side: NDArray[np.int8]
    bare: NDArray[np.int32]
    why: NDArray[np.str_]
    complete: bool


def skeleton_points(domain: Domain, size: Any = None, *, gap: float = 3**-0.5) -> Skeleton:
    """The tips of equilateral triangles on the sides of each subsegment, as far as they are compatible.

    Parameters
    ----------
    domain : Domain
    size : number, function or size field, optional
        The wanted length of subsegments. They are halved further until their diametral disks are empty.
    gap : float
        A tip is left out if an earlier vertex is nearer to it than ``gap`` times the length of its
        subsegment. Tips of short subsegments are put first.

    Returns
    -------
    Skeleton

    Raises
    ------
    InputError
        For a gap that is negative, or above 1: then every tip would be too near to the ends of its own edge.

    Notes
    -----
    No tip lies in the open diametral disk of any subsegment (exact), so all subsegments stay Delaunay.
    Afterwards an edge of length l with both of its tips stays an edge, whatever further points are inserted,
    if these keep a distance of more than l / sqrt(3) from all vertices. Book: 2.4b.
    """
    if not 0 <= finite(gap, "gap") <= 1:
        raise InputError(f"gap = {gap} must be between 0 and 1")
    domain = as_domain(domain)
    sampled = domain.sampled(size)
    c = complex_of(domain, sampled)
    run = conform(domain, c, test="gabriel")
    complete = len(run.failing()) == 0
    half = c.where[: c.segments].astype(np.int64)
    tips, segment, side, parts, length = [], [], [], [], []
    a, b = c.xy[c.ends[: c.segments, 0]], c.xy[c.ends[: c.segments, 1]]
    along = b - a
    normal = np.column_stack([-along[:, 1], along[:, 0]])
    forward = c.vertex[np.where(half % 3 == 2, half - 2, half + 1)] == c.ends[: c.segments, 0]
    for sign in (1, -1):
        slot = np.where(forward == (sign > 0), half, c.twin[half]) // 3
        inside = np.flatnonzero(c.region[slot] >= 0)
        tips.append(((a + b) / 2 + sign * HEIGHT * normal)[inside])
        segment.append(inside)
        side.append(np.full(len(inside), sign, dtype=np.int8))
        parts.append(c.region[slot[inside]])
        length.append(np.linalg.norm(along[inside], axis=1))
    rows, of, sides, part, l = (np.concatenate(x) for x in (tips, segment, side, parts, length))
    order = np.lexsort([sides, of, l])
    rows, of, sides, part, l = rows[order] / c.factor, of[order], sides[order], part[order], l[order]
    verdict, culprit = _guard(c, rows, parts=part.astype(np.int32), gaps=gap * l / c.factor, discs=True)
    placed = verdict == INSERTED
    place, row = np.cumsum(_used(c)) - 1, _rows(c)
    why = _reasons(domain, c, verdict[~placed], culprit[~placed], place)
    why = np.array([w.replace("it would break", "it lies in the disk of") for w in why], dtype=str)
    mesh = c.mesh(
        facets=len(domain.facets), origin=sampled.origin, markers=domain.markers, points=sampled.points,
        counts={"skeleton": int(placed.sum()), "bare": int((~placed).sum())},
    )  # fmt: skip
    bare = np.column_stack([row[of[~placed]], sides[~placed]]).astype(np.int32)
    vertex = place[culprit[placed]].astype(np.int32)
    return Skeleton(
        mesh,
        mesh.points[vertex],
        vertex,
        row[of[placed]].astype(np.int32),
        sides[placed],
        bare,
        why,
        complete,
    )
