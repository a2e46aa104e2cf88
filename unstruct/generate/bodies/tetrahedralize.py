"""Tetrahedra of a wanted size in a body whose triangles are kept, and whose polygons are divided.

See `dividing` for the facets, and in `generate.volume` `lattice` for the points, `filling` for the surface,
`steps` for the cells. Book: 2.8c.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...base.arguments import as_count, as_flag, as_seed
from ...domain.domain import Domain, as_domain
from ...domain.space.by_part import size_by_part
from ...mesh.domain_mesh import DomainMesh, noticed
from ...sizing.asked import asked_again
from ...sizing.field import SizeField, as_size
from ..volume.coarse import coarse_facets
from ..volume.filling import filled
from ..volume.lacking import what_is_missing
from ..volume.lattice import MOST_INNER, lattice_points
from .dividing import Divided, divided

__all__ = ["LARGE_TRIANGLE", "as_parts", "tetrahedra_by_size", "tetrahedralize"]

LARGE_TRIANGLE = "a facet is larger than the size; split_boundary=True divides it"
CUT_UNEVENLY = (
    "a facet is larger than the size although it is divided; a size that changes less from edge to edge helps"
)
ANOTHER_SEED = "try another seed"
DIVIDE_OR_SEED = "try split_boundary=True, or another seed"


def tetrahedralize(
    domain: Domain,
    size: Any = None,
    *,
    optimize: bool = True,
    split_boundary: bool | None = None,
    seed: int = 0,
    budget: int | None = None,
    progress: bool = False,
) -> DomainMesh:
    """Fill a body with tetrahedra of a wanted size; a surface of triangles is kept triangle for triangle.

    Parameters
    ----------
    domain : Domain
        In space.
    size : number, function (k, 3) -> (k,), SizeField, or dict of region name to one of these, optional
        The wanted length of edges. In a dict the key None stands for all regions that are not named; a facet
        between two regions takes the smaller size. Without a size there are no more points than there must
        be.
    optimize : bool
        Whether to make the tetrahedra rounder by refills and by moving vertices that were added inside.
        Without, there are slivers: flat tetrahedra of four points near a circle. Without a size, nearly all
        tetrahedra reach across the body and are long or flat. Then this takes most of the time, about a
        third of a millisecond for each of them, and removes only the worst.
    split_boundary : bool, optional
        Whether facets, inner facets and inner segments are divided where a size asks for it. By default
        polygons of more than three corners are, and triangles joined to no other by an edge of their own:
        these are shapes. Other triangles are not, which somebody has meshed, and their edges stay. With True
        all are, with False none.
    seed : int
        Of the random numbers by which ties and cavities are chosen.
    budget : int, optional
        The largest number of points inside, of points that divide facets, and of points that recovery may
        add: by default 2,000,000, as many, and 300 plus half of the number of triangles.
    progress : bool
        Show progress bars.

    Returns
    -------
    DomainMesh
        As `constrained_delaunay` describes it for bodies. ``counts`` also has the "lattice points", and the
        numbers of "refills" and "moves". Where facets are divided, new vertices on them are in ``steiner``,
        as all vertices on pieces that the domain does not have. Cells with a face on a piece whose edges are
        more than twice as long as wanted in their middle are in ``unrefined``, and so are cells near coarse
        facets (see the notes) with such edges, and those that miss the size when it is asked again. If facets
        are missing, a warning of its own says which, where, and by how much the volume is off; then the mesh
        is not one of the body, ``complete`` is False, and `check` fails.

    Raises
    ------
    InputError
        For a domain of the plane, as `constrained_delaunay` does, for a size that is none, and if it asks for
        more points than the budget, or for cells below 2^-40 of the body.
    DomainError
        If facets are so close together that by rounding their parts would touch; ``split_boundary=False``
        keeps them whole.

    Notes
    -----
    Polygons are cut by `voronoi_segment` in their planes, each edge once for all pieces at it. New points are
    rounded, at most 64 times 2^-53 of the largest coordinate off their facet. Inside, points of
    body-centered cubic lattices, nested by the size where it varies, are inserted before the facets are
    recovered. Near a surface that is finer than the size, cells are as small as its triangles; their edges
    grow by 0.4 of the distance from there. A kept triangle with an edge of more than 4 times the size is
    coarse: at the small distance that is wanted, its cells would be flat. So the size near it is at least a
    quarter of the root of twice its area, less the distance from it; and points nearer than its longest edge
    are inserted only after the facets are recovered, where they cannot be in their way. If facets are missing
    all the same, they are recovered without any points inside, which then follow. Where a facet is missing in
    the end, nothing is optimized. The same input and seed give the same mesh.

    A size is a function, of which only values are known. In the end it is asked again in the mesh: at the
    barycenter of each cell, which must not have an edge more than 2.5 times as long; at each vertex, where
    the shortest edge must not be; and at the landmarks of the field (sources, vertices of features). Where it
    is, the mesh is made again, at most twice, with these places as landmarks; cells that still miss the size
    are in ``unrefined``. So ``complete`` says that the size is kept at these places of the mesh. A detail of
    a caller's function that lies between them all, and between the places where lattices are chosen, is not
    seen: give such a function as a `sizing.SizeField` with ``landmarks``. Fields that know their growth are
    kept to in all of each cell.

    O(n) in practice for n cells. Sources: N. P. Weatherill, O. Hassan, Int. J. Numer. Methods Eng. 37 (1994)
    2005-2039; P.-L. George, H. Borouchaki, Delaunay Triangulation and Meshing (1998); L. A. Freitag,
    C. Ollivier-Gooch, Int. J. Numer. Methods Eng. 40 (1997) 3979-4002. Book: 2.8c.
    """
    domain = as_domain(domain, 3)
    optimize, progress = as_flag(optimize, "optimize"), as_flag(progress, "progress")
    if split_boundary is not None:
        split_boundary = as_flag(split_boundary, "split_boundary")
    seed = as_seed(seed)
    budget = None if budget is None else as_count(budget, "budget")
    field = None
    if size is not None and len(domain.facets):
        field = as_size(size_by_part(domain, size))
    options: Any = {"optimize": optimize, "seed": seed, "budget": budget, "progress": progress}
    mesh = tetrahedra_by_size(domain, field, split_boundary, **options)
    return noticed(
        mesh,
        what_is_missing(domain, mesh, ANOTHER_SEED if split_boundary or field is None else DIVIDE_OR_SEED),
    )


def tetrahedra_by_size(
    domain: Domain, field: SizeField | None, split_boundary: bool | None = None, **options: Any
) -> DomainMesh:
    """As `tetrahedralize`, for arguments that are checked, and without a warning.

    Parameters
    ----------
    domain : Domain
    field : SizeField, optional
    split_boundary : bool, optional
    **options
        ``optimize``, ``seed``, ``budget``, ``progress``; ``names`` gives what messages call a piece, by
        default `Domain.name`.
    """

    def made(field: SizeField | None) -> DomainMesh:
        return _made(domain, field, split_boundary, options)

    return asked_again(made, field)


def _made(
    domain: Domain, field: SizeField | None, split_boundary: bool | None, options: dict[str, Any]
) -> DomainMesh:
    """The mesh, before the size is asked again."""
    parts, lattice = None, None
    options = dict(options)
    names, budget = options.pop("names", domain.name), options["budget"]
    if field is not None:
        if split_boundary is None or split_boundary:
            parts = divided(domain, field, bool(split_boundary), MOST_INNER if budget is None else budget)
        body = domain if parts is None else parts.domain
        lattice = lattice_points(body, field, budget, coarse_facets(body.triangulated, field))
    more: Any = {"field": field, "large": CUT_UNEVENLY}
    if split_boundary is False or (split_boundary is None and (domain.pieces.corners == 3).any()):
        more["large"] = LARGE_TRIANGLE
    if parts is None:
        return filled(domain, lattice, names=names, **more, **options)
    parts = parts._replace(names=names)
    return as_parts(domain, parts, filled(parts.domain, lattice, names=parts.name, **more, **options))


def as_parts(domain: Domain, parts: Divided, mesh: DomainMesh) -> DomainMesh:
    """The mesh of the divided body as one of the body."""
    span = np.asarray(mesh.span)
    low, high = parts.span[mesh.piece].T
    return DomainMesh(
        mesh.points,
        mesh.simplices,
        neighbors=mesh.neighbors,
        origin=np.where(np.asarray(mesh.origin) < len(domain.points), mesh.origin, -1),
        markers=mesh.markers,
        regions=mesh.regions,
        segments=mesh.segments,
        piece=parts.parent[mesh.piece],
        span=low[:, None] + span * (high - low)[:, None],
        faces=mesh.faces,
        face_piece=parts.parent[mesh.face_piece],
        unrefined=mesh.unrefined,
        reasons=mesh.reasons,
        counts=mesh.counts | {"added on edges and facets": len(parts.domain.points) - len(domain.points)},
        steps=mesh.steps,
    )
