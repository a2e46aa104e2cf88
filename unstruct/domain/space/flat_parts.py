"""Some facets of a body joined with those beside them in their planes: triangles of a plane end, say.

The body is the same, and so are its names: only facets are joined that have the same ones. What is cut anew
in such a plane need not respect the edges between them.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.outline import Outline
from .merging import in_common_planes

__all__ = ["FlatParts", "flat_parts"]

Rows = NDArray[np.int64]


class FlatParts(NamedTuple):
    """A body with fewer facets.

    Attributes
    ----------
    arguments : dict
        Of `Domain`.
    vertex : (n,) int64
        For each of its points that of the body.
    group : (p,) int64
        For each piece of the body that of which it is a part.
    piece : (q,) int64
        For each of its pieces the first piece of the body that is a part of it.
    """

    arguments: dict[str, Any]
    vertex: Rows
    group: Rows
    piece: Rows


def flat_parts(
    outline: Outline, which: NDArray[np.bool_], among: NDArray[np.bool_] | None = None
) -> FlatParts | None:
    """Join facets in common planes; see `in_common_planes` for the arguments.

    Returns
    -------
    FlatParts or None
        None if nothing is joined. Sides that touch themselves stay as they are. O(n log n).
    """
    found, side = in_common_planes(outline, which=which, among=among)
    many = len(side)
    first = found.piece_origin[found.piece_origin < many]
    if len(first) == many:
        return None
    place = np.empty(many, dtype=np.int64)
    place[side[first]] = np.arange(len(first))
    inner = len(first) + np.arange(len(outline.pieces) - many)
    return FlatParts(found.parts, found.origin, np.concatenate([place[side], inner]), found.piece_origin)
