"""Quadtrees as frames: division by division, balance, the order of keys, search, and the cost of balance."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import product
from typing import Any

import numpy as np

from ...plain import tree as plain
from ..draw import frames as fr

__all__ = [
    "UNIT_WINDOW",
    "balance_frames",
    "division_frames",
    "halo_frames",
    "many",
    "order_frame",
    "rule_frame",
    "search_frames",
]

Cell = tuple[int, ...]
UNIT_WINDOW = (-0.03, 1.03, -0.03, 1.03)


def corners_of(cell: Cell) -> list[list[float]]:
    """The corners of a square of the unit square, counterclockwise."""
    (x, y), (right, top) = ([float(c) for c in corner] for corner in plain.box(cell))
    return [[x, y], [right, y], [right, top], [x, top]]


def squares(role: str, cells: Collection[Cell], opacity: float = 1.0) -> fr.Item:
    """Cells of the plain version as an item, the larger ones first."""
    return fr.polygons(role, [corners_of(cell) for cell in sorted(cells)], opacity=opacity)


def many(number: int, what: str, several: str = "") -> str:
    """A number with its noun: "1 leaf", "4 leaves"."""
    return f"{number} {what if number == 1 else several or what + 's'}"


# ---------------------------------------------------------------------- division


def division_frames(
    points: Sequence[Sequence[Any]], names: Sequence[str], most: int = 1, deepest: int = 10
) -> list[fr.Frame]:
    """A tree by hand: the squares with more than `most` points are divided, one a frame, level by level.

    Parameters
    ----------
    points : sequence of (x, y)
        In the unit square. A point on a common side belongs to the square above it, or to its right.
    names : sequence of str
        Their labels.
    most : int
    deepest : int
        No cell of this level is divided.

    Returns
    -------
    list of dict
        The root, a frame for each division, and no more.
    """
    shown = [fr.dots("vertex", points), fr.labels("vertex", points, names)]
    leaves: set[Cell] = {(0, 0, 0)}
    frames = [_divided(leaves, [], shown, f"the root has {many(len(points), 'point')}")]
    waiting: list[Cell] = [(0, 0, 0)]
    while waiting:
        cell = waiting.pop(0)
        inside = [name for name, p in zip(names, points, strict=True) if _holds(cell, p)]
        if len(inside) <= most or cell[0] >= deepest:
            continue
        leaves.remove(cell)
        leaves.update(plain.children(cell))
        waiting += plain.children(cell)
        caption = f"{', '.join(inside)} are in one square of level {cell[0]}: it is divided"
        frames.append(_divided(leaves, plain.children(cell), shown, caption))
    return frames


def _holds(cell: Cell, point: Sequence[Any]) -> bool:
    """Whether a square contains a point, its lower and left sides included."""
    low, high = plain.box(cell)
    return all(a <= x < b for a, x, b in zip(low, point, high, strict=True))


def _divided(leaves: set[Cell], new: list[Cell], shown: list[fr.Item], caption: str) -> fr.Frame:
    """The leaves, those that are new, and the points."""
    number = f"{many(len(leaves), 'leaf', 'leaves')}, depth {plain.depth(leaves)}"
    items = [squares("cell", leaves), squares("accepted", new), *shown]
    return fr.frame(caption, *items, number=number, view=UNIT_WINDOW)


# ---------------------------------------------------------------------- balance


def balance_frames(leaves: Collection[Cell], across: str = "corners") -> list[fr.Frame]:
    """Balance by hand: a frame for each leaf that is divided since a neighbor is two levels deeper or more.

    The deepest leaves come first, and of their neighbors the largest.

    Parameters
    ----------
    leaves : collection of cells
        A tree of `unstruct.plain.tree` in the plane.
    across : "faces" or "corners"

    Returns
    -------
    list of dict
        The last frame has the balanced tree, and its hanging vertices.
    """
    now, frames, added = set(leaves), [], 0
    while (found := _first_jump(now, across)) is not None:
        small, large = found
        items = [squares("cell", now), squares("cavity", [large]), squares("highlight", [small])]
        caption = f"a leaf of level {small[0]} touches one of level {large[0]}: the larger one is divided"
        frames.append(fr.frame(caption, *items, number=many(len(now), "leaf", "leaves"), view=UNIT_WINDOW))
        now.remove(large)
        now.update(plain.children(large))
        added += 1
    new = [cell for cell in now if cell not in leaves]
    hanging = _hanging(now)
    items = [squares("cell", now), squares("waiting", new), fr.dots("vertex", hanging)]
    caption = f"balanced after {many(added, 'division')}"
    number = f"{len(now)} leaves, {many(len(hanging), 'hanging vertex', 'hanging vertices')}"
    return [*frames, fr.frame(caption, *items, number=number, view=UNIT_WINDOW)]


def _first_jump(leaves: set[Cell], across: str) -> tuple[Cell, Cell] | None:
    """A leaf and a neighbor that is two levels larger or more; None if there is none."""
    for small in sorted(leaves, key=lambda cell: (-cell[0], cell)):
        level, i, j = small
        beside = [plain.covering(leaves, (level, i + a, j + b)) for a, b in plain.steps(2, across)]
        large = min((cell for cell in beside if cell is not None), default=small)
        if large[0] < level - 1:
            return small, large
    return None


def _hanging(leaves: Collection[Cell]) -> list[list[float]]:
    """The vertices of leaves that lie inside a side of another leaf."""
    deep = plain.depth(leaves)
    boxes = [(i << (deep - k), j << (deep - k), 1 << (deep - k)) for k, i, j in leaves]
    vertices = {(x + a * s, y + b * s) for x, y, s in boxes for a, b in product((0, 1), repeat=2)}
    found = {
        (u, v)
        for x, y, s in boxes
        for u, v in vertices
        if (u in (x, x + s) and y < v < y + s) or (v in (y, y + s) and x < u < x + s)
    }
    return [[u / 2**deep, v / 2**deep] for u, v in sorted(found)]


def rule_frame(across: str = "corners") -> fr.Frame:
    """The rule that is balance: a divided cell Q of level 3, and the cells of level 2 that it asks for."""
    q = (3, 5, 2)
    wanted = {(2, 2 + i, 1 - j) for i, j in product((0, 1), repeat=2) if across == "corners" or i * j == 0}
    grid = [(2, i, j) for i, j in product(range(1, 4), range(3))]
    items = [squares("cell", grid), squares("waiting", wanted), squares("cavity", plain.children(q))]
    places = [[float(c) - 0.02 for c in plain.center(cell)] for cell in sorted(wanted)]
    items += [fr.labels("vertex", [[float(c) - 0.03 for c in plain.center(q)]], ["Q"])]
    items += [fr.labels("vertex", places, ["R"] * len(wanted))]
    what = "a side or a corner" if across == "corners" else "a side"
    number = f"Q asks for {len(wanted)} cells, its parent among them"
    return fr.frame(f"across {what}", *items, number=number, view=(0.22, 1.03, -0.03, 0.78))


def halo_frames() -> list[fr.Frame]:
    """The proof of the cost of balance: how far a chain of requests can reach, and whom it pays."""
    side = 1 / 4
    grid = [(2, i, j) for i, j in product(range(4), range(4))]
    middle, chain = (2, 1, 1), [(3, 4, 2), (4, 10, 5), (5, 22, 9)]
    payer = (2, 2, 1)
    ring = [(2, 1 + i, 1 + j) for i, j in product((-1, 0, 1), repeat=2) if i or j]
    names = [fr.labels("vertex", [[0.36, 0.355]], ["S"])]
    base = [squares("cell", grid), squares("cavity", [middle]), *names]
    texts = [
        "a divided cell of half the side of S touches S, or lies in it: it asks for S",
        "and is asked for itself by a cell of half its own side",
        "and so on: the chain reaches less than s/2 + s/4 + ... = s beyond S",
        "so its end lies in S or in one of the 8 cells beside S: this cell A pays for S",
    ]
    frames = []
    for k in range(1, 4):
        items = [*base, squares("waiting", chain[:k])]
        reach = sum(side / 2**i for i in range(1, k + 1))
        frames.append(fr.frame(texts[k - 1], *items, number=f"reach {reach / side:g} s", view=UNIT_WINDOW))
    last = [*base[:1], squares("layer", ring), squares("accepted", [payer]), *base[1:]]
    label = fr.labels("vertex", [[0.68, 0.42]], ["A"])
    frames.append(
        fr.frame(texts[3], *last, squares("waiting", chain), label, number="reach below s", view=UNIT_WINDOW)
    )
    return frames


# ---------------------------------------------------------------------- order and search


def order_frame(leaves: Collection[Cell], *, numbers: bool = True) -> fr.Frame:
    """The leaves in the order of their keys, as a path through their centers; below it their intervals.

    The bar below the square is the range of all keys of the deepest level, and each leaf a part of it.
    """
    deep = plain.depth(leaves)
    ordered = sorted(leaves, key=lambda cell: plain.key(cell, deep))
    centers = np.array([[float(c) for c in plain.center(cell)] for cell in ordered])
    bar = [(plain.key(cell, deep) / 4**deep, 4.0 ** -cell[0]) for cell in ordered]
    boxes = [[[x, -0.16], [x + w, -0.16], [x + w, -0.08], [x, -0.08]] for x, w in bar]
    items = [squares("cell", leaves), fr.polygons("cell", boxes)]
    items += [fr.segments("layer", np.stack([centers[:-1], centers[1:]], axis=1)), fr.dots("layer", centers)]
    if numbers:
        items.append(fr.labels("vertex", centers, range(len(ordered))))
    caption = "the leaves in the order of their keys"
    number = f"{len(ordered)} leaves share {4**deep} keys of level {deep}"
    return fr.frame(caption, *items, number=number, view=(-0.03, 1.03, -0.2, 1.03))


def search_frames(leaves: Collection[Cell], point: Sequence[Any]) -> list[fr.Frame]:
    """The leaf that contains a point, by halving the sorted list of keys: a frame for each comparison.

    Parameters
    ----------
    leaves : collection of cells
        A tree of `unstruct.plain.tree` in the plane.
    point : (x, y)
        In the unit square, not on its upper sides.

    Returns
    -------
    list of dict
        Blue: the leaves that are still possible. The last frame has the leaf.
    """
    deep = plain.depth(leaves)
    ordered = sorted(leaves, key=lambda cell: plain.key(cell, deep))
    firsts = [plain.key(cell, deep) for cell in ordered]
    key = plain.key((deep, *(int(c * 2**deep) for c in point)), deep)
    star, low, high, frames = fr.dots("inserted", [point]), 0, len(ordered), []
    while high - low > 1:
        middle = (low + high) // 2
        items = [squares("cell", leaves), squares("accepted", ordered[low:high])]
        items += [squares("highlight", [ordered[middle]]), star]
        relation = ">=" if key >= firsts[middle] else "<"
        caption = f"leaf {middle} begins with key {firsts[middle]}: {key} {relation} {firsts[middle]}"
        frames.append(fr.frame(caption, *items, number=f"{high - low} leaves are possible", view=UNIT_WINDOW))
        low, high = (middle, high) if key >= firsts[middle] else (low, middle)
    items = [squares("cell", leaves), squares("accepted", [ordered[low]]), star]
    caption = f"leaf {low} contains the point"
    return [*frames, fr.frame(caption, *items, number=many(len(frames), "comparison"), view=UNIT_WINDOW)]
