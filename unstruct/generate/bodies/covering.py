"""Facets of a body of which something else covers a part: only the rest is divided.

What is covered ends in edges that stay, so that the rest fits to it. See the book, chapter 4c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...mesh.grouping import group_rows
from .patches import Patches

__all__ = ["Cover", "covered"]

Numbers = NDArray[np.int64]
Flags = NDArray[np.bool_]


class Cover(NamedTuple):
    """What covers facets that lie in planes.

    Attributes
    ----------
    points : (k, 3) float64
        Further points; they are numbered after those of the body.
    edges : (e, 2) int64
        Where it ends within each piece, and at the piece's sides.
    piece : (e,) int64
        The piece that each edge is of.
    side : (m, 2) int64
        Sides of pieces, the smaller vertex first, once for each vertex on them.
    vertex : (m,) int64
        That vertex; those of one side are in order, from its first end on.
    kept : (q, 2) int64
        Edges that are not cut, the smaller vertex first.
    """

    points: NDArray[np.float64]
    edges: Numbers
    piece: Numbers
    side: Numbers
    vertex: Numbers
    kept: Numbers

    def taken_from(
        self, rows: Numbers, of: Numbers, within: Flags, patches: Patches
    ) -> tuple[Numbers, Numbers, Flags]:
        """The edges of patches without what is covered: edges of both cancel. All in the order of patches."""
        patch_of = np.full(int(patches.piece.max(initial=-1)) + 1, -1, dtype=np.int64)
        patch_of[patches.piece] = np.arange(len(patches.piece))
        rows = np.concatenate([rows, self.edges])
        of = np.concatenate([of, patch_of[self.piece]])
        within = np.concatenate([within, np.zeros(len(self.edges), dtype=bool)])
        group, _ = group_rows(np.column_stack([np.sort(rows, axis=1), of, within]))
        left = np.flatnonzero(within | (np.bincount(group)[group] == 1))
        left = left[np.argsort(of[left], kind="stable")]
        return rows[left], of[left], within[left]


def covered(patches: Patches, cover: Cover) -> tuple[Patches, Flags]:
    """Patches whose sides have the further vertices on them, and which of them are others than before."""
    changed = np.isin(patches.piece, cover.piece)
    group, _ = group_rows(np.concatenate([np.sort(patches.sides, axis=1), cover.side]))
    mine, theirs = group[: len(patches.sides)], group[len(patches.sides) :]
    order = np.argsort(theirs, kind="stable")
    start, stop = (np.searchsorted(theirs[order], mine, side=end) for end in ("left", "right"))
    cut = np.flatnonzero(stop > start)
    changed[patches.patch[cut]] = True
    pairs, owner = [patches.sides], [np.arange(len(patches.sides))]
    for i in cut.tolist():
        vertices = cover.vertex[order[start[i] : stop[i]]]
        first, last = patches.sides[i].tolist()
        chain = np.concatenate([[first], vertices if first < last else vertices[::-1], [last]])
        pairs.append(np.column_stack([chain[:-1], chain[1:]]))
        owner.append(np.full(len(chain) - 1, i))
    sides, row = np.concatenate(pairs), np.concatenate(owner)
    whole = np.ones(len(sides), dtype=bool)
    whole[cut] = False
    sides, row = sides[whole], row[whole]
    return patches._replace(sides=sides, patch=patches.patch[row], within=patches.within[row]), changed
