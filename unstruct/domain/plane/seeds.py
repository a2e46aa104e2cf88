"""Seeds of regions and holes: on a piece or a vertex a seed would pick a side by chance, and is refused.

Straight pieces are judged exactly. A curve is stored as a function with rounding errors, so a seed that is
nearer to it than these counts as lying on it.
"""

from __future__ import annotations

from typing import Any, NoReturn

import numpy as np

from ...base.errors import InputError
from ...geometry.boxes import BoxTree
from ...geometry.outline import Outline
from ...geometry.segment_pairs import vertices_on_segments
from . import by_size, sample
from .faults import first_copies
from .inside import contains
from .lunes import in_lunes
from .prescribed import mirrored, spaced
from .sample import HALVINGS, Sampled, halve, on_curve_text, safe

__all__ = [
    "check_loose_off_curves",
    "check_seeds",
    "check_seeds_off_pieces",
    "coarse",
    "first_on_piece",
    "sized",
]

ON_CURVE = 2.0**-40  # a seed nearer to a curve than this lies on it; unit: the largest coordinate
NEAREST_PARTS = 64  # parts of a curve that are searched for the point nearest to a seed
SAMPLES_OF_STRETCH = 9  # where the distance is computed
NARROWINGS = 21  # each time to a quarter, until the distance between samples is far below `ON_CURVE`


def first_on_piece(outline: Outline, x: np.ndarray) -> tuple[int, str] | None:
    """The first of points (k, 2) that lies on a vertex or a piece, and the name of that; None for none."""
    n, k = len(outline.points), len(x)
    points = np.concatenate([outline.points, x])
    found: dict[int, str] = {}
    if outline.curves:
        for row, piece in _on_curves(outline, x):
            found.setdefault(row, outline.name(piece))
    bent = np.zeros(len(outline.pieces), dtype=bool)
    bent[list(outline.curves)] = True
    straight = np.flatnonzero(~bent)
    for v, i in vertices_on_segments(points, np.arange(n, n + k), outline.pieces[straight]).tolist():
        found[v - n] = outline.name(int(straight[i]))
    same = first_copies(points)[n:]
    for row in np.flatnonzero(same < n).tolist():
        found[row] = f"point {same[row]}"
    if not found:
        return None
    row = min(found)
    return row, found[row]


def _on_curves(outline: Outline, x: np.ndarray) -> list[tuple[int, int]]:
    """Pairs (row of x, curved piece) where the point lies on the curve up to rounding.

    Each curve is cut into stretches. The nearest point of those that are near enough is found by narrowing
    the interval of its parameter down.
    """
    piece = np.repeat(np.array(list(outline.curves)), NEAREST_PARTS)
    start = np.tile(np.arange(NEAREST_PARTS) / NEAREST_PARTS, len(outline.curves))
    first = outline.points_at(piece, start)
    last = outline.points_at(piece, start + 1.0 / NEAREST_PARTS)
    reach = np.abs(last - first).max(axis=1, keepdims=True)
    slack = ON_CURVE * max(np.abs(outline.points).max(), np.abs(first).max(), np.abs(x).max())
    low, high = np.minimum(first, last) - reach - slack, np.maximum(first, last) + reach + slack
    row, stretch = BoxTree(low, high).pairs(x, x)
    if len(row) == 0:
        return []
    middle, half, owner = start[stretch] + 0.5 / NEAREST_PARTS, 0.5 / NEAREST_PARTS, piece[stretch]
    steps = np.linspace(-1.0, 1.0, SAMPLES_OF_STRETCH)
    for _ in range(NARROWINGS):
        t = np.clip(middle[:, None] + half * steps, 0.0, 1.0)
        at = outline.points_at(np.repeat(owner, len(steps)), t.ravel()).reshape(*t.shape, 2)
        away = np.hypot(*(at - x[row][:, None]).transpose(2, 0, 1))
        apart = np.hypot(*np.diff(at, axis=1).transpose(2, 0, 1)).max(axis=1)
        best = away.argmin(axis=1)
        near = away.min(axis=1) <= np.maximum(2 * apart, slack)
        row, owner, middle, half = row[near], owner[near], t[near, best[near]], half / 4
    return list(zip(row.tolist(), owner.tolist()))


