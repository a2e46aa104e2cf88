"""Straight triangles of a refined surface are repaired: none faces the wrong way, is too far, or crosses."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...domain.given_surface import GivenSurface
from ...sizing.field import SizeField
from .intrinsic_run import IntrinsicRun
from .near_sheets import GROWN_MUCH, HELPED, KEEPINGS, MOST_TIMES, creases_near, keeping, total_area
from .straightening import MEETS_OTHERS, Faulty, Straight, faulty, straightened, too_far

__all__ = ["Repaired", "Wanted", "repaired"]

REPAIRS = 15  # rounds of halving edges where straight triangles are no surface, or too far away


class Wanted(NamedTuple):
    """What triangles should be like.

    Attributes
    ----------
    size : SizeField, optional
    angle : float
        The least one, in degrees.
    near : float, optional
        The largest distance from the surface.
    sharp : float, optional
        The angle of creases.
    budget : int
        The most vertices.
    """

    size: SizeField | None
    angle: float
    near: float | None
    sharp: float | None
    budget: int


class Repaired(NamedTuple):
    """The triangles, and what is still wrong with them.

    Attributes
    ----------
    run : IntrinsicRun
    straight : Straight
    wrong : Faulty
    far : (k,) int64
        Triangles that are too far from the surface.
    measured : float
        The largest distance.
    vain : bool
        Whether triangles meet, and halving their edges does not help, or was not tried.
    """

    run: IntrinsicRun
    straight: Straight
    wrong: Faulty
    far: NDArray[np.int64]
    measured: float
    vain: bool

    @property
    def meeting(self) -> NDArray[np.float64]:
        """The corners of the triangles that meet others, in scaled coordinates: (k, 3, 3)."""
        rows = self.wrong.triangles[: None if self.wrong.text == MEETS_OTHERS else 0]
        points = self.straight.points * self.run.found.factor
        return points[self.straight.triangles[rows]].reshape(-1, 3, 3)


def repaired(given: GivenSurface, wanted: Wanted, bar: Any) -> Repaired:
    """Refine, straighten, and halve edges until the straight triangles are right.

    Where triangles meet, and halving does not help since parts of the surface are too near each other, given
    edges are kept instead. If neither helps, triangles are left that meet.
    """
    found = _once(given, wanted, bar, True)
    if not found.vain:
        return found
    plain = _once(given, wanted, bar, False)
    room = MOST_TIMES * (len(plain.straight.points) + len(given.support.points))
    limited, kept = wanted._replace(budget=min(room, wanted.budget)), given
    meeting = np.concatenate([plain.meeting, found.meeting])
    for times in range(KEEPINGS):
        other = keeping(kept, creases_near(kept.support, meeting, times), wanted.sharp)
        if len(other.support.features) == len(kept.support.features):
            break
        found, kept = _once(other, limited, bar, True), other
        if found.run.out_of_budget:
            return plain
        if not found.vain:
            return found
        meeting = found.meeting
    if kept is given:
        return plain
    found = _once(kept, limited, bar, False)
    better = not found.run.out_of_budget and total_area(found.meeting) < total_area(plain.meeting)
    return found if better else plain


def _once(given: GivenSurface, wanted: Wanted, bar: Any, halving: bool) -> Repaired:
    """The same without keeping edges; with ``halving``, edges of triangles that meet are halved."""
    rows = given.support.held.rows.astype(np.int32)
    run = IntrinsicRun(given, rows, wanted.size, wanted.angle, wanted.budget, bar)
    run.refine()
    early, areas, near, first = run.out_of_budget, [], wanted.near, 0
    for tries in range(REPAIRS + 1):
        straight, measured = straightened(run), -1.0
        wrong, far = faulty(run, straight), np.empty(0, dtype=np.int64)
        meets = wrong.text == MEETS_OTHERS
        left = not wrong.text or (meets and not halving)  # nothing is to be halved
        if left and near is not None:
            far, excess, measured = too_far(run, straight, near)
        if run.out_of_budget or tries == REPAIRS:
            break
        if meets and halving:
            corners = straight.points[straight.triangles[wrong.triangles]]
            areas.append(total_area(corners * run.found.factor))
            first = first or len(straight.triangles)
            if len(areas) > 2 and areas[-1] > HELPED * areas[-3]:
                break
            if len(straight.triangles) > GROWN_MUCH * first:
                break
        if len(far):
            run.want_less(far, excess)
        elif left or run.divide(wrong.sides) == 0:
            break
        run.refine()
    if measured < 0.0:
        measured = max(given.support.deviation(straight.points, straight.triangles))
    return Repaired(run, straight, wrong, far, measured, meets and not early)
