"""Triangles removed one by one, and a mesh cut along a line: what N - E + T does (chapter 1)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np

from ...base.errors import InputError
from ...plain.adjacency import face_counts, neighbors, removable
from ..draw import frames as fr
from .choices import within

__all__ = ["CUT_MESH", "cut_counts", "line_cut_state", "peeling_frames"]

# Seven points and seven triangles, the example of chapter 1.
CUT_MESH = (
    ((0, 2), (3, 0), (7, 1), (6, 5), (2, 6), (3, 3), (5, 3)),
    ((0, 1, 5), (1, 6, 5), (1, 2, 6), (2, 3, 6), (3, 5, 6), (3, 4, 5), (4, 0, 5)),
)
LINE_CUT_WINDOW = [-1.0, 8.0, -0.9, 6.9]


def peeling_frames(
    points: Any, cells: Sequence[Sequence[int]], keep: int = 0, names: str = ""
) -> list[fr.Frame]:
    """Remove triangles from a disk, always one that may go and the last such one, until one is left.

    Parameters
    ----------
    points : (n, 2) array
    cells : rows of three vertices
        A triangulated disk.
    keep : int
        The triangle that stays.
    names : str
        A letter for each point; by default they have none.

    Returns
    -------
    list of dict
        A frame for each triangle: removable ones are blue, those that would leave two parts which touch in a
        point are red, and the next one to go is pink. The number is N - E + T.

    Raises
    ------
    InputError
        If at some time no triangle but ``keep`` may be removed: the triangles are no disk.
    """
    points = np.asarray(points, dtype=float)
    if not 0 <= keep < len(cells):
        raise InputError(f"keep = {keep} must be one of the {len(cells)} triangles")
    window = fr.bounds([fr.frame("", fr.dots("vertex", points))], margin=0.14)
    left, frames = list(range(len(cells))), []
    while True:
        rows = [list(cells[t]) for t in left]
        free = [left[k] for k in removable(rows)]
        chosen = next((t for t in reversed(free) if t != keep), None)
        if chosen is None and len(left) > 1:
            raise InputError(f"none of the {len(left)} triangles but {keep} may be removed: this is no disk")
        edge = [t for t, beyond in zip(left, neighbors(rows)) if min(beyond) < 0]
        groups = {
            "cell": [t for t in left if t not in edge],
            "accepted": [t for t in free if t != chosen],
            "bad": [t for t in edge if t not in free and len(left) > 1],
            "highlight": [chosen] if chosen is not None else left,
        }
        items = [fr.polygons(name, points[[list(cells[t]) for t in ts]]) for name, ts in groups.items() if ts]
        used = sorted({v for row in rows for v in row})
        items.append(fr.dots("vertex", points[used]))
        items += [fr.labels("vertex", points[used], [names[v] for v in used])] if names else []
        n, e, t = face_counts(rows)
        caption = f"{len(left)} triangles" if len(left) > 1 else "one triangle: 3 − 3 + 1"
        frames.append(fr.frame(caption, *items, number=f"{n} − {e} + {t} = {n - e + t}", view=window))
        if chosen is None:
            return frames
        left.remove(chosen)


def cut_counts(
    points: Any, cells: Sequence[Sequence[int]], offset: float, slope: float
) -> tuple[tuple[int, int, int], list[list[Any]], list[list[Any]]]:
    """Cut a triangulation along the line y = offset + slope (x - 3.5), exactly.

    Returns
    -------
    counts : (vertices, edges, cells) after the cut
    below, above : list
        The convex pieces on both sides, as lists of points that are pairs of `Fraction`.
    """
    a, b = Fraction(offset), Fraction(slope)
    exact = [(Fraction(x), Fraction(y)) for x, y in np.asarray(points, dtype=float).tolist()]
    height = [y - a - b * (x - Fraction(7, 2)) for x, y in exact]

    def crossing(u: int, v: int) -> tuple[Fraction, Fraction]:
        s = height[u] / (height[u] - height[v])
        (x, y), (z, w) = exact[u], exact[v]
        return x + s * (z - x), y + s * (w - y)

    faces = {frozenset(f) for cell in cells for k in (1, 2, 3) for f in combinations(cell, k)}
    counts = [0, 0, 0]
    for face in faces:
        cut = min(height[v] for v in face) < 0 < max(height[v] for v in face)
        counts[len(face) - 1] += 2 if cut else 1
        if cut:
            counts[len(face) - 2] += 1
    halves: list[list[list[Any]]] = [[], []]
    for cell in cells:
        for side, sign in zip(halves, (-1, 1)):
            piece: list[Any] = []
            for u, v in zip(cell, (*cell[1:], cell[0])):
                piece += [exact[u]] if height[u] * sign >= 0 else []
                piece += [crossing(u, v)] if height[u] * height[v] < 0 else []
            if any(height[v] * sign > 0 for v in cell):
                side.append(piece)
    return (counts[0], counts[1], counts[2]), halves[0], halves[1]


def line_cut_state(offset: float = 3.25, slope: float = 0.25) -> fr.Frame:
    """The seven triangles of `CUT_MESH`, cut along a line; the number is N - E + T before and after.

    Parameters
    ----------
    offset : float
        The height of the line in the middle of the picture, from 0 to 6.
    slope : float
        From -2 to 2.
    """
    within("offset", offset, 0.0, 6.0)
    within("slope", slope, -2.0, 2.0)
    points, cells = CUT_MESH
    before = face_counts(cells)
    after, below, above = cut_counts(points, cells, offset, slope)
    xs = np.array(LINE_CUT_WINDOW[:2])
    new = {p for piece in below for p in piece} & {p for piece in above for p in piece}
    new -= {(Fraction(x), Fraction(y)) for x, y in points}
    items: list[Any] = [
        fr.polygons("cell", below),
        fr.polygons("accepted", above),
        fr.segments("front", [np.column_stack([xs, offset + slope * (xs - 3.5)])]),
        fr.dots("vertex", points),
        fr.labels("vertex", np.array(points) + np.array([0.15, 0.1]), "ABCDEFG"),
    ]
    if new:
        items.append(fr.dots("inserted", sorted((float(x), float(y)) for x, y in new)))
    gained = [b - a for a, b in zip(before, after)]
    caption = "more vertices: {}, edges: {}, cells: {}".format(*gained)
    number = " → ".join(f"{n} − {e} + {t} = {n - e + t}" for n, e, t in (before, after))
    return fr.frame(caption, *items, number=number, view=LINE_CUT_WINDOW)