def check_loose_off_curves(outline: Outline) -> None:
    """Raise if a loose vertex lies on a curve: it would be inside, outside or on the boundary by chance."""
    if not len(outline.loose) or not outline.curves:
        return
    found = _on_curves(outline, outline.points[outline.loose])
    if found:
        row, piece = min(found)
        raise InputError(on_curve_text(outline, int(outline.loose[row]), piece))


def _stacked(outline: Outline) -> tuple[np.ndarray, list[str], np.ndarray]:
    """All seeds, the names of the regions, and where the seeds of each begin."""
    names = list(outline.regions)
    start = np.cumsum([0] + [len(seeds) for seeds in outline.regions.values()])
    return np.concatenate([np.empty((0, 2)), *outline.regions.values()]), names, start


def _refuse(outline: Outline, row: int, where: str) -> NoReturn:
    seeds, names, start = _stacked(outline)
    i = int(np.searchsorted(start, row, side="right")) - 1
    raise InputError(
        f"regions[{names[i]!r}][{row - start[i]}] = {seeds[row].tolist()} lies {where}; move it into a part "
        "of the region"
    )


def check_seeds_off_pieces(outline: Outline) -> None:
    """Raise if a seed of a region lies on a piece or a vertex."""
    found = first_on_piece(outline, _stacked(outline)[0]) if outline.regions else None
    if found is not None:
        _refuse(outline, found[0], f"on {found[1]}")


def check_seeds(outline: Outline, sampled: Sampled) -> None:
    """Raise if a seed of a region lies outside."""
    if not outline.regions or len(outline.facets) == 0:
        return
    outside = ~contains(outline, sampled, _stacked(outline)[0])
    if outside.any():
        _refuse(outline, int(np.argmax(outside)), "outside the region (even-odd)")


def _apart_from_seeds(outline: Outline, sampled: Sampled) -> Sampled:
    """Cut curves further until no seed lies between a chord and its curve, however near to it."""
    if not outline.regions or not outline.curves:
        return sampled
    seeds = _stacked(outline)[0]
    for _ in range(HALVINGS):
        rows = np.flatnonzero(np.isin(sampled.piece, list(outline.curves)))
        query, row, inside = in_lunes(outline, sampled, rows, seeds)
        if not inside.any():
            return sampled
        cut = np.zeros(len(sampled.piece), dtype=bool)
        cut[rows[row[inside]]] = True
        sampled = safe(outline, *halve(sampled, cut), np.inf)
    _refuse(outline, int(query[inside][0]), f"on {outline.name(int(sampled.piece[rows[row[inside][0]]]))}")


def _prescribed(outline: Outline, sampled: Sampled, cut: bool) -> Sampled:
    """The subsegments with the points that spaced and matched pieces must have, still apart from seeds.

    ``cut`` says that spaced pieces have been cut between their points.
    """
    if not outline.spacings and not outline.matches:
        return sampled
    sampled = spaced(outline, sampled, cut)
    for _ in range(HALVINGS):
        sampled = mirrored(outline, sampled)
        apart = _apart_from_seeds(outline, sampled)
        if apart is sampled:
            break
        sampled = apart
    return sampled


def coarse(outline: Outline) -> Sampled:
    """`sample.coarse`, apart from seeds."""
    return _prescribed(outline, _apart_from_seeds(outline, sample.coarse(outline)), False)


def sized(outline: Outline, size: Any, step: float) -> Sampled:
    """`by_size.sized`, apart from seeds."""
    found = by_size.sized(outline, size, step, lambda: coarse(outline))
    return _prescribed(outline, _apart_from_seeds(outline, found), True)
