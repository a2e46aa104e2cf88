"""The finishing pass of `voronoi_segment`: poor triangles are smoothed, and small angles are refined away.

Some passes survey all triangles; apart from these only poor triangles and their neighbors are looked at.
"""

from __future__ import annotations

from math import asin, degrees, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.codes import DONE, MORE
from ...base.jit import kernel
from ...connect.planar.complex import PlanarComplex
from ...connect.planar.stars import Stars, legalize_moved, opposite_half_edges
from ...domain.domain import Domain
from ..improve.relocation import BY_MEANS, FAIRER, ROUNDER, changed, improve, look_for, survey
from ..refinement.account import account
from ..refinement.encroachment import FREE_VERTEX, INPUT_VERTEX
from ..refinement.limits import make_limits
from ..refinement.run import Planned, RefineRun, counts_of
from ..refinement.state import REFUSALS, VERTEX_LIMIT

__all__ = [
    "PASSES", "PROMISED_ANGLE", "QUICK", "THOROUGH", "Best", "Effort", "figures", "refine_angles",
    "small_angles", "smooth_poor",
]  # fmt: skip


STARS_A_CALL = 100_000  # vertices looked at in one kernel call
# Laplace steps are tried on stars with a triangle below the fairness `NEARLY`, and afterwards a pattern
# search on stars with a triangle below the fairness `POOR`. Each of the two takes at most so many rounds.
NEARLY, LAPLACE_ROUNDS = 0.995, 3
POOR, SEARCH_ROUNDS = 0.93, 6
# In the end the smallest 2 r / R of stars is raised where it is below this bound; most triangles are above.
IMPROVED_BELOW, SHARP_ROUNDS = 0.91, 24


class Effort(NamedTuple):
    """How far smoothing goes: see the constants above. Patches are changed below the angle ``patched``."""

    poor: float
    search_rounds: int
    improved_below: float
    sharp_rounds: int
    patched: float


THOROUGH = Effort(POOR, SEARCH_ROUNDS, IMPROVED_BELOW, SHARP_ROUNDS, 60.0)
# Where a size grows by a fifth of the distance, most stars have a triangle below 0.93: to raise the least of
# each costs more than all else, and lowers the mean. This has a larger mean, and least angles that are a few
# degrees smaller.
QUICK = Effort(0.85, 2, 0.85, 4, 30.0)

PROMISED_ANGLE = 25.0  # degrees: refinement starts where an angle is smaller
WANTED_ANGLE = 26.0  # degrees: the minimum angle that this refinement asks for
# Before that, inner points are tried where an angle is below the first number, for the second one. The
# boundary is not split for it, so that edges there keep their lengths.
HOPED_ANGLE, TRIED_ANGLE = 29.5, 30.0
PASSES = 3  # of smoothing and refinement, at most
LENS = 0.25  # squared cosine: a subsegment is split where a point would see it under 120 degrees or more


class Best:
    """The best state of a complex so far, by its minimum angle. It is copied when it is about to change.

    Parameters
    ----------
    complex_ : PlanarComplex
    wanted : bool
        Whether it will be asked for.
    """

    def __init__(self, complex_: PlanarComplex, wanted: bool):
        self.complex, self.wanted = complex_, wanted
        self.angle = -1.0
        self.saved: tuple[NDArray, ...] | None = None
        self.current = wanted  # whether it is the present state

    def offer(self, angle: float) -> bool:
        """Take the present state if its minimum angle is larger; whether it is."""
        better = self.wanted and angle > self.angle
        if better:
            self.angle, self.saved, self.current = angle, None, True
        return better

    def keep(self) -> None:
        """Call this before the complex changes."""
        if self.current:
            self.saved, self.current = self.complex.saved(), False


def smooth_poor(
    complex_: PlanarComplex, given: int, since: int = 0, effort: Effort = THOROUGH
) -> tuple[int, int, NDArray[np.bool_], dict[str, float]]:
    """Move vertices of poor triangles in place. Vertices on segments and those numbered below ``given`` stay.

    ``since`` is for a mesh that was smoothed before and has since changed only by new vertices: it is the
    number of the first new one. Then only the triangles around new vertices are looked at, and only the
    pattern search is used. 0 means the whole mesh.

    Returns
    -------
    moves, swaps : int
    moved : ndarray of bool
        The vertices that have been moved, and the corners of triangles that have changed.
    before : dict of str to float
        The `figures` of the mesh before smoothing; empty with ``since``.
    """
    c = complex_
    n, count = c.size, c.triangles
    at = np.empty(n, dtype=np.int32)
    opposite_half_edges(c.vertex, c.region, count, at)
    still = at < 0
    still[:given] = True
    still[c.ends[: c.segments].ravel()] = True
    todo, moved = np.zeros(n, dtype=bool), np.zeros(n, dtype=bool)
    # A move puts two edges for each triangle of its star on the stack, and a swap adds three more: this is
    # room for all edges that may wait.
    stack, counts = np.empty(4 * len(c.mark) + 64, dtype=np.int32), np.zeros(2, dtype=np.int64)
    ring, places = np.empty(n + 8, dtype=np.int32), np.empty((n + 9, 2))
    stars = Stars(c.xy, c.vertex, c.twin, c.mark, c.where, at, still, ring, places, stack, counts)
    before: dict[str, float] = {}
    corners = c.vertex[: 3 * count].copy()
    if since:
        seen = np.arange(n) >= since
        look_for(c.xy, c.vertex, c.region, count, np.inf, seen, todo)
    else:
        before = _named(_survey(c, NEARLY, todo))
        seen = todo.copy()
        if _rounds(stars, todo, moved, NEARLY, BY_MEANS, LAPLACE_ROUNDS):
            counts[1] += legalize_moved(stars, c.region, count, moved)
        todo[:] = False
        # the other triangles have not changed: their 2 r / R is still at least NEARLY
        look_for(c.xy, c.vertex, c.region, count, effort.poor, seen | moved, todo)
    _rounds(stars, todo, moved, effort.poor, FAIRER, effort.search_rounds)
    todo[:] = False
    look_for(c.xy, c.vertex, c.region, count, effort.improved_below, seen | moved, todo)
    _rounds(stars, todo, moved, effort.improved_below, ROUNDER, effort.sharp_rounds)
    changed(corners, c.vertex, moved)
    return int(counts[0]), int(counts[1]), moved, before


