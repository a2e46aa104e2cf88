"""Sides of a body that lie in planes of the lattice: there leaves may be hexahedra up to the side.

A facet at which one coordinate is constant may lie in the faces of leaves. Where it covers the whole face of
a leaf, the leaf may end there. See the book, chapter 4c.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...domain.domain import Domain
from ...geometry.box_contact import pieces_in_boxes
from ...geometry.boxes import BoxTree, bounding_boxes
from ...geometry.parity import even_odd
from ...predicates.batch import power_of_two
from ..bodies.patches import shapes_of
from ..tree.cells import TreeCells

__all__ = ["NO_AXIS", "Planes", "faces_in_planes", "pieces_at", "planes_of"]

Array = NDArray[np.float64]
NO_AXIS = -1  # of pieces at which no coordinate is constant, and of those that are kept as they are
FAR_PLANE = 0.5  # sides of a leaf from it to a plane of the lattice between which there is another leaf


class Planes(NamedTuple):
    """For each piece the axis across which it lies in a plane, (p,) int64, and where, (p,) float64."""

    axis: NDArray[np.int64]
    at: Array

    def passed(self, piece: NDArray[np.int64], low: Array, high: Array) -> NDArray[np.bool_]:
        """Which pieces are in a plane in which the box beside them has a face, or that is farther away.

        Parameters
        ----------
        piece : (q,) int64
        low, high : (q, 3) float64
            The corners of a leaf for each.
        """
        axis, at = self.axis[piece], self.at[piece]
        rows = np.arange(len(piece))
        first, last = low[rows, axis], high[rows, axis]
        room = FAR_PLANE * (last - first)
        return (axis != NO_AXIS) & ((at == first) | (at == last) | (at <= first - room) | (at >= last + room))

    def groups(self) -> Iterator[tuple[int, float, NDArray[np.int64]]]:
        """The planes: axis, place, and the pieces there, in order."""
        known = np.flatnonzero(self.axis != NO_AXIS)
        keys, inverse = np.unique(
            np.column_stack([self.axis[known], self.at[known]]), axis=0, return_inverse=True
        )
        order = np.argsort(inverse.ravel(), kind="stable")
        start = np.searchsorted(inverse.ravel()[order], np.arange(len(keys) + 1))
        for k, (axis, at) in enumerate(keys.tolist()):
            yield int(axis), at, known[order[start[k] : start[k + 1]]]


def planes_of(tree: TreeCells, split_boundary: bool | None, walls: bool) -> Planes:
    """The planes with faces of leaves of facets that may be divided, and, with `walls`, of inner facets.

    Parameters
    ----------
    tree : TreeCells
        An octree over a domain.
    split_boundary : bool or None
        See `Tree.mesh`.
    """
    domain = tree.domain
    pieces = domain.pieces
    many = len(pieces)
    axis, at = np.full(many, NO_AXIS), np.zeros(many)
    may = pieces.corners >= 3
    if split_boundary is None:
        may &= shapes_of(domain)
    if not walls:
        may[len(domain.facets) :] = False
    if split_boundary is False or not may.any():
        return Planes(axis, at)
    owner = np.repeat(np.arange(many), pieces.corners)
    x = domain.points[pieces.vertices]
    low, high = np.full((many, 3), np.inf), np.full((many, 3), -np.inf)
    np.minimum.at(low, owner, x)
    np.maximum.at(high, owner, x)
    flat = (low == high) & may[:, None]
    one = flat.sum(axis=1) == 1
    axis[one] = flat[one].argmax(axis=1)
    at[one] = low[one, axis[one]]
    for a in range(3):
        mine = np.flatnonzero(axis == a)
        known = np.unique(np.concatenate([corner[:, a] for corner in tree.corners]))
        axis[mine[~np.isin(at[mine], known)]] = NO_AXIS
    return Planes(axis, at)


def faces_in_planes(
    tree: TreeCells, domain: Domain, planes: Planes, chosen: NDArray[np.bool_]
) -> tuple[NDArray[np.int8], NDArray[np.bool_]]:
    """The faces of chosen leaves that facets in planes cover, as bits, and leaves with faces partly covered.

    Both (n,), exact.
    """
    bits, partly = np.zeros(len(tree), dtype=np.int8), np.zeros(len(tree), dtype=bool)
    ends, owner = domain.pieces.sides
    order = np.argsort(owner, kind="stable")
    start = np.searchsorted(owner[order], np.arange(len(domain.pieces) + 1))
    factor = power_of_two(np.concatenate([domain.points, tree.box]))
    points = domain.points * factor
    for axis, at, pieces in planes.groups():
        sides = [ends[order[start[p] : start[p + 1]]] for p in pieces.tolist()]
        facets = [rows for rows, p in zip(sides, pieces.tolist(), strict=True) if p < len(domain.facets)]
        view = [(axis + 1) % 3, (axis + 2) % 3]
        flat, edges = np.ascontiguousarray(points[:, view]), np.concatenate(sides).astype(np.int64)
        boxes = BoxTree(*bounding_boxes(flat[edges]))
        for upper, corner in enumerate(tree.corners):
            leaf = np.flatnonzero(chosen & (corner[:, axis] == at))
            low, high = (np.ascontiguousarray(end[leaf][:, view] * factor) for end in tree.corners)
            query, hit = boxes.pairs(low, high)
            meets = pieces_in_boxes(flat, edges, hit, low[query], high[query])
            partly[leaf[query[meets]]] = True
            if facets:
                odd, _ = even_odd(flat, np.concatenate(facets).astype(np.int64), low + 0.5 * (high - low))
                bits[leaf[odd]] |= np.int8(1 << (2 * axis + upper))
    bits[partly] = 0
    return bits, partly


def pieces_at(domain: Domain, planes: Planes, x: Array, rows: NDArray[np.integer]) -> NDArray[np.int64]:
    """The piece in whose plane and outline each face lies; -1 for none.

    Parameters
    ----------
    domain : Domain
    planes : Planes
    x : (v, 3) float64
    rows : (f, w) int
        Faces that no outline crosses, padded by -1.
    """
    found = np.full(len(rows), -1, dtype=np.int64)
    used = rows >= 0
    corner = x[np.where(used, rows, rows[:, :1])]
    low, high = corner.min(axis=1), corner.max(axis=1)
    middle = low + 0.5 * (high - low)
    triangle = ~used[:, -1] if rows.shape[1] > 3 else np.ones(len(rows), dtype=bool)
    middle[triangle] = corner[triangle, :3].sum(axis=1) / 3.0
    ends, owner = domain.pieces.sides
    order = np.argsort(owner, kind="stable")
    start = np.searchsorted(owner[order], np.arange(len(domain.pieces) + 1))
    factor = power_of_two(np.concatenate([domain.points, x]))
    for axis, at, pieces in planes.groups():
        here = np.flatnonzero((low[:, axis] == at) & (high[:, axis] == at))
        view = [(axis + 1) % 3, (axis + 2) % 3]
        flat = np.ascontiguousarray(domain.points[:, view] * factor)
        q = np.ascontiguousarray(middle[here][:, view] * factor)
        for p in pieces.tolist():
            edges = ends[order[start[p] : start[p + 1]]].astype(np.int64)
            first, last = flat[edges].reshape(-1, 2).min(axis=0), flat[edges].reshape(-1, 2).max(axis=0)
            near = np.flatnonzero(((q >= first) & (q <= last)).all(axis=1))
            found[here[near[even_odd(flat, edges, q[near])[0]]]] = p
    return found
