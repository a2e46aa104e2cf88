"""Is a point inside of an outline? A ray that counts facets, as frames (section 2.6d)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...plain.regions import crossings
from ..draw import frames as fr
from .choices import preset_named, within

__all__ = ["PARITY_OUTLINES", "PARITY_PLACES", "parity_frames", "parity_state"]

Edges = Sequence[tuple[int, int]]

OUTER_RING = [(0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0)]
RING_CORNERS = [
    *OUTER_RING,
    (1.0, 2.0),
    (3.0, 0.5),
    (5.0, 2.0),
    (3.0, 3.5),
    (2.4, 1.6),
    (3.6, 1.6),
    (3.0, 2.6),
]
EIGHT_OUTLINE = [(0.0, 0.0), (3.0, 2.0), (0.0, 4.0), (6.0, 0.0), (6.0, 4.0)]
GAP_OUTLINE = [*OUTER_RING, (0.0, 2.6), (0.0, 1.4)]
# Points and facets; in the last one, one facet ends at each of the points 4 and 5.
PARITY_OUTLINES: dict[str, tuple[list[tuple[float, float]], list[tuple[int, int]]]] = {
    "three rings": (
        RING_CORNERS,
        [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (8, 9), (9, 10), (10, 8)],
    ),
    "a figure of eight": (EIGHT_OUTLINE, [(0, 1), (1, 2), (2, 0), (1, 3), (3, 4), (4, 1)]),
    "nasty: a gap": (GAP_OUTLINE, [(0, 1), (1, 2), (2, 3), (3, 4), (5, 0)]),
}
# Where the point may be: inside and outside of each outline, on no facet.
PARITY_PLACES = (
    (0.4, 2.0), (2.0, 2.0), (3.0, 1.9), (4.5, 2.0), (5.6, 2.7),
    (3.0, 3.8), (3.0, 0.3), (-0.7, 2.0), (3.0, 4.6),
)  # fmt: skip
PARITY_WINDOW = (-1.6, 7.6, -1.1, 5.1)
RAY_LENGTH = 12.0  # how far the ray is drawn


def _ray(x: np.ndarray, unit: np.ndarray, far: float) -> fr.Item:
    return fr.segments("front", [[x, x + far * unit]])


def _where(x: np.ndarray, unit: np.ndarray, a: np.ndarray, b: np.ndarray) -> float:
    """How far along the ray it meets the line ab."""
    side = b - a
    return float((side[1] * (a - x)[0] - side[0] * (a - x)[1]) / (side[1] * unit[0] - side[0] * unit[1]))


def parity_state(outline: str = "three rings", place: int = 0, turn: float = 0.0) -> fr.Frame:
    """A ray from a point in some direction, and the facets that it counts.

    Parameters
    ----------
    outline : str
        One of `PARITY_OUTLINES`.
    place : int
        The number of the point in `PARITY_PLACES`.
    turn : float
        The direction of the ray in degrees.

    Returns
    -------
    dict
        A frame; its number is that of the facets, and whether it is odd.
    """
    points, facets = preset_named(PARITY_OUTLINES, outline)
    within("place", place, 0, len(PARITY_PLACES) - 1)
    x = np.array(PARITY_PLACES[place])
    unit = np.array([np.cos(np.radians(turn)), np.sin(np.radians(turn))])
    met = crossings(points, facets, x.tolist(), (x + unit).tolist())
    ends = np.array(points)
    at = [x + _where(x, unit, *ends[list(facet)]) * unit for facet in met]
    items = [
        fr.segments("constrained", ends[np.array(facets)]),
        _ray(x, unit, RAY_LENGTH),
        fr.dots("cavity", at),
        fr.dots("inserted", [x], handles=["X"]),
        fr.labels("inserted", [x], "X"),
    ]
    odd = len(met) % 2 == 1
    number = f"{len(met)} facet{'s' * (len(met) != 1)}: {'odd' if odd else 'even'}"
    return fr.frame("inside" if odd else "outside", *items, number=number, view=PARITY_WINDOW)


def parity_frames(
    points: Sequence[Sequence[float]], facets: Edges, x: Sequence[float], inner: Edges = ()
) -> list[fr.Frame]:
    """Counting by hand along the ray to the right, one place of the ray a frame.

    Parameters
    ----------
    points : (n, 2) floats
    facets, inner : pairs of numbers of points
        Inner pieces are met, but never count.
    x : pair of floats
        A point on no piece.

    Returns
    -------
    list of frames
        The point; the places where the ray meets pieces, from left to right; the result. Pieces along the
        ray itself are met at their left ends.
    """
    ends, start = np.array(points, dtype=float), np.array(x, dtype=float)
    unit = np.array([1.0, 0.0])
    counted = set(crossings(points, facets, x, (x[0] + 1, x[1])))
    stops: dict[float, list[tuple[int, int]]] = {}
    for piece in [*facets, *inner]:
        a, b = ends[list(piece)]
        low, high = min(a[1], b[1]), max(a[1], b[1])
        if not low <= x[1] <= high:
            continue
        along = min(a[0], b[0]) - x[0] if low == high else _where(start, unit, a, b)
        if along > 0:
            stops.setdefault(round(along, 9), []).append(piece)
    base = [
        fr.segments("constrained", ends[np.array(facets)]),
        fr.segments("highlight", [ends[list(piece)] for piece in inner]),
        fr.labels("vertex", ends, range(len(ends))),
    ]
    dot = [fr.dots("inserted", [start]), fr.labels("inserted", [(start[0], start[1] + 0.35)], "X")]
    made = [fr.frame("a ray to the right, from X", *base, _ray(start, unit, RAY_LENGTH), *dot, number="0")]
    total = 0
    for along in sorted(stops):
        named: dict[bool, list[str]] = {True: [], False: []}
        for piece in stops[along]:
            named[piece in counted].append(f"{piece[0]}–{piece[1]}")
        total += len(named[True])
        told = [f"{' and '.join(named[True])} count{'s' * (len(named[True]) == 1)}"] if named[True] else []
        told += [f"not {' and '.join(named[False])}"] if named[False] else []
        hit = [ends[list(piece)] for piece in stops[along] if piece in counted]
        items = [fr.segments("cavity", hit), fr.segments("front", [[start, start + along * unit]])]
        caption = ", ".join(told)
        made.append(fr.frame(caption, *base, *items, *dot, number=str(total)))
    odd = total % 2 == 1
    result = f"{total} is {'odd: X is inside' if odd else 'even: X is outside'}"
    made.append(fr.frame(result, *base, _ray(start, unit, RAY_LENGTH), *dot, number=str(total)))
    return [{**one, "view": list(PARITY_WINDOW)} for one in made]
