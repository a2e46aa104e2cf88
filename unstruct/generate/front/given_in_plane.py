"""Points that are given to `front_delaunay`: told from a size, and refused where they are on the boundary."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import as_points
from ...base.errors import InputError
from ...domain.derived import held_by
from ...domain.domain import Domain, Sampled
from ...geometry.segment_pairs import vertices_on_segments

__all__ = ["as_given", "refuse_on_curves", "with_points"]


def as_given(value: Any, dimension: int = 2) -> NDArray[np.float64] | None:
    """The points, or None if the value is a size."""
    if not isinstance(value, (list, tuple, np.ndarray)):
        return None
    if isinstance(value, np.ndarray) and value.ndim != 2:
        return None
    if len(value) and not isinstance(value[0], (list, tuple, np.ndarray)):
        return None
    rows = as_points(value) if len(value) else np.empty((0, dimension))
    if rows.shape[1] != dimension:
        raise InputError(
            f"points must have shape (k, {dimension}), not {rows.shape}; a size is a number or a function"
        )
    return rows


def with_points(domain: Domain, points: NDArray[np.float64]) -> Domain:
    """The domain with the points as loose vertices, after its own."""
    n, rows = len(domain.points), np.concatenate([domain.points, points])
    _, first, group = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    copies = np.flatnonzero(first[group.reshape(-1)] != np.arange(len(rows)))
    if len(copies):
        i, j = int(copies[0]), int(first[group.reshape(-1)[copies[0]]])
        other = f"points[{j - n}]" if j >= n else f"vertex {j} of the domain"
        raise InputError(f"points[{i - n}] = {rows[i].tolist()} is equal to {other}: drop one of them")
    straight = np.setdiff1d(np.arange(len(domain.pieces)), list(domain.curves))
    on = vertices_on_segments(rows, np.arange(n, len(rows)), domain.pieces[straight])
    if len(on):
        i, s = on[np.argmin(on[:, 0])].tolist()
        raise InputError(
            f"points[{i - n}] = {rows[i].tolist()} lies on piece {straight[s]} of the domain: drop it, or "
            "make it a vertex of the domain that divides the piece"
        )
    refuse_on_curves(domain.sampled(), points, len(domain.points))

    def given(many: int) -> Domain:
        return Domain(
            rows[: n + many], domain.facets, inner=domain.inner, curves=domain.curves,
            markers=domain.markers, regions=domain.regions,
        )  # fmt: skip

    try:
        whole = given(len(points))
    except InputError as error:
        good, bad = 0, len(points)  # with so many of the points there is a domain, or none
        while bad - good > 1:
            middle = (good + bad) // 2
            try:
                given(middle)
                good = middle
            except InputError:
                bad = middle
        raise InputError(
            f"points[{good}] = {points[good].tolist()} cannot be a vertex of the domain; if it lies on a "
            f"curve up to rounding, drop it, or make it a vertex that divides the curve ({error})"
        ) from None
    return held_by(whole, domain.spacings, domain.matches)


def refuse_on_curves(sampled: Sampled, points: NDArray[np.float64], known: int) -> None:
    """Refuse points where chords of curves end, which are the points of ``sampled`` from ``known`` on.

    Other points that are on a curve up to rounding make the domain cut it there, or are refused by it.
    """
    rest = sampled.points[known:].tolist()
    place = {tuple(x): i for i, x in enumerate(points.tolist())} if rest else {}
    on = [place[x] for x in map(tuple, rest) if x in place]
    if on:
        raise InputError(
            f"points[{min(on)}] = {points[min(on)].tolist()} lies on a curve of the domain: drop it, or make "
            "it a vertex of the domain that divides the curve"
        )
