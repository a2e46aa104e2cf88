"""Rebay's Voronoi-segment insertion: from a domain and a wanted size to nearly equilateral triangles."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET, MOST_VERTICES, as_count
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...domain.domain import Domain, as_domain
from ...mesh.domain_mesh import DomainMesh
from ..boundary.constrained import planar_complex
from ..boundary.kept import SplitBoundary, kept_pieces
from .run import COUNT_NAMES, VoronoiSegmentRun, rule_of

__all__ = ["CASES", "epsilon_chains", "voronoi_segment"]

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
    """Mesh a planar domain by Rebay's insertion along Voronoi segments.

    Parameters
    ----------
    domain : Domain
    size : number, function (k, 2) -> (k,), or SizeField
        The wanted edge length h. The chapter's threshold is f = h / sqrt(3), the circumradius of the
        equilateral triangle; the boundary is cut into edges of about h = sqrt(3) f, whole counts.
    priority : "alpha", "circumradius", or anything that is a size, optional
        Which waiting triangle at the front is next: that of the largest R / f ("alpha", and by default), of
        the largest R, or of the largest alpha(S) = sqrt(3) R / g(Q), Q the circumcenter, for a size g.
    accept : float
        delta: triangles with R < delta f are accepted. The chapter has 3/2; up to sqrt(2) see the notes.
    finish : bool
        Whether to improve the result afterwards.
    split_boundary : bool or "inner"
        Whether edges on pieces that are longer than 2 f and that a new point would flatten are split, on the
        true curve: True, False, or "inner": those on inner pieces only. The finishing pass keeps to it.
    evaluate : "center" or "middle"
        Where f is taken for a new point: at the center of gravity of the triangle that is about to be made,
        or at the middle of its edge, as the chapter has it. For a constant size both are the same.
    order : "first" or "last"
        Of triangles with about the same R / f (half an octave of its square), the one that has waited
        longest, or the newest.
    budget : int, optional
        At most so many new points besides those that cut the boundary; 10^7 by default. `DomainMesh.complete`
        tells whether they were enough.
    history : bool
        Keep a record of each step in ``steps``.
    progress : bool
        Show a bar.

    Returns
    -------
    DomainMesh
        ``counts``, by name. Of the points put in: "points"; those "capped", with d = q because the circle
        through A, B and F is smaller than f; "clamped", because q < p; "behind", F lying on the other side of
        AB; "deleted": X in the circle of the accepted triangle, so that AB goes; "cocircular": X exactly on
        it; "moved": f at the center differs from f at M by more than a tenth; "wide": X sees a boundary
        edge under 90 to 120 degrees. Of those rejected: "outside" (beyond a boundary edge), "encroaching"
        (120 degrees or more), "collisions" (nearer than 0.7 f to a vertex), "rounded". Then "circumcenters"
        and boundary "splits" as a last resort, "refused splits", triangles "given up". Of the finishing pass
        "moves", "swaps", "points again", "angle points", "angle splits", "removed".
        ``figures``: least angle, least and mean 2r/R, before and after finishing. ``unrefined`` lists the
        triangles that are too large, and after finishing those with an angle below 26 degrees, with
        ``reasons``: "input angle ..." (the angle of the domain that leaves no choice), "budget", ...
        ``steps`` (with ``history``): columns with one row for each new vertex, in order: "vertex", "point"
        (as put in), "edge" A B, "accepted" C and "waiting" D (-1: none), "f", "p", "q", "d", "case" (bits,
        see `CASES`), "parent" (the row that made AB as its AX or XB, or -1); vertices that finishing has
        taken away are -1.

    Raises
    ------
    InputError
        For options that are not in the list, sizes that are not positive and finite (with the place), and as
        `unstruct.constrained_delaunay` does.

    Notes
    -----
    *The step.* AB is the shortest active edge of the chosen triangle ADB, M its middle, p = |AM|, F the
    circumcenter of ADB and q = |MF|. X is on the bisector at d = R + sqrt(R^2 - p^2), R = min(max(f, p),
    (p^2 + q^2) / 2q): the chapter's (12.4) and (12.5). q < p is possible, against the chapter; then d stops
    at q. Boundary edges are active from the beginning, as if accepted triangles lay beyond.

    *What is proved,* for one f and away from the boundary, where R < delta f for accepted triangles and
    R >= delta f for waiting ones: |AX|^2 = p^2 + d^2 = 2 R d >= 2 f^2 where d is not cut off, since
    d >= R >= f; and where X = F, |AX| is the circumradius of a waiting triangle, at least delta f. X lies
    on the Voronoi edge of AB unless the accepted triangle is very obtuse (above 135 degrees), so that A and B
    are its nearest vertices. Hence new edges have at least the length m f with m = min(sqrt(2), delta), and
    by the law of sines an accepted triangle has angles of at least arcsin(m / (2 delta)): 30 degrees for
    delta <= sqrt(2), and 28 for the chapter's 3/2. At the boundary, and where f varies, this does not hold:
    angles just below 30 degrees come up; narrow places and small input angles need the finishing pass.

    *The finishing pass* moves the vertices of poor triangles (a smart Laplace step, then a pattern search),
    swaps diagonals so that the mesh stays constrained Delaunay, and refines by Chew's second algorithm where
    an angle is below 25 degrees. It ends with all angles at least 25 degrees but those it lists.

    All signs that decide the topology are exact. Triangles are taken by R / f in buckets of half an octave of
    its square, first in first out; O(n) after the boundary is triangulated. Every new edge is longer than
    f, so that the number of points is bounded. Sources: S. Rebay, Journal of Computational Physics 106 (1993)
    125-138; L. P. Chew, Symposium on Computational Geometry (1993) 274-280. Book: 2.6c.
    """
    rule = rule_of(accept, evaluate, order, priority, bool(split_boundary))
    budget = DEFAULT_BUDGET if budget is None else min(as_count(budget, "budget"), MOST_VERTICES)
    domain = as_domain(domain)
    complex_ = planar_complex(domain, size, progress=progress)
    kept = kept_pieces(split_boundary, len(domain.facets), len(domain.pieces))
    run = VoronoiSegmentRun(domain, complex_, size, priority if rule.general else None, rule, kept, history)
    with progress_bar(progress, " points") as bar:
        run.insert(budget, bar)
    return run.result(run.finish(budget) if finish and not run.spent else None)


def epsilon_chains(mesh: DomainMesh) -> list[NDArray[np.float64]]:
    """The deviations epsilon_n = f / p - 2 / sqrt(3) along chains of parent edges (12.6).

    Parameters
    ----------
    mesh : DomainMesh
        Made by `voronoi_segment` with ``history=True``.

    Returns
    -------
    list of ndarray
        One array for each chain: edge AB, on which X was put, then AX or BX with the point put on it, and so
        on. Each pair of an edge and its child is in exactly one chain, if X had its wanted place (was not
        cut off at F); chains of one entry are left out.
    """
    steps = mesh.steps
    if steps is None:
        raise InputError("the mesh has no record: make it with voronoi_segment(..., history=True)")
    with np.errstate(invalid="ignore"):
        epsilon = steps["f"] / steps["p"] - 2 / np.sqrt(3)
    parent = steps["parent"].copy()
    cut = CASES["capped"] | CASES["clamped"] | CASES["behind"]
    parent[(parent >= 0) & (steps["case"][parent] & cut > 0)] = -1
    chains: list[list[int]] = []
    chain_of: dict[int, list[int]] = {}  # the chain that ends with this step
    for i in np.flatnonzero(parent >= 0).tolist():
        chain = chain_of.pop(int(parent[i]), None)
        if chain is None:
            chain = [int(parent[i])]
            chains.append(chain)
        chain.append(i)
        chain_of[i] = chain
    return [epsilon[chain] for chain in chains]
