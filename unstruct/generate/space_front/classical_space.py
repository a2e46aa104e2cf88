"""The classical advancing front of a body in space."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...base.arguments import DEFAULT_BUDGET, MOST_VERTICES, as_count, as_flags, as_seed
from ...base.errors import InputError
from ...domain.domain import Domain, as_domain
from ...domain.space.by_part import size_by_part
from ...mesh.domain_mesh import DomainMesh
from ...sizing.asked import COARSE_BOUNDARY, asked_again
from ...sizing.field import SizeField, as_size
from ...sizing.metric import Metric
from ..bodies.dividing import divided
from ..bodies.tetrahedralize import tetrahedra_by_size
from ..volume.improving import improve
from .classical_mesh import mesh_of_body, quality_in_space
from .classical_rest import completed
from .classical_run import BODY_ORDERS, BODY_SEARCHES, body_faces, marched_in_space
from .in_space import NO_ROOM_FOR_POINT, larger_cells

__all__ = ["classical_in_space"]


def classical_in_space(
    domain: Domain,
    size: Any,
    *,
    order: str = "smallest",
    search: str = "barycenter",
    finish: bool = True,
    split_boundary: bool | None = None,
    seed: int = 0,
    budget: int | None = None,
    history: bool = False,
    progress: bool = False,
) -> DomainMesh:
    """Fill a body with tetrahedra by the classical advancing front.

    Parameters
    ----------
    domain : Domain
        In space.
    size : number, function (k, 3) -> (k,), SizeField, or dict of region name to one of these
        The wanted edge length.
    order : "smallest", "shortest" or "oldest"
        Which face of the front is next: where the wanted length is smallest (the rule of the source chapter),
        that with the shortest edges, or the one that has waited longest, which also decides between equals.
    search : "barycenter" or "ideal"
        Candidates are the vertices of the front in a sphere: about the barycenter of the face, with 1.5
        heights of the ideal tetrahedron as radius, as the source chapter has it; or about the ideal point,
        with 3/4 of its edges.
    finish : bool
        Whether to make the cells rounder afterwards, as `improve` does.
    split_boundary : bool, optional
        Whether facets are divided by the size, as for `tetrahedralize`.
    seed : int
        Of the random numbers of the recovery of rests, and of `improve`.
    budget : int, optional
        The largest number of new points of the front; 10^7 by default.
    history : bool
        Keep a record of each cell of the front in ``steps``, as it was made: before the finishing pass.
    progress : bool
        Show a bar.

    Returns
    -------
    DomainMesh
        With ``finish=False`` the cells of the front come first, in the order in which they were made:
        ``simplices[:k]`` is the state after k of them, and in each the first three vertices are the face, the
        last one is the apex. Then come those of rests. ``counts``: how many cells were made with a
        "new point", a "near vertex" (from the sphere), or, for a face that was "put aside", from a wider
        sphere, with a point half as high, or with "all vertices" as candidates; how many "candidates" were
        tried; in how many "stuck rests" the front ended, with how many "stuck faces", "filled" by how many
        cells with how many points "added inside", and how many cells of the front were "taken back" for that.
        If a rest cannot be filled by whole faces, the mesh is that of `tetrahedralize`, and "by recovery" is
        1. ``figures`` has the quality, with "before" and "after" if it is finished. ``unrefined`` contains
        cells that miss the size, and all if the budget was spent. ``steps`` (with ``history``): "face",
        "apex", "reason" (as above), "ideal" (the ideal point), "size" (the wanted length there), "radius" (of
        the search), and "start": the candidates of step i are rows ``start[i]`` to ``start[i + 1] - 1`` of
        "vertex" (-1: the ideal point) and "verdict" ("valid", "behind", "holds a vertex", "crosses the
        front", "not round", "too near").

    Raises
    ------
    InputError
        For an unknown option, for a metric, and as `tetrahedralize` does.

    Notes
    -----
    *The step.* See `classical_steps`. A candidate is accepted if the solid tetrahedron is valid, by exact
    signs: it is ahead of the face, and nothing of the front is in it or touches it but its own faces, edges
    and corners (`classical_signs`).

    *The front may stick.* In space a face may have no valid candidate, even if all vertices of the front are
    tried, as on Schönhardt's polyhedron. That is found exactly: the front is stuck if and only if no cell on
    its vertices may be made at any of its faces. What is left is filled by recovery with points inside
    (`classical_rest`), so a valid mesh always results.

    Expected O(n log n). Sources: R. Löhner, P. Parikh, International Journal for Numerical Methods in Fluids
    8 (1988) 1135-1149; J. Peraire et al., International Journal for Numerical Methods in Engineering 26
    (1988) 2135-2159. Book: 3.5.
    """
    if not isinstance(order, str) or order not in BODY_ORDERS:
        raise InputError(f"order = {order!r} must be one of {BODY_ORDERS} for the classical method")
    if not isinstance(search, str) or search not in BODY_SEARCHES:
        raise InputError(f"search = {search!r} must be one of {tuple(BODY_SEARCHES)}")
    as_flags(finish=finish, history=history, progress=progress)
    if split_boundary is not None:
        as_flags(split_boundary=split_boundary)
    seed = as_seed(seed)
    most = DEFAULT_BUDGET if budget is None else min(as_count(budget, "budget"), MOST_VERTICES)
    domain = as_domain(domain, 3)
    if isinstance(size, Metric):
        raise InputError("in space the front takes sizes, not a metric: give a length")
    if not len(domain.facets):
        raise InputError("the domain has no facets, so nothing is inside: give facets")
    options: dict[str, Any] = {"order": order, "search": search, "history": history, "progress": progress}

    def made(field: SizeField) -> DomainMesh:
        mesh = _made(domain, field, split_boundary, most, seed, options)
        return _finished(mesh, seed, progress) if finish and not (mesh.reasons == "budget").any() else mesh

    field = as_size(size_by_part(domain, size))
    mesh = asked_again(made, field, again=False)
    # Of constant sizes only this tells, because asking again would not help: facets that stay may be coarse.
    why = NO_ROOM_FOR_POINT if split_boundary else NO_ROOM_FOR_POINT + COARSE_BOUNDARY
    listed = dict.fromkeys(larger_cells(mesh, field).tolist(), why)
    listed |= dict(zip(mesh.unrefined.tolist(), mesh.reasons.tolist()))
    mesh.unrefined = np.array(sorted(listed), dtype=np.int32)
    mesh.reasons = np.array([listed[cell] for cell in sorted(listed)], dtype=str)
    return mesh


def _made(
    domain: Domain,
    field: SizeField,
    split_boundary: bool | None,
    most: int,
    seed: int,
    options: dict[str, Any],
) -> DomainMesh:
    """The mesh, before it is improved."""
    parts = None
    if split_boundary is None or split_boundary:
        parts = divided(domain, field, bool(split_boundary))
    body = body_faces(domain if parts is None else parts.domain)
    run = marched_in_space(body, field, budget=most, **options)
    found = completed(body, run, seed=seed)
    counts = run.counts | found.counts | {"by recovery": int(not found.whole)}
    if not found.whole:
        mesh = tetrahedra_by_size(
            domain,
            field,
            split_boundary,
            optimize=False,
            seed=seed,
            budget=None,
            progress=options["progress"],
        )
        mesh.counts = {**mesh.counts, **counts}
        return mesh
    steps = run.steps if found.counts["taken back"] == 0 else None
    missing = {"missing segments": 0, "missing triangles": 0}
    account: dict[str, Any] = {"counts": counts | missing, "steps": steps}
    if run.spent:
        account["unrefined"] = np.arange(len(found.cells))
        account["reasons"] = np.full(len(found.cells), "budget")
    mesh = mesh_of_body(domain, parts, found.points, found.cells, **account)
    mesh.figures = quality_in_space(mesh)
    return mesh


def _finished(mesh: DomainMesh, seed: int, progress: bool) -> DomainMesh:
    """The same, with rounder cells."""
    better = improve(mesh, seed=seed, progress=progress)
    before, after = quality_in_space(mesh), quality_in_space(better)
    better.figures, better.steps = dict(after), mesh.steps
    better.figures |= {f"{name} before": x for name, x in before.items()}
    better.figures |= {f"{name} after": x for name, x in after.items()}
    return better
