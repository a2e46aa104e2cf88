"""The start of an insertion in space: the facets, subsegments and vertices of a body that has been filled."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...connect.spatial.complex import Recovered, SpatialComplex, SpatialMesh
from ...domain.domain import Domain
from ...domain.space.cutting import Shell
from ...mesh.grouping import group_rows
from ..volume.filling import chains_of_segments

__all__ = ["Surface", "find_surface", "planes_of"]

FLAT_FACET = 16.0 * 2.0**-53  # of the largest coordinate: facets that are flat up to this are one plane


class Surface(NamedTuple):
    """Subsegments and facets of a complex, by the numbers of its vertices.

    Attributes
    ----------
    ends : (k, 2) int32
        Subsegments: edges where facets end or meet, and those of inner segments.
    parent : (k,) int32
        Below the number of pieces the inner segment that each is a part of; other numbers for edges of
        facets.
    span : (k, 2) float64
        The parameters of the ends on inner segments.
    wings : tuple of arrays
        For each pair of a subsegment and a face at it: the row in ``ends``, the third vertex of the face, and
        its mark.
    faces, mark : (f, 3) and (f,) int32
        All marked faces, and their marks.
    """

    ends: NDArray[np.int32]
    parent: NDArray[np.int32]
    span: NDArray[np.float64]
    wings: tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.int32]]
    faces: NDArray[np.int32]
    mark: NDArray[np.int32]


def planes_of(shell: Shell, factor: float) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """For each triangle the first one of its plane, and for each triangle a point and the unit normal.

    The triangles of a piece that is flat up to rounding have one plane; else each has its own.

    Returns
    -------
    first : (t,) int32
    plane : (t, 6) float64
        Scaled by the factor.
    """
    x = shell.points[shell.triangles] * factor
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    area = np.linalg.norm(normal, axis=1)
    plane = np.concatenate([x[:, 0], normal / np.where(area > 0, area, 1.0)[:, None]], axis=1)
    first = np.arange(len(x), dtype=np.int32)
    if len(x) == 0:
        return first, plane
    order = np.lexsort((-area, shell.piece))
    start = np.append(True, np.diff(shell.piece[order]) != 0)
    largest = np.empty(int(shell.piece.max()) + 1, dtype=np.int64)
    largest[shell.piece[order[start]]] = order[start]
    own = largest[shell.piece]
    off = np.abs(((x - plane[own, None, :3]) * plane[own, None, 3:]).sum(axis=2)).max(axis=1)
    scale = max(float(np.abs(shell.points).max()) * factor, 1e-300)
    flat = np.ones(len(largest), dtype=bool)
    flat[shell.piece[off > FLAT_FACET * scale]] = False
    together = flat[shell.piece]
    first[together] = own[together]
    plane[together] = plane[own[together]]
    return first, plane


def find_surface(domain: Domain, found: Recovered, made: SpatialMesh, cells: SpatialComplex) -> Surface:
    """The subsegments of a complex whose marked faces carry the first triangle of their plane.

    Parameters
    ----------
    domain : Domain
    found : Recovered
        Of the recovery, which is complete.
    made : SpatialMesh
        The cells inside before anything else.
    cells : SpatialComplex
    """
    slots = np.flatnonzero(cells.used())
    marks = cells.mark[: 4 * cells.slots].reshape(-1, 4)[slots]
    across = cells.across[: 4 * cells.slots].reshape(-1, 4)[slots]
    corner = cells.vertex[: 4 * cells.slots].reshape(-1, 4)[slots]
    row, k = np.nonzero((marks >= 0) & (across > 4 * slots[:, None] + np.arange(4)))
    others = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])
    faces, number = corner[row[:, None], others[k]], marks[row, k]
    ends = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [0, 2]]]), axis=1)
    mark, far = np.tile(number, 3), np.concatenate([faces[:, 2], faces[:, 0], faces[:, 1]])
    group, first = group_rows(ends)
    count = np.bincount(group)
    least, most = np.full(len(count), np.iinfo(np.int32).max), np.full(len(count), -1)
    np.minimum.at(least, group, mark)
    np.maximum.at(most, group, mark)
    border = (count != 2) | (least != most)
    inner, piece, span = chains_of_segments(domain, found, made)
    inner = made.vertex[inner]
    keys = {tuple(sorted(ends_)) for ends_ in inner.tolist()}
    rows = np.flatnonzero(border)
    place = np.asarray(first)[rows]
    edges = ends[place]
    new = np.array([tuple(e) not in keys for e in edges.tolist()], dtype=bool)
    every = np.concatenate([inner, edges[new]]).astype(np.int32).reshape(-1, 2)
    number_of = {tuple(sorted(e)): i for i, e in enumerate(every.tolist())}
    at_border = np.flatnonzero(border[group])
    beside = np.array([number_of[tuple(e)] for e in ends[at_border].tolist()], dtype=np.int64)
    return Surface(
        every,
        np.concatenate([piece, len(domain.pieces) + np.arange(int(new.sum()))]).astype(np.int32),
        np.concatenate([span, np.tile([0.0, 1.0], (int(new.sum()), 1))]).reshape(-1, 2),
        (beside, far[at_border], mark[at_border]),
        faces,
        number,
    )
