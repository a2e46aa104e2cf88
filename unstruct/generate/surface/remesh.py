"""Remeshing of a given surface to a size (12.2.7)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET, as_count, as_flag, positive
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...connect.surface.complex import SurfaceComplex, Taken
from ...connect.surface.halfedges import SMOOTH
from ...domain.domain import Domain
from ...domain.given_surface import USUAL_SHARP, GivenSurface, directed, given_surface
from ...geometry.support_features import same_points
from ...mesh.domain_mesh import DomainMesh, noticed
from ...mesh.mesh import Mesh
from ...sizing.asked import MISSED_SIZE
from ...sizing.field import SizeField, as_size
from .cleaning import Cleaned, cleaned
from .distances import curve_deviation
from .measuring import FLAT_TRIANGLE, INVERTED, TOO_FAR_OFF
from .missed import missed_size, sharp_triangles
from .near_sheets import HELPED, KEEPINGS, MOST_TIMES, creases_near, keeping
from .needles import without_needles
from .own_crossings import CROSSES_ANOTHER, OWN_CROSSING
from .run import ALLOWED, KEPT_TO, REMESH_ROUNDS, RemeshRun
from .seams import divide_seams
from .shapes import COLLAPSES, FLIPS_DONE, MOVES_DONE, SPLITS_DONE, TOO_FAR, TURNED
from .true_surface import moved_onto, nearest_by

__all__ = ["remesh"]

FAULT_REASONS = {
    TOO_FAR_OFF: "farther from the given surface than allowed: a smaller size or a larger deviation helps",
    INVERTED: "turned against the given surface",
    FLAT_TRIANGLE: "flat",
}
BESIDE_SURFACE = "a vertex is beside the surface, as a triangle would turn over: give a smaller size there"
NEAR_CREASE = "sharp: creases are too near each other for the size: give a smaller size there"
NEAR_VERTICES = (
    "sharp: vertices much nearer each other than the size could not be merged: give a smaller size there"
)
SHARP_BETWEEN = 10.0  # degrees below which an angle between creases is told
NO_BUDGET = "larger than the size: the budget of vertices is used up"


def remesh(
    surface: Any,
    size: Any,
    *,
    sharp: float | None = USUAL_SHARP,
    deviation: float | None = None,
    onto: Any = None,
    budget: int | None = None,
    progress: bool = False,
) -> DomainMesh:
    """Triangles of a wanted size on a given surface, however bad its own triangles are.

    Parameters
    ----------
    surface : Domain or Mesh
        A body in space, whose facets are meant, or a mesh of triangles in space: closed or open, of any
        topology. Its triangles may be needles or flat, points may be equal, more than two triangles may meet
        in an edge.
    size : number, function (k, 3) -> (k,), or SizeField
        The wanted length of edges.
    sharp : float, optional
        Edges at which the surface turns by more degrees are kept; None for none. Kept are also boundaries,
        edges between triangles with different names, named edges, and edges in which more than two triangles
        meet. Their points stay on them.
    deviation : float, optional
        How far the new triangles may be from the given ones, and these from them, at samples; triangles for
        which that cannot be are in ``unrefined``. By default a hundredth of the size, and as much more as the
        given triangles are off a smooth surface themselves, where they are coarse: altogether at most 0.15 of
        the size. Where the surface is too curved for the size, the size is lowered, to no less than an
        eighth.
    onto : function (k, 3) -> (k, 3), optional
        The nearest points of the true surface, which the given triangles approximate: they are divided and
        moved onto it first, points of features, too. It must leave its own results where they are; this is
        not tested, and with other functions (a reflection, say) the division may take minutes.
    budget : int, optional
        The largest number of vertices, by default ten million.
    progress : bool
        Show a progress bar.

    Returns
    -------
    DomainMesh
        Triangles in space, turned as the given ones (those of a body outward). ``origin`` has the number of
        the given point for vertices that are in its place: corners of features are, always. ``markers`` are
        carried on. Triangles that are too far from the given surface, turned against it, flat, or that cross
        others or miss the size, and those of less than ten degrees between creases, or at edges much too
        short, are in ``unrefined``, with ``reasons``; crossings of the given surface itself have a reason of
        their own, and nothing is refined there. ``counts``: "splits", "collapses", "flips", "moves", how many
        changes were "refused: too far" and "refused: turned over", "lowered" (the vertices where the size had
        to be lowered), "kept edges" (given ones, for sheets near each other), "feature edges", and what was
        wrong with the given triangles ("equal points", "degenerate triangles", "repeated triangles", "turned
        triangles"; "seams": edges of more than two triangles; "one-sided edges": of two that cannot be turned
        alike, where a surface of one side closes; "own crossings": pairs of given triangles that cross, where
        the mesh does, too). ``figures``: "deviation" (of all distances, both ways, the largest), "feature
        deviation", "least angle" in degrees, "least size" (the smallest part of the wanted size to which it
        was lowered), and "sharp" as given, 0 for None.

    Raises
    ------
    InputError
        For anything but a surface and a size, and if all triangles are degenerate.

    Notes
    -----
    Rounds of splits (edges longer than 4/3 of the size, the longest of both their triangles), collapses
    (shorter than 4/5), flips toward six edges at each vertex, moves to the mean of the star, along the
    surface, and flips toward less sharp triangles; the sharpest are then improved one by one, up to 40
    degrees where possible. No operation turns a triangle over or changes the topology: each keeps the link
    condition. A collapse or flip that would leave the surface too far is refused. In the end triangles that
    are too far are split, and an exact test finds those that cross others, where the size is halved, unless
    the given surface crosses itself there; where that does not help, as sheets are very near each other, all
    is done again with given edges kept there (`near_sheets`). Between creases nearer than 0.3 of the size it
    is lowered to their distance, if an eighth suffices. Names of triangles do not move. Edges of
    more than two triangles are divided first and fixed; they are halved where the size is lowered. Vertices
    stay on their part of the surface, and with the normals of their sheet where a part crosses itself.

    Distances are measured at samples: they are lower bounds. O(n) in practice for n triangles, given and new.
    Sources: M. Botsch, L. Kobbelt, *A remeshing approach to multiresolution modeling* (SGP 2004); H. Hoppe et
    al., *Mesh optimization* (1993); T. K. Dey et al., *Topology preserving edge contraction* (1999), for the
    link condition. Book: 2.7.
    """
    field = as_size(size)
    within = None if deviation is None else positive(deviation, "deviation")
    if onto is not None and not callable(onto):
        raise InputError(f"onto must be a function of points (k, 3), not {onto!r:.60}")
    most = DEFAULT_BUDGET if budget is None else as_count(budget, "budget")
    progress = as_flag(progress, "progress")
    clean = cleaned(surface, flat=True)
    if onto is not None:
        clean = clean._replace(surface=_true(clean.surface, onto, field, within, most))
    given = directed(given_surface(clean.surface, sharp))
    with progress_bar(progress, " rounds", total=REMESH_ROUNDS) as bar:
        attempt = _least_crossing(given, field, (within, sharp), most, bar)
        kept = len(attempt.given.support.features) - len(given.support.features)
        clean = clean._replace(counts={"kept edges": kept} | clean.counts)
    if onto is not None:
        run, factor = attempt.run, given.support.factor
        run.put(nearest_by(onto, run.complex.sheets.xyz[: run.used] / factor) * factor)
        attempt = attempt._replace(crossing=run.crossing())
    return noticed(_account(attempt, clean, sharp))


class Attempt(NamedTuple):
    """A remeshed surface.

    Attributes
    ----------
    given : GivenSurface
        With the edges that are kept because sheets are near each other.
    run : RemeshRun
    crossing : tuple of two (k,) int64
        As of `RemeshRun.crossing`.
    group : (m,) int64
        For each name of a triangle one that is given.
    seams : tuple of two int
        How many edges are divided first, as of `divide_seams`.
    """

    given: GivenSurface
    run: RemeshRun
    crossing: tuple[NDArray[np.int64], NDArray[np.int64]]
    group: NDArray[np.int64]
    seams: tuple[int, int]


def _least_crossing(
    given: GivenSurface, field: SizeField, limits: tuple[float | None, float | None], most: int, bar: Any
) -> Attempt:
    """The surface remeshed, with given edges kept where triangles cross that no smaller size helps.

    ``limits`` are the deviation and the angle of creases.
    """
    (within, sharp), best, least, room = limits, None, np.inf, most
    for kept in range(1 + KEEPINGS):
        run, group, seams = _begun(without_needles(given), field, within, room)
        run.run(bar)
        crossing = run.untangle(bar)
        area = run.area(crossing[0])
        if best is not None and run.short and room < most:
            break
        vain = area > HELPED * least
        if best is None or area < least:
            best, least = Attempt(given, run, crossing, group, seams), area
        if area == 0.0 or run.short or (vain and kept > 1):
            break
        before = len(given.support.features)
        given = keeping(given, creases_near(run.support, run.crossed, kept), sharp)
        room = min(room, MOST_TIMES * (run.used + len(given.support.points)))
        if len(given.support.features) == before:
            break
    assert best is not None
    return best


def _true(surface: Any, onto: Any, field: SizeField, within: float | None, most: int) -> Mesh:
    """The given triangles moved onto the true surface, divided where that is needed."""
    if isinstance(surface, Domain):
        given = given_surface(surface, None)
        rows = np.asarray(given.support.triangles)
        names = {name: rows[among] for name, among in given.names.items()}
        surface = Mesh(surface.points, rows, markers=names | given.edges | given.values)

    def allowed(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return ALLOWED * field(x) if within is None else np.full(len(x), within)

    return moved_onto(surface, onto, allowed, most)


def _begun(
    given: GivenSurface, field: SizeField, within: float | None, most: int
) -> tuple[RemeshRun, Any, tuple[int, int]]:
    """The run before its first round; for each name of a triangle one that is given; the edges of seams."""
    support = given.support
    rows = support.held.rows
    whole = np.flatnonzero((rows != np.roll(rows, 1, axis=1)).all(axis=1))
    code = np.zeros(len(rows), dtype=np.int64)
    for values in (*given.names.values(), *given.values.values()):
        both = np.stack([code, np.unique(values, return_inverse=True)[1].ravel()], axis=1)
        code = np.unique(both, axis=0, return_inverse=True)[1].ravel()
    first, code = np.unique(code, return_index=True, return_inverse=True)[1:]
    complex = SurfaceComplex(
        support.points * support.factor,
        rows[whole].astype(np.int32),
        support.features,
        support.chain,
        support.corners,
        code.ravel()[whole].astype(np.int32),
    )
    factor = support.factor
    seams = divide_seams(complex, lambda x: field(x / factor) * factor)
    s = complex.sheets
    used = s.at >= 0
    s.near[used] = whole[np.minimum(s.at[used] // 3, len(whole) - 1)]
    return RemeshRun(support, complex, field, within, most), first, seams


def _account(attempt: Attempt, clean: Cleaned, sharp: float | None) -> DomainMesh:
    """The mesh with its names, and what is to be said of it."""
    given, run, crossing, group, seams = attempt
    support, taken, s = given.support, run.complex.taken(), run.complex.sheets
    points = taken.points / support.factor
    origin = np.full(len(points), -1, dtype=np.int32)
    old = np.flatnonzero(taken.vertices < len(support.points))
    same = (points[old] == support.points[taken.vertices[old]]).all(axis=1)  # slots are used again
    origin[old[same]] = taken.vertices[old[same]]
    mesh = Mesh(points, taken.triangles)
    fault = run.faults()
    if run.deviation is not None:
        fault = fault & ~TOO_FAR_OFF | run.farther(1.0 / KEPT_TO)
    fault = fault[taken.slots]
    crossed, own = (np.isin(taken.slots, slots) for slots in crossing)
    large = missed_size(points, taken.triangles, run.size)
    why = dict.fromkeys(large.tolist(), NO_BUDGET if run.short else MISSED_SIZE)
    angle = mesh.quality("min_angle")
    corners = 3 * taken.slots[:, None] + np.arange(3)
    on_creases = s.kind[s.vertex[corners]] != SMOOTH
    creased, thin = sharp_triangles(points[taken.triangles], s.curve[corners] >= 0, on_creases, run.size)
    why |= dict.fromkeys(np.flatnonzero(thin & (angle < SHARP_BETWEEN)).tolist(), NEAR_VERTICES)
    why |= dict.fromkeys(np.flatnonzero(creased & (angle < SHARP_BETWEEN)).tolist(), NEAR_CREASE)
    for kind, text in FAULT_REASONS.items():
        why |= dict.fromkeys(np.flatnonzero(fault & kind).tolist(), text)
    off = run.off[taken.vertices][taken.triangles].any(axis=1)
    why |= dict.fromkeys(np.flatnonzero(off).tolist(), BESIDE_SURFACE)
    why |= dict.fromkeys(np.flatnonzero(own).tolist(), OWN_CROSSING)
    why |= dict.fromkeys(np.flatnonzero(crossed).tolist(), CROSSES_ANOTHER)
    cells = sorted(why)
    names = ("splits", "collapses", "flips", "moves", "refused: too far", "refused: turned over")
    kinds = (SPLITS_DONE, COLLAPSES, FLIPS_DONE, MOVES_DONE, TOO_FAR, TURNED)
    lowered = s.size[taken.vertices] / run.asked(taken.vertices)
    counts = {name: int(run.counts[kind]) for name, kind in zip(names, kinds)} | {
        "lowered": int((lowered < 1.0).sum()),
        "feature edges": len(taken.edges),
        "seams": seams[0],
        "one-sided edges": seams[1],
        "own crossings": run.own.count,
    }
    figures = {
        "deviation": max(support.deviation(points, taken.triangles)),
        "feature deviation": curve_deviation(support, taken),
        "least angle": float(angle.min()),
        "least size": float(lowered.min()),
        "sharp": 0.0 if sharp is None else sharp,
    }
    return DomainMesh(
        points,
        taken.triangles,
        origin=origin,
        markers=_markers(given, clean, taken, group[s.name[taken.slots]], origin),
        regions=clean.regions,
        unrefined=cells,
        reasons=[why[i] for i in cells],
        counts=counts | clean.counts,
        figures=figures,
    )


def _markers(
    given: GivenSurface, clean: Cleaned, taken: Taken, triangle: NDArray[np.int64], origin: NDArray[np.int32]
) -> dict[str, Any]:
    """The names of triangles, feature edges and vertices."""
    found: dict[str, Any] = given.markers(taken.triangles, triangle)
    support = given.support
    n, number = len(support.points), same_points(support.points)
    kept = np.sort(support.features, axis=1)
    key = kept[:, 0] * n + kept[:, 1]
    for name, rows in given.edges.items():
        ends = np.sort(number[rows], axis=1)
        curves = np.unique(support.chain[np.isin(key, ends[:, 0] * n + ends[:, 1])])
        found[name] = taken.edges[np.isin(taken.curves, curves)]
    place = {int(v): i for i, v in enumerate(origin.tolist()) if v >= 0}
    for name, rows in clean.vertices.items():
        found[name] = np.array([place[int(v)] for v in rows if int(v) in place], dtype=np.int32)[:, None]
    return found
