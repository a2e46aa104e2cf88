"""The advancing-front Delaunay method in space (12.3.4): given points, cell by cell by the empty sphere."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arguments import as_flags, as_seed
from ...base.arrays import as_points, frozen
from ...base.codes import DONE, ROOM
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...connect.insertion.engine import grown
from ...domain.domain import Domain, as_domain
from ...domain.space.cutting import Shell
from ...geometry.ordering import hilbert_order
from ...geometry.polygons import Polygons
from ...geometry.triangle_pairs import points_on_edges, points_on_triangles
from ...mesh.domain_mesh import DomainMesh
from ...mesh.grouping import group_rows
from ...predicates.batch import in_sphere
from ..advancing.rows import CELLS_MADE, room_to_wait
from ..volume.filling import filled
from . import empty_sphere as k
from .classical_mesh import mesh_of_body, quality_in_space
from .classical_open import SpaceFront, larger_space_front
from .classical_rest import completed
from .classical_run import BodyFaces, SpaceRun, body_faces, scaled_front
from .classical_steps import NO_CELL
from .tie_order import order_that_fits

__all__ = ["given_points_in_space"]

WRAPPED_A_CALL = 2_000  # cells, a fraction of a second: Ctrl-C works between calls
WITHOUT_APEX = "no apex: no vertex of the front fits to a face, so recovery filled what is left"
NOT_EMPTY = "not Delaunay: a vertex in its sphere is seen through a face"


def given_points_in_space(
    domain: Domain, points: ArrayLike, *, seed: int = 0, history: bool = False, progress: bool = False
) -> DomainMesh:
    """Mesh a body and points inside cell by cell from its boundary, each by the empty sphere.

    Parameters
    ----------
    domain : Domain
        In space. Its triangles stay as they are.
    points : array_like, shape (k, 3)
    seed : int
        Of the random numbers by which a rest is filled, if there is one.
    history : bool
        Keep a record of each cell in ``steps``.
    progress : bool
        Show a bar.

    Returns
    -------
    DomainMesh
        The cells of the front in the order in which they were made: in each the first three vertices are the
        face of the front, the last one is the apex. Then come those of rests. Vertices are those of the
        domain, then the points, in their order, then points that had to be added inside of rests. ``counts``:
        "cells" of the front; "cospherical" ones, whose sphere has another visible vertex on it; "hidden"
        candidates, which were in the sphere of a cell but not visible from its face; "outside" points, which
        were left out (their rows are in ``left_out``); "stuck rests", "stuck faces", "filled", "added inside"
        and "taken back" as for `classical_in_space`; "not Delaunay": faces inside, on no piece, across which
        a cell has a vertex in its sphere. Where these are none and nothing was filled, the mesh is a
        constrained Delaunay tetrahedralization. Other cells are in ``unrefined``, and ``complete`` is False.
        ``steps`` (with ``history``): "face", "apex", "cospherical", one row for each cell of the front.

    Raises
    ------
    InputError
        For points that are equal to one another or to a vertex of the domain, or lie on a piece, by exact
        signs (with the first such row), and for exponents too wide for one scale.

    Notes
    -----
    See `empty_sphere` for the rule, its ties, and the theorem: if a constrained Delaunay tetrahedralization
    exists and no five vertices are on a sphere, this is one. With ties it is one if there is one for the
    heights by which ties are decided: those of the order of the vertices, and if it fails, those of an order
    that fits to the diagonals of given triangles (`tie_order`; then ``counts`` has "ties decided anew").
    There may be one for other decisions only, or none; then faces may be left without an apex, or cells not
    be Delaunay, and that is counted. No other triangulation is used, except for a rest. Expected O(n log n)
    for even points. All signs are exact. Source: the source chapter, 12.3.4. Book: 3.5.
    """
    as_flags(history=history, progress=progress)
    seed = as_seed(seed)
    domain = as_domain(domain, 3)
    if not len(domain.facets):
        raise InputError("the domain has no facets, so nothing is inside: give facets")
    rows = as_points(points) if np.size(points) else np.empty((0, 3))
    if rows.shape[1] != 3:
        raise InputError(f"points must have shape (k, 3), not {rows.shape}; a size is a number or a function")
    whole = _with_points(domain, rows)
    body = body_faces(whole)
    n = len(domain.points)
    order = np.append(np.arange(n), n + hilbert_order(rows))
    loose = np.arange(len(domain.points), len(whole.points))
    outside = frozen(np.flatnonzero(~np.isin(loose, body.needed)).astype(np.int32))
    with progress_bar(progress, " tetrahedra") as bar:
        mesh = _by_order(whole, domain, order, (seed, history, progress), bar)
        if mesh.counts["cospherical"] and not _is_delaunay(mesh):
            fits = order_that_fits(body.points, body.faces, order)
            if not np.array_equal(fits, order):
                again = _by_order(whole, domain, fits, (seed, history, progress), bar)
                if _is_delaunay(again):
                    mesh = again
                    mesh.counts = {**mesh.counts, "ties decided anew": 1}
    mesh.counts, mesh.left_out = {**mesh.counts, "outside": len(outside)}, outside
    return mesh


def _is_delaunay(mesh: DomainMesh) -> bool:
    return mesh.counts["stuck faces"] == 0 and mesh.counts["not Delaunay"] == 0


def _by_order(
    whole: Domain, domain: Domain, order: NDArray[np.int64], asked: tuple[int, bool, bool], bar: Any
) -> DomainMesh:
    """The mesh with ties decided by this order of the vertices; ``asked`` is seed, history and progress."""
    seed, history, progress = asked
    body = body_faces(whole)
    front, _ = scaled_front(_along_curve(body, order))
    front, ties, counts = _wrapped(front, bar)
    run = _as_run(front, counts, body, order)
    found = completed(body, run, seed=seed)
    counts = run.counts | found.counts
    if not found.whole:
        mesh = filled(whole, seed=seed, progress=progress)
        mesh.counts = {**mesh.counts, **counts}
        return mesh
    steps = None
    if history and counts["taken back"] == 0:
        steps = {"face": run.cells[:, :3].copy(), "apex": run.cells[:, 3].copy(), "cospherical": ties}
    missing = {"missing segments": 0, "missing triangles": 0}
    account: dict[str, Any] = {"counts": counts | missing, "steps": steps}
    mesh = mesh_of_body(domain, None, found.points, found.cells, **account)
    mesh.figures = quality_in_space(mesh)
    return _judged(mesh, found.by_front)


def _with_points(domain: Domain, rows: NDArray[np.float64]) -> Domain:
    """The domain with the points as loose vertices, after its own."""
    n, every = len(domain.points), np.concatenate([domain.points, rows])
    group, first = group_rows(np.ascontiguousarray(every).view(np.int64))
    copies = np.flatnonzero(first[group] != np.arange(len(every)))
    if len(copies):
        i, j = int(copies[0]), int(first[group[copies[0]]])
        other = f"points[{j - n}]" if j >= n else f"vertex {j} of the domain"
        raise InputError(f"points[{i - n}] = {every[i].tolist()} is equal to {other}: drop one of them")
    new = np.arange(n, len(every))
    shell: Shell = domain.triangulated
    on: list[tuple[int, int]] = []
    if len(new) and len(shell.triangles):
        v, t, _ = points_on_triangles(every, new, shell.triangles)
        on += zip(v.tolist(), shell.piece[t].tolist())
    if len(new) and len(shell.segments):
        v, s = points_on_edges(every, new, shell.segments)
        on += zip(v.tolist(), shell.segment_piece[s].tolist())
    if on:
        i, piece = min(on)
        raise InputError(
            f"points[{i - n}] = {every[i].tolist()} lies on {domain.name(piece)} of the domain: drop it, or "
            "make it a vertex of the domain that divides the piece"
        )
    facets, inner = Polygons.of(domain.facets), Polygons.of(domain.inner)
    return Domain(
        every, facets, inner=inner if len(inner) else None, markers=domain.markers, regions=domain.regions
    )


def _along_curve(body: BodyFaces, order: NDArray[np.int64]) -> BodyFaces:
    """The same front with its vertices in this order: neighbors along a curve are near in memory."""
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.arange(len(order))
    return BodyFaces(
        body.points[order], number[body.faces], body.part,
        number[body.threads].astype(np.int32).reshape(-1, 2), np.sort(number[body.needed]),
    )  # fmt: skip


def _wrapped(front: SpaceFront, bar: Any) -> tuple[SpaceFront, NDArray[np.bool_], dict[str, int]]:
    """Cell by cell until no face has an apex: the front, which cells have a choice, and the counts."""
    counts, ties = np.zeros(k.APEX_COUNTS, dtype=np.int64), np.zeros(len(front.made), dtype=bool)
    waiting = room_to_wait(None, len(front.corner), len(front.xyz))
    k.start_in_age(front, waiting)
    while True:
        before = int(front.state[CELLS_MADE])
        code = k.wrap_in_space(front, waiting, ties, counts, WRAPPED_A_CALL)
        bar.update(int(front.state[CELLS_MADE]) - before)
        if code in (DONE, NO_CELL):
            break
        if code == ROOM:
            front = larger_space_front(front)
            waiting = room_to_wait(waiting, len(front.corner), len(front.xyz))
            ties = grown(ties, len(front.made))
    m = int(front.state[CELLS_MADE])
    names = {
        "cells": m, "cospherical": int(counts[k.OTHERS_ON_SPHERE]), "hidden": int(counts[k.HIDDEN_APEXES]),
    }  # fmt: skip
    return front, ties[:m].copy(), names


def _as_run(front: SpaceFront, counts: dict[str, int], body: BodyFaces, order: NDArray[np.int64]) -> SpaceRun:
    """What the front has made, as the filling of rests wants it, with the numbers of the body."""
    alive = np.flatnonzero(front.stamp >= 0)
    alive = alive[np.argsort(front.stamp[alive])]
    m = int(front.state[CELLS_MADE])
    cells = front.made[:m].copy()
    cells[:, :4] = order[cells[:, :4]]
    left, part = order[front.corner[alive]], front.region[alive].astype(np.int64)
    return SpaceRun(body.points, cells, left, part, counts, None, False)


def _judged(mesh: DomainMesh, by_front: int) -> DomainMesh:
    """The mesh with the account of cells that are not constrained Delaunay."""
    cells, rows = mesh.simplices, np.asarray(mesh.neighbors)
    t, j = np.nonzero(rows > np.arange(len(cells))[:, None])
    sides = np.sort(cells[t[:, None], np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])[j]], axis=1)
    group, _ = group_rows(np.concatenate([np.sort(mesh.faces, axis=1), sides]))
    free = ~np.isin(group[len(mesh.faces) :], group[: len(mesh.faces)])
    t, u = t[free], rows[t[free], j[free]]
    back = (rows[u] == t[:, None]).argmax(axis=1)
    wrong = np.asarray(in_sphere(mesh.points[cells[t]], mesh.points[cells[u, back]])) > 0
    why = {one: NOT_EMPTY for one in np.concatenate([t[wrong], u[wrong]]).tolist()}
    why |= {one: WITHOUT_APEX for one in range(by_front, len(cells))}
    mesh.counts = {**mesh.counts, "not Delaunay": int(wrong.sum())}
    listed = sorted(why)
    mesh.unrefined = np.array(listed, dtype=np.int32)
    mesh.reasons = np.array([why[one] for one in listed], dtype=str)
    return mesh
