"""The limits for triangles: minimum angle, largest area, and largest circumradius, by regions.

A size h is a wanted edge length. A triangle is too large if its circumradius exceeds h / sqrt(2). Then a new
point is farther than h / sqrt(2) from all other points that it sees, and in the end no edge is longer than
sqrt(2) h. So the edge lengths lie between h / sqrt(2) and sqrt(2) h, symmetrically about the wanted length.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import as_number
from ...base.elementary import sine
from ...base.errors import InputError
from ...base.jit import inline
from ...domain.plane.by_region import per_region
from ...sizing import as_size
from ...sizing.table import size_at

__all__ = ["Limits"]

NO_TABLE = np.empty(0, dtype=np.int32), np.empty((0, 4)), np.zeros(4)  # child, values, box
ANGLE, AREA, SIZE = 1, 2, 4  # bits: the limits that a triangle misses
# A point put in for the angle's sake keeps this share (squared) of the length of the input's edges nearby: a
# thousandth, or half for angles above `PLAUSIBLE` degrees, where neither theorems nor experience promise an
# end. There the distance that is kept also grows by this share of the distance from the input.
FRACTION, STEEP_FRACTION, STEEP_GROWTH = 2.0**-20, 0.25, 0.125
PLAUSIBLE = 33.5
UNDERFLOW = 1e-290  # changes no product of doubles that is exact enough to be compared; 0 < 0 would be false
BY_ANGLE, BY_SIZE = 1, 2  # why a triangle or subsegment is refined: only for the angle, or for area or size


class Limits(NamedTuple):
    """The limits as the kernels see them; lengths are scaled."""

    sine2: float  # squared sine of the minimum angle, 0 for none
    lens: float  # squared cosine of the angle under which an encroaching vertex sees a subsegment
    fraction: float  # see FRACTION
    growth: float
    twice_area: NDArray[np.float64]  # (regions,) twice the largest area, inf for none
    radius2: NDArray[np.float64]  # (regions,) largest circumradius, squared, if the size is constant
    first: NDArray[np.int64]  # (regions,) first row of the region's size table, -1 if the size is constant
    last: NDArray[np.int64]
    child: NDArray[np.int32]
    values: NDArray[np.float64]
    box: NDArray[np.float64]


@inline
def largest_radius2(limits, r, x, y):
    """The squared circumradius that a triangle of region r may have at (x, y)."""
    i = limits.first[r]
    if i < 0:
        return limits.radius2[r]
    j = limits.last[r]
    h = size_at(limits.child[i:j], limits.values[i:j], limits.box, x, y)
    return 0.5 * h * h


@inline
def misses_of(twice, p, q, s, x, y, r, limits):
    """`misses` for twice the area, the squared edges, and the centroid.

    R = abc / (2 twice), and the sine of the minimum angle is twice over the product of the two longer edges.
    There are no branches: the outcome cannot be predicted, and wrong predictions of the processor would cost
    more time than everything else here. If the product is below all doubles, the angle is missed.
    """
    square, product = twice * twice, p * q * s
    angle = square * min(min(p, q), s) < limits.sine2 * (product + UNDERFLOW)
    area = twice > limits.twice_area[r]
    size = product > 4.0 * square * largest_radius2(limits, r, x, y)
    return ANGLE * angle + AREA * area + SIZE * size


@inline
def misses(xy, a, b, c, r, limits):
    """Which limits the counterclockwise triangle a, b, c of region r misses: a sum of bits, 0 for none."""
    ax, ay, bx, by, cx, cy = xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1]
    twice = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    p = (bx - ax) * (bx - ax) + (by - ay) * (by - ay)
    q = (cx - bx) * (cx - bx) + (cy - by) * (cy - by)
    s = (ax - cx) * (ax - cx) + (ay - cy) * (ay - cy)
    return misses_of(twice, p, q, s, (ax + bx + cx) / 3.0, (ay + by + cy) / 3.0, r, limits)


# --- building them ---------------------------------------------------------------------------------


def make_limits(
    names: list[str], box_of: Callable[[], NDArray[np.float64]], factor: float, *, min_angle: float,
    max_area: Any, size: Any, lens: float,
) -> Limits:  # fmt: skip
    """Limits for the named regions (region k is called ``names[k]``) over a box of unscaled coordinates.

    ``box_of`` is called only if a table is made.
    """
    smallest = sine(math.radians(min_angle))
    sine2 = smallest * smallest
    steep = min_angle > PLAUSIBLE
    fraction, growth = (STEEP_FRACTION, STEEP_GROWTH) if steep else (FRACTION, 0.0)
    if max_area is None and size is None:
        far, none = np.empty(len(names)), np.empty(len(names), dtype=np.int64)
        far.fill(np.inf)
        none.fill(-1)
        return Limits(sine2, lens, fraction, growth, far, far, none, none, *NO_TABLE)
    areas = [
        _positive(a, "max_area") * factor * factor * 2.0 for a in per_region(max_area, names, "max_area")
    ]
    box, radius2 = box_of(), np.full(len(names), np.inf)
    first, last = np.full(len(names), -1, dtype=np.int64), np.full(len(names), -1, dtype=np.int64)
    child, values, rows = [np.empty(0, np.int32)], [np.empty((0, 4))], 0
    made: dict[int, tuple[int, int]] = {}
    for r, one in enumerate(per_region(size, names, "size")):
        if one is None:
            continue
        field = as_size(one)
        if field.constant is not None:
            h = field.constant * factor
            radius2[r] = 0.5 * h * h  # inf for an enormous size, which then limits nothing
            continue
        if id(one) not in made:  # one table for all regions that share a field
            nodes = field.table(box[:2], box[2:], factor=factor).nodes
            child.append(nodes.child)
            values.append(nodes.values)
            made[id(one)] = rows, rows + len(nodes.child)
            rows += len(nodes.child)
        first[r], last[r] = made[id(one)]
    return Limits(
        sine2, lens, fraction, growth, np.array(areas), radius2, first, last, np.concatenate(child),
        np.concatenate(values), box * factor,
    )  # fmt: skip


def _positive(value: Any, what: str) -> float:
    if value is None:
        return math.inf
    number = as_number(value, what)
    if not number > 0:
        raise InputError(f"{what} = {number} must be positive")
    return number
