"""The advancing-front Delaunay triangulation (12.3.4): cell by cell from the boundary by the empty circle."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET, MOST_VERTICES, as_count, as_flags
from ...base.arrays import frozen
from ...base.errors import InputError
from ...base.jit import kernel
from ...base.progress import progress_bar
from ...connect.insertion.engine import grown
from ...connect.planar.complex import PlanarComplex
from ...connect.planar.flood import number_parts
from ...domain.domain import Domain, Sampled, as_domain
from ...domain.plane.by_region import size_by_region
from ...geometry.ordering import hilbert_order
from ...geometry.parity import even_odd, left_parity, right_parity
from ...mesh.domain_mesh import DomainMesh, noticed
from ...predicates.batch import power_of_two, scaled, unscaled
from ...sizing import as_size
from ..advancing.rows import CELLS_MADE, VERTEX_COUNT, Waiting, room_to_wait
from ..boundary.constrained import planar_complex
from ..boundary.kept import kept_pieces
from ..boundary.pairs import paired
from ..rebay.run import TOLERANCE
from ..space_front.given_points import given_points_in_space
from ..volume.lacking import what_is_missing
from . import delaunay_steps as k
from .classical import emptied, enter_all, finished_mesh
from .classical_steps import Choices
from .empty_circle import new_ahead
from .given_in_plane import as_given, refuse_on_curves, with_points
from .made_mesh import Made, domain_mesh_of, neighbors_of, quality_figures
from .open_front import OpenFront, new_front

__all__ = ["front_delaunay"]

MOST_ROWS = 5  # of points outside that are named in a warning
CELLS_A_CALL = 50_000  # a fraction of a second: Ctrl-C works between calls


def front_delaunay(
    domain: Domain,
    points_or_size: Any,
    *,
    finish: bool = False,
    budget: int | None = None,
    history: bool = False,
    progress: bool = False,
) -> DomainMesh:
    """Mesh a domain cell by cell from its boundary, each by the empty circle; in space, by the empty sphere.

    Parameters
    ----------
    domain : Domain
    points_or_size : array_like, shape (k, 2), in space (k, 3); or a size
        Points to be triangulated, or, in the plane, the wanted edge length: a number, function, SizeField, or
        dict of region name to one of these. With a size the boundary is cut by it, and points are made ahead
        of the front.
    finish : bool
        With a size: whether to improve the result afterwards, as `voronoi_segment` does. Given points stay.
    budget : int, optional
        With a size: the largest number of new points, besides those that cut the boundary; 10^7 by default.
    history : bool
        Keep a record of each cell in ``steps``.
    progress : bool
        Show a bar.

    Returns
    -------
    DomainMesh
        A constrained Delaunay triangulation of the points and the boundary, with the cells in the order in
        which they were made: ``simplices[:k]`` is the state after k of them, and in each the first two
        vertices are the edge of the front, the third is the apex. Vertices are those of the domain, those
        that cut curves and pieces, then the points, in their order. ``counts``: "cells"; "cocircular" cells,
        whose circle has another visible vertex on it, so that another choice would have been as good;
        "hidden" candidates, which were in the circle of a cell but not visible from its edge, and which a
        test of all points would have taken for obstacles; "outside" points, which were left out: their rows
        are in ``left_out``, and a warning names the first ones. With a size
        also "points", "circumcenters", "forced" cells and edges "set aside", from making the points.
        ``figures``: "triangles", "minimum angle", "minimum 2r/R" and "mean 2r/R". ``steps`` (with
        ``history``): "edge", "apex" and "cocircular", one row for each cell. With ``finish=True`` the order
        of the cells is lost, and counts, figures and ``unrefined`` are those of the finishing pass, too.

    Raises
    ------
    InputError
        For points that are equal to one another or to a vertex of the domain, or lie on a piece, by exact
        signs (with the first such row), for sizes that are not positive and finite, for exponents too wide
        for one scale, and for ``finish`` with points, or together with ``history``.

    Notes
    -----
    The apex of a front edge is the visible vertex on its left whose circle with the edge has no other one
    inside; of several on one circle the leftmost, lowest one. Without the word *visible* an edge may have no
    apex. The proof that there always is one, and that the result is constrained Delaunay, is in
    `empty_circle`. No other triangulation is used, except to finish. A search goes through digital trees of
    the vertices and edges of the front, expected O(log n) for even distributions; if k vertices are on one
    circle up to rounding and none inside, each of them costs O(k). All signs are exact.

    With a size the points come first, from a front of their own that takes the widest cell first; then they
    are triangulated.

    *In space* faces take the place of edges, and spheres that of circles; a vertex is visible if the solid
    tetrahedron meets the front in its own faces, edges and corners only. If a constrained Delaunay
    tetrahedralization exists and no five vertices are on a sphere, the result is one. It need not exist:
    ``counts`` has the faces inside that are "not Delaunay", and the "stuck faces", which have no apex; what
    they enclose is "filled" by recovery. These cells are in ``unrefined``. "cospherical" stands for
    "cocircular", and "face" for "edge". Ties are decided alike for all faces, as if points were a little
    elsewhere (`unstruct.generate.space_front.empty_sphere`): by the order of vertices, and if that fails, by
    one that fits to the given diagonals ("ties decided anew"). On lattices there may be a constrained
    Delaunay tetrahedralization for other decisions only; then it may be missed, and cells are in
    ``unrefined``. Sources: the source chapter, 12.3.4; D. Lee, A. Lin, Discrete & Computational Geometry 1
    (1986) 201-217, for visibility. Book: 3.4, 3.5.
    """
    budget = DEFAULT_BUDGET if budget is None else min(as_count(budget, "budget"), MOST_VERTICES)
    as_flags(history=history, finish=finish, progress=progress)
    domain = as_domain(domain, None)
    if domain.dimension == 3:
        return _in_space(domain, points_or_size, finish, history, progress)
    if not len(domain.facets):
        raise InputError("the domain has no facets, so nothing is inside: give facets")
    points = as_given(points_or_size)
    if finish and (history or points is not None):
        told = "points, which stay where they are" if points is not None else "history, since cells change"
        raise InputError(f"finish=True goes with a size, and not with {told}")
    size = points_or_size
    counts: dict[str, int] = {}
    spent = False
    with progress_bar(progress, " cells") as bar:
        if points is not None:
            sampled = with_points(domain, points).sampled()
            refuse_on_curves(sampled, points, len(domain.points) + len(points))
            rows = sampled.points
        else:
            sampled = domain.sampled(size)
            if isinstance(size, Mapping):
                size = size_by_region(planar_complex(domain, size), size, domain.regions)
            new, counts, spent = _points_ahead(domain, sampled, size, budget, bar)
            rows = np.concatenate([sampled.points, new])
        order = hilbert_order(rows)
        made, ties, more = _wrapped(_first_front(sampled, rows, order), power_of_two(rows), bar)
        made = order[made].astype(np.int32)
    outside = np.empty(0, dtype=np.int64)
    if points is not None:
        loose = np.arange(len(domain.points), len(domain.points) + len(points))
        outside = np.flatnonzero(~np.isin(loose, made))
        more["outside"] = len(outside)
    figures, subsegments = quality_figures(rows, made), (sampled.ends, sampled.piece, sampled.span)
    if finish and not spent:
        kept = kept_pieces(True, len(domain.facets), len(domain.pieces), domain.held())
        counts = more | counts
        return noticed(
            paired(domain, finished_mesh(domain, subsegments, rows, size, kept, budget, figures, counts))
        )
    result = _labelled(domain, sampled, rows, made)
    steps = None
    if history:
        steps = {"edge": made[:, :2].copy(), "apex": made[:, 2].copy(), "cocircular": ties}
    everything = np.arange(len(made)) if spent else None
    mesh = domain_mesh_of(
        domain, subsegments, result, steps=steps, counts=more | counts, figures=figures, unrefined=everything,
        reasons=np.full(len(made), "budget") if spent else None,
    )  # fmt: skip
    mesh.left_out = frozen(outside.astype(np.int32))
    return noticed(paired(domain, mesh), _what_is_outside(mesh, points))


def _in_space(domain: Domain, points: Any, finish: bool, history: bool, progress: bool) -> DomainMesh:
    """`front_delaunay` for a body."""
    rows = as_given(points, 3)
    if rows is None:
        raise InputError("in space front_delaunay takes points (k, 3); with a size use advancing_front")
    if finish:
        raise InputError("finish=True goes with a size, and not with points, which stay where they are")
    mesh = given_points_in_space(domain, rows, history=history, progress=progress)
    told = [_what_is_outside(mesh, rows), what_is_missing(domain, mesh)]
    return noticed(mesh, "; ".join(filter(None, told)))


def _what_is_outside(mesh: DomainMesh, points: NDArray[np.float64] | None) -> str:
    """How many of the points are outside of the domain, and which; "" if there are none."""
    rows = mesh.left_out.tolist()
    if points is None or not rows:
        return ""
    first = ", ".join(f"points[{i}]" for i in rows[:MOST_ROWS]) + (", ..." if len(rows) > MOST_ROWS else "")
    return (
        f"{len(rows)} of {len(points)} points are outside of the domain and were left out: {first}; "
        "see mesh.left_out"
    )


# --- the first front ------------------------------------------------------------------------------


def _first_front(
    sampled: Sampled, rows: NDArray[np.float64], order: NDArray[np.int64] | None = None
) -> OpenFront:
    """The front of the boundary, with all vertices inside that it does not use; found by exact parity.

    With ``order``, vertex i of the front is row ``order[i]``: along a curve, so that neighbors are near in
    memory.
    """
    order = np.arange(len(rows)) if order is None else order
    number = np.empty(len(rows), dtype=np.int64)
    number[order] = np.arange(len(rows))
    xy, exact = scaled(rows[order])
    if not exact:
        raise InputError(
            "the exponents of the coordinates differ too much for one scale: drop or move points that are "
            "closer to each other than 1e-300 of the largest coordinate"
        )
    facets = sampled.piece < len(sampled.outline.facets)
    outer, inner = sampled.ends[facets], sampled.ends[~facets]
    if len(inner):
        inner = inner[right_parity(rows, outer, inner)]
    left = left_parity(rows, outer)
    edges = np.concatenate(
        [
            np.where(left[:, None], outer, outer[:, ::-1]),
            np.stack([inner, inner[:, ::-1]], axis=1).reshape(-1, 2),
        ]
    )
    free = np.ones(len(rows), dtype=bool)
    free[sampled.ends.ravel()] = False
    loose = np.flatnonzero(free)
    odd, on = even_odd(rows, outer, rows[loose])
    front = new_front(xy, 2 * len(edges) + 8 * int(len(rows) ** 0.5) + 64, len(rows) + 64)
    table = np.column_stack([number[edges], np.zeros(len(edges), dtype=np.int64)])
    enter_all(front, table, np.sort(number[loose[odd & ~on]]))
    return front


# --- the work -------------------------------------------------------------------------------------


def _wrapped(
    front: OpenFront, factor: float, bar: Any
) -> tuple[NDArray[np.int32], NDArray[np.bool_], dict[str, int]]:
    """Cell by cell until the front is empty: the cells, which of them have a choice, and the counts."""
    ahead, counts = new_ahead(), np.zeros(k.WRAP_COUNTS, dtype=np.int64)
    ties = np.zeros(len(front.made), dtype=bool)

    def advance(front: OpenFront, waiting: Waiting) -> int:
        nonlocal ties
        ties, ahead.found[3] = grown(ties, len(front.made)), 0
        return int(k.wrap(front, ahead, waiting, ties, counts, CELLS_A_CALL))

    waiting = room_to_wait(None, len(front.ends), len(front.xy))
    k.start_in_turn(front, waiting)
    front = emptied(front, waiting, advance, factor, bar)
    m = int(front.state[CELLS_MADE])
    names = {"cells": m, "cocircular": int(counts[k.TIES]), "hidden": int(counts[k.HIDDEN_TIMES])}
    return front.made[:m, :3].copy(), ties[:m].copy(), names


def _points_ahead(
    domain: Domain, sampled: Sampled, size: Any, budget: int, bar: Any
) -> tuple[NDArray[np.float64], dict[str, int], bool]:
    """New points ahead of the front, in the order of making; counts; whether the budget is spent."""
    field, (lower, upper) = as_size(size), domain.bounds
    factor, n = power_of_two(sampled.points), len(sampled.points)
    table = field.table(lower, upper, factor=factor, tolerance=TOLERANCE).nodes
    constant = 0.0 if field.constant is None else float(table.values[0, 0])
    choices = Choices(0, 0, False, 1.0, 0.0, constant, n + budget, table)
    front, ahead = _first_front(sampled, sampled.points), new_ahead()
    waiting, counts = (
        room_to_wait(None, len(front.ends), len(front.xy)),
        np.zeros(k.WRAP_COUNTS, dtype=np.int64),
    )

    def advance(front: OpenFront, waiting: Waiting) -> int:
        ahead.found[3] = 0
        return int(k.place_ahead(front, choices, ahead, waiting, counts, CELLS_A_CALL))

    k.start_widest(front, choices, ahead, waiting)
    front = emptied(front, waiting, advance, factor, bar)
    names = {
        "points": int(counts[k.PLACED]), "circumcenters": int(counts[k.AT_CENTERS]),
        "forced": int(counts[k.FORCED_CELLS]), "set aside": int(counts[k.SET_ASIDE]),
    }  # fmt: skip
    stop = int(front.state[VERTEX_COUNT])
    return unscaled(front.xy[n:stop], factor), names, stop >= n + budget


# --- regions --------------------------------------------------------------------------------------


@kernel
def _parts(triangles, neighbors, mark, part, least, stack):
    """Number the parts that marked sides divide the triangles into, in ``part``; return how many.

    ``least`` gets the lowest vertex of each part.
    """
    count = 0
    for t in range(len(part)):
        part[t] = -1
    for t in range(len(part)):
        if part[t] >= 0:
            continue
        part[t], stack[0], depth = count, t, 1
        least[count] = triangles[t, 0]
        while depth > 0:
            depth -= 1
            s = np.int64(stack[depth])
            for i in range(3):
                least[count] = min(least[count], triangles[s, i])
                o = neighbors[s, i]
                if o >= 0 and mark[3 * s + i] < 0 and part[o] < 0:
                    part[o] = count
                    stack[depth] = o
                    depth += 1
        count += 1
    return count


def _labelled(domain: Domain, sampled: Sampled, rows: NDArray[np.float64], made: NDArray[np.int32]) -> Made:
    """The cells with the numbers of their regions, as `constrained_delaunay` numbers them."""
    n, m = len(rows), len(made)
    side = np.stack([made[:, [1, 2, 0]], made[:, [2, 0, 1]]], axis=2).reshape(-1, 2).astype(np.int64)
    ends = np.sort(sampled.ends.astype(np.int64), axis=1)
    fixed = np.isin(side.min(axis=1) * n + side.max(axis=1), ends[:, 0] * n + ends[:, 1])
    mark = np.where(fixed, 0, -1).astype(np.int32)
    part, least, stack = np.empty(m, np.int32), np.empty(m, np.int32), np.empty(m + 4, np.int32)
    parts = int(_parts(made, neighbors_of(made, n), mark, part, least, stack)) if m else 0
    factor = power_of_two(rows)
    # What the numbering of parts reads of a triangulation.
    view = SimpleNamespace(
        xy=rows * factor, vertex=made.ravel(), mark=mark, region=part, triangles=m, factor=factor, regions={}
    )
    number_parts(cast(PlanarComplex, view), domain.regions, parts, least)
    return Made(rows, made, part, view.regions)
