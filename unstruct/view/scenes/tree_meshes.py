"""Triangles of a quadtree as frames: templates square by square, and a boundary by cutting and warping."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from fractions import Fraction
from functools import cache
from itertools import pairwise
from typing import Any

from ...base.errors import InputError
from ...plain import tree as plain_tree
from ...plain import tree_regions, tree_templates
from ..draw import frames as fr

__all__ = ["CUT_BOUNDARIES", "cut_state", "template_frames"]

Cell = tuple[int, ...]
Point = tuple[Any, ...]
CUT_LEVEL = 2  # the squares of `cut_state` are those of this level
CUT_WINDOW = [-0.04, 1.04, -0.04, 1.04]


def _square(cell: Cell) -> list[Point]:
    """The corners of a cell, counterclockwise."""
    (left, low), (right, high) = plain_tree.box(cell)
    return [(left, low), (right, low), (right, high), (left, high)]


def template_frames(leaves: Collection[Cell]) -> list[fr.Frame]:
    """How the leaves of a balanced quadtree become triangles: one square a frame.

    Parameters
    ----------
    leaves : collection of (level, i, j)
        As in `unstruct.plain.tree`; balanced across faces.

    Returns
    -------
    list of dict
        The squares, their hanging vertices, the fans one by one, the other squares, and the mesh.
    """
    if not plain_tree.is_balanced(leaves, "faces"):
        raise InputError("the leaves are not balanced across faces")
    cells = sorted(leaves, key=lambda cell: (plain_tree.center(cell)[1], plain_tree.center(cell)[0]))
    squares = fr.polygons("cell", [_square(cell) for cell in cells])
    hanging = sorted(tree_templates.hanging(leaves))
    hung = fr.dots("inserted", hanging)
    whole = tree_templates.triangles(leaves)
    centers = {cell: plain_tree.center(cell) for cell in cells}
    fans = [cell for cell in cells if any(centers[cell] in triangle for triangle in whole)]
    vertices = fr.dots("vertex", sorted(tree_templates.vertices(leaves)))
    frames = [
        fr.frame("the leaves of a tree", squares, number=f"{len(cells)} squares"),
        fr.frame("their corners", squares, vertices, number=f"{len(vertices['data'])} vertices"),
        fr.frame(
            "some hang on a side of a larger square",
            squares,
            vertices,
            hung,
            number=f"{len(hanging)} hanging vertices",
        ),
    ]
    done: list[Any] = []
    for cell in fans:
        fan = sorted(triangle for triangle in whole if centers[cell] in triangle)
        items = [
            squares,
            fr.polygons("accepted", done),
            fr.polygons("highlight", fan),
            hung,
            fr.dots("vertex", [centers[cell]]),
        ]
        done += fan
        frames.append(fr.frame("a fan about the center", *items, number=f"{len(fan)} triangles"))
    rest = sorted(whole - set(done))
    frames += [
        fr.frame(
            "two triangles in each of the other squares",
            squares,
            fr.polygons("accepted", done),
            fr.polygons("highlight", rest),
            number=f"{len(rest)} triangles",
        ),
        fr.frame("nothing hangs", fr.polygons("accepted", sorted(whole)), number=f"{len(whole)} triangles"),
    ]
    return frames


def _line(slope: Fraction) -> Callable[[Fraction], Callable[[Point], Any]]:
    half = Fraction(1, 2)
    return lambda offset: lambda p: p[1] - half - offset - slope * (p[0] - half)


def _disc(offset: Fraction) -> Callable[[Point], Any]:
    radius = Fraction(17, 20) + offset
    return lambda p: p[0] ** 2 + p[1] ** 2 - radius**2


CUT_BOUNDARIES: dict[str, Callable[[Fraction], Callable[[Point], Any]]] = {
    "a slope": _line(Fraction(2, 5)),
    "a steep slope": _line(Fraction(7, 3)),
    "a disc": _disc,
    "nasty: near a row": _line(Fraction(1, 50)),
}


def _outline(name: str, level: Callable[[Point], Any], offset: Fraction) -> list[Any]:
    """The boundary itself, as segments."""
    if name == "a disc":
        r = float(Fraction(17, 20) + offset)
        arc = [(r * math.cos(t), r * math.sin(t)) for t in (math.pi / 48 * k for k in range(25))]
        return list(pairwise(arc))
    zero, one = Fraction(0), Fraction(1)
    left, right = -level((zero, zero)), -level((one, zero))
    if right - left > 1:  # steep: it leaves through the lower and the upper side
        return [[(-left / (right - left), zero), ((1 - left) / (right - left), one)]]
    return [[(zero, left), (one, right)]]


@cache
def _squares_around() -> list[Any]:
    """The triangles of 16 squares and of a ring around them, so that the window is not where they end."""
    side = range(-1, 2**CUT_LEVEL + 1)
    return sorted(tree_templates.triangles({(CUT_LEVEL, i, j) for i in side for j in side}))


def _mean(triangle: Any) -> Point:
    return (sum(p[0] for p in triangle) / 3, sum(p[1] for p in triangle) / 3)


def _shown(p: Point) -> bool:
    """Whether a point lies in the unit square."""
    return bool(0 <= p[0] <= 1 and 0 <= p[1] <= 1)


def cut_state(boundary: str = "a slope", offset: float = 0.0, threshold: float = 0.0) -> fr.Frame:
    """Triangles of 16 squares, warped to a boundary and cut along it.

    Parameters
    ----------
    boundary : str
        One of `CUT_BOUNDARIES`.
    offset : float
        How far the boundary is moved; a side of a square is 1/4.
    threshold : float
        From 0 (only cut) to 1/2: a vertex is moved if less than this part of an edge is enough.

    Returns
    -------
    dict
        The triangles inside, the worst one marked, the moved vertices, the boundary, and the minimum angle.
    """
    shift, share = (Fraction(value).limit_denominator(1000) for value in (offset, threshold))
    level = CUT_BOUNDARIES[boundary](shift)
    whole = _squares_around()
    moved, value = tree_regions.warp(whole, level, share)
    moves = sorted({(p, q) for t, s in zip(whole, moved, strict=True) for p, q in zip(t, s, strict=True)})
    moves = [(p, q) for p, q in moves if p != q and _shown(q)]
    inside = [part for part in tree_regions.cut_all(moved, value, level) if _shown(_mean(part))]
    worst = max(inside, key=lambda triangle: max(tree_regions.cotangents(triangle)))
    angle = math.degrees(math.atan2(1, tree_regions.sharpest([worst])))
    items = [
        fr.polygons("muted", [triangle for triangle in whole if _shown(_mean(triangle))]),
        fr.polygons("cell", [triangle for triangle in inside if triangle != worst]),
        fr.polygons("bad", [worst]),
        fr.segments("constrained", _outline(boundary, level, shift)),
        fr.segments("highlight", moves),
        fr.dots("inserted", [q for _, q in moves]),
    ]
    text = "only cut" if threshold == 0 else f"vertices moved along up to {float(share):g} of an edge"
    number = f"minimum angle {angle:.1f} degrees; {len(moves)} vertices moved"
    return fr.frame(text, *items, number=number, view=CUT_WINDOW)
