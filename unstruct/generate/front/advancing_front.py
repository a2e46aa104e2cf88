"""The advancing front: from the boundary inward, one triangle after the other."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ...base.arguments import DEFAULT_BUDGET, MOST_VERTICES, as_count, as_flags
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...domain.domain import Domain, as_domain
from ...domain.plane.by_region import size_by_region
from ...mesh.domain_mesh import DomainMesh, noticed
from ...sizing.directions import as_metric
from ...sizing.metric import Metric
from ...sizing.space_metric import SpaceMetric
from ..boundary.constrained import planar_complex
from ..boundary.kept import SplitBoundary, check_split_boundary, kept_pieces
from ..boundary.pairs import paired
from ..rebay.run import VoronoiSegmentRun, rule_of
from ..space_front.classical_space import classical_in_space
from ..space_front.in_space import space_front
from ..space_front.metric_space import metric_space_front
from ..volume.lacking import what_is_missing
from .classical import SEARCHES, classical_front, classical_mesh
from .metric_front import MetricRun, filled_by_metric
from .run import ORDERS, PLACEMENTS, FrontRun, Placement

__all__ = ["advancing_front"]

FRONT_METHODS = ("delaunay", "classical")
SPACE_METHODS: dict[str, Callable[..., DomainMesh]] = {
    "delaunay": space_front,
    "classical": classical_in_space,
}
ANOTHER_DIVISION = "tetrahedralize with another seed may recover it"
FINISHING = 1.35  # the finishing pass inserts points where R is above so many f, as `voronoi_segment` does


def advancing_front(
    domain: Domain,
    size: Any,
    *,
    method: str = "delaunay",
    order: str | None = None,
    placement: str | Placement | None = None,
    search: str = "barycenter",
    finish: bool = True,
    split_boundary: SplitBoundary | None = None,
    budget: int | None = None,
    history: bool = False,
    progress: bool = False,
) -> DomainMesh:
    """Mesh a domain by an advancing front: a region of the plane, or a body in space.

    Parameters
    ----------
    domain : Domain
    size : number, function (k, 2) -> (k,), SizeField, Metric, or dict of region name to one of these
        For a body also a SpaceMetric, for all of it.
        The wanted edge length h. In a dict the key None stands for all regions that are not named; a piece
        between two regions takes the smaller size. Pieces of the boundary are cut into edges of about this
        length: they are the first front. With a `sizing.Metric` the wanted length depends on the direction;
        see the notes.
    method : "delaunay" or "classical"
        How the triangle ahead of an edge is found: over the triangulation of what is not meshed (see the
        notes), or as the source chapter tells it: by the distance of candidates, with tests for what they
        would cross or contain (see `unstruct.plain.advancing_front`). The classical front is rougher, slower,
        and there to be compared.
    order : "widest", "smallest", "shortest" or "oldest", optional
        Which edge of the front is next: the one with the largest R / f ahead of it, R being the circumradius
        of the triangle ahead and f = h / sqrt(3) (the default); that with the smallest wanted length there,
        as the source chapter has it (the default of the classical method, which has no "widest"); the
        shortest; or the one that has waited longest. Measures that differ by less than a fifth count as
        equal; among these the one that has waited longest is next.
    placement : "equal sides", "angle", "circle", or function, optional
        The ideal point for a front edge AB. "equal sides": on the line through the middle of AB at right
        angles to it, at the distance h from A and B, with h kept between 0.55 and 2 times |AB|. "angle": the
        smaller of the angles between AB and the edges of the front before and after it is left as it is,
        halved, or divided by three, whichever gives parts nearest to 60 degrees (it changes at 80 and 144
        degrees; from 206 degrees on as "equal sides"). "circle" (the default): such that the circle through
        A, B and the point has the radius f. A function is called as ``placement(p, a, b, n, h)``, with the
        points before A, A, B and after B on the front, and h; it returns a point, or None for the apex ahead.
        The classical method has "equal sides" alone.
    search : "barycenter" or "ideal"
        Where the classical method looks for candidates: about the middle of the edge, as the source chapter
        has it, or more narrowly about the ideal point.
    finish : bool
        Whether to improve the result afterwards, as `voronoi_segment` does.
    split_boundary : bool or "inner", optional
        Whether the finishing pass may split edges on pieces, on the true curve: True (the default), False, or
        "inner", for inner pieces only. In space: which facets are divided before, as for `tetrahedralize`.
    budget : int, optional
        The largest number of new points, besides those that cut the boundary at first; 10^7 by default.
        If it is spent before the front is empty, nothing is improved afterwards (``reasons``: "budget").
    history : bool
        Keep a record of each accepted triangle in ``steps``.
    progress : bool
        Show a bar.

    Returns
    -------
    DomainMesh
        With ``finish=False`` the cells are in the order in which the front made them: ``cells[:k]`` are the
        first k. ``counts`` says, by name, how many were accepted as: "new point" (with the ideal point),
        "small enough" (the triangle ahead, R < 1.2 f), "empty circle" (the triangle ahead; the ideal point
        is not in its circle), "near apex" (the ideal point is nearer than 0.8 h to the apex of the triangle
        ahead), "angle" (the angle rule, or the caller's function, wants this apex), "closed" (at least two
        edges were at the front), "forced" (no point was possible). Also counted are
        triangles that were "set aside" until the front was empty otherwise, their "circumcenters", and ideal
        points that were not possible: "outside" (beyond the front), "encroaching" (they see an edge of the
        front under 120 degrees or more), "collisions" (nearer than 0.8 h to another vertex). For the counts
        and figures of the finishing pass see `voronoi_segment`. ``unrefined`` lists the triangles that are
        too large and, after finishing, those with an angle below 26 degrees, and ``reasons`` says why.
        ``steps`` (with ``history``) has one row for each accepted triangle, in order: "edge" A B, "apex",
        "reason" (as above), "ideal" (the ideal point), "size" (h there), "radius" (R of the triangle that was
        ahead) and "near" (the vertex that was too near to the ideal point). Of closed triangles only edge,
        apex and reason are known. Vertices that the finishing pass has removed are -1.

    Raises
    ------
    InputError
        For an unknown option, for a size that is not positive and finite (with the place), and as
        `unstruct.constrained_delaunay` does. For a placement that returns something else than a point.

    Notes
    -----
    *The step.* What is not meshed yet has a triangulation of its own, which is constrained Delaunay between
    the edges of the front. Let ABC be its triangle ahead of the front edge AB, with circumradius R. It is
    accepted if R < 1.2 f, if the ideal point X is not inside its circle, or if C is the vertex that is too
    near to X. Otherwise X is inserted (its cavity does not cross the front) and ABX is accepted. Then every
    triangle with R < 1.2 f that has two edges at the front is accepted, too. If X is not possible, the
    triangle is set aside. In the end its circumcenter is tried, or it is accepted as it is.

    *The front does not get stuck in the plane.* What is not meshed is a valid triangulation at all times, so
    there is a valid triangle ahead of every edge of the front, and it may be accepted. Where h is the same
    everywhere, no edge is ever shorter than min(0.64 h, l) with the placements named above, before finishing;
    l is the shortest edge of the triangulation of the boundary (book, Theorem 3.2.3). So the number of new
    points is bounded, and the front becomes empty. Where h varies, and for a function, ``budget`` bounds it,
    too. In space both the triangulation and the conclusion fail.

    *Metrics.* With a metric everything that is measured goes through it: R, the ideal point, distances,
    angles, and the circles of the cavity. Lengths are 1 where they are as wanted. A cavity grows across an
    edge only if the point strictly sees both new edges, by exact signs, so the mesh is valid whatever the
    metric is; but it is not Delaunay, neither here nor in the metric. No point is placed within the metric
    distance 0.05 of the boundary of its cavity, hence of any other vertex, so that the number of points is
    bounded whatever the metric is. ``placement`` is "circle" or "equal
    sides", and "smallest" compares the geometric means of the two lengths. ``split_boundary`` has no effect.
    The finishing pass swaps diagonals and moves vertices for the metric quality, 4 sqrt(3) area / (sum of
    squared edges); it gives edges longer than sqrt(2) a point ("points again"), and removes vertices at edges
    shorter than 0.62 ("removed"). ``figures`` has qualities and lengths in the metric, ``unrefined`` the
    triangles with an edge longer than 2 in the metric; ``steps["size"]`` is the geometric mean of the two
    lengths, and ``steps["radius"]`` is in the metric. The ideal triangle must be small beside the distance in
    which the metric turns: long edges of about 1 / ratio of the radius of curvature are needed for the best
    quality. At ratios above 1000 use layers instead.

    *In space* the front consists of triangles, and t is the tetrahedron ahead of a face ABC in a
    tetrahedralization of what is not meshed. It is accepted if R < 1.1 f, with f = sqrt(6) h / 4; no point
    is placed within 0.75 h of a vertex, nor where a face of the front is seen under 120 degrees; and cells
    with R < 1.1 f and three or four faces at the front are closed at once. There, h is at most 1.4 times the
    mean edge m of ABC, so that cells grow gently from a surface finer than the size. "widest" compares
    R / f, "shortest" areas. ``placement`` is "equal sides" (XA = XB = XC, between 0.55 m and 1.4 m; the
    default), "sphere" (the sphere through A, B, C and X has the radius f), "angle", or a function, called as
    ``placement(a, b, c, h)``. "angle" looks at the edge of ABC where the angle to the next face of the front
    is least: up to 94 degrees the apex ahead is taken if it is that of this face; up to 169 degrees X halves
    the angle. The cell ahead of a face is valid, again at all times, but it may be flat: where no point is
    possible, a "forced" cell may be a sliver, and so may a small one. ``finish`` cures these by `improve`.
    The number of new points is bounded: six volumes of a cell with a new point are at least 0.05 m^3, these
    cells do not overlap, and no edge is ever shorter than the shortest one of the triangulation of the
    surface, or 0.75 times the least h. ``counts`` has "empty sphere" for "empty circle", and "flat", for
    ideal points whose cells would be flatter than that. ``unrefined`` are the cells with an edge of more than
    2.5 h; there are some where triangles that stay are larger than the size. ``steps`` has "face" for "edge".

    *In space, by a* `sizing.SpaceMetric`, R, the ideal point, distances, lenses and the spheres of cavities
    are measured in the metric, and edges and polygons of the surface are cut by it. A cavity is used only if
    the point sees all its walls, by exact signs, so the mesh is valid whatever the metric is. No point is
    placed within the metric distance 0.05 of a wall, hence of any vertex: their number is bounded. Where the
    surface is cut, a metric that asks for more points than the budget is refused before any work;
    ``figures["tetrahedra expected"]`` is the volume of the body in the metric over that of an ideal cell. A
    stretched surface is recovered in the coordinates of its mean metric, so that a box at ratio 1000 takes
    seconds, for each cell one to four times as long as at ratio 10. A curved surface that lengths in fixed
    directions cut across (``split_boundary=True``) takes minutes from a ratio of about 30 on; Ctrl-C ends it.
    ``finish`` judges shapes in the metric. ``figures`` has qualities and lengths as in the plane,
    ``unrefined`` the cells with an edge above 2.5. ``order`` is "widest" or "oldest", ``placement`` "equal
    sides" or "sphere"; ``steps["size"]`` (the lateral edge) and ``steps["radius"]`` are in the metric.

    *The classical method in space* may stick: no vertex of the front can be joined to any face of it, as with
    Schönhardt's prism. What is left is then filled by recovery with points inside, and counted. See
    `unstruct.generate.space_front.classical_space` for its counts and steps.

    All signs that decide the topology are exact. O(n) after the boundary is triangulated. Sources: S. H. Lo,
    International Journal for Numerical Methods in Engineering 21 (1985) 1403-1426; J. Peraire et al., Journal
    of Computational Physics 72 (1987) 449-466, also for directions; the front over a triangulation: J. D.
    Mueller, P. L. Roe, H. Deconinck, International Journal for Numerical Methods in Fluids 17 (1993) 241-256;
    D. L. Marcum, N. P. Weatherill, AIAA Journal 33 (1995) 1619-1625. Book: 3.1, 3.2, 3.3, 3.5.
    """
    if split_boundary is not None:
        check_split_boundary(split_boundary)
    as_flags(finish=finish, history=history, progress=progress)
    if not isinstance(method, str) or method not in FRONT_METHODS:
        raise InputError(f"method = {method!r} must be 'delaunay' or 'classical'")
    if not (isinstance(search, str) and search in SEARCHES):
        raise InputError(f"search = {search!r} must be one of {', '.join(map(repr, SEARCHES))}")
    if isinstance(domain, Domain) and domain.dimension == 3:
        mesh = _in_space(
            domain, size, method, order, placement, search, finish=finish, split_boundary=split_boundary,
            budget=budget, history=history, progress=progress,
        )  # fmt: skip
        return noticed(mesh, what_is_missing(domain, mesh, ANOTHER_DIVISION))
    split_boundary = True if split_boundary is None else split_boundary
    if method == "classical":
        if _has_metric(size):
            raise InputError("a metric is for method = 'delaunay'; the classical method takes sizes")
        return _classical(
            domain, size, "smallest" if order is None else order,
            "equal sides" if placement is None else placement, search, finish, split_boundary,
            budget, history, progress,
        )  # fmt: skip
    order = "widest" if order is None else order
    placement = "circle" if placement is None else placement
    if not isinstance(order, str) or order not in ORDERS:
        raise InputError(f"order = {order!r} must be one of {', '.join(map(repr, ORDERS))}")
    if not (placement in PLACEMENTS if isinstance(placement, str) else callable(placement)):
        raise InputError(
            f"placement = {placement!r} must be one of {', '.join(map(repr, PLACEMENTS))}, or a function"
        )
    most = DEFAULT_BUDGET if budget is None else min(as_count(budget, "budget"), MOST_VERTICES)
    domain = as_domain(domain)
    if _has_metric(size):
        return _in_metric(domain, size, order, placement, finish, most, history, progress)
    complex_ = planar_complex(domain, size, progress=progress)
    kept = kept_pieces(split_boundary, len(domain.facets), len(domain.pieces), domain.held())
    size = size_by_region(complex_, size, domain.regions)
    rule = rule_of(FINISHING, "center", "first", None, bool(split_boundary))
    base = VoronoiSegmentRun(domain, complex_, size, None, rule, kept, False)
    run = FrontRun(base, order, placement, history)
    with progress_bar(progress, " points") as bar:
        run.march(most, bar)
    return noticed(paired(domain, run.result(most, finish)))


def _in_space(
    domain: Domain, size: Any, method: str, order: str | None, placement: Any, search: str, **options: Any
) -> DomainMesh:
    """`advancing_front` for a body."""
    if options["split_boundary"] == "inner":
        raise InputError("split_boundary = 'inner' is for the plane; in space it must be True or False")
    chosen = {"order": order, "placement": placement}
    if method == "classical":
        if not (placement is None or (isinstance(placement, str) and placement == "equal sides")):
            raise InputError(f"placement = {placement!r} must be 'equal sides' for the classical method")
        chosen = {"order": order, "search": search}
    options |= {name: choice for name, choice in chosen.items() if choice is not None}
    if isinstance(size, SpaceMetric):
        if method == "classical":
            raise InputError("a metric is for method = 'delaunay'; the classical method takes sizes")
        return metric_space_front(domain, size, filled_by_metric, **options)
    if isinstance(size, Metric):
        raise InputError(f"{size!r} is of the plane; for a body give a sizing.SpaceMetric")
    if isinstance(size, Mapping) and any(isinstance(one, SpaceMetric) for one in size.values()):
        raise InputError("a metric in space is for the whole body: give it alone, not by regions")
    return SPACE_METHODS[method](domain, size, **options)


def _has_metric(size: Any) -> bool:
    """Whether a size, or that of a region, is a metric."""
    values = size.values() if isinstance(size, Mapping) else [size]
    return any(isinstance(one, Metric) for one in values)


def _classical(
    domain: Domain, size: Any, order: str, placement: Any, search: str, finish: bool,
    split_boundary: SplitBoundary, budget: int | None, history: bool, progress: bool,
) -> DomainMesh:  # fmt: skip
    """`advancing_front` by the classical method."""
    most = DEFAULT_BUDGET if budget is None else min(as_count(budget, "budget"), MOST_VERTICES)
    domain = as_domain(domain)
    complex_ = planar_complex(domain, size, progress=progress)
    kept = kept_pieces(split_boundary, len(domain.facets), len(domain.pieces), domain.held())
    size = size_by_region(complex_, size, domain.regions)
    options: dict[str, Any] = {
        "order": order, "placement": placement, "search": search, "history": history, "budget": most,
    }  # fmt: skip
    run = classical_front(domain, complex_, size, progress=progress, **options)
    mesh = classical_mesh(domain, complex_, size, run, finish=finish, kept=kept, budget=most)
    return noticed(paired(domain, mesh))


def _in_metric(
    domain: Domain,
    size: Any,
    order: str,
    placement: str | Placement,
    finish: bool,
    most: int,
    history: bool,
    progress: bool,
) -> DomainMesh:
    """`advancing_front` with a metric."""
    if not isinstance(placement, str) or placement == "angle":
        raise InputError(
            f"placement = {placement!r} is for sizes; with a metric it must be 'circle' or 'equal sides'"
        )
    complex_ = planar_complex(domain, size, progress=progress)
    metric = as_metric(size_by_region(complex_, size, domain.regions))
    run = MetricRun(domain, complex_, metric, order, placement, history)
    with progress_bar(progress, " points") as bar:
        run.march(most, bar)
    return noticed(paired(domain, run.result(finish)))
