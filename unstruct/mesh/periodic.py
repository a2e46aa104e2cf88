"""Sides of a mesh that match: pairs of vertices of which one is the image of the other.

See `Mesh`, `Domain.matched`, and the book, chapter 2.6d.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from ..base.arrays import frozen
from ..base.errors import InputError
from ..geometry.motion import Motion
from .grouping import group_rows

__all__ = ["NO_IMAGES", "Periodic", "as_periodic", "facet_images", "pairs_of", "renumbered"]

NO_IMAGES = frozen(np.empty((0, 2), dtype=np.int32))


class Periodic(NamedTuple):
    """Vertices and their images by one motion.

    Attributes
    ----------
    motion : Motion or None
        Called with points it gives their images; None if a file does not say it.
    pairs : ndarray of int32, shape (k, 2)
        Rows (vertex, image), sorted.
    """

    motion: Motion | None
    pairs: np.ndarray


def as_periodic(values: Iterable[Any], n: int, d: int) -> tuple[Periodic, ...]:
    """Pairs by motions, checked: each vertex is one of n, is not its own image, and has one image.

    Raises
    ------
    InputError
        For anything else; the message names the first row that is wrong.
    """
    found = []
    try:
        couples = [(motion, np.asarray(rows)) for motion, rows in values]
    except (TypeError, ValueError):
        raise InputError(f"periodic must be pairs (motion, rows of vertices), not {values!r:.60}") from None
    for i, (motion, array) in enumerate(couples):
        if array.ndim != 2 or array.shape[1] != 2 or (array.size and array.dtype.kind not in "iu"):
            raise InputError(f"periodic[{i}] needs pairs of vertices, integers (k, 2), not {array.shape}")
        if not (motion is None or (isinstance(motion, Motion) and len(motion.shift) == d)):
            raise InputError(f"periodic[{i}] needs a Motion in {d} dimensions or None, not {motion!r:.60}")
        array = np.unique(array.astype(np.int64), axis=0)
        wrong = (array[:, 0] == array[:, 1]) | (np.diff(array[:, 0], prepend=-1) == 0)
        wrong |= (array < 0).any(axis=1) | (array >= n).any(axis=1)
        if wrong.any():
            row = array[int(np.argmax(wrong))].tolist()
            raise InputError(
                f"periodic[{i}]: the pair {row} is not of two of the vertices 0..{n - 1}, or the first has "
                "two images: drop it"
            )
        found.append(Periodic(motion, frozen(array.astype(np.int32))))
    return tuple(found)


def pairs_of(periodic: tuple[Periodic, ...]) -> np.ndarray:
    """All pairs, each once, sorted: (k, 2) int32."""
    if not periodic:
        return NO_IMAGES
    if len(periodic) == 1:
        return periodic[0].pairs
    return frozen(np.unique(np.concatenate([each.pairs for each in periodic]), axis=0))


def renumbered(periodic: tuple[Periodic, ...], number: np.ndarray) -> tuple[Periodic, ...]:
    """The pairs with vertex v called ``number[v]``; those with a vertex that is gone (-1) are left out."""
    found = []
    for motion, pairs in periodic:
        rows = number[pairs]
        rows = rows[(rows >= 0).all(axis=1)].astype(np.int32)
        if len(rows):
            found.append(Periodic(motion, frozen(rows[np.lexsort(rows.T[::-1])])))
    return tuple(found)


def facet_images(pairs: np.ndarray, facets: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Facets whose corners all have images that are the corners of another facet.

    Parameters
    ----------
    pairs : ndarray of int, shape (k, 2)
    facets : ndarray of int, shape (f, w)
    n : int
        The number of vertices.

    Returns
    -------
    first, second : ndarray of int, shape (c,)
        Facets, and their images.
    """
    image = np.full(n, -1, dtype=np.int32)
    image[pairs[:, 0]] = pairs[:, 1]
    moved = image[facets]
    rows = np.flatnonzero((moved >= 0).all(axis=1))
    if len(rows) == 0:
        return rows, rows
    both = np.concatenate([facets.astype(np.int32), moved[rows]])
    group, head = group_rows(np.sort(both, axis=1))
    target = head[group[len(facets) :]]  # the first row of a group is a facet, if one is among them
    there = (target < len(facets)) & (target != rows)
    return rows[there], target[there]
