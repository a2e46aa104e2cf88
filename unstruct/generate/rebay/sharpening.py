"""The last step of finishing, around its kernel: which vertices may slide, and how long it may take."""

from __future__ import annotations

from math import radians, sin
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...connect.planar.complex import PlanarComplex
from ...domain.domain import Domain
from .patch import Vertices, patch_of
from .sharpest import (
    MAY_GROW,
    MOST_GRAVE,
    MOST_TRIALS,
    REPLACED,
    WAITING_AT_FIRST,
    Queue,
    sharpen,
    survey_sharp,
)

__all__ = ["SPARE_VERTICES", "sharpen_worst"]

GOAL = 46.0  # degrees: triangles with a smaller angle are treated, the sharpest first
SLIDING_GOAL = 43.0  # degrees: where one stays that is sharper (`ASKED`), vertices of the boundary slide
SPARE_VERTICES = 64  # there must be room for so many new ones, of which there are few
QUEUED = 4096  # there is room for so many in the queue
# How many changes are tried: each takes about a tenth of a millisecond. Small meshes have few, and in a large
# one the wish for a larger minimum angle must not take longer than a few percent of the rest.
FIRST_TRIALS, CELLS_A_TRIAL, ALL_TRIALS = 12, 16, 120
LEAST_TRIALS, LARGE_CELLS = 16, 2_000_000  # in a large mesh LARGE_CELLS over the number of cells
GRAVE_TRIALS, CELLS_A_GRAVE = 60, 1000  # where angles are below 40 degrees: so many more, and one for so many
PLACES = 12  # on either side of a vertex that slides, up to the share SLIDE_REACH of the way to the next one
SLIDE_REACH = 0.45  # below a half, so that vertices cannot meet


def sharpen_worst(
    domain: Domain,
    complex_: PlanarComplex,
    front: Any,
    given: int,
    kept: NDArray[np.uint8],
    grow: bool,
) -> int:
    """Make the sharpest triangles less sharp, by changes of the small patches around them.

    Parameters
    ----------
    domain : Domain
    complex_ : PlanarComplex
        Constrained Delaunay, with room for `SPARE_VERTICES`; it stays constrained Delaunay.
    front : Front
        The size, and the classes of triangles, which are kept up to date. Nothing may wait in the queue.
    given : int
        Inner vertices with smaller numbers stay where they are.
    kept : ndarray of uint8
        1 for pieces on which no vertex may slide.
    grow : bool
        Whether vertices may be added.

    Returns
    -------
    int
        The number of patches that were replaced.
    """
    c, plane = complex_, complex_.plane()
    goal, sliding_goal = (sin(radians(degrees)) ** 2 for degrees in (GOAL, SLIDING_GOAL))
    queue = Queue(
        np.empty(QUEUED), np.empty(QUEUED, dtype=np.int64), np.empty(0, dtype=np.int32),
        np.empty(0, dtype=bool), np.empty(QUEUED, dtype=np.int32),
    )  # fmt: skip
    waiting = int(survey_sharp(plane, front, queue, goal))
    if not waiting:
        return 0
    n, slots = len(c.xy), len(c.region)
    still = np.zeros(n, dtype=bool)
    still[:given] = True
    still[c.ends[: c.segments].ravel()] = True
    vertices = Vertices(
        still, _nothing(n), _nothing(n), np.empty(n, dtype=np.int32), np.empty(n, dtype=np.int32),
        np.zeros(n, dtype=bool),
    )  # fmt: skip
    queue = queue._replace(place=_nothing(slots), stuck=np.zeros(slots, dtype=bool))
    patches = patch_of(), patch_of(), patch_of()
    tally = np.zeros(8, dtype=np.int64)
    most = min(FIRST_TRIALS + c.triangles // CELLS_A_TRIAL, ALL_TRIALS)
    tally[MOST_TRIALS] = min(max(LEAST_TRIALS, LARGE_CELLS // c.triangles), most)
    tally[MOST_GRAVE] = most + GRAVE_TRIALS + c.triangles // CELLS_A_GRAVE
    tally[MAY_GROW], tally[WAITING_AT_FIRST] = grow, waiting
    sharpen(plane, front, vertices, queue, patches, np.empty((0, 1, 3)), goal, tally)
    if not vertices.asked.any():
        return int(tally[REPLACED])
    v, before, after = _sliding(c, len(domain.points), vertices.asked, kept)
    if not len(v):
        return int(tally[REPLACED])
    spots = _spots(domain, c, v, before, after)
    vertices.row[v], vertices.spot[v] = np.arange(len(v)), PLACES
    queue.stuck[:] = False
    tally[WAITING_AT_FIRST] = survey_sharp(plane, front, queue, sliding_goal)
    tally[MOST_TRIALS] *= 2
    tally[MOST_GRAVE] *= 2
    sharpen(plane, front, vertices, queue, patches, spots, sliding_goal, tally)
    return int(tally[REPLACED])


def _nothing(k: int) -> NDArray[np.int32]:
    found = np.empty(k, dtype=np.int32)
    found.fill(-1)
    return found


def _sliding(
    c: PlanarComplex, joints: int, asked: NDArray[np.bool_], kept: NDArray[np.uint8]
) -> tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.int32]]:
    """Of the vertices ``asked`` for those that may slide, and the subsegments of the piece before and after.

    They are between two subsegments of one facet that is not kept and bounds the domain on one side; they are
    no vertices of the domain (numbers below ``joints``).
    """
    s, n = c.segments, len(c.xy)
    ends, piece, where = c.ends[:s], c.piece[:s], c.where[:s].astype(np.int64)
    outer = (c.region[where // 3] < 0) != (c.region[c.twin[where] // 3] < 0)
    ours = np.flatnonzero(outer & (kept[piece] == 0) & asked[ends].any(axis=1))
    before, after, count = _nothing(n), _nothing(n), np.bincount(ends.ravel(), minlength=n)
    after[ends[ours, 0]], before[ends[ours, 1]] = ours, ours
    v = np.flatnonzero(asked & (count == 2) & (before >= 0) & (after >= 0))
    v = v[(v >= joints) & (piece[before[v]] == piece[after[v]])]
    return v, before[v], after[v]


def _spots(
    domain: Domain, c: PlanarComplex, v: NDArray, before: NDArray, after: NDArray
) -> NDArray[np.float64]:
    """For each of these vertices the places to which it may slide: x, y and parameter."""
    t, share = c.span[after, :1], np.arange(-PLACES, PLACES + 1) / PLACES * SLIDE_REACH
    way = np.where(share < 0, t - c.span[before, :1], c.span[after, 1:] - t)
    at = t + way * share
    xy = domain.points_at(np.repeat(c.piece[after], len(share)), at.ravel()) * c.factor
    spots = np.concatenate([xy.reshape(*at.shape, 2), at[..., None]], axis=-1)
    spots[:, PLACES, :2] = c.xy[v]
    return spots
