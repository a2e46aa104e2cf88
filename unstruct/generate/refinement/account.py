"""The triangles that miss a limit after refinement, and the reason for each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.elementary import turns
from ...base.jit import lean
from ...connect.insertion.engine import COUNT
from .encroachment import STRAIGHT, across_small_angle
from .limits import ANGLE, PLAUSIBLE, Limits, misses
from .run import Planned
from .state import (
    CIRCUMCENTERS,
    CURVE,
    FLOOR,
    KEPT,
    LARGE,
    NARROW,
    PRECISION,
    REJECTED,
    REMOVED,
    SMALL_ANGLE,
    SPLITS,
    Work,
)
from .steps import shortest_first

__all__ = ["account", "history_of", "survey_missed", "told"]

TEXTS = {
    KEPT: "kept: only a vertex on a piece that must not be split would help",
    FLOOR: "too near: the angle would need edges shorter than a thousandth of the input's, or near rounding",
    NARROW: "narrow: a gap or wedge this long and thin would take very many triangles; a budget allows them",
    PRECISION: "precision: the needed point cannot be told from its neighbors in doubles",
    CURVE: "curve: a split of a curve would meet another piece or vertex",
}
STEEP = f"too near: an angle above {PLAUSIBLE:g}° would need edges shorter than half of those nearby"
TANGENT_STEP = 2.0**-13  # of the parameter of a curve, for its tangent at an end
MISSES = ("angle", "area", "size")
NOTHING, NO_SLOTS, NO_WORDS = np.empty((0, 8), dtype=np.int64), np.empty(0, dtype=np.int32), np.full(0, "")
EVENT_NAMES = {CIRCUMCENTERS: "circumcenter", SPLITS: "split", REJECTED: "rejected", REMOVED: "removed"}


@lean
def survey_missed(w, limits, found):
    """Write rows on the triangles that miss a limit into ``found``; return their number.

    A row has the slot, the limits that are missed (bits), the apex of a small input angle or -1, the ends of
    the shortest edge, why the triangle was given up, and the pieces that make the angle.
    """
    count = 0
    for t in range(w.state[COUNT]):
        r = w.region[t]
        if r < 0:
            continue
        a, b, c = shortest_first(w.xy, w.vertex, t)
        bits = misses(w.xy, a, b, c, r, limits)
        if bits == 0:
            continue
        if count < len(found):
            found[count, 0], found[count, 1], found[count, 2] = t, bits, -1
            found[count, 3], found[count, 4], found[count, 5] = a, b, w.status[t] & 255
            if bits == ANGLE:
                apex = across_small_angle(w.xy, w.kind, w.joints, a, b)
                found[count, 6], found[count, 7] = w.kind[a], w.kind[b]
                e = 3 * t
                while w.vertex[e] != c:
                    e += 1
                n, p = (e - 2 if e % 3 == 2 else e + 1), (e + 2 if e % 3 == 0 else e - 1)
                if apex < 0 and w.mark[n] >= 0 and w.mark[p] >= 0:
                    apex = c  # the minimum angle of the triangle lies between two subsegments
                    found[count, 6], found[count, 7] = w.piece[w.mark[p]], w.piece[w.mark[n]]
                found[count, 2] = apex
        count += 1
    return count


def account(
    w: Work, limits: Limits, planned: Planned, finished: bool, given_up: bool
) -> tuple[NDArray[np.int32], NDArray[np.str_], dict[str, int]]:
    """Slots of triangles that miss a limit, the reason for each, and the number that miss each limit.

    Parameters
    ----------
    w, limits : Work, Limits
        As the kernels use them.
    planned : Planned
        The pieces, for the angles between them.
    finished : bool
        Whether the run came to its end. If not, the budget is the reason where no other is known.
    given_up : bool
        Whether the run ever gave up a triangle. If not, and if it is finished, no triangle misses a limit:
        each one was looked at when it was made, and waited until it was replaced.

    Returns
    -------
    slots : ndarray of int32, shape (k,)
    reasons : ndarray of str, shape (k,)
    missed : dict of str to int
    """
    count = 0 if finished and not given_up else survey_missed(w, limits, NOTHING)
    if count == 0:
        return NO_SLOTS, NO_WORDS, dict.fromkeys(MISSES, 0)
    found = np.empty((count, 8), dtype=np.int64)
    survey_missed(w, limits, found)
    return told(found, w.xy, limits, planned, finished)


def told(
    found: NDArray[np.int64], xy: NDArray[np.float64], limits: Limits, planned: Planned, finished: bool
) -> tuple[NDArray[np.int32], NDArray[np.str_], dict[str, int]]:
    """`account` for the rows that `survey_missed` has found; the slots are as in the rows."""
    if len(found) == 0:
        return NO_SLOTS, NO_WORDS, dict.fromkeys(MISSES, 0)
    slot, bits, apex, a, b, why, p, q = found.T
    why[apex >= 0] = SMALL_ANGLE
    reasons = np.full(len(slot), TEXTS[PRECISION], dtype=object)
    for code, text in TEXTS.items():
        reasons[why == code] = text
    if limits.growth > 0.0:
        reasons[why == FLOOR] = STEEP
    if not finished:
        reasons[why <= LARGE] = "budget"
    rows = np.flatnonzero(apex >= 0)
    u = _directions(xy, planned, p[rows], apex[rows], a[rows])
    v = _directions(xy, planned, q[rows], apex[rows], b[rows])
    turn = np.abs(turns(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], (u * v).sum(axis=1)))
    reasons[rows] = [f"input angle {x:.3g}°" for x in np.degrees(turn)]
    missed = {name: int(((bits & (1 << k)) > 0).sum()) for k, name in enumerate(MISSES)}
    return slot.astype(np.int32), reasons.astype(str), missed


def _directions(
    xy: NDArray[np.float64], planned: Planned, piece: NDArray[np.int64], apex: NDArray[np.int64],
    far: NDArray[np.int64],
) -> NDArray[np.float64]:  # fmt: skip
    """The directions of pieces at their end ``apex``: the true tangents of curves.

    Elsewhere, and on straight pieces, it is the direction to the vertex ``far``.
    """
    u = xy[far] - xy[apex]
    first, last = planned.joints[piece].T == apex
    rows = np.flatnonzero((first != last) & (planned.curve[piece] != STRAIGHT))
    if len(rows):  # the derivative by three points
        k, begin, step = (
            piece[rows],
            np.where(first[rows], 0.0, 1.0),
            np.where(first[rows], TANGENT_STEP, -TANGENT_STEP),
        )
        x0, x1, x2 = (planned.at(k, begin + i * step) for i in range(3))
        u[rows] = 4.0 * (x1 - x0) - (x2 - x0)
    return u


def history_of(w: Work, count: int) -> dict[str, NDArray]:
    """The record of a run as named arrays; the caller has to divide "place" by the factor of coordinates."""
    event = w.event[:count]
    kind = (
        np.array([EVENT_NAMES[int(k)] for k in event[:, 0]], dtype=str) if count else np.empty(0, dtype="U12")
    )
    return {
        "kind": kind,
        "vertex": event[:, 1].copy(),
        "cause": event[:, 2:].copy(),
        "place": w.place[:count].copy(),
    }
