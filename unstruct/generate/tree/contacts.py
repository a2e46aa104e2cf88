"""Which nodes of a tree the boundary of a domain meets, and which lie inside or outside: exactly, from above.

Pieces of the boundary are handed down from a node to those of its children whose inside they meet. A node
that no piece meets lies inside or outside as a whole, as do all nodes below it; one exact test of its center
decides. See the book, chapter 4a.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import frozen
from ...geometry.box_contact import pieces_in_boxes
from ...predicates.batch import power_of_two

__all__ = [
    "ALL_INSIDE",
    "ALL_OUTSIDE",
    "CUT",
    "Boundary",
    "Contacts",
    "at_root",
    "boundary_of",
    "handed_down",
]

ALL_OUTSIDE, CUT, ALL_INSIDE = -1, 0, 1


class Boundary(NamedTuple):
    """Segments or triangles that bound a domain, and the test of points that they do not touch.

    Attributes
    ----------
    points : (n, d) float64
        Divided by `unit`, so that they are of magnitude up to 1.
    pieces : (m, d) int64
    factor : float
        The power of two by which coordinates are multiplied.
    contains : callable
        Points (k, d) in the units of the domain -> whether they lie inside (k,).
    deviation : float
        How far chords may be from the curves that they stand for; 0 if all pieces are straight.
    margin : float
        In the units of the domain: nodes count as cut if the boundary comes so near to them, along each axis.
    """

    points: NDArray[np.float64]
    pieces: NDArray[np.int64]
    factor: float
    contains: Callable[[Any], NDArray[np.bool_]]
    deviation: float = 0.0
    margin: float = 0.0


class Contacts(NamedTuple):
    """The nodes of one level: where each lies, and which pieces meet its inside.

    Attributes
    ----------
    state : (n,) int8
        `ALL_OUTSIDE`, `CUT` or `ALL_INSIDE`.
    node, piece : (q,) int64
        Pairs, sorted by node.
    """

    state: NDArray[np.int8]
    node: NDArray[np.int64]
    piece: NDArray[np.int64]


def boundary_of(
    points: NDArray[np.float64],
    pieces: NDArray[Any],
    box: NDArray[np.float64],
    contains: Callable[[Any], Any],
    deviation: float = 0.0,
) -> Boundary:
    """The record for points in the units of the domain; the box (2, d) is the root of the tree."""
    factor = power_of_two(np.concatenate([points, box]))
    rows = np.ascontiguousarray(pieces, dtype=np.int64)
    return Boundary(frozen(points * factor), frozen(rows), factor, contains, deviation)


def at_root(boundary: Boundary, low: NDArray[np.float64], high: NDArray[np.float64]) -> Contacts:
    """The contacts of the root, whose corners are (1, d)."""
    many = len(boundary.pieces)
    above = Contacts(np.zeros(1, dtype=np.int8), np.zeros(many, dtype=np.int64), np.arange(many))
    return _met(boundary, above, np.zeros(1, dtype=np.int64), low, high)


def handed_down(
    boundary: Boundary,
    contacts: Contacts,
    divided: NDArray[np.int64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
) -> Contacts:
    """The contacts of the children of the `divided` nodes; low, high (2**d k, d) are their corners."""
    d = low.shape[1]
    rank = np.full(len(contacts.state), -1, dtype=np.int64)
    rank[divided] = np.arange(len(divided))
    kept = rank[contacts.node] >= 0
    parent, piece = rank[contacts.node[kept]], contacts.piece[kept]
    node = ((parent[:, None] << d) | np.arange(1 << d)).ravel()
    above = Contacts(contacts.state[divided], node, np.repeat(piece, 1 << d))
    return _met(boundary, above, np.arange(len(low)) >> d, low, high)


def _met(
    boundary: Boundary,
    above: Contacts,
    parent: NDArray[np.int64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
) -> Contacts:
    """Of the pairs of `above`, those that meet; states from those of the parents, or by one exact test."""
    f = boundary.factor
    meets = pieces_in_boxes(
        boundary.points,
        boundary.pieces,
        above.piece,
        (low[above.node] - boundary.margin) * f,
        (high[above.node] + boundary.margin) * f,
    )
    node, piece = above.node[meets], above.piece[meets]
    order = np.argsort(node, kind="stable")
    node, piece = node[order], piece[order]
    state = above.state[parent].copy()
    was_cut = state == CUT
    cut = np.zeros(len(low), dtype=bool)
    cut[node] = True
    asked = np.flatnonzero(was_cut & ~cut)
    if len(asked):
        middle = low[asked] + 0.5 * (high[asked] - low[asked])
        state[asked] = np.where(boundary.contains(middle), ALL_INSIDE, ALL_OUTSIDE)
    return Contacts(state, node, piece)
