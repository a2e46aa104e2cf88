"""A run of Rebay's insertion as frames: the chosen triangle, its Voronoi segment, the cavity, the star."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from ...geometry.simplex import circumcenter, circumradius
from ...plain.rebay import Insertion
from ..draw import frames as fr

__all__ = ["rebay_frames"]


def rebay_frames(
    points: Any,
    cells: Iterable[Sequence[int]],
    history: Iterable[Insertion],
    accepted: Callable[[Any, Any], bool],
    *,
    cavities: int = 1,
) -> list[fr.Frame]:
    """Two frames per insertion, or three if the cavity is shown as well.

    Parameters
    ----------
    points : (n, 2) array_like
        The vertices before the first insertion.
    cells : triples of int
        The triangles before the first insertion.
    history : iterable of Insertion
        From `unstruct.plain.rebay.voronoi_segment`.
    accepted : function (points, cell) -> bool
        Whether a triangle is accepted.
    cavities : int
        The number of insertions at the start for which the cavity has a frame of its own.

    Returns
    -------
    list of dict
    """
    have: list[Any] = [tuple(map(float, p)) for p in points]
    cells = frozenset(tuple(map(int, c)) for c in cells)
    number = _many(have, cells, accepted)
    first = fr.frame("the boundary, triangulated", *_mesh(have, cells, accepted), number=number)
    frames = [{**first, "view": fr.bounds([first], 0.12)}]
    for count, one in enumerate(history):
        frames.append(_choice(have, cells, one, accepted))
        if count < cavities:
            gone = [_corners(have, c) for c in one.cavity]
            items = [fr.polygons("cavity", gone), *fr.numbered(have), _star_of(one)]
            items = [*_mesh(have, cells, accepted)[:-2], *items]
            text = "the circles of these triangles contain X"
            frames.append(fr.frame(text, *items, number=f"{len(gone)} triangles are deleted"))
        have, cells = one.points, one.cells
        number = _many(have, cells, accepted)
        caption = f"{one.vertex} is joined to the boundary of the cavity; all triangles are judged again"
        frames.append(fr.frame(caption, *_mesh(have, cells, accepted), number=number))
    return frames


def _choice(have: list[Any], cells: Iterable[Any], one: Insertion, accepted: Callable[..., bool]) -> fr.Frame:
    """The waiting triangle, its circle, the active edge, and X on the segment from M to F."""
    a, b = one.edge
    corners, x = _corners(have, one.waiting), one.step.point
    beside = "boundary edge" if one.accepted is None else "edge of an accepted triangle"
    start = one.step.middle if one.step.accepted_center is None else one.step.accepted_center
    made = np.array([have[a], have[b], x])
    items = [
        *_mesh(have, cells, accepted)[:-2],
        fr.polygons("highlight", [corners]),
        fr.circles("circumcircle", [circumcenter(corners)], [circumradius(corners)]),
        fr.segments("voronoi", [[start, one.step.center]]),
        fr.dots("voronoi", [start, one.step.center]),
        fr.circles("inserted", [circumcenter(made)], [circumradius(made)]),
        fr.segments("front", [[have[a], have[b]]]),
        *fr.numbered(have),
        _star_of(one),
    ]
    caption = f"largest waiting triangle {' '.join(map(str, one.waiting))}: {beside} {a} {b}"
    return fr.frame(caption, *items, number=_radii(one))


def _radii(one: Insertion) -> str:
    got = one.step
    return f"p = {got.p:.2f}, q = {got.q:.2f}, R = {got.radius:.2f}, d = {got.distance:.2f}"


def _mesh(have: list[Any], cells: Iterable[Any], accepted: Callable[..., bool]) -> list[fr.Item]:
    verdict = {cell: accepted(have, cell) for cell in sorted(cells)}
    return [
        fr.polygons("waiting", [_corners(have, c) for c, good in verdict.items() if not good]),
        fr.polygons("accepted", [_corners(have, c) for c, good in verdict.items() if good]),
        *fr.numbered(have),
    ]


def _star_of(one: Insertion) -> fr.Item:
    return fr.dots("inserted", [one.step.point])


def _corners(have: list[Any], cell: Sequence[int]) -> np.ndarray:
    return np.array([have[v] for v in cell])


def _many(have: list[Any], cells: Iterable[Any], accepted: Callable[..., bool]) -> str:
    good = [accepted(have, cell) for cell in cells]
    return f"{sum(good)} accepted, {len(good) - sum(good)} waiting"
