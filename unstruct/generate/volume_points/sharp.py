"""Small angles of the input, and which parts of a surface meet at one.

A segment is *sharp* if two facets meet there at less than 60 degrees, a vertex if two subsegments do at less
than 45, or if a sharp segment ends there. Vertices on two pieces that meet at something sharp come as near to
each other as one likes, whatever is divided: so no division is asked for because of them. Facets that are
nearly in one plane, as the triangles into which a plane side of a file is cut, are treated as if they met
sharply; edges stay, and needles among them are not divided for the shape's sake. See the book, 2.8d.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import apart, inline
from ...geometry.edge_vectors import exponents, lengths
from .records import FREE_POINT, OF_DOMAIN

__all__ = ["Sharp", "feature_of", "find_sharp", "meet_sharply"]

SHARP_SEGMENT, SHARP_VERTEX = 60.0, 45.0  # degrees
NEARLY_ONE_PLANE = 1e-3  # radians
SHARP_TRIANGLE = (
    2.0  # circumradius of a triangle over its shortest edge, if its least angle is below 14.5 degrees
)
ANGLE_ROUNDING = 1e-9  # an angle of exactly 60 degrees is not sharp


class Sharp(NamedTuple):
    """For each part of the surface what is sharp on it: ``items[first[f] : first[f + 1]]``, in order.

    Parts are the vertices of the domain, the segments, and the facets, in this order. ``base`` are the
    numbers of the first segment, of the first facet, and of the first item that stands for facets in a plane.
    """

    first: NDArray[np.int64]
    items: NDArray[np.int32]
    base: NDArray[np.int64]


@inline
def feature_of(sharp, feature, v):
    """The part of the surface on which vertex v is; -1 for none."""
    f = feature[v]
    if f == OF_DOMAIN:
        return np.int64(v)
    if f == FREE_POINT:
        return np.int64(-1)
    return sharp.base[0] + f if f >= 0 else sharp.base[1] - 3 - f


@apart
def meet_sharply(sharp, f, g, least):
    """Whether two different parts have something sharp in common, with a number of ``least`` or more."""
    if f < 0 or g < 0 or f == g:
        return False
    i, last = sharp.first[f], sharp.first[f + 1]
    j, end = sharp.first[g], sharp.first[g + 1]
    while i < last and j < end:
        if sharp.items[i] == sharp.items[j] and sharp.items[i] >= least:
            return True
        if sharp.items[i] <= sharp.items[j]:
            i += 1
        else:
            j += 1
    return False


def find_sharp(
    xyz: NDArray[np.float64],
    ends: NDArray[np.int32],
    parent: NDArray[np.int32],
    wings: tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.int32]],
    marks: int,
) -> tuple[Sharp, NDArray[np.bool_], tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """What is sharp, which vertices are, and which segments and facets are of needles nearly in a plane.

    Parameters
    ----------
    xyz : (n, 3) float64
    ends, parent : (k, 2) and (k,) int32
        Subsegments, and the segments that they are parts of.
    wings : tuple of arrays
        For each pair of a subsegment and a face at it: its row, the third vertex of the face, its mark.
    marks : int
        How many marks there are.
    """
    n, row, far, mark = len(xyz), *wings
    segments = int(parent.max()) + 1 if len(parent) else 0
    narrow, flat = _narrow_segments(xyz, ends, row, far)
    sharp_vertex = _narrow_vertices(xyz, ends)
    sharp_vertex[ends[narrow].ravel()] = True
    parts, items = [np.flatnonzero(sharp_vertex)], [np.flatnonzero(sharp_vertex)]
    parts.append(n + parent[narrow].astype(np.int64))
    items.append(n + np.flatnonzero(narrow))
    for k in range(2):
        at = sharp_vertex[ends[:, k]]
        parts.append(n + parent[at].astype(np.int64))
        items.append(ends[at, k].astype(np.int64))
        at = sharp_vertex[ends[row, k]]
        parts.append(n + segments + mark[at].astype(np.int64))
        items.append(ends[row[at], k].astype(np.int64))
    at = narrow[row]
    parts.append(n + segments + mark[at].astype(np.int64))
    items.append(n + row[at])
    label = _joined(row, mark, flat, marks)
    at = label[mark] >= 0
    own = n + len(ends) + label[mark[at]]
    for part in (ends[row[at], 0], ends[row[at], 1], far[at], n + segments + mark[at]):
        parts.append(part.astype(np.int64))
        items.append(own)
    at &= flat[row]
    parts.append(n + parent[row[at]].astype(np.int64))
    items.append(n + len(ends) + label[mark[at]])
    pairs = np.unique(np.column_stack([np.concatenate(parts), np.concatenate(items)]), axis=0)
    first = np.searchsorted(pairs[:, 0], np.arange(n + segments + marks + 1))
    base = np.array([n, n + segments, n + len(ends)], dtype=np.int64)
    needles = np.zeros(marks, dtype=bool)
    at = (label[mark] >= 0) & (_quotient(xyz, ends[row, 0], ends[row, 1], far) > SHARP_TRIANGLE)
    needles[mark[at]] = True
    soft = np.unique(parent[row[flat[row] & needles[mark]]]).astype(np.int64), np.flatnonzero(needles)
    return Sharp(first.astype(np.int64), pairs[:, 1].astype(np.int32), base), sharp_vertex, soft


def _quotient(
    xyz: NDArray[np.float64], a: NDArray[np.int32], b: NDArray[np.int32], c: NDArray[np.int32]
) -> NDArray[np.float64]:
    """The circumradius of triangles over their shortest edges."""
    edges = np.stack([xyz[b] - xyz[a], xyz[c] - xyz[b], xyz[a] - xyz[c]], axis=1)
    edges = np.ldexp(edges, -exponents(edges)[:, None, None])  # products of lengths may be no doubles
    sides = np.sort(lengths(edges), axis=1)
    area = lengths(np.cross(edges[:, 0], edges[:, 1]))
    return sides[:, 1] * sides[:, 2] / (2 * np.maximum(area, 1e-300))


def _narrow_segments(
    xyz: NDArray[np.float64], ends: NDArray[np.int32], row: NDArray[np.int64], far: NDArray[np.int32]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """The subsegments where faces are at less than 60 degrees, on either side; those where two are flat."""
    result = np.zeros(len(ends), dtype=bool)
    if len(row) == 0:
        return result, result.copy()
    along = xyz[ends[:, 1]] - xyz[ends[:, 0]]
    along /= lengths(along)[:, None]
    out = xyz[far] - xyz[ends[row, 0]]
    out -= (out * along[row]).sum(axis=1)[:, None] * along[row]
    out = np.ldexp(out, -np.frexp(np.abs(out).max(axis=1, keepdims=True))[1])
    some = np.zeros((len(ends), 3))
    some[row] = out  # one direction for each subsegment from which angles are counted
    other = np.cross(along, some)
    angle = np.arctan2((out * other[row]).sum(axis=1), (out * some[row]).sum(axis=1))
    order = np.lexsort((angle, row))
    r, a = row[order], angle[order]
    count = np.bincount(r, minlength=len(ends))
    last = np.append(r[1:] != r[:-1], True)
    step = np.empty(len(a))
    step[:-1] = a[1:] - a[:-1]
    first = np.flatnonzero(np.append(True, r[1:] != r[:-1]))
    step[last] = a[first] + 2 * np.pi - a[last]
    small = (step < np.radians(SHARP_SEGMENT) - ANGLE_ROUNDING) & (count[r] > 1)
    result[r[small]] = True
    even = np.bincount(r[np.abs(step - np.pi) < NEARLY_ONE_PLANE], minlength=len(ends))
    return result, (count == 2) & (even == 2)


def _joined(
    row: NDArray[np.int64], mark: NDArray[np.int32], flat: NDArray[np.bool_], marks: int
) -> NDArray[np.int64]:
    """For each mark the least one of those that it is nearly in a plane with; -1 if there is no other."""
    label = np.arange(marks)
    at = np.flatnonzero(flat[row])
    order = at[np.argsort(row[at], kind="stable")]
    pairs = mark[order].reshape(-1, 2)
    while True:
        least = np.minimum(label[pairs[:, 0]], label[pairs[:, 1]])
        new = label.copy()
        for k in range(2):
            np.minimum.at(new, label[pairs[:, k]], least)
            np.minimum.at(new, pairs[:, k], least)
        new = new[new]
        if np.array_equal(new, label):
            break
        label = new
    alone = np.bincount(label, minlength=marks)[label] < 2
    return np.where(alone, -1, label)


def _narrow_vertices(xyz: NDArray[np.float64], ends: NDArray[np.int32]) -> NDArray[np.bool_]:
    """The vertices where two subsegments are at less than 45 degrees."""
    result = np.zeros(len(xyz), dtype=bool)
    at = np.concatenate([ends[:, 0], ends[:, 1]])
    way = xyz[np.concatenate([ends[:, 1], ends[:, 0]])] - xyz[at]
    way /= lengths(way)[:, None]
    order = np.argsort(at, kind="stable")
    at, way = at[order], way[order]
    vertex, first, count = np.unique(at, return_index=True, return_counts=True)
    least = np.cos(np.radians(SHARP_VERTEX)) + ANGLE_ROUNDING
    for degree in np.unique(count):
        if degree < 2:
            continue
        chosen = np.flatnonzero(count == degree)
        for part in np.array_split(chosen, 1 + len(chosen) * degree * degree // 1_000_000):
            rows = way[first[part][:, None] + np.arange(degree)]
            cosine = (rows[:, :, None] * rows[:, None]).sum(axis=3)
            cosine[:, np.arange(degree), np.arange(degree)] = -1.0
            result[vertex[part]] = cosine.max(axis=(1, 2)) > least
    return result
