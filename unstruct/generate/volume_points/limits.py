"""Limits for tetrahedra: radius-edge ratio, dihedral angle, volume and size; sizes by regions.

A size h is a wanted edge length. As in the plane, a cell is too large if its circumradius exceeds
h / sqrt(2); a new point is then farther than that from all vertices that it sees, and edges are at most
sqrt(2) h long in the end. See the book, 2.8d.
"""

from __future__ import annotations

import math
from numbers import Real
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET, as_count, as_number, positive
from ...base.elementary import cosine
from ...base.errors import InputError
from ...base.jit import inline
from ...domain.domain import Domain
from ...domain.plane.by_region import per_region
from ...domain.space.inside import outward
from ...geometry.inside_shell import enclosed_volume
from ...predicates.batch import power_of_two
from ...sizing.field import SizeField, as_size
from ...sizing.metric import Metric
from ...sizing.space_table import size_in_space, space_nodes

__all__ = [
    "BY_FIELD",
    "BY_MEASURE",
    "BY_QUALITY",
    "BY_QUOTIENT",
    "BY_RADIUS",
    "CENTER_RULE",
    "REGULAR",
    "SEGMENT_RULE",
    "BodyLimits",
    "field_of",
    "make_body_limits",
    "points_allowed",
    "shape_limits",
    "wanted_in_space",
]

BY_QUOTIENT, BY_RADIUS, BY_FIELD = 0, 1, 2
CENTER_RULE, SEGMENT_RULE = 0, 1
REGULAR = math.sqrt(6.0) / 4.0  # circumradius of a regular tetrahedron with edges of length 1
BY_MEASURE, BY_QUALITY = 1, 2  # why something is divided: size and volume, or shape
NO_FIELD = np.full(1, -1, dtype=np.int32), np.zeros((1, 8)), np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0])
LARGEST_DIHEDRAL = 60.0  # degrees: more cannot be asked for
FEWEST_IN_A_CUBE = 0.5  # vertices in a cube of the wanted size; most meshes have about one


def points_allowed(domain: Domain, size: Any, budget: int | None) -> int:
    """The largest number of vertices that a mesh may have.

    Raises
    ------
    InputError
        If there is no budget, and a constant size asks for more vertices than there are by default. With a
        budget, as many are put.
    """
    if budget is not None:
        return as_count(budget, "budget")
    h = size.constant if isinstance(size, SizeField) else size
    if isinstance(h, Real):
        factor = power_of_two(domain.points)  # a volume may be no double
        side = enclosed_volume(domain.points * factor, outward(domain.triangulated)) ** (1.0 / 3.0) / factor
        with np.errstate(over="ignore"):
            count = FEWEST_IN_A_CUBE * (np.float64(side) / positive(h, "size")) ** 3
        if count > DEFAULT_BUDGET:
            raise InputError(
                f"the size asks for {count:.3g} vertices or more, and without a budget at most "
                f"{DEFAULT_BUDGET:,} are put; give a larger size, or a budget"
            )
    return DEFAULT_BUDGET


class BodyLimits(NamedTuple):
    """The limits as the kernels see them; lengths are scaled."""

    ratio2: float  # largest radius-edge ratio, squared; inf for none
    sliver: float  # cosine of the least dihedral angle; 1 for none
    reach2: float  # largest circumradius, squared, in sizes
    order: int  # which cell is next: `BY_QUOTIENT`, `BY_RADIUS`, `BY_FIELD`: by the size of a further region
    rule: int  # which point is put: `CENTER_RULE`, `SEGMENT_RULE`
    bold: int  # whether points are put in the spheres of what must stay
    lens: float  # 0: spheres are encroached upon; 1: only lenses in them, where one is seen under 120 degrees
    thin: float  # gaps narrower than this share of the size and of what is beside them are left; 0 for none
    volume: NDArray[np.float64]  # (regions,) six times the largest volume, inf for none
    size: NDArray[np.float64]  # (regions,) the size, if it is constant; inf for none
    first: NDArray[np.int64]  # (regions,) first row of the size's table, -1 if the size is constant
    last: NDArray[np.int64]
    child: NDArray[np.int32]
    values: NDArray[np.float64]
    box: NDArray[np.float64]


