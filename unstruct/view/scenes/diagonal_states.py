"""How one finds a diagonal of a room, with a loose vertex to be dragged, as a frame (section 3.1)."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from ...plain.predicates import orient
from ..draw import frames as fr
from .choices import preset_named, within

__all__ = ["DIAGONAL_ROOMS", "DIAGONAL_X", "DIAGONAL_Y", "diagonal_state"]

DIAGONAL_WALLS = (0.4, 2.6), (0.0, 0.5), (3.0, -0.6), (3.6, 1.6)  # u, v, w and a fourth corner
DIAGONAL_ROOMS = {"with a hole": ((1.5, 0.6), (2.2, 0.9), (1.7, 1.2)), "without a hole": ()}
DIAGONAL_X = [round(0.4 + 0.2 * k, 1) for k in range(14)]  # where the loose vertex may be
DIAGONAL_Y = [round(0.4 + 0.2 * k, 1) for k in range(7)]


def diagonal_state(x: float = 0.8, y: float = 0.8, room: str = "with a hole") -> fr.Frame:
    """Steps (2) to (4) of the proof of Theorem 3.1.3 in a room with a loose vertex.

    Parameters
    ----------
    x, y : float
        The loose vertex, which the reader can drag.
    room : str
        One of `DIAGONAL_ROOMS`.

    Returns
    -------
    dict
        The triangle uvw, the vertices in it, and the diagonal: from v to c, the one of these that is farthest
        from uw, or uw itself if there are none. The number has their distances from uw.
    """
    hole = preset_named(DIAGONAL_ROOMS, room)
    within("x", x, DIAGONAL_X[0], DIAGONAL_X[-1])
    within("y", y, DIAGONAL_Y[0], DIAGONAL_Y[-1])
    (u, v, w, _), loose = DIAGONAL_WALLS, (x, y)
    items = [
        fr.polygons("waiting", [(v, w, u)]),
        fr.segments("constrained", [*_sides(DIAGONAL_WALLS), *_sides(hole)]),
        fr.dots("vertex", [*DIAGONAL_WALLS, *hole]),
        fr.dots("vertex", [loose], handles=["loose"]),
        fr.labels("vertex", [u, v, w], "uvw"),
    ]
    if hole and _contains(hole, loose):
        return fr.frame("the loose vertex is in the hole, not in the room", *items)
    found = [p for p in (loose, *hole) if _contains((v, w, u), p)]
    if not found:
        items.append(fr.segments("inserted", [(u, w)]))
        return fr.frame("no other vertex is in uvw: uw is the diagonal", *items, number="nothing in uvw")
    c = max(found, key=lambda p: _twice_area(u, w, p))
    items += [
        fr.dots("highlight", [p for p in found if p != c]),
        fr.segments("inserted", [(v, c)]),
        fr.labels("vertex", [c], "c"),
    ]
    base = float(np.sqrt((u[0] - w[0]) ** 2 + (u[1] - w[1]) ** 2))
    away = sorted((abs(float(_twice_area(u, w, p))) / base for p in found), reverse=True)
    which = "the loose vertex" if c == loose else "a corner of the hole"
    number = "distances from uw: " + ", ".join(f"{d:.2f}" for d in away)
    return fr.frame(f"c is {which}, and vc is the diagonal", *items, number=number)


def _sides(corners: tuple) -> list:
    return list(zip(corners, (*corners[1:], *corners[:1])))


def _contains(corners: tuple, p: tuple) -> bool:
    """Whether a closed triangle, counterclockwise, contains a point."""
    return all(orient([a, b, p]) >= 0 for a, b in _sides(corners))


def _twice_area(u: tuple, w: tuple, p: tuple) -> Fraction:
    """Twice the area of uwp, exactly; positive if p is on the right of the way from u to w, as v is."""
    (a, b), (c, d), (e, f) = (tuple(map(Fraction, q)) for q in (u, w, p))
    return -((c - a) * (f - b) - (d - b) * (e - a))
