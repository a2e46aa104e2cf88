"""How far a finished mesh is from the given surface, and its feature edges from the given ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ...connect.surface.complex import Taken
from ...geometry.edge_vectors import lengths
from ...geometry.support import Support
from ...geometry.support_walk import WAITING_BOXES, nearest_from, walked
from ...geometry.triangle_tree import TriangleTree

__all__ = ["curve_deviation", "surface_deviation"]

MEASURED = 0.02  # of the length of an edge: a distance up to which walks are good enough
ALONG = (0.0, 0.25, 0.5, 0.75)  # where edges are sampled


def curve_deviation(support: Support, taken: Taken) -> float:
    """The largest distance, at samples and both ways, between the feature edges of a mesh and the given ones.

    Each curve is compared with itself. In the coordinates of the surface.
    """
    if not len(taken.edges):
        return 0.0
    worst = 0.0
    ends = taken.points[taken.edges] / support.factor
    for t in ALONG:
        x = (1.0 - t) * ends[:, 0] + t * ends[:, 1]
        away = lengths(x - support.onto_chain(x, taken.curves)[2])
        worst = max(worst, float(away.max()))
    tree = TriangleTree(ends[:, [0, 1, 1]])
    own = support.points[support.features]
    for t in ALONG:
        x = (1.0 - t) * own[:, 0] + t * own[:, 1]
        which, weights = tree.nearest(x)
        near = (ends[which][:, [0, 1, 1]] * weights[:, :, None]).sum(axis=1)
        worst = max(worst, float(lengths(x - near).max()))
    return worst


@kernel
def _farthest_walked(held, x, starts, hints, within):
    """The largest squared distance from the surface of samples in triangles, whose near places are known.

    A walk from there is good enough if it ends at no more than ``within``; the tree of boxes decides else.
    """
    place, stack, zero = np.zeros(6), np.empty(WAITING_BOXES, dtype=np.int64), np.zeros(3)
    worst = 0.0
    for t in range(hints.shape[0]):
        near = hints[t]
        last = starts[t + 1] if t + 1 < hints.shape[0] else x.shape[0]
        for q in range(starts[t], last):
            for trial in range(2):
                if trial == 0:
                    near = walked(held, x[q], zero, near, place)
                else:
                    near = nearest_from(held, x, q, zero, near, place, stack)
                square = 0.0
                for k in range(3):
                    away = x[q, k]
                    for j in range(3):
                        away -= place[j] * held.corners[near, j, k]
                    square += away * away
                if square <= within:
                    break
            worst = max(worst, square)
    return worst


@kernel
def _spread_hints(held, hints):
    """Fill in hints of -1 from triangles nearby."""
    queue, count = np.empty(hints.shape[0], dtype=np.int64), 0
    for t in range(hints.shape[0]):
        if hints[t] >= 0:
            queue[count] = t
            count += 1
    done = 0
    while done < count:
        t = queue[done]
        done += 1
        for k in range(3):
            v = held.rows[t, k]
            for i in range(held.start[v], held.start[v + 1]):
                other = held.around[i]
                if hints[other] < 0:
                    hints[other] = hints[t]
                    queue[count] = other
                    count += 1
    for t in range(hints.shape[0]):
        hints[t] = max(hints[t], 0)


def surface_deviation(
    support: Support, points: NDArray[np.float64], triangles: NDArray[np.int32], near: NDArray[np.int64]
) -> float:
    """As the larger one of `Support.deviation`, for a mesh that was made on it.

    Walks may find places that are not the nearest ones; so this is no less, but for rounding.

    Parameters
    ----------
    support : Support
    points, triangles
        The mesh.
    near : (n,) int64
        A given triangle near each point.
    """
    _, (there, starts), (back, starts_back) = support.samples(points, triangles)
    mesh = Support(points * support.factor, triangles)
    trust = (MEASURED * float(np.sqrt(_mean_square(mesh.held.corners)))) ** 2
    first = _farthest_walked(support.held, there, starts, near[triangles[:, 0]], trust)
    hints = np.full(len(support.triangles), -1, dtype=np.int64)
    hints[near[triangles[:, 0]]] = np.arange(len(triangles))
    _spread_hints(support.held, hints)
    other = mesh.factor
    second = _farthest_walked(mesh.held, back * other, starts_back, hints, trust * other * other) / other**2
    return float(np.sqrt(max(first, second))) / support.factor


def _mean_square(corners: NDArray[np.float64]) -> float:
    sides = corners[:, 1] - corners[:, 0]
    return float((sides * sides).sum()) / len(sides)
