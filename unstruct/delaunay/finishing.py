"""The finishing pass of `voronoi_segment`: poor triangles are smoothed, too small angles refined away.

Nothing here looks at good triangles more than once: what it costs follows the number of poor ones.
"""

from __future__ import annotations

from math import asin, degrees, sqrt
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .encroachment2 import FREE_VERTEX, INPUT_VERTEX
from .refinement_account import account
from .refinement_limits import make_limits
from .refinement_run import Planned
from .refinement_run import Run as Refinement
from .refinement_state import FINISHED, MORE, REFUSED
from .relocation2 import fill_at, improve, survey

if TYPE_CHECKING:
    from ..domain import Domain
    from .planar import PlanarComplex

__all__ = ["LEAST", "PASSES", "figures", "refine_angles", "smooth_poor"]

CHUNK = 100_000  # vertices of a kernel call
# first the stars with a triangle below 0.99, by Laplace steps, then those below 0.85, by search; most rounds
STAGES = ((0.99, False, 3), (0.85, True, 6))
AGAIN = ((0.9, True, 6),)
LEAST = 25.0  # degrees: what is promised
WANTED = 26.0  # and what is asked for
PASSES = 3  # of refinement and smoothing
LENS = 0.25  # squared cosine: a subsegment is split where a point would see it under 120 degrees or more


def smooth_poor(
    complex_: PlanarComplex, given: int, again: bool = False
) -> tuple[int, int, dict[str, float]]:
    """Move vertices of poor triangles in place; those below number ``given`` and on segments stay.

    ``again``: the mesh was smoothed before, and has changed in few places.

    Returns
    -------
    moves, swaps : int
    before : dict of str to float
        The `figures` of the mesh as it was.
    """
    c = complex_
    n, count = c.size, c.triangles
    at = np.full(n, -1, dtype=np.int32)
    fill_at(c.vertex, c.region, count, at)
    still = at < 0
    still[:given] = True
    still[c.ends[: c.segments].ravel()] = True
    # a move asks for two edges a triangle of its star, and a swap for three more: room for all that may wait
    stack, counts = np.empty(4 * len(c.mark) + 64, dtype=np.int32), np.zeros(2, dtype=np.int64)
    todo = np.zeros(n, dtype=bool)
    stages = AGAIN if again else STAGES
    found = _survey(c, stages[0][0], todo)
    for threshold, patterns, rounds in stages:
        for _ in range(rounds):
            moves = 0
            for start in range(0, n, CHUNK):
                moves += improve(
                    c.xy, c.vertex, c.twin, c.mark, c.where, at, still, todo, threshold, patterns,
                    start, min(start + CHUNK, n), stack, counts,
                )  # fmt: skip
            if moves == 0:
                break
    return int(counts[0]), int(counts[1]), _named(found)


def figures(complex_: PlanarComplex) -> dict[str, float]:
    """Number of triangles of the domain, least angle in degrees, least and mean 2 r / R."""
    return _named(_survey(complex_, 0.0, np.zeros(complex_.size, dtype=bool)))


def _survey(c: PlanarComplex, threshold: float, todo: NDArray[np.bool_]) -> NDArray[np.float64]:
    found = np.zeros(5)
    survey(c.xy, c.vertex, c.region, c.triangles, threshold, todo, found)
    return found


def _named(found: NDArray[np.float64]) -> dict[str, float]:
    return {
        "triangles": float(found[0]),
        "least angle": degrees(asin(sqrt(min(found[3], 0.75)))),
        "least 2r/R": float(found[2]),
        "mean 2r/R": float(found[1] / max(found[0], 1.0)),
    }


def refine_angles(
    domain: Domain, complex_: PlanarComplex, given: int, most: int
) -> tuple[dict[str, int], list[int], list[str]]:
    """Chew's second algorithm on the complex, for the sake of the least angle alone.

    Parameters
    ----------
    domain : Domain
    complex_ : PlanarComplex
        Constrained Delaunay; it stays so.
    given : int
        Vertices from this number on may be taken away.
    most : int
        The number of vertices at which to stop.

    Returns
    -------
    counts : dict of str to int
        "circumcenters", "splits" and "removed" among others.
    slots, reasons : list
        Triangles that still have an angle below 26 degrees, and why.
    """
    lower, upper = domain.bounds
    names = [""] * (int(complex_.region[: complex_.triangles].max(initial=-1)) + 1)
    limits = make_limits(
        names, np.concatenate([lower, upper]), complex_.factor, min_angle=WANTED, max_area=None, size=None,
        lens=LENS,
    )  # fmt: skip
    cuts = domain.cuts()
    planned = Planned(
        complex_, names, domain.pieces, cuts.kind, cuts.arc, domain.points_at,
        {"inputs": np.arange(len(domain.points))},
    )  # fmt: skip
    run = Refinement(planned, limits, 0.0, most, False)
    free = run.kind[given : complex_.size]
    free[free == INPUT_VERTEX] = FREE_VERTEX
    run.start()
    code = run.advance()
    while code == MORE:
        code = run.advance()
    slots, reasons, _ = account(run.work(), limits, code == FINISHED, run.tally[REFUSED] > 0)
    return run.counts(), slots.tolist(), reasons.tolist()
