"""The wanted lengths of a front on a surface: what is asked for, and what the surface itself allows.

A front can close only where triangles of its size can follow the surface. So two bounds are there: a
component without curves, such as a ball, gets triangles that are small enough to go around it, always; and if
a front with the lengths that were asked for has failed, the lengths are lowered where the surface turns by
more than an angle within one of them, and rise from there only gradually.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ...geometry.support import Support
from ...geometry.support_features import side_groups, united

__all__ = ["caps_of", "parts_of"]

AROUND_COMPONENT = 0.25  # of the diagonal of its box: the largest length on a component without curves
GROWTH_OF_CAPS = 0.4  # by distance


def parts_of(rows: NDArray[np.int64], n: int) -> NDArray[np.int64]:
    """The component of each vertex, connected over triangles."""
    parent = np.arange(n)
    united(rows[:, 0], rows[:, 1], parent)
    united(rows[:, 1], rows[:, 2], parent)
    return parent


def caps_of(support: Support, part: NDArray[np.int64], turn: float) -> NDArray[np.float64]:
    """The largest length at each vertex of the surface, scaled: (n,).

    Parameters
    ----------
    turn : float
        The angle, in radians, by which the surface may turn within that length; infinite for any.
    """
    xyz, own = support.points * support.factor, support.held.rows
    cap = np.full(len(xyz), np.inf)
    curved = np.zeros(len(xyz), dtype=bool)
    curved[part[support.features.ravel()]] = True
    low, high = np.full((len(xyz), 3), np.inf), np.full((len(xyz), 3), -np.inf)
    np.minimum.at(low, part[own.ravel()], xyz[own.ravel()])
    np.maximum.at(high, part[own.ravel()], xyz[own.ravel()])
    around = high - low
    diagonal = AROUND_COMPONENT * np.sqrt(
        np.maximum(around[:, 0], 0.0) ** 2 + around[:, 1] ** 2 + around[:, 2] ** 2
    )
    bare = ~curved[part]
    cap[bare] = diagonal[part[bare]]
    if np.isfinite(turn):
        _lowered(support, xyz, cap, turn)
        rows = own[(own != own[:, [1, 2, 0]]).all(axis=1)]
        ends = np.concatenate([rows[:, [0, 1]], rows[:, [1, 2]], rows[:, [2, 0]]])
        away = xyz[ends[:, 1]] - xyz[ends[:, 0]]
        length = np.sqrt(away[:, 0] ** 2 + away[:, 1] ** 2 + away[:, 2] ** 2)
        _graded(ends, length, cap)
    return cap


def _lowered(support: Support, xyz: np.ndarray, cap: np.ndarray, turn: float) -> None:
    """Lower the caps at the vertices of triangles between which the surface turns, but at its curves."""
    own = support.held.rows
    place, _, size = side_groups(own)
    first = np.cumsum(size) - size
    pairs = np.flatnonzero(size == 2)
    one, two = place[first[pairs]] // 3, place[first[pairs] + 1] // 3
    ends = np.stack([own, own[:, [1, 2, 0]]], axis=2).reshape(-1, 2)[place[first[pairs]]]
    n = len(xyz)
    known = np.sort(support.features, axis=1)
    free = ~np.isin(ends.min(axis=1) * n + ends.max(axis=1), known[:, 0] * n + known[:, 1])
    u, v = support.normals[one], support.normals[two]
    free &= (u != 0.0).any(axis=1) & (v != 0.0).any(axis=1)
    one, two = one[free], two[free]
    chord = support.normals[one] - support.normals[two]
    angle = np.sqrt(chord[:, 0] ** 2 + chord[:, 1] ** 2 + chord[:, 2] ** 2)  # its double sine of the half
    away = xyz[own[one]].mean(axis=1) - xyz[own[two]].mean(axis=1)
    apart = np.sqrt(away[:, 0] ** 2 + away[:, 1] ** 2 + away[:, 2] ** 2)
    least = turn * apart / np.maximum(angle, 1e-12)
    for t in (one, two):
        for k in range(3):
            np.minimum.at(cap, own[t, k], least)


@kernel
def _graded(ends, length, cap):
    """Lower caps until none is larger than at a neighbor by more than the growth allows."""
    lowered = True
    while lowered:
        lowered = False
        for i in range(ends.shape[0]):
            u, v = ends[i, 0], ends[i, 1]
            most = GROWTH_OF_CAPS * length[i]
            if cap[u] > cap[v] + most:
                cap[u] = cap[v] + most
                lowered = True
            elif cap[v] > cap[u] + most:
                cap[v] = cap[u] + most
                lowered = True
