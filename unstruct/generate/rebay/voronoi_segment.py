"""Rebay's Voronoi-segment insertion: from a domain and a wanted size to nearly equilateral triangles."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET, MOST_VERTICES, as_count, as_flags, positive
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...domain.domain import Domain, as_domain
from ...domain.plane.by_region import size_by_region
from ...mesh.domain_mesh import DomainMesh, noticed
from ...sizing.asked import MUCH_LONGER, asked_again
from ..boundary.constrained import planar_complex
from ..boundary.kept import SplitBoundary, check_split_boundary, kept_pieces
from ..boundary.pairs import paired
from ..volume_points.methods import segments_in_body
from .run import COUNT_NAMES, VoronoiSegmentRun, rule_of

__all__ = ["CASES", "epsilon_chains", "voronoi_segment"]

CHOICES = ("center", "first")  # of `evaluate` and `order`, in space
USUALLY_ACCEPTED = 1.35
# The bits of ``steps["case"]``, by name.
CASES: dict[str, int] = {name: 1 << bit for bit, name in enumerate(COUNT_NAMES[:8])}


def voronoi_segment(
    domain: Domain,
    size: Any,
    *,
    priority: Any = None,
    accept: float = 1.35,
    finish: bool = True,
    split_boundary: SplitBoundary = True,
    evaluate: str = "center",
    order: str = "first",
    budget: int | None = None,
    history: bool = False,
    progress: bool = False,
) -> DomainMesh:
    """Mesh a region, or a body in space, by Rebay's insertion along Voronoi segments.

    Parameters
    ----------
    domain : Domain
    size : number, function (k, d) -> (k,), SizeField, or dict of region name to one of these
        The wanted edge length h. In a dict the key None stands for all regions that are not named; a piece
        between two regions takes the smaller size. The threshold of the source chapter, which this book
        follows, is f = h / sqrt(3): the circumradius of an equilateral triangle with edges h. Each piece of
        the boundary is cut into a whole number of edges of about the length h = sqrt(3) f.
    priority : "alpha", "circumradius", or anything that is a size, optional
        Which waiting triangle at the front is next. "alpha", the default, takes the one with the largest
        R / f, "circumradius" the one with the largest R, and a size g the one with the largest alpha(S) =
        sqrt(3) R / g(Q), Q being the circumcenter.
    accept : float
        delta: triangles with R < delta f are accepted. The source chapter has 3/2. For values up to sqrt(2)
        see the notes.
    finish : bool
        Whether to improve the result afterwards.
    split_boundary : bool or "inner"
        Whether edges on pieces that are longer than 2 f are split, on the true curve, where they reject a
        point because it would be beyond them or make a flat triangle with them: True, False, or "inner", for
        those on inner pieces only. The finishing pass keeps to it.
    evaluate : "center" or "middle"
        Where f is taken for a new point: at the center of gravity of the triangle that is about to be made,
        or at the middle of its edge, as in the source chapter. For a constant size both are the same.
    order : "first" or "last"
        Among triangles with about the same R / f (within half an octave of its square), the one that has
        waited longest is next, or the newest.
    budget : int, optional
        The largest number of new points, besides those that cut the boundary at first; 10^7 by default.
        `DomainMesh.complete` says whether they were enough.
    history : bool
        Keep a record of each step in ``steps``.
    progress : bool
        Show a bar.

    Returns
    -------
    DomainMesh
        ``counts``, by name. The inserted points are counted as "points". Some of them are also counted as
        "capped" (d = q, because the circle through A, B and F is smaller than f), "clamped" (because q < p),
        "behind" (F lies on the other side of AB), "deleted" (X lies in the circle of the accepted triangle,
        so that AB is removed) or "cocircular" (X lies exactly on that circle). "moved": f at the center
        differs from f at M by more than a tenth. "wide": X sees a boundary edge under 90 to 120 degrees. The
        rejected points are "outside" (beyond a boundary edge), "encroaching" (they see one under 120 degrees
        or more), "collisions" (nearer than 0.7 f to a vertex) or "rounded" (by rounding not in the circle of
        their triangle).
        As a last resort there are "circumcenters" and "splits" of the boundary; then "refused splits", and
        "given up" for triangles. The finishing pass counts "moves", "swaps", "points again" (inserted as
        before), "patches" (of triangles that were replaced by less sharp ones), and "angle points", "angle
        splits" and "removed" vertices of the refinement.
        ``figures``: "triangles", "minimum angle", "minimum 2r/R" and "mean 2r/R", each followed by "before"
        and "after" (finishing). ``unrefined`` lists the triangles that are too large and, after finishing,
        those with an angle below 26 degrees. ``reasons`` says why: "input angle ..." (an angle of the domain
        that leaves no choice), "budget", ...
        ``steps`` (with ``history``) has columns with one row for each new vertex, in order: "vertex", "point"
        (as inserted), "edge" A B, "accepted" C and "waiting" D (-1: none), "f", "p", "q", "d", "case" (bits,
        see `CASES`), "parent" (the row that made AB as its AX or XB, or -1). Vertices that the finishing pass
        has removed are -1.

    Raises
    ------
    InputError
        For an unknown option, for a size that is not positive and finite (with the place), and as
        `unstruct.constrained_delaunay` does.

    Notes
    -----
    *The step.* AB is the shortest active edge of the chosen triangle ADB, M its middle, p = |AM|, F the
    circumcenter of ADB and q = |MF|. X is put on the bisector at the distance d = R + sqrt(R^2 - p^2) from M,
    with R = min(max(f, p), (p^2 + q^2) / 2q): these are (12.4) and (12.5) of the source chapter. Contrary to
    that chapter q < p is possible; then d = q. Boundary edges are active from the beginning, as if accepted
    triangles were beyond them.

    *What is proved,* for a constant f and a convex region, of which no edges are split: let m = min(sqrt(2),
    delta). If no two vertices are nearer than m f at first, none ever are. For |AX|^2 = p^2 + d^2 = 2 R d
    >= 2 f^2 where d is not cut off, since d >= R >= f; and where X = F, |AX| is the circumradius of a waiting
    triangle, at least delta f. Vertices on the side of D are outside circle ADB, which covers that part of
    the disk around X through A and B; a vertex on the other side is nearer to A or B than to X, since d >= p,
    or else X = F. By the law of sines an accepted triangle has angles above arcsin(m / (2 delta)): 30 degrees
    for delta <= sqrt(2), and 28 for the source chapter's 3/2; both are sharp. The proof fails at notches of
    the boundary and where f varies: there angles just below 30 degrees occur. Narrow places and small input
    angles need the finishing pass.

    *The finishing pass* moves the vertices of poor triangles (a smart Laplace step, then pattern searches,
    the last one for the smallest 2 r / R), swaps diagonals so that the mesh stays constrained Delaunay,
    replaces patches around the sharpest triangles (there vertices may be added, removed, and slide along an
    outer piece of the boundary, unless `split_boundary` or a spacing forbids points there), tries
    inner points where an angle is below 29.5 degrees, and refines by Chew's second algorithm where an angle
    is below 25 degrees. At its end all angles are at least 25 degrees, except in the triangles that it lists.

    All signs that decide the topology are exact. Triangles are taken by R / f from buckets of half an octave
    of its square, first in, first out. It takes O(n) after the boundary is triangulated. No point is inserted
    nearer than 0.7 f to a vertex that it would be joined to, so that the number of points is bounded.
    Sources: S. Rebay, Journal of Computational Physics 106 (1993) 125-138; L. P. Chew, Symposium on
    Computational Geometry (1993) 274-280. Book: 2.6c.

    *In space* the edge AB becomes the active face ABC of a tetrahedron that waits, M its circumcenter, p its
    circumradius; the formulas for R and d are the same, and f = sqrt(6) h / 4. Of the active faces of a cell
    the one with the least circumradius is taken. A point nearer than 0.7 f to a vertex is not put; the
    circumcenter of the cell is then tried. There are slivers: ``finish`` cures them by `improve` (not with
    ``history``), and ``figures`` has the least dihedral angles and 3r/R before and after. ``priority`` is
    "alpha", "circumradius" or a size; the boundary is divided as in `circumcenter_insertion`. ``counts`` has
    "Voronoi points", "circumcenters", "segment points", "facet points". No bound on angles is known.
    Book: 2.8c.
    """
    check_split_boundary(split_boundary)
    as_flags(finish=finish, history=history, progress=progress)
    if isinstance(domain, Domain) and domain.dimension == 3:
        if not (isinstance(evaluate, str) and isinstance(order, str)) or (evaluate, order) != CHOICES:
            raise InputError("evaluate and order are for the plane")
        body = domain

        def made(size: Any) -> DomainMesh:
            return segments_in_body(
                body, size, priority=priority, accept=accept, finish=finish, split_boundary=split_boundary,
                budget=budget, history=history, progress=progress,
            )  # fmt: skip

        longer = MUCH_LONGER * max(1.0, positive(accept, "accept") / USUALLY_ACCEPTED)
        return noticed(asked_again(made, size, longer=longer))
    rule = rule_of(accept, evaluate, order, priority, bool(split_boundary))
    budget = DEFAULT_BUDGET if budget is None else min(as_count(budget, "budget"), MOST_VERTICES)
    domain = as_domain(domain)
    complex_ = planar_complex(domain, size, progress=progress)
    kept = kept_pieces(split_boundary, len(domain.facets), len(domain.pieces), domain.held())
    size = size_by_region(complex_, size, domain.regions)
    run = VoronoiSegmentRun(domain, complex_, size, priority if rule.general else None, rule, kept, history)
    with progress_bar(progress, " points") as bar:
        run.insert(budget, bar)
    mesh = run.result(run.finish(budget) if finish and not run.spent else None)
    return noticed(paired(domain, mesh))


def epsilon_chains(mesh: DomainMesh) -> list[NDArray[np.float64]]:
    """The deviations epsilon_n = f / p - 2 / sqrt(3) along chains of parent edges (12.6).

    Parameters
    ----------
    mesh : DomainMesh
        A mesh made by `voronoi_segment` with ``history=True``.

    Returns
    -------
    list of ndarray
        One array for each chain. A chain is an edge AB with its point X, then AX or BX with its point, and so
        on. Each pair of an edge and its child is in exactly one chain, if X had its wanted place (d was not
        cut off at F). Chains of one entry are left out.
    """
    steps = mesh.steps
    if steps is None:
        raise InputError("the mesh has no record of its steps: make it by voronoi_segment(..., history=True)")
    with np.errstate(invalid="ignore"):
        epsilon = steps["f"] / steps["p"] - 2 / np.sqrt(3)
    parent = steps["parent"].copy()
    cut = CASES["capped"] | CASES["clamped"] | CASES["behind"]
    parent[(parent >= 0) & (steps["case"][parent] & cut > 0)] = -1
    chains: list[list[int]] = []
    chain_of: dict[int, list[int]] = {}  # for each step at the end of a chain, that chain
    for i in np.flatnonzero(parent >= 0).tolist():
        chain = chain_of.pop(int(parent[i]), None)
        if chain is None:
            chain = [int(parent[i])]
            chains.append(chain)
        chain.append(i)
        chain_of[i] = chain
    return [epsilon[chain] for chain in chains]
