"""Tetrahedra of a wanted size in a body whose surface is kept.

See `generate.volume.lattice` for the points, `filling` for the surface, `steps` for the cells. Book: 2.8c.
"""

from __future__ import annotations

from typing import Any

from ...base.arguments import as_count, as_flag, as_seed
from ...domain.domain import Domain, as_domain
from ...mesh.domain_mesh import DomainMesh, noticed
from ...sizing.field import as_size
from .filling import filled
from .lattice import lattice_points

__all__ = ["tetrahedralize"]


def tetrahedralize(
    domain: Domain,
    size: Any = None,
    *,
    optimize: bool = True,
    seed: int = 0,
    budget: int | None = None,
    progress: bool = False,
) -> DomainMesh:
    """Fill a body with tetrahedra of a wanted size; its surface is kept triangle for triangle.

    Parameters
    ----------
    domain : Domain
        In space.
    size : float, callable, or SizeField, optional
        The wanted length of edges inside. Without it there are no more points than there must be.
    optimize : bool
        Whether to make the tetrahedra rounder by refills and by moving vertices that were added inside.
        Without, there are slivers: flat tetrahedra of four points near a circle.
    seed : int
        Of the random numbers by which ties and cavities are chosen.
    budget : int, optional
        The largest number of points inside, and of points that recovery may add: by default 2,000,000, and
        100 plus a tenth of the number of triangles.
    progress : bool
        Show progress bars.

    Returns
    -------
    DomainMesh
        As `constrained_delaunay` describes it for bodies. ``counts`` also has the "lattice points", and the
        numbers of "refills" and "moves". No facet is divided: cells with a face on a piece whose edges are
        more than twice as long as wanted are in ``unrefined``.

    Raises
    ------
    InputError
        For a domain of the plane, as `constrained_delaunay` does, for a size that is none, and if it asks for
        more points than the budget.

    Notes
    -----
    Points of body-centered cubic lattices, nested by the size where it varies, are inserted before the facets
    are recovered. Near a surface that is finer than the size, cells are as small as its triangles; their
    edges grow by 0.4 of the distance from there. Where a facet is missing, nothing is optimized. The same
    input and seed give the same mesh.
    O(n) in practice for n cells. Sources: N. P. Weatherill, O. Hassan, Int. J. Numer. Methods Eng. 37 (1994)
    2005-2039; P.-L. George, H. Borouchaki, Delaunay Triangulation and Meshing (1998); L. A. Freitag,
    C. Ollivier-Gooch, Int. J. Numer. Methods Eng. 40 (1997) 3979-4002. Book: 2.8c.
    """
    domain = as_domain(domain, 3)
    optimize, progress = as_flag(optimize, "optimize"), as_flag(progress, "progress")
    seed = as_seed(seed)
    budget = None if budget is None else as_count(budget, "budget")
    field, lattice = None, None
    if size is not None and len(domain.facets):
        field = as_size(size)
        lattice = lattice_points(domain, field, budget)
    mesh = filled(
        domain, lattice, field=field, optimize=optimize, seed=seed, budget=budget, progress=progress
    )
    return noticed(mesh)
