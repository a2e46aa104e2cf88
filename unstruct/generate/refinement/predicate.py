"""Refinement by a function of the caller: `refine(..., refine_if=function)`.

The compiled loop runs until no triangle waits. Then the function is asked about all triangles that are new
since it was asked last, together; those for which it answers True wait like triangles that are too large, and
the loop goes on.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...base.jit import lean
from .account import TEXTS
from .limits import SIZE
from .run import RefineRun
from .state import BY_FUNCTION, LARGE, PRECISION, settle

__all__ = ["Predicate"]

TRIANGLES_AT_ONCE = 1 << 18  # in one call of the function, to bound its memory


@lean
def queue_all(w, tally, slots):
    """Let the triangles in these slots wait as too large."""
    for i in range(len(slots)):
        settle(w, tally, slots[i], SIZE)


class Predicate:
    """What a function has been asked about the triangles of a run, and what it wants to be refined.

    Parameters
    ----------
    function : callable
        As for `refine`.
    run : RefineRun
    numbers : array_like of int
        For each region of the run the number by which the function knows it.
    """

    def __init__(self, function: Any, run: RefineRun, numbers: Any):
        if not callable(function):
            raise InputError(f"refine_if must be a function of triangles, not {type(function).__name__}")
        self.function: Callable[..., Any] = function
        self.run, self.numbers = run, np.asarray(numbers)
        self.seen = np.full((0, 3), -1, dtype=np.int32)  # the corners of each slot when the function saw it
        self.wanted = np.zeros(0, dtype=bool)
        run.tally[BY_FUNCTION] = 1

    def ask(self) -> NDArray[np.int64]:
        """Ask about all triangles that are new; return the slots of those that it wants to be refined."""
        c = self.run.complex
        rows = c.vertex[: 3 * c.triangles].reshape(-1, 3)
        more = len(rows) - len(self.seen)
        self.seen = np.concatenate([self.seen, np.full((more, 3), -1, dtype=np.int32)])
        self.wanted = np.concatenate([self.wanted, np.zeros(more, dtype=bool)])
        slots = np.flatnonzero(c.kept() & (rows != self.seen).any(axis=1))
        answers = [
            self._answer(slots[i : i + TRIANGLES_AT_ONCE]) for i in range(0, len(slots), TRIANGLES_AT_ONCE)
        ]
        self.seen[slots] = rows[slots]
        self.wanted[slots] = np.concatenate(answers) if answers else False
        return slots[self.wanted[slots]]

    def queue(self) -> int:
        """Let the triangles wait that the function wants to be refined, and return their number."""
        slots = self.ask()
        if len(slots):
            queue_all(self.run.work(), self.run.tally, slots)
        return len(slots)

    def _answer(self, slots: NDArray[np.int64]) -> NDArray[np.bool_]:
        c = self.run.complex
        corners = c.xy[c.vertex[: 3 * c.triangles].reshape(-1, 3)[slots]]
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        with np.errstate(over="ignore", under="ignore"):  # an area may be beyond all doubles: inf, or 0
            areas = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / c.factor / c.factor
        raw = self.function(corners / c.factor, areas, self.numbers[c.region[slots]])
        answer = np.asarray(raw)
        if answer.shape != (len(slots),) or answer.dtype != np.bool_ or np.ma.isMaskedArray(raw):
            raise InputError(
                f"refine_if must return one bool for each triangle: an array of shape ({len(slots)},) and "
                f"dtype bool, not {type(raw).__name__} of shape {answer.shape} and dtype {answer.dtype}"
            )
        return answer

    def left(
        self, slots: NDArray[np.int32], reasons: NDArray[np.str_], finished: bool
    ) -> tuple[NDArray[np.int32], NDArray[np.str_], int]:
        """Unrefined slots and reasons, together with those that only the function misses; their number."""
        if not finished:
            self.ask()
        c = self.run.complex
        rows = c.vertex[: 3 * c.triangles].reshape(-1, 3)
        same = (rows == self.seen[: len(rows)]).all(axis=1)
        missed = np.flatnonzero(self.wanted[: len(rows)] & same & c.kept())
        fresh = np.setdiff1d(missed, slots).astype(np.int32)
        code = self.run.status[fresh].astype(np.int64) & 255
        why = [TEXTS.get(k, TEXTS[PRECISION]) if finished or k > LARGE else "budget" for k in code.tolist()]
        joined = np.concatenate([slots, fresh])
        words = np.concatenate([reasons.astype(object), np.array(why, dtype=object)]).astype(str)
        order = np.argsort(joined, kind="stable")
        return joined[order], words[order], len(missed)
