"""Sizes by region in a body: one field that knows in which part of the body each point lies. Book: 2.8c."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ...geometry.boxes import BoxTree, bounding_boxes
from ...geometry.inside_shell import front_inside
from ...geometry.outline import Outline
from ...geometry.triangle_tree import TriangleTree, onto
from ...predicates.batch import power_of_two
from ...sizing.field import SizeField, as_size
from ..plane.by_region import no_entry, per_region
from .parts import UNBOUNDED, Parts, parts_in_space

__all__ = ["parts_of_body", "size_by_part"]

Array = NDArray[np.float64]
ON_TRIANGLE = (
    2.0**-40
)  # of the largest coordinate: points so near to a facet are on it, and on both its sides


class PartMap(NamedTuple):
    """Which parts of a body there are at a point.

    Attributes
    ----------
    parts : Parts
    inside : (p,) bool
        Which parts belong to the body.
    corners : (t, 3, 3) float64
        All triangles, scaled by ``factor``.
    sides : (t, 2) int64
        The parts in front of and behind each triangle, `UNBOUNDED` for those outside of the body.
    tree : BoxTree
        That of the corners.
    nearest : TriangleTree
        That of the triangles that bound the body.
    beside : (b,) int64
        The part of the body beside each of these.
    """

    parts: Parts
    inside: NDArray[np.bool_]
    corners: Array
    factor: float
    sides: NDArray[np.int64]
    tree: BoxTree
    nearest: TriangleTree
    beside: NDArray[np.int64]

    def at(self, x: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Pairs of a point and a part of the body that contains it; outside, the part beside it."""
        scaled = np.ascontiguousarray(x * self.factor)
        off = ON_TRIANGLE * max(float(np.abs(self.corners).max()), 2.0**-900)
        query, hit = self.tree.pairs(scaled - off, scaled + off)
        on = np.zeros(len(query), dtype=np.bool_)
        _are_on(scaled, self.corners, query, hit, off * off, on)
        query, hit = query[on], hit[on]
        free = np.ones(len(x), dtype=bool)
        free[query] = False
        rows = np.flatnonzero(free)
        found = self.parts.locate(x[rows])
        pairs = [
            np.column_stack([np.repeat(query, 2), self.sides[hit].ravel()]),
            np.column_stack([rows, found]),
        ]
        every = np.concatenate(pairs)
        every = every[(every[:, 1] != UNBOUNDED) & self.inside[every[:, 1]]]
        outside = np.setdiff1d(np.arange(len(x)), every[:, 0])
        if len(outside):
            which, _ = self.nearest.nearest(x[outside])
            every = np.concatenate([every, np.column_stack([outside, self.beside[which]])])
        return every[:, 0], every[:, 1]


@kernel
def _are_on(x, corners, query, hit, square, on):
    place = np.empty(3)
    for i in range(query.shape[0]):
        on[i] = onto(x[query[i]], corners[hit[i]], place) <= square


def parts_of_body(shell: Any) -> tuple[Parts, NDArray[np.bool_], NDArray[np.int64]]:
    """The parts of space that the triangles of a body divide, and which of them belong to it.

    Returns
    -------
    parts : Parts
    inside : (p + 1,) bool
        Whether each part belongs to the body; the last entry stands for what is unbounded.
    beside : (b,) int64
        The part of the body beside each triangle of a facet.
    """
    parts = parts_in_space(shell.points, shell.triangles)
    bounding = np.flatnonzero(shell.piece < shell.facets)
    ahead = front_inside(shell.points, shell.triangles[bounding])
    beside = np.where(ahead, parts.front[bounding], parts.back[bounding])
    inside = np.zeros(len(parts.walls) + 1, dtype=bool)
    inside[beside] = True
    within = np.flatnonzero(shell.piece >= shell.facets)
    front, back = parts.front[within], parts.back[within]
    while (inside[front] != inside[back]).any():  # inner facets do not bound the body
        inside[front] |= inside[back]
        inside[back] |= inside[front]
    inside[UNBOUNDED] = False
    return parts, inside, beside


def _map_of(domain: Any) -> PartMap:
    shell = domain.triangulated
    parts, inside, beside = parts_of_body(shell)
    bounding = np.flatnonzero(shell.piece < shell.facets)
    factor = power_of_two(shell.points)
    corners = np.ascontiguousarray(shell.points[shell.triangles] * factor)
    return PartMap(
        parts, inside, corners, factor, np.stack([parts.front, parts.back], axis=1),
        BoxTree(*bounding_boxes(corners)), TriangleTree(shell.points[shell.triangles[bounding]]), beside,
    )  # fmt: skip


def size_by_part(domain: Outline, size: Any) -> Any:
    """A size given by region as one field over a body; any other size as it is.

    Parameters
    ----------
    domain : Domain
        In space, with facets.
    size : size, or mapping of names to sizes

    Returns
    -------
    SizeField
        At a point of a facet between two regions the smaller one of their sizes; outside that of the region
        beside the nearest facet.

    Raises
    ------
    InputError
        For an unknown region, and for one without a size.

    Notes
    -----
    Which region a point is in is decided exactly, by the parity of crossings of a ray with its boundary.
    """
    if not isinstance(size, Mapping):
        return size
    where = _map_of(domain)
    names = list(domain.regions)
    number = np.full(len(where.inside), -1)
    places: dict[int, Array] = {}
    for k, seeds in enumerate(domain.regions.values()):
        for x, part in zip(seeds, where.parts.locate(seeds).tolist()):
            if part != UNBOUNDED:
                number[part] = k
                places[k] = x
    unnamed = np.flatnonzero(where.inside[:-1] & (number[:-1] < 0))
    called = names + [""] * min(1, len(unnamed))
    if len(unnamed):
        number[unnamed] = len(names)
        places[len(names)] = domain.points[where.parts.walls[unnamed[0]]].mean(axis=1)[0]
    given = per_region(size, called, "size")
    for r, one in enumerate(given):
        if one is None:
            raise no_entry(called[r], places.get(r, domain.points[0]))
    fields = [as_size(one) for one in given]
    constants = {field.constant for field in fields}
    if len(constants) == 1 and None not in constants:
        return fields[0]
    shell = domain.triangulated  # type: ignore[attr-defined]
    marks = [shell.points[shell.triangles].mean(axis=1), shell.points[np.unique(shell.triangles)]]
    marks += [field.landmarks for field in fields if field.landmarks.shape[1:] == (3,)]
    return SizeField(
        partial(_by_part, fields, number, where),
        landmarks=np.concatenate(marks),
        name=f"{len(set(size))} sizes by region",
    )


def _by_part(fields: list[SizeField], number: NDArray[np.int64], where: PartMap, x: Array) -> Array:
    sizes = np.full(len(x), np.inf)
    row, part = where.at(x)
    region = number[part]
    for r in np.unique(region).tolist():
        rows = np.unique(row[region == r])
        sizes[rows] = np.minimum(sizes[rows], fields[r](x[rows]))
    return sizes
