"""Narrow gaps: parts of a surface that are much nearer to each other than they are wide, and do not touch.

Cells in a gap of width d have a good shape only if the parts beside it are divided into pieces of about d. A
gap that is as wide as 1/16 of the parts and of the size is given these. In a narrower one no division is
asked for because of vertices across it, and cells whose shape it makes are left alone. A part is as wide as
the area of a facet over its longest edge; a segment and a vertex, as the widest facet there. So surfaces near
to something that is itself small, a fine hole or a rod, are divided as finely as that asks for: what is small
in two directions needs few points.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import apart, inline
from ...geometry.edge_vectors import lengths as lengths_of
from ...mesh.grouping import group_rows
from .limits import wanted_in_space
from .records import FREE_POINT
from .sharp import Sharp, feature_of, meet_sharply

__all__ = ["across_gap", "find_extents", "find_touching", "flat_in_gap", "gap_to_face", "gap_to_segment"]

BARE_SEGMENT = 1.0 / 16.0  # of its length: how wide a segment without facets is


@inline
def _near(w, f, g, square, h):
    """Whether two parts at this squared distance, where the size is h, have a narrow gap between them."""
    if w.limits.thin == 0.0 or f < 0 or g < 0 or f == g:
        return False
    reach = w.limits.thin * min(min(w.extent[f], w.extent[g]), h)
    if not square < reach * reach or meet_sharply(w.touch, f, g, 0):
        return False
    return not meet_sharply(w.sharp, f, g, w.sharp.base[2])  # facets nearly in a plane have no gap


@inline
def gap_to_face(w, v, m, out, h):
    """Whether vertex v is across a narrow gap from the face whose center and normal are in ``out``."""
    height = 0.0
    for j in range(3):
        height += (w.solid.xyz[v, j] - out[j]) * out[3 + j]
    return _near(w, feature_of(w.sharp, w.feature, v), w.sharp.base[1] + m, height * height, h)


@apart
def gap_to_segment(w, v, s, h):
    """Whether vertex v is across a narrow gap from subsegment s."""
    xyz, a, b = w.solid.xyz, w.ends[s, 0], w.ends[s, 1]
    along = square = dot = 0.0
    for j in range(3):
        u, d = xyz[v, j] - xyz[a, j], xyz[b, j] - xyz[a, j]
        square, dot, along = square + u * u, dot + u * d, along + d * d
    part = w.sharp.base[0] + w.parent[s]
    return _near(w, feature_of(w.sharp, w.feature, v), part, square - dot * dot / along, h)


@inline
def _size_at(w, t):
    """The size at the centroid of cell t."""
    x = y = z = 0.0
    for k in range(4):
        v = w.solid.vertex[4 * t + k]
        x, y, z = x + 0.25 * w.solid.xyz[v, 0], y + 0.25 * w.solid.xyz[v, 1], z + 0.25 * w.solid.xyz[v, 2]
    return wanted_in_space(w.limits, w.solid.region[t], x, y, z)


@inline
def _square(xyz, a, b):
    square = 0.0
    for j in range(3):
        square += (xyz[a, j] - xyz[b, j]) ** 2
    return square


@apart
def across_gap(w, u, v, t):
    """Whether the edge uv of cell t leads across a narrow gap."""
    f, g = feature_of(w.sharp, w.feature, u), feature_of(w.sharp, w.feature, v)
    return _near(w, f, g, _square(w.solid.xyz, u, v), _size_at(w, t))


@inline
def _off(xyz, p, q, a, b, c, d):
    """The squared distance of p and q along the normal of ab and cd."""
    ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    vx, vy, vz = xyz[d, 0] - xyz[c, 0], xyz[d, 1] - xyz[c, 1], xyz[d, 2] - xyz[c, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    dot = nx * (xyz[p, 0] - xyz[q, 0]) + ny * (xyz[p, 1] - xyz[q, 1]) + nz * (xyz[p, 2] - xyz[q, 2])
    return dot * dot / max(nx * nx + ny * ny + nz * nz, 1e-300)


@inline
def _gap(w, a, b, square, h):
    """Whether the parts of two vertices have a narrow gap of this squared width between them."""
    return _near(w, feature_of(w.sharp, w.feature, a), feature_of(w.sharp, w.feature, b), square, h)


@apart
def flat_in_gap(w, t):
    """Whether cell t is no larger than the size, but flat, since its vertices are on both sides of a gap."""
    if w.limits.thin == 0.0 or w.limits.volume[w.solid.region[t]] < np.inf:
        return False
    xyz, vertex, h, longest = w.solid.xyz, w.solid.vertex, _size_at(w, t), 0.0
    for i in range(4):
        if w.feature[vertex[4 * t + i]] == FREE_POINT:
            return False
        for j in range(i):
            longest = max(longest, _square(xyz, vertex[4 * t + i], vertex[4 * t + j]))
    if longest > 4.0 * w.limits.reach2 * h * h:
        return False
    for k in range(4):  # a vertex and a face
        a, b = vertex[4 * t + k], vertex[4 * t + (k + 1 & 3)]
        c, d = vertex[4 * t + (k + 2 & 3)], vertex[4 * t + (k + 3 & 3)]
        square = _off(xyz, a, b, b, c, b, d)
        if _gap(w, a, b, square, h) and _gap(w, a, c, square, h) and _gap(w, a, d, square, h):
            return True
    a = vertex[4 * t]
    for k in range(1, 4):  # two edges
        b = vertex[4 * t + k]
        c, d = vertex[4 * t + (2 if k == 1 else 1)], vertex[4 * t + (2 if k == 3 else 3)]
        square = _off(xyz, a, c, a, b, c, d)
        if (
            _gap(w, a, c, square, h)
            and _gap(w, a, d, square, h)
            and _gap(w, b, c, square, h)
            and _gap(w, b, d, square, h)
        ):
            return True
    return False


# ---------------------------------------------------------------------- parts


def find_touching(
    n: int,
    ends: NDArray[np.int32],
    parent: NDArray[np.int32],
    faces: NDArray[np.int32],
    mark: NDArray[np.int32],
    marks: int,
) -> Sharp:
    """For each part of the surface its vertices, as a `Sharp` has what is sharp on it.

    Parameters
    ----------
    n : int
        How many vertices there are.
    ends, parent : (k, 2) and (k,) int32
        Subsegments, and the segments that they are parts of.
    faces, mark : (f, 3) and (f,) int32
        All marked faces.
    marks : int
        How many marks there are.
    """
    segments = int(parent.max()) + 1 if len(parent) else 0
    part = np.concatenate([np.arange(n), n + np.repeat(parent, 2), n + segments + np.repeat(mark, 3)])
    item = np.concatenate([np.arange(n), ends.ravel(), faces.ravel()])
    pairs = np.unique(np.column_stack([part, item]), axis=0)
    first = np.searchsorted(pairs[:, 0], np.arange(n + segments + marks + 1))
    base = np.array([n, n + segments, 0], dtype=np.int64)
    return Sharp(first.astype(np.int64), pairs[:, 1].astype(np.int32), base)


def find_extents(
    xyz: NDArray[np.float64],
    ends: NDArray[np.int32],
    parent: NDArray[np.int32],
    faces: NDArray[np.int32],
    mark: NDArray[np.int32],
    marks: int,
) -> NDArray[np.float64]:
    """How wide the parts of the surface are, in the order of `find_touching`, whose arguments these are."""
    x = xyz[faces]
    area = 0.5 * lengths_of(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]))
    longest, total = np.zeros(marks), np.bincount(mark, area, marks)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        np.maximum.at(longest, mark, lengths_of(x[:, i] - x[:, j]))
    facet = total / np.maximum(longest, 1e-300)
    vertex = np.zeros(len(xyz))
    np.maximum.at(vertex, faces.ravel(), np.repeat(facet[mark], 3))
    segment = np.zeros(int(parent.max()) + 1 if len(parent) else 0)
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    group, _ = group_rows(np.sort(np.concatenate([ends, sides]), axis=1))
    widest = np.zeros(int(group.max(initial=-1)) + 1)
    np.maximum.at(widest, group[len(ends) :], np.tile(facet[mark], 3))
    own = widest[group[: len(ends)]]
    own = np.where(own > 0, own, BARE_SEGMENT * lengths_of(xyz[ends[:, 1]] - xyz[ends[:, 0]]))
    np.maximum.at(segment, parent, own)
    np.maximum.at(vertex, ends.ravel(), np.repeat(own, 2))
    return np.concatenate([vertex, segment, facet])