@inline
def wanted_in_space(limits, r, x, y, z):
    """The wanted length in region r at (x, y, z); inf for none."""
    i = limits.first[r]
    if i < 0:
        return limits.size[r]
    j = limits.last[r]
    return size_in_space(limits.child[i:j], limits.values[i:j], limits.box, x, y, z)


def field_of(value: Any) -> Any:
    """A size field, where a size in space is asked for."""
    if isinstance(value, Metric):
        raise InputError(
            "in space points are not put by a metric: give a size, which is the same in all directions; "
            "cells with directions are made in the plane by advancing_front"
        )
    return as_size(value)


def make_body_limits(
    names: list[str],
    box: NDArray[np.float64],
    factor: float,
    *,
    size: Any = None,
    max_volume: Any = None,
    radius_edge: float | None = None,
    min_dihedral: float | None = None,
    reach: float = math.sqrt(0.5),
    order: int = 0,
    rule: int = 0,
    bold: bool = False,
    lens: float = 0.0,
    thin: float = 0.0,
    priority: Any = None,
) -> BodyLimits:
    """Limits for the named regions (region k is called ``names[k]``) over a box of unscaled coordinates.

    Parameters
    ----------
    names : list of str
    box : (2, 3) ndarray
    factor : float
        By which coordinates are multiplied.
    size, max_volume
        One for all, or a dict by names of regions.
    radius_edge : float, optional
        The largest ratio of circumradius and shortest edge.
    min_dihedral : float, optional
        The least dihedral angle, in degrees.
    reach : float
        The largest circumradius, in sizes.
    order, rule, bold, lens, thin
        As for `BodyLimits`.
    priority : size, optional
        That of the further region, with ``order=BY_FIELD``.
    """
    further = [] if priority is None else [priority]
    count = len(names) + len(further)
    volumes = [
        math.inf if one is None else 6.0 * positive(one, "max_volume") * factor * factor * factor
        for one in per_region(max_volume, names, "max_volume")
    ]
    volumes += [math.inf] * len(further)
    sizes, first, last = np.full(count, np.inf), np.full(count, -1), np.full(count, -1)
    parts, rows = [], 0
    made: dict[int, tuple[int, int]] = {}
    for r, one in enumerate([*per_region(size, names, "size"), *further]):
        if one is None:
            continue
        field = field_of(one)
        if field.constant is not None:
            sizes[r] = field.constant * factor
            continue
        if id(one) not in made:
            marks = field.landmarks if field.landmarks.shape[1:] == (3,) else np.empty((0, 3))
            marks = marks[((marks >= box[0]) & (marks <= box[1])).all(axis=1)]
            nodes = space_nodes(field, box, factor, marks)
            made[id(one)] = rows, rows + len(nodes.child)
            parts.append(nodes)
            rows += len(nodes.child)
        first[r], last[r] = made[id(one)]
    child, values = [part.child for part in parts], [part.values for part in parts]
    return BodyLimits(
        math.inf if radius_edge is None else radius_edge * radius_edge,
        1.0 if min_dihedral is None else cosine(math.radians(min_dihedral)),
        reach * reach, order, rule, int(bold), lens, thin, np.array(volumes, dtype=np.float64), sizes,
        first.astype(np.int64), last.astype(np.int64),
        np.concatenate(child) if child else NO_FIELD[0], np.concatenate(values) if values else NO_FIELD[1],
        (box * factor).ravel(),
    )  # fmt: skip


def shape_limits(radius_edge: Any, min_dihedral: Any) -> tuple[float | None, float | None]:
    """The ratio and the angle that were asked for; None for none."""
    ratio = None if radius_edge is None else as_number(radius_edge, "radius_edge")
    if ratio is not None and not ratio >= 0.7:
        raise InputError(f"radius_edge = {ratio} must be at least 0.7: regular tetrahedra have 0.612")
    angle = None if min_dihedral is None else as_number(min_dihedral, "min_dihedral")
    if angle is not None and not 0 <= angle <= LARGEST_DIHEDRAL:
        raise InputError(f"min_dihedral = {angle} must be between 0 and {LARGEST_DIHEDRAL:g} degrees")
    return ratio, angle or None
