"""The finishing pass of `voronoi_segment`: poor triangles are smoothed, too small angles refined away.

Nothing here looks at good triangles more than once: what it costs follows the number of poor ones.
"""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .encroachment2 import FREE_VERTEX, INPUT_VERTEX
from .refinement_account import account
from .refinement_limits import make_limits
from .refinement_run import Planned
from .refinement_run import Run as Refinement
from .refinement_state import MORE
from .relocation2 import fill_at, improve, mark_poor, survey

if TYPE_CHECKING:
    from ..domain import Domain
    from .planar import PlanarComplex

__all__ = ["figures", "finish"]

CHUNK = 100_000  # vertices of a kernel call
# first the stars with a triangle below 0.99, by Laplace steps, then those below 0.85, by search; most rounds
ROUNDS = ((0.99, False, 5), (0.85, True, 6))
LEAST = 25.0  # degrees: what is promised
WANTED = 26.0  # and what is asked for
PASSES = 3  # of refinement and smoothing
LENS = 0.25  # squared cosine: a subsegment is split where a point would see it under 120 degrees or more


def smooth_poor(complex_: PlanarComplex, given: int) -> dict[str, int]:
    """Move vertices of poor triangles in place; those below number ``given`` and on segments stay."""
    c = complex_
    n, count = c.size, c.triangles
    at = np.full(n, -1, dtype=np.int32)
    fill_at(c.vertex, c.region, count, at)
    still = at < 0
    still[:given] = True
    still[c.ends[: c.segments].ravel()] = True
    stack, counts = c.scratch()[0], np.zeros(2, dtype=np.int64)
    for threshold, patterns, rounds in ROUNDS:
        todo = np.zeros(n, dtype=bool)
        if mark_poor(c.xy, c.vertex, c.region, count, threshold, todo) == 0:
            break
        for _ in range(rounds):
            moves = 0
            for start in range(0, n, CHUNK):
                moves += improve(
                    c.xy, c.vertex, c.twin, c.mark, c.where, at, still, todo, threshold, patterns,
                    start, min(start + CHUNK, n), stack, counts,
                )  # fmt: skip
            if moves == 0:
                break
    return {"moves": int(counts[0]), "swaps": int(counts[1])}


def figures(complex_: PlanarComplex) -> dict[str, float]:
    """Least angle in degrees, least and mean 2 r / R of the triangles of the domain."""
    c = complex_
    found = np.zeros(4)
    survey(c.xy, c.vertex, c.region, c.triangles, found)
    return {
        "triangles": found[0],
        "least angle": degrees(np.arcsin(np.sqrt(min(found[3], 0.75)))),
        "least 2r/R": found[2],
        "mean 2r/R": found[1] / max(found[0], 1),
    }


class Refiner:
    """Chew's second algorithm on the complex of a run, for the sake of the least angle alone."""

    def __init__(self, domain: Domain, complex_: PlanarComplex, given: int):
        self.domain, self.complex, self.given = domain, complex_, given
        lower, upper = domain.bounds
        parts = int(complex_.region[: complex_.triangles].max(initial=-1)) + 1
        self.names = [""] * parts
        self.limits = make_limits(
            self.names, np.concatenate([lower, upper]), complex_.factor,
            min_angle=WANTED, max_area=None, size=None, lens=LENS,
        )  # fmt: skip

    def run(self) -> tuple[dict[str, int], NDArray[np.int32], NDArray[np.str_]]:
        """Refine where an angle is below `WANTED`: what happened; slots that still miss it, and why."""
        domain, c = self.domain, self.complex
        cuts = domain.cuts()
        planned = Planned(
            c, self.names, domain.pieces, cuts.kind, cuts.arc, domain.points_at,
            {"inputs": np.arange(len(domain.points))},
        )  # fmt: skip
        run = Refinement(planned, self.limits, 0.0, 2**30, False)
        free = run.kind[self.given : c.size]
        free[free == INPUT_VERTEX] = FREE_VERTEX
        run.start()
        while run.advance() == MORE:
            pass
        slots, reasons, _ = account(run.work(), self.limits, False)
        return run.counts(), slots, reasons


def finish(
    domain: Domain, complex_: PlanarComplex, given: int
) -> tuple[dict[str, int], list[int], list[str]]:
    """Improve a mesh in place.

    Parameters
    ----------
    domain : Domain
    complex_ : PlanarComplex
        Constrained Delaunay; it stays so.
    given : int
        Vertices below this number stay where they are.

    Returns
    -------
    counts : dict of str to int
    slots, reasons : list
        Triangles with an angle below 25 degrees, and why they have it.
    """
    total = smooth_poor(complex_, given)
    slots, reasons = np.empty(0, np.int32), np.empty(0, str)
    total |= {"angle points": 0, "angle splits": 0, "removed": 0, "passes": 0}
    for _ in range(PASSES):
        if figures(complex_)["least angle"] >= LEAST:
            break
        refiner = Refiner(domain, complex_, given)
        counts, slots, reasons = refiner.run()
        total["passes"] += 1
        for name, source in (
            ("angle points", "circumcenters"),
            ("angle splits", "splits"),
            ("removed", "removed"),
        ):
            total[name] += counts[source]
        if counts["circumcenters"] + counts["splits"] == 0:
            break
        for name, number in smooth_poor(complex_, given).items():
            total[name] += number
    return total, slots.tolist(), reasons.tolist()
