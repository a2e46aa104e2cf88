"""Which cells of a tree lie inside, outside, or are cut, told plainly (section 4a of the book).

A piece of the boundary, a point, a segment or a triangle, meets the inside of a cell exactly when what is
left of it after it is cut off at all sides of the cell has a point there. All numbers are Fractions.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from fractions import Fraction
from typing import Any

from unstruct.plain.tree import box, center

__all__ = ["clipped", "contains", "meets", "state"]

Cell = tuple[int, ...]
Point = tuple[Fraction, ...]
Piece = Sequence[Sequence[Any]]


def clipped(piece: list[Point], axis: int, bound: Fraction, sign: int) -> list[Point]:
    """The part of a point, a segment or a convex polygon in the half-space sign * (x[axis] - bound) >= 0."""
    left = []
    for p, q in zip(piece, piece[1:] + piece[:1], strict=True):
        here, there = sign * (p[axis] - bound), sign * (q[axis] - bound)
        if here >= 0:
            left.append(p)
        if here * there < 0:
            t = here / (here - there)
            left.append(tuple(a + t * (b - a) for a, b in zip(p, q, strict=True)))
    return left


def meets(piece: Piece, low: Sequence[Any], high: Sequence[Any]) -> bool:
    """Whether a piece meets the open box from low to high."""
    left = [tuple(map(Fraction, p)) for p in piece]
    for axis, (a, b) in enumerate(zip(low, high, strict=True)):
        left = clipped(clipped(left, axis, Fraction(a), 1), axis, Fraction(b), -1)
        if not left:
            return False
    # the mean of its corners is inside of what is left; if it is not inside of the box, nothing is
    mean = [sum(column, Fraction(0)) / len(left) for column in zip(*left, strict=True)]
    return all(a < m < b for a, m, b in zip(low, mean, high, strict=True))


def contains(segments: Collection[Piece], x: Sequence[Any]) -> bool:
    """Whether a point lies inside of a closed outline in the plane: a ray to the right crosses it oddly."""
    odd = False
    for (ax, ay), (bx, by) in segments:
        if (ay > x[1]) != (by > x[1]):
            t = Fraction(x[1] - ay) / Fraction(by - ay)
            odd ^= ax + t * (bx - ax) > x[0]
    return odd


def state(segments: Collection[Piece], cell: Cell) -> str:
    """ "cut" if the outline meets the inside of a square, otherwise "inside" or "outside"."""
    low, high = box(cell)
    if any(meets(segment, low, high) for segment in segments):
        return "cut"
    return "inside" if contains(segments, center(cell)) else "outside"
