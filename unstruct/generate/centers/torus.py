"""Circumcenter insertion without a boundary, on the unit torus.

There the three relations of the book's chapter 2.6a between circumradii and edge lengths are valid without
exception. This is the purpose of this module.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arguments import as_count, as_flags
from ...base.codes import MORE, ROUNDED
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...connect.insertion.engine import COUNT, grown
from ...connect.insertion.halfedges import VERTICES
from ...sizing import as_size
from .periodic import PeriodicMesh, half_edge_twins, periodic_delaunay
from .torus_steps import Torus, TorusScratch, enter_all, insert_on_torus
from .worst import CENTERS_A_CALL, Contest, Rule, make_rule

__all__ = ["periodic_circumcenters"]

MOST_ON_TORUS = 10_000_000  # the default budget of insertions


def periodic_circumcenters(
    points: ArrayLike,
    size: Any = None,
    *,
    priority: Any = None,
    limit: float | None = None,
    budget: int | None = None,
    history: bool = False,
    progress: bool = False,
) -> PeriodicMesh:
    """Insert the circumcenter of the worst triangle, again and again, on the unit torus, without a boundary.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        The first points, taken modulo 1. Every disk of radius 1/4 must contain one of them.
    size : float or function of points (k, 2), optional
        The wanted edge length h: a triangle is bad if sqrt(3) R >= h(Q), Q being its circumcenter modulo 1.
    priority, limit, budget, history, progress : optional
        As for `circumcenter_insertion`; without a budget at most 10^7 points are inserted.

    Returns
    -------
    PeriodicMesh
        ``points`` are the first points, then the inserted ones in order, so that the first so many of them
        are the points of a state. With ``history`` its ``steps`` are as those of `circumcenter_insertion`.

    Notes
    -----
    Each insertion replaces a cavity of O(1) triangles on average; the worst one is found in O(log m).
    With the priority "circumradius", R_n never increases and l_n = min(l_0, R_0, ..., R_{n-1}), up to the
    rounding of a circumcenter to a multiple of 2^-50. Book: 2.6a.
    """
    as_flags(history=history, progress=progress)
    start = periodic_delaunay(points)
    field = None if size is None else _wrapped(size)
    if priority is not None and not isinstance(priority, str):
        priority = _wrapped(priority)
    rule = make_rule(field, priority, limit, ([-0.5, -0.5], [1.5, 1.5]))
    most = MOST_ON_TORUS if budget is None else as_count(budget, "budget")
    if size is None and limit is None and budget is None:
        raise InputError("without a size or a limit every triangle is bad: give a size, a limit or a budget")
    run = TorusRun(start, rule, history)
    end = run.advance(len(start.points) + most, progress)
    return run.result(end)


def _wrapped(size: Any) -> Any:
    """A size on the unit square, continued periodically."""
    field = as_size(size)
    return field if field.constant is not None else as_size(lambda x: field(x - np.floor(x)))


class TorusRun(Contest):
    """The arrays of a run on the torus."""

    def __init__(self, start: PeriodicMesh, rule: Rule, history: bool):
        n = len(start.points)
        super().__init__(rule, history)
        self.first = n
        self.xy, self.vertex = start.points.copy(), start.simplices.ravel().copy()
        self.shift = start.shifts.reshape(-1, 2).copy()
        twin = half_edge_twins(start.simplices, start.shifts)
        assert twin is not None  # a mesh of the torus has no boundary
        self.twin = twin
        self.state = np.zeros(16, dtype=np.int64)
        self.state[COUNT], self.state[VERTICES] = 2 * n, n
        self._reserve(2 * n)
        enter_all(self._torus(), self.entries())

    def _torus(self) -> Torus:
        return Torus(self.xy, self.vertex, self.twin, self.shift, self.state)

    def _reserve(self, points: int) -> None:
        self.xy = grown(self.xy, points)
        slots = 2 * len(self.xy)
        self.vertex, self.twin, self.shift = (
            grown(a, 3 * slots) for a in (self.vertex, self.twin, self.shift)
        )
        self.make_room(slots, len(self.xy))

    def advance(self, last: int, progress: bool) -> int:
        """Insert points until no triangle is bad or there are ``last`` vertices; return how it ended."""
        end = MORE
        bar = progress_bar(progress, " points")
        while end == MORE and self.state[VERTICES] < last:
            before = int(self.state[VERTICES])
            stop = min(before + CENTERS_A_CALL, last)
            self._reserve(stop)
            room = 2 * len(self.xy) + 8
            stack, spare, fresh = (np.empty(room, dtype=np.int32) for _ in range(3))
            frame = np.empty((room, 2), dtype=np.int32)
            scratch = TorusScratch(stack, frame, spare, fresh)
            end = int(insert_on_torus(self._torus(), scratch, self.entries(), stop))
            bar.update(int(self.state[VERTICES]) - before)
        bar.close()
        return end

    def result(self, end: int) -> PeriodicMesh:
        n, m = int(self.state[VERTICES]), int(self.state[COUNT])
        simplices, neighbors = (a[: 3 * m].reshape(-1, 3) for a in (self.vertex, self.twin // 3))
        bad = np.flatnonzero(self.waiting(m))
        reason = "rounding puts a circumcenter out of its circle" if end == ROUNDED else "budget"
        steps: dict[str, NDArray] | None = None
        if len(self.watch):
            steps = {
                **self.story(self.first, n, 1.0),
                "vertex": np.arange(self.first, n, dtype=np.int32),
                "triangle": self.events[self.first : n, 2:].astype(np.int32),
            }
        return PeriodicMesh(
            self.xy[:n], simplices.copy(), self.shift[: 3 * m].reshape(-1, 3, 2), neighbors.copy(),
            unrefined=bad, reason=reason, counts={"circumcenters": n - self.first}, steps=steps,
        )  # fmt: skip
