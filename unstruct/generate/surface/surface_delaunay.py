"""Delaunay triangulations of given surfaces: `surface_delaunay` (12.2.7, section 2.7 of the book)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET, as_count, as_flag, as_number, finite, positive
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...connect.surface.criteria import SurfaceCriteria, surface_criteria
from ...connect.surface.given import refuse_flat
from ...domain.given_surface import USUAL_SHARP, GivenSurface, given_surface
from ...geometry.embedded import embedded
from ...geometry.support_features import same_points
from ...mesh.domain_mesh import DomainMesh, noticed
from ...mesh.mesh import Mesh
from ...sizing import as_size
from .cleaning import Cleaned, cleaned
from .given_flips import Flipped, flip_given
from .own_crossings import OWN_CROSSING, OwnCrossings
from .repairing import Repaired, Wanted, repaired
from .straightening import own_crossings

__all__ = ["surface_delaunay"]

Array = NDArray[np.float64]
FLAT_ENOUGH = 2.0**-44  # of the largest coordinate: the surface moves by no more without a deviation
USUAL_LEAST_ANGLE = 25.0  # degrees
LARGEST_ASKED_ANGLE = 30.0
TOLERANCE_CUTS = 6  # of the tolerance of flips, until the measured deviation is what was asked for
ANOTHER_PART = "another part: a vertex that is not beside it is in its sphere"
NEAR_OTHERS = "it meets another part of the surface, which is too near"


def surface_delaunay(
    surface: Any,
    size: Any = None,
    *,
    min_angle: float | None = None,
    deviation: float | None = None,
    sharp: float | None = USUAL_SHARP,
    budget: int | None = None,
    progress: bool = False,
) -> DomainMesh:
    """A Delaunay triangulation of a surface: of its own vertices, or with new ones on it for a size.

    Parameters
    ----------
    surface : Mesh or Domain
        Triangles in space, none of them flat, or a body, whose facets and inner facets are meant.
    size : number, function (k, 3) -> (k,) or size field, optional
        The wanted edge length h: edges along the surface are at most sqrt(2) h long. Without it and without
        ``min_angle`` there are no new vertices.
    min_angle : float, optional
        With new vertices: the least angle wanted in triangles on the surface, in degrees, at most 30; 25 by
        default, 0 for none. Straight triangles have other angles where the surface bends.
    deviation : float, optional
        How far the triangles may be from the surface, and the surface from them. Without new vertices it
        permits flips across shallow creases; by default a flip must not move the surface but by rounding.
        With new vertices, more of them are put until this is reached.
    sharp : float, optional
        Degrees by which the surface turns at an edge that is kept; None keeps no edge for that.
    budget : int, optional
        The number of vertices at which to stop; 10^7 by default.
    progress : bool
        Show the number of vertices as it grows.

    Returns
    -------
    DomainMesh
        Triangles in space. ``origin``: the given vertex or -1. ``markers``: names of facets, values of cells,
        and names of edges. ``counts``: "flips", "inserted", "own crossings" (pairs of given triangles that
        cross, where the mesh does, too), "kept edges" (given ones, for parts that are near each other), how
        many triangles fail which criterion ("not plane-centered", "not intrinsic" in edges), and what was
        wrong with the given ones, as of `remesh`: repeated ones count once. ``figures``: "deviation", the
        larger of the distances measured both ways, and "sharp" as given, 0 for None. ``unrefined`` lists,
        without new vertices, the triangles whose plane-centered sphere has a vertex inside, with the reason:
        there need be no triangulation without them; with new vertices, those that are larger or sharper (on
        the surface) than wanted, or not as near; and those that cross others. Where the given surface
        crosses itself nothing is refined for that.

    Raises
    ------
    InputError
        For another thing than a surface, and for arguments that are out of range.
    MeshError
        For flat triangles.

    Notes
    -----
    *Without new vertices* the chapter's criterion may have no solution, as for (0,0,0), (4,0,0), (0,4,0),
    (1,1,1). Edges are flipped where this lowers the sum of cotangents and moves nothing (`given_flips`); flat
    parts become Delaunay in every sense. The result is embedded if the given surface is.

    *With new vertices*, edges are first flipped along the surface until it is intrinsic Delaunay, then
    circumcenters of bad triangles are put, found by lines on the surface (`intrinsic_run`, with the bound of
    30 degrees and its hypotheses), then the edges are made straight. Where straight triangles would meet,
    face the wrong way or be too far from the surface, edges are halved; where that does not help, as parts of
    the surface are very near each other, given edges are kept (`near_sheets`). All vertices lie on given
    triangles, kept edges on given edges, up to rounding. O(m log m) in practice.

    Source: N. Sharp, Y. Soliman and K. Crane, *Navigating intrinsic triangulations*, ACM Trans. Graphics 38
    (2019). Book: 2.7.
    """
    near = _checked(min_angle, deviation)
    clean = cleaned(surface)
    given = given_surface(clean.surface, None if sharp is None else finite(sharp, "sharp"))
    turn = 0.0 if sharp is None else float(sharp)
    as_flag(progress, "progress")
    most = DEFAULT_BUDGET if budget is None else as_count(budget, "budget")
    refuse_flat(given.support.points, given.support.held.rows.astype(np.int32))
    if size is None and min_angle is None:
        return noticed(_flipped(given, clean, near, turn))
    field = None if size is None else as_size(size)
    angle = USUAL_LEAST_ANGLE if min_angle is None else float(min_angle)
    with progress_bar(progress, "", desc="vertices") as bar:
        found = repaired(given, Wanted(field, angle, near, sharp, most), bar)
        kept = len(found.run.given.support.features) - len(given.support.features)
        return noticed(_meshed(found, clean._replace(counts=clean.counts | {"kept edges": kept}), turn))


def _checked(min_angle: Any, deviation: Any) -> float | None:
    if min_angle is not None and not 0.0 <= as_number(min_angle, "min_angle") <= LARGEST_ASKED_ANGLE:
        raise InputError(f"min_angle = {min_angle} must lie between 0 and {LARGEST_ASKED_ANGLE:g} degrees")
    if deviation is None:
        return None
    return positive(deviation, "deviation")


# ---------------------------------------------------------------------- without new vertices


def _flipped(given: GivenSurface, clean: Cleaned, near: float | None, turn: float) -> DomainMesh:
    support, rows = given.support, given.support.held.rows.astype(np.int32)
    xyz, own = support.points * support.factor, OwnCrossings(support)
    rounding = FLAT_ENOUGH * float(np.abs(xyz).max(initial=0.0))
    allowed = rounding if near is None else max(rounding, near * support.factor)
    whole, tolerance, measured = embedded(support.points, rows), allowed, 0.0
    for _ in range(TOLERANCE_CUTS):
        found = flip_given(xyz, rows, support.features, tolerance)
        measured = max(support.deviation(support.points, found.triangles))
        good = measured * support.factor <= 2.0 * allowed or tolerance <= rounding
        embeds = good and embedded(support.points, found.triangles)
        if embeds or (good and not whole and len(own.others(xyz, found.triangles)[0]) == 0):
            break
        tolerance = tolerance / 4.0 if tolerance > rounding else 0.0
    else:
        found, measured = Flipped(rows, 0), 0.0
    used, number = np.unique(found.triangles, return_inverse=True)
    triangles = number.reshape(-1, 3).astype(np.int32)
    points, place = support.points[used], np.full(len(support.points), -1)
    place[used] = np.arange(len(used))
    markers = given.markers(triangles, np.arange(len(triangles)))
    for name, edges in given.edges.items():
        if name not in markers:
            markers[name] = place[same_points(support.points)[edges]].astype(np.int32)
    criteria = surface_criteria(Mesh(points, triangles))
    why = _why(criteria, place[same_points(support.points)[support.features]])
    if not whole:
        why[own.others(xyz, found.triangles)[1]] = f"not embedded: {OWN_CROSSING}"
    bad = np.flatnonzero(why != "").astype(np.int32)
    return DomainMesh(
        points, triangles, origin=used.astype(np.int32), markers=markers, regions=clean.regions,
        unrefined=bad, reasons=why[bad].tolist(),
        counts={"flips": found.flips, "inserted": 0, "own crossings": own.count, "kept edges": 0}
        | _failures(criteria) | clean.counts,
        figures={"deviation": measured, "sharp": turn},
    )  # fmt: skip


def _failures(criteria: SurfaceCriteria) -> dict[str, int]:
    counts = criteria.counts
    return {
        "not plane-centered": counts["plane-centered"],
        "not restricted": counts["restricted"],
        "not intrinsic": counts["intrinsic"],
    }


def _why(criteria: SurfaceCriteria, kept: NDArray) -> np.ndarray:
    """Why no flip makes a triangle plane-centered Delaunay; empty for those that are."""
    many = len(criteria.mesh.points)
    stay = np.isin(
        criteria.edges.min(axis=1).astype(np.int64) * many + criteria.edges.max(axis=1),
        kept.min(axis=1) * many + kept.max(axis=1) if len(kept) else [],
    )
    reason = np.full(len(criteria.plane_centered), ANOTHER_PART, dtype="<U80")
    for chosen, text in (
        (~criteria.at_edges & ~stay, "bent: a flip would change the surface"),
        (~criteria.at_edges & stay, "kept: an edge that must stay is in the way"),
    ):
        reason[criteria.edge_triangles[chosen].ravel()] = text
    reason[criteria.plane_centered] = ""
    return reason


# ---------------------------------------------------------------------- with new vertices


def _meshed(found: Repaired, clean: Cleaned, turn: float) -> DomainMesh:
    run, straight, wrong, far, measured, vain = found
    given, sides = run.given, run.found.sides
    markers = given.markers(straight.triangles, sides.label)
    flat = given.support.triangles.ravel()
    under = sides.under[straight.sides]
    same = same_points(given.support.points)
    ends = np.sort(
        same[np.stack([flat[under], flat[np.where(under % 3 == 2, under - 2, under + 1)]], 1)], axis=1
    )
    many = len(given.support.points)
    for name, edges in given.edges.items():
        if name not in markers:
            wanted = np.sort(same[edges], axis=1)
            on = np.isin(ends[:, 0] * many + ends[:, 1], wanted[:, 0] * many + wanted[:, 1])
            markers[name] = np.unique(np.sort(straight.edges[on], axis=1), axis=0)
    rows, _ = run.bad()
    why = np.full(len(straight.triangles), "", dtype="<U80")
    why[run.angles_below()] = "sharp: angles of the surface leave no room"
    large = run.too_large()
    why[large] = "large: edges that are kept leave no room"
    if run.out_of_budget:
        why[rows] = "budget"
    why[far] = "budget" if run.out_of_budget else "far: it stays too far from the surface"
    if wrong.text:
        why[wrong.triangles] = f"not embedded: {NEAR_OTHERS if vain else wrong.text}"
    why[own_crossings(run, straight)] = f"not embedded: {OWN_CROSSING}"
    bad = np.flatnonzero(why != "").astype(np.int32)
    return DomainMesh(
        straight.points, straight.triangles, origin=straight.origin, markers=markers,
        regions=clean.regions, unrefined=bad, reasons=why[bad].tolist(),
        counts={
            "flips": run.found.counts["flips"],
            "inserted": int((straight.origin < 0).sum()),
            "repaired": run.repaired,
            "own crossings": run.own.count,
        } | clean.counts,
        figures={"deviation": measured, "sharp": turn},
    )  # fmt: skip
