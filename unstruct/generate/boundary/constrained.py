"""Constrained Delaunay triangulation of a planar domain: every segment is an edge.

A triangulation that contains given segments is called *constrained Delaunay* if the circle of no triangle
contains a vertex that is visible from within the triangle, the segments being opaque. A local test is enough,
and `check` uses it: except at segments, the far corner of one triangle beside an edge is not inside the
circle of the other. We make the Delaunay triangulation of all points, insert one segment after the other
(`connect.planar.inserting`), and then find the inside by flooding from the ghosts beyond the hull. See the
book, 2.5.
"""

from __future__ import annotations

from typing import Any, Literal

from ...base.arguments import as_flag, as_flags
from ...base.errors import InputError
from ...connect.planar.bounded import SEGMENTS_AT_ONCE, bound_at_once
from ...connect.planar.complex import PlanarComplex
from ...connect.planar.flood import mark_regions
from ...connect.planar.holes import eat_holes
from ...connect.planar.inserting import insert_all
from ...domain.arguments import refuse_tiny
from ...domain.domain import Domain, Sampled, as_domain
from ...mesh.domain_mesh import DomainMesh, noticed
from ..volume.filling import filled
from ..volume.lacking import what_is_missing
from .pairs import paired

__all__ = ["complex_of", "constrained_delaunay", "planar_complex"]


def constrained_delaunay(
    domain: Domain,
    hull: bool | Literal["holes"] = False,
    *,
    history: bool = False,
    progress: bool = False,
) -> DomainMesh:
    """The constrained Delaunay triangulation of a domain; in space, tetrahedra that have its facets as faces.

    Parameters
    ----------
    domain : Domain
        Vertices, facets and inner pieces. Curves are replaced by chords, as coarsely as is safe.
    hull : bool or "holes"
        In the plane: whether to mesh the whole convex hull; then ``domain.facets`` may be empty. True ignores
        holes. "holes" leaves them out (Triangle's -pc): the parts with a point of ``domain.hole_seeds``, as
        `Domain.read` finds them in a file, and those that are outside and enclosed by pieces.
    history : bool
        In space: whether to keep a record of the recovery in ``steps`` of the result.
    progress : bool
        Show a bar while segments are inserted.

    Returns
    -------
    DomainMesh
        Without ``hull`` the vertices in holes or beyond the boundary are not in the mesh. ``origin`` says
        which vertex of the domain each vertex is. The markers are "facets", "inner", those of the domain, and
        "region". In "region" a cell of a part with a named seed has the place of the name in
        ``domain.regions``; cells of the other connected parts have further numbers, one for each part.
        ``mesh.regions`` has the number of each name.

        In space ``faces`` and ``face_piece`` say which faces lie on which piece. There may be no tetrahedra
        of the given vertices alone: `steiner` lists the vertices that had to be added on pieces,
        ``counts["added inside"]`` counts others. Should a facet be missing all the same, the mesh is not
        `complete`, and `reasons` says which; the cells are valid.

        With ``history``, ``steps`` is the record of the recovery. "points" are its vertices: those of the
        domain, the eight of a box around it, and those that were added. "start" are the vertices of the
        cells at the beginning; the number of a row is the slot of its cell. Each event has a row in "kind",
        "goal" (the vertices of the segment, then -1, or of the triangle that is to be recovered), "faces"
        (how many were in the way before; of a triangle those with an edge that crosses it) and "point" (or
        -1). Its cells are ``removed[removed_end[k - 1] : removed_end[k]]``, slots, and ``made[made_end[k - 1]
        : made_end[k]]``, slots and four vertices. The kinds are "refill" (fewer faces are in the way after
        it), "shake" (as many), "found" (the goal is there), "given up" (for now), "point" (inserted on the
        goal), then "fewer" (a refill, so that fewer cells are at the point that goes next), "released" (the
        point is gone), "moved" (it is off the surface), "removed" (now it is gone as well). What was there
        from the beginning has no event. "inside" are the slots of the cells of the mesh, "vertex" which
        vertex each of its points is. ``studies.replay_recovery(steps, k)`` gives the cells after k events.

    Raises
    ------
    InputError
        For ``history`` in the plane. For equal vertices, and for exponents too wide for one scale. For facets
        that bound no area. For a seed that is on a segment, outside, or in the same part as a seed of another
        name. For segments that cross or overlap (a `Domain` refuses them earlier).

    Notes
    -----
    Exact for any scaled doubles. A vertex on a segment splits it; both parts keep its number in ``piece``.
    Ties (four points on a circle) are decided by the Delaunay triangulation of the vertices, the same for the
    same input. The Delaunay triangulation takes O(n) in practice (`delaunay`); then a segment that crosses k
    triangles takes O(k log k) in practice, also if rows of points lie along it. Sources: D. T. Lee,
    A. K. Lin, Discrete & Computational Geometry 1 (1986) 201-217; L. P. Chew, Algorithmica 4 (1989) 97-108;
    M. V. Anglada, Computers & Graphics 21 (1997) 215-223.

    In space a triangulation need not exist, and where it does, not be Delaunay. Edges, then faces, of the
    Delaunay triangulation of the vertices are recovered by refilling small cavities; points are added where
    nothing else helps, and taken away again if possible (N. P. Weatherill, O. Hassan, Int. J. Numer. Methods
    Eng. 37 (1994) 2005-2039). Where this has changed nothing, the tetrahedra are Delaunay. Book: 2.5, 2.8b.
    """
    as_flags(history=history, progress=progress)
    domain = as_domain(domain, None)
    if domain.dimension == 3:
        if hull is not False:
            raise InputError("hull is for planar domains; delaunay(points) fills the convex hull in space")
        mesh = filled(domain, history=history, progress=progress)
        return noticed(mesh, what_is_missing(domain, mesh))
    if history:
        raise InputError("history is for domains in space; for the plane see studies.recover_edges")
    sampled = domain.sampled()
    holes = isinstance(hull, str) and hull == "holes"
    if isinstance(hull, str) and not holes:
        raise InputError(f"hull must be True, False or 'holes', not {hull!r}")
    complex_ = complex_of(domain, sampled, hull=holes or as_flag(hull, "hull"), progress=progress)
    if holes:
        eat_holes(complex_, len(domain.facets), domain.hole_seeds, list(domain.regions))
    mesh = complex_.mesh(
        facets=len(domain.facets), origin=sampled.origin, markers=domain.markers, points=sampled.points
    )
    return paired(domain, mesh)


