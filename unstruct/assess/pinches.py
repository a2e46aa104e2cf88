"""Where a mesh may be pinched because the facets of its domain meet there."""

from __future__ import annotations

import numpy as np

from ..domain.domain import Domain
from ..geometry.boxes import BoxTree, bounding_boxes
from ..geometry.inside_shell import side_mates
from ..mesh import topology
from ..mesh.grouping import group_rows
from ..mesh.mesh import Mesh
from ..predicates.batch import power_of_two
from .held import same_places

__all__ = ["OFF_ULPS", "pinch_points"]

OFF_ULPS = 64  # the most that a new vertex may be off its facet or edge, in 2^-53 of the largest coordinate


def pinch_points(mesh: Mesh, domain: Domain) -> np.ndarray:
    """Mesh vertices where four or more facets of the domain meet, so that the cells may form several fans.

    In space: on edges where four or more facets meet, also between the ends of these, up to rounding; and
    where the facets at a vertex form several fans.
    """
    if domain.dimension == 2:
        many, origin = _crowded(domain), np.asarray(mesh.origin)
    elif mesh.points.shape[1] != 3:
        return np.empty(0, dtype=np.int64)
    else:
        edges, many = _pinched(domain)
        origin = same_places(mesh.points, domain.points)  # files have no record of it
    known = (origin >= 0) & (origin < len(domain.points))
    found = known & many[np.where(known, origin, 0)]
    if domain.dimension == 3 and len(edges):
        found[_on_edges(mesh.points, domain.points, edges)] = True
    return np.nonzero(found)[0]


def _crowded(domain: Domain) -> np.ndarray:
    return np.bincount(domain.facets.ravel(), minlength=len(domain.points)) >= 4


def _pinched(domain: Domain) -> tuple[np.ndarray, np.ndarray]:
    """The edges of a body where more than two triangles meet; whether each point of it may be pinched."""
    rows = domain.triangulated.bounding
    many = np.zeros(len(domain.points), dtype=bool)
    ends = np.sort(np.concatenate([rows[:, [0, 1]], rows[:, [1, 2]], rows[:, [2, 0]]]), axis=1)
    group, _ = group_rows(ends)
    crowded = np.unique(ends[np.bincount(group, minlength=1)[group] > 2], axis=0)
    many[crowded.ravel()] = True
    # the corners at a vertex that follow each other over edges are a fan
    mates = side_mates(rows).reshape(-1, 3)
    ahead = np.full((len(rows), 3, 2), -1, dtype=np.int64)
    for k in range(3):
        for side in range(2):
            mate = mates[:, (k + 1 + side) % 3]
            there = np.flatnonzero(mate >= 0)
            other = mate[there] // 3
            ahead[there, k, side] = 3 * other + (rows[other] == rows[there, k][:, None]).argmax(axis=1)
    label = topology.components(ahead.reshape(-1, 2))[1]
    first = np.unique(label, return_index=True)[1]
    many |= np.bincount(rows.ravel()[first], minlength=len(domain.points)) > 1
    return crowded, many


def _on_edges(points: np.ndarray, given: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Points that lie on edges (e, 2) of given points, up to `OFF_ULPS`."""
    factor, off = power_of_two(given), OFF_ULPS * 2.0**-53
    x, ends = points * factor, given[edges] * factor
    low, high = bounding_boxes(ends)
    row, edge = BoxTree(low - off, high + off).pairs(x, x)
    start, along = ends[edge, 0], ends[edge, 1] - ends[edge, 0]
    away = x[row] - start
    share = (away * along).sum(axis=1) / np.maximum((along * along).sum(axis=1), 1e-300)
    foot = np.clip(share, 0.0, 1.0)[:, None] * along
    return row[np.sqrt(((away - foot) ** 2).sum(axis=1)) <= off]