def _rounds(stars: Stars, todo: NDArray, moved: NDArray, threshold: float, way: int, rounds: int) -> int:
    """Repeat `improve` until nothing moves, for at most ``rounds`` rounds, and return the number of moves."""
    n, moves = len(todo), 0
    if n <= STARS_A_CALL:
        return int(improve(stars, todo, moved, threshold, way, 0, n, rounds))
    for _ in range(rounds):
        before = moves
        for start in range(0, n, STARS_A_CALL):
            moves += improve(stars, todo, moved, threshold, way, start, min(start + STARS_A_CALL, n), 1)
        if moves == before:
            break
    return moves


def figures(complex_: PlanarComplex) -> dict[str, float]:
    """Number of triangles of the domain, minimum angle in degrees, minimum and mean 2 r / R."""
    return _named(_survey(complex_, 0.0, np.zeros(complex_.size, dtype=bool)))


def _survey(c: PlanarComplex, threshold: float, todo: NDArray[np.bool_]) -> NDArray[np.float64]:
    found = np.zeros(5)
    survey(c.xy, c.vertex, c.region, c.triangles, threshold, todo, found)
    return found


def _named(found: NDArray[np.float64]) -> dict[str, float]:
    return {
        "triangles": float(found[0]),
        "minimum angle": degrees(asin(sqrt(min(found[3], 0.75)))),
        "minimum 2r/R": float(found[2]),
        "mean 2r/R": float(found[1] / max(found[0], 1.0)),
    }


def small_angles(c: PlanarComplex, least: float) -> NDArray[np.int64]:
    """The slots of triangles with an angle below ``least`` degrees."""
    found = np.empty(c.triangles, dtype=bool)
    _sharper(c.xy, c.vertex, c.region, np.sin(np.radians(least)) ** 2, found)
    return np.flatnonzero(found)


@kernel
def _sharper(xy, vertex, region, square, found):
    """Mark the triangles of the domain with an angle whose squared sine is below ``square``."""
    for t in range(found.shape[0]):
        found[t] = False
        if region[t] < 0:
            continue
        a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
        ux, uy, vx, vy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1], xy[c, 0] - xy[a, 0], xy[c, 1] - xy[a, 1]
        wx, wy = xy[c, 0] - xy[b, 0], xy[c, 1] - xy[b, 1]
        one, two, three = ux * ux + uy * uy, vx * vx + vy * vy, wx * wx + wy * wy
        # the two longer sides enclose the least angle
        longer = one * two if three <= min(one, two) else two * three if one <= two else one * three
        double = ux * vy - uy * vx
        found[t] = double * double < square * longer


def refine_angles(
    domain: Domain,
    complex_: PlanarComplex,
    given: int,
    most: int | None,
    kept: NDArray[np.uint8],
    ceiling: int,
    allowed: NDArray[np.int64],
    wanted: float = WANTED_ANGLE,
) -> tuple[dict[str, int], list[int], list[str]]:
    """Refine the complex by Chew's second algorithm, with the minimum angle as the only goal.

    Parameters
    ----------
    domain : Domain
    complex_ : PlanarComplex
        A constrained Delaunay triangulation; it stays one.
    given : int
        Vertices from this number on may be removed.
    most : int
        Refinement stops at this number of vertices. None: at ``ceiling``, and where a piece costs too many.
    kept : ndarray of uint8
        1 for pieces that must not be split.
    ceiling : int
        Some times the vertices that the size asked for: refinement of wide exponents would not end for long.
    allowed : ndarray of int64, shape (pieces, 2)
        What the angle may still cost each piece (see `refinement.narrow`), with which the next call goes on;
        -1 at first.
    wanted : float
        The minimum angle, in degrees.

    Returns
    -------
    counts : dict of str to int
        "circumcenters", "splits" and "removed" among others.
    slots, reasons : list
        Triangles that still have a smaller angle, and why.
    """
    names = [""] * (int(complex_.region[: complex_.triangles].max(initial=-1)) + 1)
    limits = make_limits(
        names, lambda: np.concatenate(list(domain.bounds)), complex_.factor, min_angle=wanted,
        max_area=None, size=None, lens=LENS,
    )  # fmt: skip
    cuts = domain.cuts()
    planned = Planned(
        complex_, names, domain.pieces, cuts.kind, cuts.arc, domain.points_at,
        {"inputs": np.arange(len(domain.points))},
    )  # fmt: skip
    run = RefineRun(planned, limits, 0.0, most, False)
    if most is None:
        run.tally[VERTEX_LIMIT] = min(run.tally[VERTEX_LIMIT], ceiling)
    run.keep(kept)
    if (allowed >= 0).all():
        run.allowed[:] = allowed
    free = run.kind[given : complex_.size]
    free[free == INPUT_VERTEX] = FREE_VERTEX
    code = run.advance()
    while code == MORE:
        code = run.advance()
    allowed[:] = run.allowed
    slots, reasons, _ = account(run.work(), limits, planned, code == DONE, run.tally[REFUSALS] > 0)
    return counts_of(run.tally, {}), slots.tolist(), reasons.tolist()
