"""The first simplex: points that are affinely independent, found by exact signs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.errors import DegenerateInputError
from ...base.jit import kernel
from ...predicates.batch import orient_at
from ...predicates.kernels import orient2, orient3
from .general import exact_integers, independent_rows

FLATS = {0: "equal", 1: "collinear", 2: "coplanar"}  # what points in a flat of this dimension are called


@kernel
def _not_equal(p, start):
    for i in range(start, p.shape[0]):
        for k in range(p.shape[1]):
            if p[i, k] != p[0, k]:
                return i
    return -1


@kernel
def _not_collinear(p, j, start):
    for i in range(start, p.shape[0]):
        for k in range(p.shape[1]):  # in space, in three projections
            if p.shape[1] == 2 and k == 1:
                break
            x, y = k, (k + 1) % p.shape[1]
            if orient2(p[0, x], p[0, y], p[j, x], p[j, y], p[i, x], p[i, y]) != 0:
                return i
    return -1


@kernel
def _not_coplanar(p, j, k, start):
    for i in range(start, p.shape[0]):
        if (
            orient3(
                p[0, 0], p[0, 1], p[0, 2], p[j, 0], p[j, 1], p[j, 2],
                p[k, 0], p[k, 1], p[k, 2], p[i, 0], p[i, 1], p[i, 2],
            )
            != 0
        ):  # fmt: skip
            return i
    return -1


def first_simplex(rows: NDArray[np.float64], *, compiled: bool) -> list[int]:
    """The first rows that are affinely independent of those before them.

    There are d + 1, or fewer if all points lie in a flat of lower dimension; its dimension is one less than
    their number.
    ``compiled`` requires |coordinates| <= 1 and two or three dimensions.
    """
    if not compiled:
        return independent_rows(exact_integers(rows, 0)[0], rows.shape[1])
    corners = np.arange(rows.shape[1] + 1)
    if len(rows) >= len(corners) and orient_at(rows, corners) != 0:
        return corners.tolist()
    found = [0, int(_not_equal(rows, 1))]
    if found[-1] >= 0:
        found.append(int(_not_collinear(rows, found[1], found[1] + 1)))
    if found[-1] >= 0 and rows.shape[1] == 3:
        found.append(int(_not_coplanar(rows, found[1], found[2], found[2] + 1)))
    return found[:-1] if found[-1] < 0 else found


def not_spanning(rows: NDArray[np.float64], flat: int) -> DegenerateInputError:
    """The error for points that lie in a flat of lower dimension."""
    n, d = rows.shape
    if n == 0:
        return DegenerateInputError("there are no points yet: insert some", -1)
    where = FLATS.get(flat, f"in a flat of dimension {flat}")
    what = f"the only point is {rows[0].tolist()}" if n == 1 else f"all {n} points are {where}"
    return DegenerateInputError(
        f"{what} (dimension {flat}): a triangulation in {d} dimensions needs points that span the "
        "space; add others, or use fewer coordinates",
        flat,
    )
