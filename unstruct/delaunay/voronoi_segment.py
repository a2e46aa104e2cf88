"""Rebay's Voronoi-segment insertion: from a domain and a wanted size to nearly equilateral triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .constrained import planar_complex
from .voronoi_segment_run import COUNT_NAMES, Run, rule_of

if TYPE_CHECKING:
    from ..domain import Domain
    from .refined import Refined

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
    split_boundary: bool = True,
    evaluate: str = "center",
    order: str = "first",
    budget: int | None = None,
    history: bool = False,
    progress: bool = False,
) -> Refined:
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
    split_boundary : bool
        Whether boundary edges longer than 2 f that a new point would flatten are split, on the true curve.
    evaluate : "center" or "middle"
        Where f is taken for a new point: at the center of gravity of the triangle that is about to be made,
        or at the middle of its edge, as the chapter has it. For a constant size both are the same.
    order : "first" or "last"
        Of triangles with about the same R / f (half an octave of its square), the one that has waited
        longest, or the newest.
    budget : int, optional
        At most so many new points; `Refined.complete` tells whether they were enough.
    history : bool
        Keep a record of each step in ``steps``.
    progress : bool
        Show a bar.

    Returns
    -------
    Refined
        ``counts`` tells how often each special case came up, ``steps`` (with ``history``) what each new
        vertex did.
    """
    rule = rule_of(accept, evaluate, order, priority, split_boundary)
    if budget is not None and budget < 0:
        raise InputError(f"budget = {budget} must not be negative")
    complex_ = planar_complex(domain, size, progress=progress)
    run = Run(domain, complex_, size, priority if rule.general else None, rule, history)
    if progress:
        from tqdm.auto import tqdm

        with tqdm(unit=" points") as bar:
            run.insert(budget, bar)
    else:
        run.insert(budget, None)
    return run.result(run.finish(budget) if finish and not run.spent else None)


def epsilon_chains(mesh: Refined) -> list[NDArray[np.float64]]:
    """The deviations epsilon_n = f / p - 2 / sqrt(3) along chains of parent edges (12.6).

    Parameters
    ----------
    mesh : Refined
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