def planar_complex(domain: Domain, size: Any = None, *, progress: bool = False) -> PlanarComplex:
    """The constrained Delaunay triangulation of a domain whose pieces are cut by a size, ready to be refined.

    Parameters
    ----------
    domain : Domain
    size : number, function (k, 2) -> (k,), or size field, optional
        The wanted length of subsegments; see `Domain.sampled`.
    progress : bool
        Show a bar while segments are inserted.

    Returns
    -------
    PlanarComplex
        Its triangles are numbered by regions. For regions, errors and sources see `constrained_delaunay`.
    """
    refuse_tiny(domain.points)
    return complex_of(domain, domain.sampled(size), progress=progress)


def complex_of(
    domain: Domain, sampled: Sampled, *, hull: bool = False, progress: bool = False
) -> PlanarComplex:
    """`planar_complex` for pieces that have been cut already.

    Parameters
    ----------
    domain : Domain
    sampled : Sampled
        The result of `Domain.sampled`; further points may follow.
    hull : bool
        Whether everything within the convex hull is inside.
    progress : bool
        Show a bar while segments are inserted.

    Returns
    -------
    PlanarComplex
    """
    facets = len(domain.facets)
    if not facets and not hull:
        how = "'holes'" if len(domain.hole_seeds) else "True"
        raise InputError(
            "the domain has no facets, so nothing is inside: give facets; without any, mesh the convex hull "
            f"by constrained_delaunay(domain, hull={how}), and refine that mesh if need be"
        )
    complex_ = PlanarComplex(sampled.points, progress=progress)
    subsegments = sampled.ends, sampled.piece, sampled.span
    if len(sampled.ends) <= SEGMENTS_AT_ONCE and not progress:
        if bound_at_once(complex_, subsegments, facets, domain.regions, hull):
            return complex_
        complex_ = PlanarComplex(sampled.points)
    insert_all(complex_, *subsegments, facets=facets, progress=progress)
    mark_regions(complex_, facets, domain.regions, hull)
    return complex_
