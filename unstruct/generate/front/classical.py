"""The classical advancing front: its arrays, its growth, and its report; the steps: `classical_steps`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET
from ...base.codes import DONE, ROOM
from ...base.errors import InputError, MeshError
from ...base.jit import kernel
from ...base.progress import progress_bar
from ...connect.planar.complex import PlanarComplex
from ...domain.domain import Domain, Sampled
from ...mesh.domain_mesh import DomainMesh
from ...predicates.batch import unscaled
from ...sizing import as_size
from ..advancing.journal import Journal, columns_of, empty_journal, larger_journal
from ..advancing.rows import CELLS_MADE, VERTEX_COUNT, Waiting, room_to_wait
from ..boundary.constrained import complex_of
from ..rebay.run import TOLERANCE, VoronoiSegmentRun, rule_of
from . import classical_steps as k
from .made_mesh import Made, Subsegments, domain_mesh_of, quality_figures
from .open_front import (
    OpenFront,
    enter_edge,
    enter_vertex,
    larger_front,
    new_front,
)

__all__ = [
    "CLASSICAL_ORDERS", "CLASSICAL_PLACEMENTS", "CLASSICAL_REASONS", "SEARCHES", "VERDICTS", "ClassicalRun",
    "classical_front", "classical_mesh", "emptied", "enter_all", "finished_mesh",
]  # fmt: skip

CLASSICAL_PLACEMENTS = ("equal sides", "circle")
CLASSICAL_ORDERS = ("smallest", "shortest", "oldest")
# Where the search for candidates is centered, and its radius: in heights of the ideal triangle about the
# middle of the edge, in sides about the ideal point. The last number is the least 2 r / R.
SEARCHES: dict[str, tuple[float, float]] = {"barycenter": (1.5, 0.3), "ideal": (0.75, 0.0)}
CLASSICAL_REASONS = ("new point", "near vertex", "wider search", "all vertices")
VERDICTS = ("valid", "behind", "crosses the front", "holds a vertex", "not round", "too near", "")
TRIANGLES_A_CALL = 50_000  # a fraction of a second: Ctrl-C works between calls


class ClassicalRun(NamedTuple):
    """What the classical front has made, and its account."""

    made: Made
    steps: dict[str, NDArray] | None
    counts: dict[str, int]
    spent: bool  # whether the budget kept it from making points


def classical_front(
    domain: Domain,
    complex_: PlanarComplex,
    size: Any,
    *,
    order: str = "smallest",
    placement: str = "equal sides",
    search: str = "ideal",
    history: bool = False,
    budget: int | None = None,
    progress: bool = False,
) -> ClassicalRun:
    """Make triangles from the boundary inward, as the source chapter tells it, until the front is empty.

    Parameters
    ----------
    domain : Domain
    complex_ : PlanarComplex
        The domain triangulated with its subsegments, by `planar_complex`. Only its subsegments, the regions
        on their sides and its loose vertices are read.
    size : number, function, or size field
        The wanted edge length.
    order : "smallest", "shortest" or "oldest"
        The next edge of the front: where the wanted length is smallest (the rule of the source chapter), the
        shortest one, or the one that has waited longest. Lengths that differ by less than about a percent are
        equal, and then the oldest edge is next.
    placement : "equal sides" or "circle"
        The ideal point makes sides of the wanted length, or the wanted circumradius.
    search : "ideal" or "barycenter"
        Where candidates are searched; see `classical_steps`. "barycenter" is the rule of the source chapter.
    history : bool
        Keep a record of each step.
    budget : int, optional
        The largest number of new points; 10^7 by default.
    progress : bool
        Show a bar.

    Returns
    -------
    ClassicalRun
        ``steps`` has one row for each triangle, in order: "edge" A B, "apex", "reason", "ideal" (the point),
        "size", "radius" (of the search, about the middle or the ideal point), and "start": the candidates of
        step i are rows ``start[i]`` to ``start[i + 1] - 1`` of "vertex" (-1: the ideal point) and "verdict".

    Notes
    -----
    All signs that decide the topology are exact; the front always has a valid triangle ahead (see
    `classical_steps`). Expected O(n log n): a step costs some searches in two digital trees. Book: 3.1.
    """
    if not isinstance(order, str) or order not in CLASSICAL_ORDERS:
        raise InputError(f"order = {order!r} must be one of {CLASSICAL_ORDERS} for the classical method")
    if not isinstance(placement, str) or placement not in CLASSICAL_PLACEMENTS:
        raise InputError(
            f"placement = {placement!r} must be one of {CLASSICAL_PLACEMENTS} for the classical method"
        )
    if search not in SEARCHES:
        raise InputError(f"search = {search!r} must be one of {tuple(SEARCHES)}")
    c, field = complex_, as_size(size)
    lower, upper = domain.bounds
    table = field.table(lower, upper, factor=c.factor, tolerance=TOLERANCE).nodes
    constant = 0.0 if field.constant is None else float(table.values[0, 0])
    reach, round_enough = SEARCHES[search]
    most = c.size + (DEFAULT_BUDGET if budget is None else budget)
    choices = k.Choices(
        CLASSICAL_ORDERS.index(order),
        list(SEARCHES).index(search),
        placement == "circle",
        reach,
        round_enough,
        constant,
        most,
        table,
    )
    front = _boundary_front(c)
    journal, counts = empty_journal(2), np.zeros(k.CLASSICAL_COUNTS, dtype=np.int64)

    def advance(front: OpenFront, waiting: Waiting) -> int:
        nonlocal journal
        if history:
            journal = larger_journal(journal, len(front.made), int(counts[k.TRIED]), len(front.xy))
        return int(k.march(front, choices, waiting, journal, counts, TRIANGLES_A_CALL))

    with progress_bar(progress, " triangles") as bar:
        waiting = room_to_wait(None, len(front.ends), len(front.xy))
        k.start_waiting(front, choices, waiting)
        front = emptied(front, waiting, advance, c.factor, bar)
    return _account(c, front, journal, counts, most, history)


def _boundary_front(c: PlanarComplex) -> OpenFront:
    """The front at the beginning: every side of a subsegment that has a region, and all loose vertices."""
    half = c.where[: c.segments].astype(np.int64)
    ends = c.ends[: c.segments]
    along = c.vertex[np.where(half % 3 == 2, half - 2, half + 1)] == ends[:, 0]
    other = c.twin[half].astype(np.int64)
    rows = []
    for e, pair in ((np.where(along, half, other), ends), (np.where(along, other, half), ends[:, ::-1])):
        region = c.region[e // 3]
        rows.append(np.column_stack([np.arange(len(e)), pair, region])[region >= 0])
    edges = np.concatenate(rows)
    edges = edges[np.argsort(edges[:, 0], kind="stable"), 1:].astype(np.int64)
    front = new_front(c.xy[: c.size], 2 * len(edges) + 64, 2 * c.size + 64)
    loose = np.zeros(c.size, dtype=bool)
    loose[c.vertex[: 3 * c.triangles].reshape(-1, 3)[c.kept()].ravel()] = True
    loose[c.ends[: c.segments].ravel()] = False
    enter_all(front, edges, np.flatnonzero(loose))
    return front


@kernel
def enter_all(front, edges, loose):
    """Put edges (start, end, region) and loose vertices into an empty front."""
    for i in range(len(edges)):
        enter_edge(front, edges[i, 0], edges[i, 1], edges[i, 2])
    for i in range(len(loose)):
        enter_vertex(front, loose[i])


def emptied(
    front: OpenFront, waiting: Waiting, advance: Callable[[OpenFront, Waiting], int], factor: float, bar: Any,
) -> OpenFront:  # fmt: skip
    """Advance until the front is empty; return it, in larger arrays if need be.

    ``advance`` takes some steps and returns how it ended: DONE, MORE, ROOM or NONE_FITS.
    """
    while True:
        before = int(front.state[CELLS_MADE])
        code = advance(front, waiting)
        bar.update(int(front.state[CELLS_MADE]) - before)
        if code == DONE:
            return front
        if code == k.NONE_FITS:
            raise MeshError(_no_apex(front, factor))
        if code == ROOM:
            front = larger_front(front)
            waiting = room_to_wait(waiting, len(front.ends), len(front.xy))


def _no_apex(front: OpenFront, factor: float) -> str:
    """What to say if no vertex can be joined to the oldest edge of the front."""
    rows = np.flatnonzero(front.ends[:, 0] >= 0)
    row = int(rows[np.argmin(front.stamp[rows])])
    a, b = (front.xy[front.ends[row]] / factor).tolist()
    return f"no vertex can be joined to the front edge from {a} to {b}: the boundary meets itself there"


def _account(
    c: PlanarComplex,
    front: OpenFront,
    journal: Journal,
    counts: NDArray[np.int64],
    most: int,
    history: bool,
) -> ClassicalRun:
    m, n = int(front.state[CELLS_MADE]), int(front.state[VERTEX_COUNT])
    points = unscaled(front.xy[:n], c.factor)
    made = Made(points, front.made[:m, :3].copy(), front.made[:m, 3].copy(), dict(c.regions))
    named = dict(zip([*CLASSICAL_REASONS, "candidates"], counts.tolist()))
    steps = None
    if history:
        steps = {"edge": made.triangles[:, :2].copy(), "apex": made.triangles[:, 2].copy()}
        steps |= columns_of(journal, m, int(counts[k.TRIED]), c.factor, CLASSICAL_REASONS, VERDICTS)
    return ClassicalRun(made, steps, named, n >= most)


def classical_mesh(
    domain: Domain,
    complex_: PlanarComplex,
    size: Any,
    run: ClassicalRun,
    *,
    finish: bool = True,
    kept: NDArray[np.uint8] | None = None,
    budget: int | None = None,
) -> DomainMesh:
    """The result of `classical_front` as a mesh.

    Parameters
    ----------
    domain, complex_, size
        As for `classical_front`; ``size`` without regions.
    run : ClassicalRun
    finish : bool
        False gives the triangles as they were made, in that order: ``simplices[:k]`` is the state after k
        steps. True makes the constrained Delaunay triangulation of the same points and improves it as
        `voronoi_segment` does; the order is lost.
    kept : ndarray of uint8, optional
        1 for pieces that finishing must not split.
    budget : int, optional
        As for `classical_front`.

    Returns
    -------
    DomainMesh
        ``figures`` has "triangles", "minimum angle", "minimum 2r/R" and "mean 2r/R", with "before" and
        "after" if it is finished. ``unrefined`` contains all triangles if the budget was spent, with that
        reason.
    """
    c = complex_
    subsegments = c.ends[: c.segments], c.piece[: c.segments], c.span[: c.segments]
    before = quality_figures(run.made.points, run.made.triangles)
    if not finish or run.spent:
        everything = np.arange(len(run.made.triangles)) if run.spent else None
        reasons = np.full(len(run.made.triangles), "budget") if run.spent else None
        return domain_mesh_of(
            domain, subsegments, run.made, unrefined=everything, reasons=reasons, counts=run.counts,
            figures=before, steps=run.steps,
        )  # fmt: skip
    kept = np.zeros(len(domain.pieces), dtype=np.uint8) if kept is None else kept
    return finished_mesh(domain, subsegments, run.made.points, size, kept, budget, before, run.counts)


def finished_mesh(
    domain: Domain,
    subsegments: Subsegments,
    points: NDArray[np.float64],
    size: Any,
    kept: NDArray[np.uint8],
    budget: int | None,
    before: dict[str, float],
    counts: dict[str, int],
) -> DomainMesh:
    """The constrained Delaunay triangulation of the points of a front, improved as `voronoi_segment` does.

    ``points`` are first those of the domain and of its subsegments; further ones may move. ``before`` are
    the `quality_figures` of what the front made, and ``counts`` its counts.
    """
    origin = np.full(len(points), -1, dtype=np.int32)
    origin[: len(domain.points)] = np.arange(len(domain.points))
    whole = complex_of(domain, Sampled(points, origin, *subsegments, domain))
    rule = rule_of(1.35, "center", "first", None, True)
    base = VoronoiSegmentRun(domain, whole, size, None, rule, kept, False)
    base.first = max(len(domain.points), int(subsegments[0].max()) + 1)
    result = base.finish(budget)
    result["counts"] = counts | result["counts"]
    result["figures"] |= {f"{name} before": x for name, x in before.items()}
    return base.result(result)
