"""The cells of columns of layers: wedges, and pyramids and tetrahedra where rays have stopped.

A column stands on a triangle of rays. Between two levels each of its rays either rises or has stopped, and
then both of its levels are one vertex. So there are eight cases: a wedge if all three rise, a pyramid if
two do, a tetrahedron if one does, nothing if none does.

        c'                          c'                      c'
       /|\\                         /|\\                     /|
     a'-+-b'     a has stopped:   / | b'   b, too:         / |
     |  c |                      /  c |                   /  c
     | / \\|                     / /  \\|                  / /  \\
     a----b                    a------b                 a------b

Over an edge both columns have the same face: a quadrilateral if both of its rays rise, a triangle if one
does, the edge itself if none does. So cells fit, whatever the levels are; see the book, chapter 5.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.jacobians import pyramid_signs, wedge_signs
from ...predicates.batch import orient_rows

__all__ = ["STACKED", "Stack", "signs_of_cells", "stacked_cells", "tops_of"]

STACKED = ("wedge", "pyramid", "tetra")
# The places of a column turned until a ray that differs from both others stands first: its corners in this
# order, a b c below and a' b' c' above as 0 to 5, are the corners of a cell of the kind.
TWO_RISE = [1, 4, 5, 2, 0]  # a pyramid: b and c rise, seen from a
ONE_RISES = [0, 1, 2, 3]  # a tetrahedron: a rises


class Stack(NamedTuple):
    """Cells of columns, by kind.

    Attributes
    ----------
    cells : dict of str to (k, corners) array
        "wedge", "pyramid" and "tetra", also where there are none; layer by layer.
    layer, column : dict of str to (k,) array
        Of each cell.
    """

    cells: dict[str, NDArray[np.int32]]
    layer: dict[str, NDArray[np.int32]]
    column: dict[str, NDArray[np.int32]]


def stacked_cells(number: NDArray[np.int32], columns: NDArray[np.int32]) -> Stack:
    """The cells of all columns.

    Parameters
    ----------
    number : (levels + 1, r) int32
        The vertex of each ray at each level; a ray that has stopped keeps its vertex.
    columns : (c, 3) int32
        Rows of rays, counterclockwise seen from above.

    Returns
    -------
    Stack
        Positive where the columns are. O(c levels).
    """
    cells: dict[str, list[NDArray]] = {kind: [np.empty((0, k), dtype=np.int32)] for kind, k in _SIZES.items()}
    layer: dict[str, list[NDArray]] = {kind: [np.empty(0, dtype=np.int32)] for kind in STACKED}
    column: dict[str, list[NDArray]] = {kind: [np.empty(0, dtype=np.int32)] for kind in STACKED}
    for k in range(len(number) - 1):
        rises = (number[k] != number[k + 1])[columns]
        count = rises.sum(axis=1)
        for kind, many in zip(STACKED, (3, 2, 1)):
            which = np.flatnonzero(count == many)
            if len(which) == 0:
                continue
            rows = columns[which]
            if many < 3:  # the ray that stops, or the one that rises, first
                first = (rises[which] == (many == 1)).argmax(axis=1)
                rows = np.take_along_axis(rows, (first[:, None] + np.arange(3)) % 3, axis=1)
            corners = np.concatenate([number[k][rows], number[k + 1][rows]], axis=1)
            if many < 3:
                corners = corners[:, TWO_RISE if many == 2 else ONE_RISES]
            cells[kind].append(corners.astype(np.int32))
            layer[kind].append(np.full(len(which), k, dtype=np.int32))
            column[kind].append(which.astype(np.int32))
    return Stack(
        *({kind: np.concatenate(parts[kind]) for kind in STACKED} for parts in (cells, layer, column))
    )


_SIZES = {"wedge": 6, "pyramid": 5, "tetra": 4}


def signs_of_cells(points: NDArray[np.float64], kind: str, rows: NDArray[np.integer]) -> NDArray[np.int8]:
    """The exact sign of the Jacobian over each of some cells of one kind: 1, -1, or 0 where it is neither."""
    if kind == "tetra":
        return orient_rows(points, np.asarray(rows, dtype=np.int32))
    return (wedge_signs if kind == "wedge" else pyramid_signs)(points[rows])


def tops_of(number: NDArray[np.int32], columns: NDArray[np.int32]) -> NDArray[np.int32]:
    """The cap: a triangle for each column, of the last vertices of its rays."""
    return number[-1][columns]
