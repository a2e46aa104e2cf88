"""The classical advancing front in space: its arrays, its growth, and its report.

For the steps see `classical_steps`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET
from ...base.codes import DONE, ROOM
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...connect.insertion.engine import grown
from ...domain.domain import Domain
from ...domain.space.by_part import parts_of_body
from ...predicates.batch import power_of_two, unscaled
from ...sizing.field import SizeField
from ...sizing.space_table import SpaceNodes, space_nodes
from ..advancing.journal import Journal, columns_of, empty_journal, larger_journal
from ..advancing.rows import CELLS_MADE, VERTEX_COUNT, room_to_wait
from . import classical_steps as k
from .classical_ideal import SpaceChoices
from .classical_open import SpaceFront, larger_space_front, new_space_front

__all__ = [
    "BODY_ORDERS",
    "BODY_SEARCHES",
    "BODY_VERDICTS",
    "CLASSICAL_BODY_REASONS",
    "BodyFaces",
    "SpaceRun",
    "body_faces",
    "marched_in_space",
    "scaled_front",
]  # fmt: skip

BODY_ORDERS = ("smallest", "shortest", "oldest")
# Where the search for candidates is centered, and its radius: in heights of the ideal tetrahedron about the
# barycenter, in its edges about the ideal point. The last number is the least quality.
BODY_SEARCHES: dict[str, tuple[float, float]] = {"barycenter": (1.5, 0.3), "ideal": (0.75, 0.2)}
CLASSICAL_BODY_REASONS = ("new point", "near vertex", "put aside", "all vertices")
BODY_VERDICTS = ("valid", "behind", "holds a vertex", "crosses the front", "not round", "too near")
LOOKS_A_CALL = 10_000  # a fraction of a second: Ctrl-C works between calls


class BodyFaces(NamedTuple):
    """The first front of a body, and what must become part of its mesh.

    Attributes
    ----------
    points : (n, 3) float64
    faces : (m, 3) int64
        Triangles with what is to be meshed on their positive side, inner facets once for each side.
    part : (m,) int64
        The part of the body there.
    threads : (s, 2) int32
        Inner segments that are no edges of triangles.
    needed : (k,) int64
        Vertices inside that are on no triangle.
    """

    points: NDArray[np.float64]
    faces: NDArray[np.int64]
    part: NDArray[np.int64]
    threads: NDArray[np.int32]
    needed: NDArray[np.int64]


class SpaceRun(NamedTuple):
    """What the classical front has made, and its account.

    Attributes
    ----------
    points : (n, 3) float64
        First those of the body, then new ones.
    cells : (m, 5) int32
        In the order in which they were made: the face, the apex, and the part of the body.
    left : (f, 3) int64
        The faces that are still at the front, since none has a valid cell; none if all is meshed.
    part : (f,) int64
        The parts of the body ahead of these.
    counts : dict of str to int
    steps : dict of str to array, optional
    spent : bool
        Whether the budget kept it from making points.
    """

    points: NDArray[np.float64]
    cells: NDArray[np.int32]
    left: NDArray[np.int64]
    part: NDArray[np.int64]
    counts: dict[str, int]
    steps: dict[str, NDArray] | None
    spent: bool


def body_faces(domain: Domain) -> BodyFaces:
    """The first front of a body: its triangles, as they are; found by exact signs. O(n log n)."""
    shell = domain.triangulated
    parts, inside, _ = parts_of_body(shell)
    rows = np.asarray(shell.triangles, dtype=np.int64)
    both = np.stack([rows, rows[:, [0, 2, 1]]], axis=1).reshape(-1, 3)
    part = np.stack([parts.front, parts.back], axis=1).ravel()
    there = inside[part]
    on = np.zeros(len(domain.points), dtype=bool)
    on[rows.ravel()] = True
    free = np.flatnonzero(~on)
    needed = free[domain.contains(domain.points[free])] if len(free) else free
    ends = np.sort(np.asarray(shell.segments, dtype=np.int64).reshape(-1, 2), axis=1)
    sides = np.sort(np.concatenate([rows[:, [0, 1]], rows[:, [1, 2]], rows[:, [2, 0]]]), axis=1)
    known = np.isin(ends[:, 0] << 32 | ends[:, 1], sides[:, 0] << 32 | sides[:, 1])
    return BodyFaces(domain.points, both[there], part[there], ends[~known].astype(np.int32), needed)


def scaled_front(body: BodyFaces) -> tuple[SpaceFront, float]:
    """The front of a body as kernels need it, and the factor of its coordinates."""
    factor = power_of_two(body.points)
    xyz = body.points * factor
    if not np.array_equal(xyz / factor, body.points):
        raise InputError(
            "the exponents of the coordinates differ too much for one scale: set those that are nearly 0 to 0"
        )
    return new_space_front(xyz, body.faces, body.part, body.needed, body.threads), factor


def marched_in_space(
    body: BodyFaces,
    field: SizeField,
    *,
    order: str = "smallest",
    search: str = "barycenter",
    history: bool = False,
    budget: int | None = None,
    progress: bool = False,
) -> SpaceRun:
    """Make cells from the boundary inward, as the source chapter tells it, until the front is empty or stuck.

    Parameters
    ----------
    body : BodyFaces
        The first front, already divided as the size wants it.
    field : SizeField
        The wanted edge length.
    order : "smallest", "shortest" or "oldest"
        The next face of the front: where the wanted length is smallest (the rule of the source chapter), the
        one with the shortest edges, or the one that has waited longest. Lengths that differ by less than
        about a percent are equal, and then the oldest face is next.
    search : "barycenter" or "ideal"
        Where candidates are searched; see `classical_steps`.
    history : bool
        Keep a record of each step.
    budget : int, optional
        The largest number of new points; 10^7 by default.
    progress : bool
        Show a bar.

    Returns
    -------
    SpaceRun
        ``steps`` has one row for each cell, in order: "face" a b c, "apex", "reason", "ideal" (the point),
        "size", "radius" (of the search), and "start": the candidates of step i are rows ``start[i]`` to
        ``start[i + 1] - 1`` of "vertex" (-1: the ideal point) and "verdict".

    Notes
    -----
    All signs that decide the topology are exact. It ends: no two points are nearer than half the ideal edges
    of a face, so that there are finitely many, and each cell takes a part of what is not meshed. Expected
    O(n log n): a step costs some searches in digital trees. Book: 3.5.
    """
    if order not in BODY_ORDERS:
        raise InputError(f"order = {order!r} must be one of {BODY_ORDERS} for the classical method")
    if search not in BODY_SEARCHES:
        raise InputError(f"search = {search!r} must be one of {tuple(BODY_SEARCHES)}")
    front, factor = scaled_front(body)
    most = len(body.points) + (DEFAULT_BUDGET if budget is None else budget)
    constant = 0.0 if field.constant is None else field.constant * factor
    nodes = _table(body.points, field, factor)
    reach, least = BODY_SEARCHES[search]
    choices = SpaceChoices(
        BODY_ORDERS.index(order), list(BODY_SEARCHES).index(search), reach, least, constant, most, nodes
    )
    waiting, counts = _waiting(front, None), np.zeros(k.MARCH_COUNTS, dtype=np.int64)
    journal = _journal(front, empty_journal(3), history, counts)
    k.start_waiting_in_space(front, choices, waiting)
    with progress_bar(progress, " tetrahedra") as bar:
        while True:
            before = int(front.state[CELLS_MADE])
            code = k.march_in_space(front, choices, waiting, journal, counts, LOOKS_A_CALL)
            bar.update(int(front.state[CELLS_MADE]) - before)
            if code in (DONE, k.NO_CELL):
                break
            if code == ROOM:
                front = larger_space_front(front)
                waiting = _waiting(front, waiting)
                journal = _journal(front, journal, history, counts)
    return _account(front, journal, counts, factor, most, history)


def _table(points: NDArray[np.float64], field: SizeField, factor: float) -> SpaceNodes:
    """The sizes for the kernels; nothing where the size is the same everywhere."""
    box = np.stack([points.min(axis=0), points.max(axis=0)])
    if field.constant is not None:
        empty = np.empty((0, 8))
        return SpaceNodes(np.empty(0, dtype=np.int32), empty, (box * factor).ravel())
    marks = field.landmarks if field.landmarks.shape[1:] == (3,) else np.empty((0, 3))
    marks = marks[((marks >= box[0]) & (marks <= box[1])).all(axis=1)]
    return space_nodes(field, box, factor, marks)


def _waiting(front: SpaceFront, old: k.SpaceWaiting | None) -> k.SpaceWaiting:
    """The queue with room for the front; ``old`` is what was in it before."""
    stuck, held, turns = np.empty(0, dtype=np.int64), np.zeros(2, dtype=np.int64), None
    if old is not None:
        turns, stuck, held = old
    rows = len(front.corner) + int(held[k.STUCK_NOW])
    turns = room_to_wait(turns, rows, len(front.xyz))
    return k.SpaceWaiting(turns, grown(stuck, len(turns.keys)), held)


def _journal(front: SpaceFront, old: Journal, history: bool, counts: NDArray[np.int64]) -> Journal:
    """The record, if one is wanted, with room for as many cells as the front has."""
    if not history:
        return old
    return larger_journal(old, len(front.made), int(counts[k.RECORDED]), len(front.xyz))


def _account(
    front: SpaceFront,
    journal: Journal,
    counts: NDArray[np.int64],
    factor: float,
    most: int,
    history: bool,
) -> SpaceRun:
    m, n = int(front.state[CELLS_MADE]), int(front.state[VERTEX_COUNT])
    alive = np.flatnonzero(front.stamp >= 0)
    alive = alive[np.argsort(front.stamp[alive])]
    named = dict(zip([*CLASSICAL_BODY_REASONS, "candidates"], counts.tolist())) | {"stuck faces": len(alive)}
    steps = None
    if history:
        steps = {"face": front.made[:m, :3].copy(), "apex": front.made[:m, 3].copy()}
        recorded = int(counts[k.RECORDED])
        steps |= columns_of(journal, m, recorded, factor, CLASSICAL_BODY_REASONS, BODY_VERDICTS)
    return SpaceRun(
        unscaled(front.xyz[:n], factor), front.made[:m].copy(), front.corner[alive].astype(np.int64),
        front.region[alive].astype(np.int64), named, steps, n >= most,
    )  # fmt: skip
