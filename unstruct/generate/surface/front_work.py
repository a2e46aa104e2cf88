"""What a step of the front on a surface works on, the wanted length at a point, shapes of triangles."""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel, lean
from ...geometry.support_walk import WAITING_BOXES, Held
from ...sizing.space_table import SpaceNodes, size_in_space
from .front_near import Nearby
from .front_records import SurfaceFront

__all__ = [
    "BY_CANDIDATE",
    "BY_POINT",
    "BY_SEARCH",
    "FRONT_CLOSED",
    "FRONT_FULL",
    "FRONT_PAUSED",
    "FRONT_STUCK",
    "LATER_AGAIN",
    "FrontChoices",
    "FrontRun",
    "between",
    "front_run",
    "roundness",
    "wanted_at",
    "wanted_lengths",
]

BY_CANDIDATE, BY_POINT, BY_SEARCH, LATER_AGAIN, SURFACE_FRONT_COUNTS = range(5)
FRONT_CLOSED, FRONT_STUCK, FRONT_FULL, FRONT_PAUSED = range(4)
CAP_RISE = 0.4  # by distance, of the largest lengths at vertices


class FrontChoices(NamedTuple):
    """The size: a table, or a constant; the largest one at each vertex of the surface; the most vertices."""

    size: SpaceNodes
    constant: float
    cap: NDArray[np.float64]
    most: int


class FrontRun(NamedTuple):
    """All that a step needs.

    Attributes
    ----------
    front : SurfaceFront
    nearby : Nearby
    held : Held
    choices : FrontChoices
    keys, waiting : heap of the edges that wait, each as its row
    stamps : (f,) int64
        The stamp that each waiting edge had.
    x : (4, 3)
        Points that are looked for on the surface.
    place : (6,), stack
        Scratch of the search there.
    measure, candidate : (c,)
        The candidates of a step, and by what they are sorted.
    counts : (5,) int64
    many : (1,) int64
        How many edges wait.
    """

    front: SurfaceFront
    nearby: Nearby
    held: Held
    choices: FrontChoices
    keys: NDArray[np.float64]
    waiting: NDArray[np.int64]
    x: NDArray[np.float64]
    place: NDArray[np.float64]
    stack: NDArray[np.int64]
    measure: NDArray[np.float64]
    candidate: NDArray[np.int64]
    counts: NDArray[np.int64]
    many: NDArray[np.int64]


def front_run(front: SurfaceFront, nearby: Nearby, held: Held, choices: FrontChoices) -> FrontRun:
    """The scratch of a run."""
    room = 2 * len(front.stamp)
    return FrontRun(
        front,
        nearby,
        held,
        choices,
        np.empty(room),
        np.empty(room, dtype=np.int64),
        np.zeros((4, 3)),
        np.zeros(6),
        np.empty(WAITING_BOXES, dtype=np.int64),
        np.empty(len(nearby.vertex)),
        np.empty(len(nearby.vertex), dtype=np.int64),
        np.zeros(SURFACE_FRONT_COUNTS, dtype=np.int64),
        np.zeros(1, dtype=np.int64),
    )


@inline
def between(p, q):
    return sqrt((p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2)


@lean
def wanted_at(run, x, t):
    """The wanted length at a point on triangle t of the surface."""
    choices, held = run.choices, run.held
    size = choices.size
    h = choices.constant
    if h <= 0.0:
        h = size_in_space(size.child, size.values, size.box, x[0], x[1], x[2])
    for k in range(3):  # the size at the vertices, as far as it may have risen from there
        most = choices.cap[held.rows[t, k]]
        if most < h:
            h = min(h, most + CAP_RISE * between(x, held.corners[t, k]))
    return h


@kernel
def wanted_lengths(run, x, near, lengths):
    """Write the wanted lengths at points near triangles of the surface."""
    for i in range(x.shape[0]):
        lengths[i] = wanted_at(run, x[i], near[i])


@inline
def roundness(p, q, r):
    """2 r / R of a triangle in space, and its circumradius."""
    a, b, c = between(q, r), between(r, p), between(p, q)
    square = (a + b + c) * (b + c - a) * (c + a - b) * (a + b - c)
    if square <= 0.0:
        return 0.0, inf
    return square / ((a + b + c) * a * b * c), a * b * c / sqrt(square)
