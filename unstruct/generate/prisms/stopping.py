"""Whole layers left out where there is no room for all: a number of layers for each ray.

Along an edge numbers differ by at most 1. So the cells on top of a column are a pyramid where one ray has
stopped, a tetrahedron where two have, and the sides of neighbors are the same triangle (see `cells`):
the cap has no quadrilaterals. Levels only ever fall, and a wall without any layers is valid: so this ends.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .records import COLUMN, CROSSING_RAY, FULL, HIDDEN_RAY, STEP_RAY

__all__ = ["Stopped", "layers_below", "stepped", "stopped"]

SAME_HEIGHT = 1.0 + 2.0**-40  # a level that is so little too high counts
STOP_SHARE = 0.7  # of its height keeps a ray at least one layer less, where something is wrong


class Stopped(NamedTuple):
    """How many layers each ray has.

    Attributes
    ----------
    level : (r,) int32
    reason : (r,) int8
        Why there are no more: an index of `RAY_REASONS`.
    rounds : int
        How often something was lowered.
    """

    level: NDArray[np.int32]
    reason: NDArray[np.int8]
    rounds: int


def layers_below(rise: NDArray[np.float64], height: NDArray[np.float64]) -> NDArray[np.int32]:
    """How many whole layers are not higher than some heights.

    Parameters
    ----------
    rise : (1, levels + 1) or (r, levels + 1) float64
        The heights of levels.
    height : (r,) float64
    """
    return (rise[:, 1:] <= height[:, None] * SAME_HEIGHT).sum(axis=1).astype(np.int32)


def stepped(
    edges: NDArray[np.integer], level: NDArray[np.int32], reason: NDArray[np.int8]
) -> tuple[NDArray[np.int32], NDArray[np.int8]]:
    """Levels lowered until those of neighbors differ by at most 1: the largest levels for which this holds.

    Parameters
    ----------
    edges : (e, 2) int
        Pairs of rays.
    level : (r,) int32
    reason : (r,) int8

    Returns
    -------
    level, reason
        New arrays; those that were lowered have the reason `STEP_RAY`. O(e levels).
    """
    lower = level.copy()
    a, b = edges.T
    while True:
        before = lower.copy()
        np.minimum.at(lower, a, before[b] + 1)
        np.minimum.at(lower, b, before[a] + 1)
        if np.array_equal(lower, before):
            break
    return lower, np.where(lower < level, STEP_RAY, reason).astype(np.int8)


def stopped(
    rise: NDArray[np.float64],
    edges: NDArray[np.integer],
    start: tuple[NDArray[np.float64], NDArray[np.int8]],
    bad: Callable[[NDArray[np.int32]], NDArray[np.integer]],
    clash: Callable[[NDArray[np.int32]], NDArray[np.integer]],
    bar: Any = None,
) -> Stopped:
    """Levels at which all cells are positive and nothing meets.

    Parameters
    ----------
    rise : (1, levels + 1) or (r, levels + 1) float64
        The heights of levels that are wanted.
    edges : (e, 2) int
        Pairs of rays.
    start : tuple of (r,) float64 and (r,) int8
        Heights that rays cannot exceed, and why.
    bad, clash : function of levels
        Return the rays of columns with a cell that is not positive, and those that meet something. They must
        return a ray with layers as long as there is a fault.
    bar : optional
        A progress bar.
    """
    levels = rise.shape[-1] - 1
    height, reason = start
    level = layers_below(rise, height)
    reason = np.where((level == levels) & (reason != HIDDEN_RAY), FULL, reason).astype(np.int8)
    rounds = 0
    while True:
        level, reason = stepped(edges, level, reason)
        code = COLUMN
        rays = np.asarray(bad(level))
        if len(rays) == 0:
            code, rays = CROSSING_RAY, np.asarray(clash(level), dtype=np.int64)
        rays = np.unique(rays)
        rays = rays[level[rays] > 0]
        if len(rays) == 0:
            return Stopped(level, reason, rounds)
        rounds += 1
        if bar is not None:
            bar.update(1)
        at = level[rays]
        rows = np.minimum(rays, len(rise) - 1)
        below = layers_below(rise[rows], STOP_SHARE * rise[rows, at])
        level[rays], reason[rays] = np.minimum(below, at - 1), code
