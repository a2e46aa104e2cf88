"""Delaunay refinement with guarantees: `refine` (section 2.6 of the book).

The kernels are in `steps`. The loop around them is in `run`; it makes room and computes points of curves.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import MOST_VERTICES, as_flags, as_number
from ...base.arrays import counted_off
from ...base.codes import DONE, MORE
from ...base.elementary import cosine, sine
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...domain.domain import Domain, Sampled, as_domain
from ...mesh.domain_mesh import DomainMesh, noticed
from ...mesh.mesh import Mesh
from ...sizing import as_size
from ...sizing.asked import asked_again
from ..boundary.constrained import planar_complex
from ..boundary.kept import SplitBoundary, check_split_boundary, kept_pieces
from ..boundary.pairs import paired
from ..volume_points.refining import refine_body
from .account import account, history_of
from .given_mesh import by_name
from .limits import make_limits
from .predicate import Predicate
from .remeshing import carry, plan_mesh
from .remeshing_body import refine_cells
from .run import Planned, RefineRun, counts_of
from .state import BUDGET, EVENTS, REFUSALS
from .whole import refined_at_once

__all__ = ["refine"]

MIN_ANGLE_OF_LENS = 15.0  # degrees: below this, the part of a curve over a chord might leave the chord's lens
LARGEST_MIN_ANGLE = 59.0  # degrees: what may be asked for
RefineIf = Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]], Any]


def refine(
    domain: Domain | Mesh,
    size: Any = None,
    *,
    min_angle: float | None = None,
    max_area: Any = None,
    method: Literal["ruppert", "chew", "off-centers"] = "off-centers",
    refine_if: RefineIf | None = None,
    split_boundary: SplitBoundary = True,
    radius_edge: float | None = None,
    max_volume: Any = None,
    min_dihedral: float | None = None,
    budget: int | None = None,
    history: bool = False,
    progress: bool = False,
) -> DomainMesh:
    """Mesh a planar domain with triangles, or a body with tetrahedra, neither too flat nor too large.

    Parameters
    ----------
    domain : Domain or Mesh
        A region, a body in space, or a mesh that is to be refined: triangles in the plane or tetrahedra. In a
        mesh, boundary edges, marked edges and edges between cells of different "region" (in space: faces, and
        marked edges) are kept as edges (faces), divided if necessary; so are vertices, names, and markers. If
        the mesh is not constrained Delaunay, it is first made so. Its edges are straight, whatever curve they
        came from; ``piece`` of the result numbers straight chains of the edges that were kept. Edges that
        match (``mesh.periodic``) are divided before anything else, both in the same way, by the smallest size
        or area that is wanted on their sides; a new vertex on one is the image, bit for bit, of that on the
        other. No more vertices are put there: triangles for which the angle asks for one say "kept". In
        space, sides that match stay as they are.
    size : number, function (k, d) -> (k,), size field, or dict of region name to one of these, optional
        The wanted edge length h. Away from the boundary all edges are at most sqrt(2) times as long, and new
        vertices keep a distance of at least 1 / sqrt(2) times the wanted length. In a dict the key None
        stands for all regions that are not named; without it these have no limit.
    min_angle : float, optional
        In the plane, as the next three: the wanted minimum angle, in degrees; 25 by default, 0 for none.
    max_area : number or dict of region name to number, optional
        The largest area wanted, the key None as for the size. In a mesh, a region is named as in
        ``mesh.regions`` or by its number.
    method : "off-centers", "chew" or "ruppert"
        "ruppert": circumcenters and diametral discs. "chew", Chew's second algorithm: subsegments are split
        if a vertex sees them under more than 180° - 2 ``min_angle``, and free vertices in their discs are
        removed first. "off-centers" (Üngör), with Chew's rule: points are no farther from the shortest edge
        than the angle needs. This gives by far the fewest triangles if the angle is the reason for
        refinement, and about as many if size or area is.
    refine_if : function, optional
        Which triangles to refine further: it takes the arrays corners (k, 3, 2), areas (k,) and regions (k,),
        numbers as in ``mesh.regions``, and returns k bools. It is asked when all other limits are met, about
        all triangles at once, and then about those that are new, until it answers False for all. Its own
        errors are raised unchanged. If it never answers False, the run ends at the budget.
    split_boundary : bool or "inner"
        Whether vertices are put on pieces (in a mesh: on edges that are kept), once they are cut by the size:
        True, False, or "inner", for inner pieces only. Triangles that need such a vertex stay; the reason
        says so.
    radius_edge : float, optional
        In space: the largest quotient of the circumradius and the shortest edge of a cell; 2 by default, inf
        for none. It bounds the angles of triangles, but not dihedral angles: flat cells of four points near a
        circle (slivers) may have a quotient of 0.71. See `improve` for these.
    max_volume : number or dict of region name to number, optional
        In space: the largest volume wanted, the key None as for the size.
    min_dihedral : float, optional
        In space: the least dihedral angle wanted, in degrees. A point against a sliver is put only if no edge
        becomes shorter than the shortest one of the sliver; others stay and say so.
    budget : int, optional
        The number of vertices at which to stop. The boundary, cut to the wanted size, and its triangulation
        are made in any case. Without a budget (then it is 10^7), a piece is not split any longer for the
        angle's sake after 8192 splits, or 256 within a wedge: long narrow gaps and needles stay as they are.
    history : bool
        Keep a record in ``steps`` of the result.
    progress : bool
        Show the number of vertices as it grows.

    Returns
    -------
    DomainMesh
        It is ``complete`` if all limits are met. Otherwise ``unrefined`` lists the cells that miss one, and
        ``reasons`` says why: "input angle 3.2°" (the angle that leaves no choice), "budget", "narrow:
        ...", "precision: ...", "too near: ...", "curve: ...", and in space those below. ``counts`` contains
        what happened. With ``history`` the arrays of ``steps`` have one row for each event: "kind" ("split",
        "circumcenter", "rejected", "removed"), "vertex" (-1 for a rejected one), "cause" (the ends of the
        subsegment and its number, or the triangle), "place". If no vertex was removed (always so for
        Ruppert's method on straight segments), each state is the constrained Delaunay triangulation of the
        first points, ``points[:k]``.

    Raises
    ------
    InputError
        For limits that are not positive or name an unknown region, and as `unstruct.constrained_delaunay`
        does. In space also for a constant size that asks for more vertices than the default budget.
    MeshError
        For a mesh of other cells, with cells that are not positively oriented or overlap, with a face of more
        than two cells, or with a marker of something that it does not have.

    Notes
    -----
    All signs that decide the topology are exact. Split points of straight segments are rounded; from then on
    the two stored halves are the constraint. Points on curves lie on the true curve.

    What is proved, for straight segments: where they meet at 60° or more, Ruppert's method ends for a
    ``min_angle`` of up to 20.7° (Ruppert), Chew's for up to 26.5° (Shewchuk), with triangles as large as the
    features allow within a constant. With concentric shells about small input angles, and the rule that
    leaves triangles across them alone (their reason is "input angle"), Ruppert's method ends for any straight
    input and up to 26.45° (Miller, Pav, Walkington). Larger values mostly work, up to about 33°; but there is
    input without small angles where, in exact arithmetic, Ruppert's method never ends for more than about
    29.5°, and other input where Chew's does not for more than about 30.7° (Rand). Beyond the
    theorems a run ends because a point put in for the angle's sake must keep a distance of a thousandth of
    the input's edges nearby (of half of them above 33.5°, where few runs would end by themselves), and one
    for the sake of size or area keeps its distance by itself. A piece is cut into parts of at least 2^-50.

    O(n log n) in practice: no point is located, as each starts at its bad triangle. Sources: J. Ruppert,
    Journal of Algorithms 18 (1995) 548-585; L. P. Chew, Symposium on Computational Geometry (1993) 274-280;
    A. Üngör, LATIN (2004) 152-161; J. R. Shewchuk, Computational Geometry 22 (2002) 21-74; G. L. Miller,
    S. E. Pav, N. J. Walkington, International Meshing Roundtable (2003) 91-102; A. Rand, On the
    non-termination of Ruppert's algorithm (2011). Book: 2.6a, 2.6d.

    *In space,* subsegments with a vertex in their sphere (the one with the segment as its diameter) or longer
    than sqrt(2) h are halved; triangles of facets with a vertex in the sphere about their circumcenter, or
    with a circumradius of more than h / sqrt(2), get this point; and so do cells that miss a limit. A point
    that would be in the sphere of a segment or a triangle is not put: that is divided instead. New points on
    facets are rounded to the plane of the facet, not moved to a curved surface that it stands for: give its
    body with fine facets (`Domain.ball` and others with ``size``). From then on the facet is the triangles
    that are stored; cells around it are positive by exact signs. Facets whose vertices are in a plane only
    up to more than rounding are divided triangle by triangle.

    What is proved (Shewchuk): where segments meet at 90 degrees or more, and facets each other and segments
    as well (dihedral angles included), it ends for a ``radius_edge`` above 2, with edges as long as the
    features allow within a constant. For lower limits, sharper input, and for ``min_dihedral``, nothing is.
    There a point for the shape's sake must keep a distance of 1/256 of the edges nearby in the beginning, and
    one for the size's or volume's sake of a quarter of the size. All these distances are at least a fixed
    share of the shortest edge or size, so only finitely many points have room: each run ends. Cells that
    would need nearer points are in ``unrefined``: "kept: ...", "too near: ...", "precision: ...". Without a
    budget, a segment also gets at most 256 points for the shape's sake alone, and a facet 1024 and 64 for
    each of its sides; each point for the size's sake allows 16 more ("divided often"). Cells at input angles
    below 60 degrees are left alone where only these angles make their shape ("input angle"), and so are cells
    so flat that their centers are far away from the body ("flat").

    Without a budget, narrow gaps are left alone, too ("narrow"): where two parts of the surface that do not
    touch are nearer to each other than 1/16 of the size and of the width of both, none is divided because of
    vertices of the other, and no cell that is flat between them, or whose shortest edge leads across. The
    width of a facet is its area over its longest edge; so a wall is divided finely at a fine hole, but not
    all over a thin plate. With a budget, these divisions are made, up to the budget.

    Recovery may have added points close to the surface (see `constrained_delaunay`); they go when points on
    segments and facets replace them, and the cells are made Delaunay again, as far as that keeps the surface.
    Nothing is refined if a facet could not be recovered. In the end the size is asked again as
    `tetrahedralize` does. ``counts``: "circumcenters", "segment points",
    "facet points", points that were "refused", and cells that miss "size" and "shape".
    O(n log n) in practice. Source: J. R. Shewchuk, Symposium on Computational Geometry (1998) 86-95; H. Si,
    ACM Trans. Math. Softw. 41 (2015) 11. Book: 2.8d.
    """
    check_split_boundary(split_boundary)
    as_flags(history=history, progress=progress)
    domain = as_domain(domain) if isinstance(domain, Sampled) else domain
    if not isinstance(domain, Domain | Mesh):
        raise InputError(f"domain must be a Domain or a Mesh, not {type(domain).__name__}")
    planar = {"min_angle": min_angle, "max_area": max_area, "refine_if": refine_if}
    spatial = {"radius_edge": radius_edge, "max_volume": max_volume, "min_dihedral": min_dihedral}
    solid = isinstance(domain, Mesh) and domain.points.shape[1] == 3
    if solid or (isinstance(domain, Domain) and domain.dimension == 3):
        other = not isinstance(method, str) or method != "off-centers"
        _refuse_others(planar | {"method": repr(method) if other else None}, "the plane")
        options: dict[str, Any] = {"budget": _budget(budget), "history": history, "progress": progress}
        options |= spatial | {"split_boundary": split_boundary}
        body = domain

        def made(size: Any) -> DomainMesh:
            if isinstance(body, Mesh):
                return refine_cells(body, size, **options)
            return refine_body(body, size, **options)

        return noticed(asked_again(made, size))
    _refuse_others(spatial, "space")
    angle, lens, offset = _method(method, min_angle)
    most = _budget(budget)
    if isinstance(domain, Mesh):
        max_area, size = by_name(domain, max_area), by_name(domain, size)
        asked_for = {"size": size, "max_area": max_area, "split_boundary": split_boundary, "budget": most}
        planned = plan_mesh(domain, **asked_for)
    else:
        planned = _plan(domain, size, progress)
    c = planned.complex_
    limits = make_limits(
        planned.names, c.box, c.factor, min_angle=angle, max_area=max_area, size=size, lens=lens
    )
    held = planned.rest.get("held")
    if isinstance(domain, Domain) and (domain.spacings or domain.matches):
        held = domain.held()
    kept = kept_pieces(split_boundary, planned.rest["mesh"]["facets"], len(planned.joints), held)
    plain = not history and not progress and refine_if is None
    if plain and isinstance(domain, Domain) and not domain.matches:
        at_once = refined_at_once(planned, limits, offset, most, kept, bool(domain.curves))
        if at_once is not None:
            return noticed(at_once)
    run = RefineRun(planned, limits, offset, most, history)
    run.keep(kept)
    asked = None if refine_if is None else Predicate(refine_if, run, _numbers(planned))
    code = _loop(run, asked, progress)
    slots, reasons, missed = account(run.work(), limits, planned, code == DONE, run.tally[REFUSALS] > 0)
    if asked is not None:
        slots, reasons, missed["refine_if"] = asked.left(slots, reasons, code == DONE)
    steps = None
    if history:
        steps = history_of(run.work(), int(run.tally[EVENTS]))
        steps["place"] /= c.factor
    result = c.mesh(
        unrefined=slots, reasons=reasons, counts=counts_of(run.tally, missed), steps=steps,
        **planned.rest["mesh"],
    )  # fmt: skip
    if isinstance(domain, Mesh):
        carry(domain, planned.rest["values"], planned.rest["periodic"], result)
    else:
        paired(domain, result)
    return noticed(result)


def _refuse_others(values: dict[str, Any], where: str) -> None:
    for name, value in values.items():
        if value is not None:
            raise InputError(
                f"{name} is for {where}: in the plane there are min_angle, max_area, method and refine_if, "
                "in space radius_edge, max_volume and min_dihedral"
            )


def _method(method: str, min_angle: float | None) -> tuple[float, float, float]:
    """The minimum angle, the squared cosine of the lens, and the distance of off-centers from their edge.

    The distance is in units of the edge's length, and 0 for circumcenters.
    """
    angle = 25.0 if min_angle is None else as_number(min_angle, "min_angle")
    if not 0.0 <= angle <= LARGEST_MIN_ANGLE:
        raise InputError(f"min_angle = {min_angle} must be between 0 and {LARGEST_MIN_ANGLE:g} degrees")
    if not isinstance(method, str) or method not in ("ruppert", "chew", "off-centers"):
        raise InputError(f"method = {method!r} must be 'ruppert', 'chew' or 'off-centers'")
    return _shape(method, angle)


@lru_cache
def _shape(method: str, angle: float) -> tuple[float, float, float]:
    """The numbers that follow from a method and an angle; most programs ask for few of these."""
    seen = cosine(math.radians(2.0 * min(max(angle, MIN_ANGLE_OF_LENS), 45.0)))
    lens = 0.0 if method == "ruppert" else seen * seen
    offset = 0.0
    if method == "off-centers" and angle > 0.0:
        # the point that sees the shortest edge under the angle, a little nearer so that rounding does no harm
        half = math.radians(angle) / 2.0
        offset = 0.475 * cosine(half) / sine(half)
    return angle, lens, offset


def _budget(budget: int | None) -> int | None:
    if budget is None:
        return None
    if isinstance(budget, bool) or not isinstance(budget, int | np.integer) or budget < 3:
        raise InputError(f"budget = {budget!r} must be a whole number of vertices, at least 3")
    return min(int(budget), MOST_VERTICES)


def _plan(domain: Domain, size: Any, progress: bool) -> Planned:
    """The constrained Delaunay triangulation of a domain; one size for all regions also cuts its boundary."""
    whole = None if size is None or isinstance(size, Mapping) else as_size(size)
    sample = whole if whole is None or whole.constant is None else whole.constant
    c = planar_complex(domain, sample, progress=progress)
    names = list(domain.regions)
    cuts, number = domain.cuts(), counted_off(len(domain.points))
    return Planned(
        c, names + [""] * (c.parts() - len(names)), domain.pieces, cuts.kind, cuts.arc, domain.points_at,
        {"inputs": number, "mesh": {
            "facets": len(domain.facets), "origin": number, "markers": domain.markers,
            "points": domain.points,
        }},
    )  # fmt: skip


def _numbers(planned: Planned) -> NDArray[Any]:
    """The numbers of regions as the result has them; in a mesh the values of its marker "region"."""
    values = planned.rest.get("values")
    if values is None or "region" not in values[0]:
        return np.arange(len(planned.names))
    return np.array([row["region"] for row in values])


def _loop(run: RefineRun, asked: Predicate | None, progress: bool) -> int:
    code = MORE
    with progress_bar(progress, " vertices", desc="refine") as bar:
        while code == MORE:
            before = run.vertices
            code = run.advance()
            if code == DONE and asked is not None and asked.queue():
                code = MORE
            bar.update(run.vertices - before)
    assert code in (DONE, BUDGET)
    return code
