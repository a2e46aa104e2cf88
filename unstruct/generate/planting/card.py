"""The picture of a tree in a notebook: its first levels as a small inline SVG, and counts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.card import card, to_pixels
from ..tree.cells import TreeCells

__all__ = ["html"]

MOST_SQUARES = 1200  # the largest number of leaves that are drawn
MOST_CUBES = 250
MOST_PIECES = 1500  # of the boundary
EDGES_OF_CUBE = [(a, a | 1 << k) for k in range(3) for a in range(8) if not a >> k & 1]


def html(tree: TreeCells) -> str:
    """An HTML card: the leaves, or those of as many first levels as can be drawn, and the counts."""
    room = MOST_SQUARES if tree.dimension == 2 else MOST_CUBES
    shown = tree.depth
    while shown > 0 and 1 + ((1 << tree.dimension) - 1) * sum(map(len, tree.linear.split[:shown])) > room:
        shown -= 1
    drawn = tree.prefix(shown)
    name = "Quadtree" if tree.dimension == 2 else "Octree"
    label = f"{name} of {len(tree):,} leaves" + ("" if shown == tree.depth else f", {shown} levels drawn")
    rows: list[tuple[str, int | str]] = [
        ("leaves", len(tree)),
        ("cells", len(tree) + tree.linear.divided),
        ("depth", tree.depth),
        ("balanced across", tree.balance or "nothing"),
    ]
    if len(tree.unfinished):
        rows.append(("unfinished", len(tree.unfinished)))
    return card(label, _flat(drawn) if tree.dimension == 2 else _solid(drawn), rows)


def _lines(ends: NDArray[np.float64], color: str, width: float) -> str:
    places = np.round(ends, 1).tolist()
    path = " ".join(f"M{a:g} {b:g}L{c:g} {d:g}" for (a, b), (c, d) in places)
    return f"<path d='{path}' stroke='{color}' stroke-width='{width:g}' fill='none'/>"


def _flat(tree: TreeCells) -> str:
    low, high = tree.corners
    rows = np.stack([low, high], axis=1)
    pixels = to_pixels(np.concatenate([rows, tree.box[None]]))[:-1]
    squares = " ".join(f"M{a:g} {b:g}H{c:g}V{d:g}H{a:g}Z" for (a, b), (c, d) in np.round(pixels, 1).tolist())
    drawing = f"<path d='{squares}' stroke='#8a8f94' stroke-width='0.5' fill='none'/>"
    if tree.boundary is not None:
        pieces = tree.boundary.pieces[:: 1 + len(tree.boundary.pieces) // MOST_PIECES]
        ends = tree.boundary.points[pieces] / tree.boundary.factor
        drawing += _lines(to_pixels(np.concatenate([ends, tree.box[None]]))[:-1], "#000000", 1.2)
    return drawing


def _solid(tree: TreeCells) -> str:
    low, high = tree.corners
    chosen = tree.states >= 0
    bits = (np.arange(8)[:, None] >> np.arange(3)) & 1
    corner = np.where(bits, high[chosen, None], low[chosen, None])
    corner = corner / max(float(np.abs(tree.box).max()), np.finfo(float).tiny)
    x, y, z = np.moveaxis(corner, -1, 0)
    flat = np.stack([0.866 * (x - y), z + 0.35 * (x + y)], axis=-1)
    return _lines(to_pixels(flat[:, EDGES_OF_CUBE].reshape(-1, 2, 2)), "#55595d", 0.5)
