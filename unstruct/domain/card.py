"""The picture of a domain in a notebook: counts, names and a small inline SVG, without matplotlib."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..base.card import card, to_pixels
from ..geometry.outline import Outline
from .space.lines import seen

__all__ = ["html"]

GRIDS = (0.1, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)  # pixels to which vertices are rounded: as fine as can be drawn
RADIX = 2**12  # more than the picture has places in a row; RADIX x + y is the number of a place
MOST_STROKES = 2000  # the largest number of segments and of loose points that are drawn
CURVE_CHORDS = 16  # straight parts in which a curve is drawn
MOST_NAMES = 6  # the largest number of names of a kind that are listed


def html(outline: Outline, repairs: int) -> str:
    """An HTML card: facets drawn, inner pieces dashed, loose vertices dotted; planar ones are filled.

    Parameters
    ----------
    outline : Outline
        If it has many pieces, their vertices are rounded to a grid of whole pixels, and what coincides is
        drawn once: that takes O(n log n), and the card stays small.
    repairs : int
        How many repairs there were.
    """
    in_space = outline.points.shape[1] == 3
    points, ends, facet = seen(outline) if in_space else _chords(outline)
    pixels = to_pixels(points)
    for grid in GRIDS:
        place = np.round(pixels / grid).astype(np.int64) @ [RADIX, 1]
        walls, times = _distinct(place[ends[facet]], grid)
        lines, _ = _distinct(place[ends[~facet]], grid)
        dots = _pixels(np.unique(place[outline.loose]), grid)
        if max(len(walls), len(lines), len(dots)) <= MOST_STROKES:
            break
    drawing = _strokes(walls, "")
    if not in_space:
        rings = "".join(f"M{_path(ring)}Z" for ring in _closed(walls[times % 2 == 1]))
        drawing = f"<path d='{rings}' fill='#dce6f2' fill-rule='evenodd'/>{drawing}"
    drawing += _strokes(lines, " stroke-dasharray='4 2'")
    drawing += "".join(f"<circle cx='{x:g}' cy='{y:g}' r='1.5'/>" for x, y in dots.tolist())
    counts = [
        ("points", len(outline.points)),
        ("facets", len(outline.facets)),
        ("inner pieces" if in_space else "inner segments", len(outline.inner)),
        ("loose points", len(outline.loose)),
        ("curves", len(outline.curves)),
        ("repairs", repairs),
    ]
    rows: list[tuple[str, int | str]] = [(name, count) for name, count in counts if count or name == "points"]
    rows += [
        (kind, _listed(names))
        for kind, names in (("markers", outline.markers), ("regions", outline.regions))
        if names
    ]
    return card(f"Domain of {len(outline.facets)} facets", drawing, rows)


def _chords(outline: Outline) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, those of the outline first; chords (s, 2) between them; whether each is part of a facet."""
    n, pieces = len(outline.points), outline.pieces
    bent = np.fromiter(outline.curves, dtype=np.int64, count=len(outline.curves))
    straight = np.delete(np.arange(len(pieces)), bent)
    t = np.arange(1, CURVE_CHORDS) / CURVE_CHORDS
    points = outline.points
    if len(bent):
        between = outline.points_at(np.repeat(bent, len(t)), np.tile(t, len(bent)))
        points = np.concatenate([points, between])
    number = n + np.arange(len(bent) * len(t)).reshape(len(bent), len(t))
    lines = np.column_stack([pieces[bent, 0], number, pieces[bent, 1]])
    chords = np.stack([lines[:, :-1], lines[:, 1:]], axis=-1).reshape(-1, 2)
    piece = np.concatenate([straight, np.repeat(bent, CURVE_CHORDS)])
    return points, np.concatenate([pieces[straight], chords]), piece < len(outline.facets)


def _listed(names: Iterable[str]) -> str:
    names = list(names)
    more = f", ... ({len(names)})" if len(names) > MOST_NAMES else ""
    return ", ".join(name if len(name) <= 24 else f"{name[:23]}…" for name in names[:MOST_NAMES]) + more


def _distinct(ends: np.ndarray, grid: float) -> tuple[np.ndarray, np.ndarray]:
    """Segments (s, 2, 2) without those of no length, each once in any direction, and how often each came."""
    ends = np.sort(ends[ends[:, 0] != ends[:, 1]], axis=1)
    keys, times = np.unique(ends @ [RADIX**2, 1], return_counts=True)
    return _pixels(np.stack(np.divmod(keys, RADIX**2), axis=1), grid), times


def _pixels(places: np.ndarray, grid: float) -> np.ndarray:
    return np.round(np.stack(np.divmod(places, RADIX), axis=-1) * grid, 1)


def _closed(segments: np.ndarray) -> list[list[tuple[float, float]]]:
    """Closed lines that together run through each segment once; an even number of segments meets at each end.

    Rounding keeps this, where pairs of equal segments are left out.
    """
    at: dict[tuple[float, float], list[int]] = {}
    pairs = [(tuple(a), tuple(b)) for a, b in segments.tolist()]
    for i, ends in enumerate(pairs):
        for end in ends:
            at.setdefault(end, []).append(i)
    used = [False] * len(pairs)
    rings = []
    for i, (start, here) in enumerate(pairs):
        if used[i]:
            continue
        used[i], ring = True, [start]
        while here != start:
            ring.append(here)
            while used[at[here][-1]]:
                at[here].pop()
            row = at[here].pop()
            used[row] = True
            here = pairs[row][1] if pairs[row][0] == here else pairs[row][0]
        rings.append(ring)
    return rings


def _path(ring: Iterable[tuple[float, float]]) -> str:
    return "L".join(f"{x:g} {y:g}" for x, y in ring)


def _strokes(segments: np.ndarray, dash: str) -> str:
    path = " ".join(f"M{_path(segment)}" for segment in segments.tolist())
    return f"<path d='{path}' stroke='#333333' stroke-width='1.2' fill='none'{dash}/>" if path else ""
