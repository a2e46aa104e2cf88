"""What a front that is stuck encloses, filled otherwise: so that a valid mesh always results.

**Theorem.** At all times the triangles of the front bound what is not meshed, from within: what is not meshed
is the union of some parts of space, divided by these triangles, with the front on their walls. They meet in
common edges and vertices only, since they are faces of cells and of the boundary, which do. So each part is a
body in the sense of `Domain`, though seldom a simple one; inner facets with both sides in one part are inner
facets of it. If `filled` recovers its facets whole, its cells and those of the front meet face to face.

Recovery may need points inside, as Schönhardt's polyhedron does, and has no theorem for few of them. Where it
splits a facet or misses one, the cells of the front that touch the part are taken away, and the larger part
is tried. If a part cannot become larger, because it ends at the boundary of the body all around, the body is
filled by recovery as a whole, with the account of that. Book: 3.5.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...base.errors import InputError
from ...domain.domain import Domain
from ...domain.space.parts import UNBOUNDED, parts_in_space
from ...mesh.grouping import group_rows
from ..volume.filling import filled
from .classical_run import BodyFaces, SpaceRun
from .classical_signs import SIDES_OF_CELL

__all__ = ["Completed", "completed", "front_of_cells", "rests_of"]

Rows = NDArray[np.int64]


class Completed(NamedTuple):
    """A run with its rest filled.

    Attributes
    ----------
    points : (n, 3) float64
        Those of the run, then points that were added inside of rests.
    cells : (m, 5) int64
        The cells of the front that stayed, in their order, then those of the rests.
    by_front : int
        How many are of the front.
    counts : dict of str to int
    whole : bool
        False if a rest could not be filled: then the body must be, by recovery.
    """

    points: NDArray[np.float64]
    cells: Rows
    by_front: int
    counts: dict[str, int]
    whole: bool


class OneRest(NamedTuple):
    """A part of what is not meshed: its triangles, inner ones, further vertices and segments."""

    facets: Rows
    inner: Rows
    loose: Rows
    threads: Rows
    part: int


def lowest_cyclic(faces: Rows) -> Rows:
    """The same oriented triangles, each with its lowest vertex first."""
    turn = (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3
    return np.take_along_axis(faces, turn, axis=1)


def front_of_cells(body: BodyFaces, cells: Rows) -> tuple[Rows, Rows]:
    """The faces that are at the front if exactly these cells (m, 5) are made, and the parts ahead of them."""
    inward = lowest_cyclic(cells[:, SIDES_OF_CELL].reshape(-1, 3))
    part = np.repeat(cells[:, 4], 4)
    first = lowest_cyclic(body.faces)
    outward = lowest_cyclic(inward[:, [0, 2, 1]])
    number, _ = group_rows(np.concatenate([first, inward, outward]))
    begin, within, without = np.split(number, [len(first), len(first) + len(inward)])
    covered, given = (
        flagged(int(number.max(initial=-1)) + 1, within),
        flagged(int(number.max(initial=-1)) + 1, begin),
    )
    open_first = ~covered[begin]
    beyond = ~given[within] & ~covered[without]
    return (
        np.concatenate([first[open_first], outward[beyond]]),
        np.concatenate([body.part[open_first], part[beyond]]),
    )


def rests_of(
    points: NDArray[np.float64], faces: Rows, part: Rows, body: BodyFaces, cells: Rows
) -> list[OneRest]:
    """The parts of what is not meshed, with the vertices and segments of the body that no cell has."""
    vertices, local = np.unique(faces, return_inverse=True)
    local = local.reshape(-1, 3)
    number, first = group_rows(np.sort(local, axis=1))
    shell = local[first]
    parts = parts_in_space(points[vertices], shell.astype(np.int32))
    same = (lowest_cyclic(local) == lowest_cyclic(shell)[number]).all(axis=1)
    label = np.where(same, parts.front[number], parts.back[number])
    used = flagged(len(points), cells[:, :4], faces)
    loose = body.needed[~used[body.needed]]
    threads = _unmade(body.threads.astype(np.int64), cells)
    loose_label = parts.locate(points[loose])
    thread_label = parts.locate(points[threads].mean(axis=1))
    found = []
    for one in np.unique(label[label != UNBOUNDED]).tolist():
        rows = np.flatnonzero(label == one)
        count = np.bincount(number[rows], minlength=len(first))[number[rows]]
        facets, inner = rows[count == 1], rows[count == 2]
        inner = inner[np.unique(number[inner], return_index=True)[1]]
        found.append(
            OneRest(
                faces[facets], faces[inner], loose[loose_label == one], threads[thread_label == one],
                int(part[rows[0]]),
            )
        )  # fmt: skip
    return found


def _unmade(threads: Rows, cells: Rows) -> Rows:
    """The segments that are no edges of cells."""
    if len(threads) == 0:
        return threads
    pairs = [(i, j) for i in range(4) for j in range(i + 1, 4)]
    edges = np.sort(cells[:, pairs].reshape(-1, 2), axis=1)
    ends = np.sort(threads, axis=1)
    return threads[~np.isin(ends[:, 0] << 32 | ends[:, 1], edges[:, 0] << 32 | edges[:, 1])]


def _filled(points: NDArray[np.float64], rest: OneRest, seed: int) -> tuple[Rows, NDArray[np.float64]] | None:
    """The cells of a rest, and new points, numbered after the others; None if a face is not there."""
    vertices = np.unique(
        np.concatenate([one.ravel() for one in (rest.facets, rest.inner, rest.threads, rest.loose)])
    )
    place = np.full(len(points), -1, dtype=np.int64)
    place[vertices] = np.arange(len(vertices))
    inner = [*place[rest.inner].tolist(), *place[rest.threads].tolist()]
    try:
        domain = Domain(points[vertices], place[rest.facets], inner=inner or None)
        mesh = filled(domain, seed=seed)
    except InputError:  # facets that touch by rounding; or so many are missing that nothing is inside
        return None
    if not mesh.complete or len(mesh.steiner):
        return None
    old = np.asarray(mesh.origin).astype(np.int64)
    new = np.flatnonzero(old < 0)
    number = np.where(old >= 0, vertices[old], 0)
    number[new] = len(points) + np.arange(len(new))
    return number[mesh.simplices], mesh.points[new]


def completed(body: BodyFaces, run: SpaceRun, *, seed: int = 0) -> Completed:
    """The cells of a run, and cells of what is left.

    Parameters
    ----------
    body : BodyFaces
    run : SpaceRun
    seed : int
        Of the random numbers of the recovery.

    Returns
    -------
    Completed
        ``counts``: how many parts were left ("stuck rests") with how many faces ("stuck faces"), how many
        cells fill them ("filled"), how many points inside of them were added ("added inside"), and how many
        cells of the front were taken away again ("taken back").
    """
    points, cells = run.points, run.cells.astype(np.int64)
    own = np.ones(len(cells), dtype=bool)  # whether a cell is of the front
    faces, part, rests = run.left, run.part, 0
    whole = True
    failed: set[bytes] = set()
    while len(faces):
        found = rests_of(points, faces, part, body, cells)
        rests = rests or len(found)
        bad = []
        for one in found:
            result = _filled(points, one, seed)
            if result is None:
                bad.append(np.concatenate([one.facets, one.inner]))
                continue
            new, more = result
            points = np.concatenate([points, more])
            cells = np.concatenate([cells, np.column_stack([new, np.full(len(new), one.part)])])
            own = np.append(own, np.zeros(len(new), dtype=bool))
        if not bad:
            break
        shapes = {np.unique(lowest_cyclic(rows), axis=0).tobytes() for rows in bad}
        if shapes & failed:  # nothing but the boundary is around it
            whole = False
            break
        failed |= shapes
        beside = flagged(len(points), *[rows.ravel() for rows in bad])[cells[:, :4]].any(axis=1)
        cells, own = cells[~beside], own[~beside]
        faces, part = front_of_cells(body, cells)
    whole = whole and len(_unmade(body.threads.astype(np.int64), cells)) == 0
    order = np.argsort(~own, kind="stable")
    counts = {
        "stuck rests": rests, "stuck faces": len(run.left), "filled": int((~own).sum()),
        "added inside": len(points) - len(run.points), "taken back": len(run.cells) - int(own.sum()),
    }  # fmt: skip
    return Completed(points, cells[order], int(own.sum()), counts, whole)
