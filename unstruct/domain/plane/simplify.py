"""`Domain.simplified`: fewer vertices on straight pieces, within a distance, and the region stays valid.

Rings smaller than the tolerance go first; then vertices are dropped one by one (`collapse`). The names of
pieces, curves, loose vertices, seeds, and vertices where pieces branch or change their names stay.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ...base.arguments import positive
from ...base.arrays import as_numbers
from ...base.errors import InputError
from ...geometry.boxes import BOXES_IN_LEAF, BoxTree
from ...geometry.outline import Outline
from ...predicates.batch import scaled
from ...sizing.field import as_size
from .account import Repair
from .collapse import Blockers, Chains, Limits, collapse, link
from .name_sets import name_sets
from .rings import Rings, small_rings
from .sample import Sampled

__all__ = ["Simplified", "simplified"]

# With a size, vertices are dropped only where a piece is shorter than this, in units of the size; and they
# are at most this far away from the new boundary if no tolerance is given.
SHORT_PIECE = 0.75
DEFAULT_TOLERANCE = 0.5
STRETCHES = 16  # boxes for each coarse chord of a curve


class Simplified(NamedTuple):
    """The arguments of the new `Domain`, what its vertices and pieces were, and the account."""

    parts: dict[str, Any]
    origin: np.ndarray
    piece_origin: np.ndarray
    repairs: list[Repair]


def simplified(outline: Outline, sampled: Sampled, tolerance: Any, size: Any) -> Simplified:
    """Simplify an outline: see `Domain.simplified`. ``sampled`` are its coarse chords."""
    xy, exact = scaled(outline.points)
    if not exact:
        raise InputError("the coordinates span too many powers of two to be simplified; scale them first")
    within, wanted = _limits(outline, tolerance, size)
    straight = np.ones(len(outline.pieces), dtype=bool)
    straight[list(outline.curves)] = False
    label, sets = name_sets(outline.markers, len(outline.pieces))
    free = _free(outline, straight, label)
    chains = _chains(outline.pieces[straight].astype(np.int64), free)
    rows = np.nonzero(straight)[0]
    seeds = np.concatenate([*outline.regions.values(), np.empty((0, 2))])
    factor = np.abs(xy).max() / np.abs(outline.points).max()  # a power of two
    rings = Rings.of(chains, label[rows])
    gone = small_rings(xy, rings, within * factor, seeds * factor, sets, outline.markers)
    lost = np.isin(chains.chain, rings.chain[gone])
    dead = np.zeros(len(xy), dtype=bool)
    dead[chains.ends[lost].ravel()] = True
    if len(outline.facets) and lost[rows < len(outline.facets)].all() and not outline.curves:
        raise InputError("the whole region is smaller than the tolerance; choose a smaller one")
    low, high = _curve_boxes(outline, sampled)
    blockers = _blockers(xy, dead, seeds * factor, low * factor, high * factor, chains)
    collapse(xy, chains, Limits(within * factor, wanted * factor), blockers)
    bare = (blockers.leaf[: len(xy)] < 0) & ~dead
    kept = (chains.ends[:, 0] >= 0) & ~lost
    repairs = _account(outline, rings, gone, bare, rows[kept])
    return _assembled(outline, chains.ends[kept], rows[kept], ~dead & ~bare, repairs)


def _limits(outline: Outline, tolerance: Any, size: Any) -> tuple[np.ndarray, np.ndarray]:
    """The tolerance at each vertex, and the length from which on pieces are long enough."""
    if tolerance is None and size is None:
        raise InputError("give a tolerance (a distance) or a size (the wanted edge length), or both")
    wanted = np.full(len(outline.points), np.inf)
    if size is not None:
        wanted = np.ascontiguousarray(as_size(size)(outline.points), dtype=np.float64)
    if tolerance is None:
        within = DEFAULT_TOLERANCE * wanted
    elif callable(tolerance) or np.ndim(as_numbers(tolerance, "tolerance")):
        raise InputError("tolerance must be a number; for one that varies give a size")
    else:
        within = np.full(len(outline.points), positive(tolerance, "tolerance"))
    return within, SHORT_PIECE * wanted


def _free(outline: Outline, straight: np.ndarray, label: np.ndarray) -> np.ndarray:
    """Vertices of just two pieces, both straight, both facets or both inner, with the same names."""
    n, pieces = len(outline.points), outline.pieces
    kind = 2 * label + (np.arange(len(pieces)) < len(outline.facets))
    degree = np.bincount(pieces.ravel(), minlength=n)
    degree += 3 * np.bincount(pieces[~straight].ravel(), minlength=n)
    least, most = np.full(n, kind.max(initial=0) + 1), np.full(n, -1)
    for column in (0, 1):
        np.minimum.at(least, pieces[:, column], kind)
        np.maximum.at(most, pieces[:, column], kind)
    return (degree == 2) & (least == most)


def _around(vertices: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """For rows with two vertices each, the rows at each vertex, as begin (n + 1,) and a list."""
    flat = vertices.ravel()
    begin = np.concatenate([[0], np.cumsum(np.bincount(flat[flat >= 0], minlength=n))])
    order = np.argsort(flat, kind="stable")
    return begin, order[np.searchsorted(flat[order], 0) :] // 2


def _chains(pieces: np.ndarray, free: np.ndarray) -> Chains:
    n, m = len(free), len(pieces)
    chains = Chains(*(np.full(shape, -1) for shape in ((m, 2), m, m, m, n, n, n, (m, 2), m)))
    begin, around = _around(pieces, n)
    many = link(pieces, free, begin, around, chains)
    return chains._replace(tips=chains.tips[:many], left=chains.left[:many])


def _curve_boxes(outline: Outline, sampled: Sampled) -> tuple[np.ndarray, np.ndarray]:
    """Boxes that contain the curves: about short chords, widened by half their length.

    A coarse chord turns by at most 60 degrees, so that its curve is nearer to it than a third of its length.
    """
    rows = np.nonzero(np.isin(sampled.piece, list(outline.curves)))[0]
    steps = np.arange(STRETCHES + 1) / STRETCHES
    t = sampled.span[rows, :1] + np.diff(sampled.span[rows]) * steps
    x = outline.points_at(np.repeat(sampled.piece[rows], STRETCHES + 1), t.ravel())
    x = x.reshape(-1, STRETCHES + 1, 2)
    a, b = x[:, :-1].reshape(-1, 2), x[:, 1:].reshape(-1, 2)
    reach = np.hypot(*(b - a).T)[:, None] / 2
    return np.minimum(a, b) - reach, np.maximum(a, b) + reach


def _blockers(
    xy: np.ndarray, dead: np.ndarray, seeds: np.ndarray, low: np.ndarray, high: np.ndarray, chains: Chains
) -> Blockers:
    """All that stays: vertices but those of dropped rings, seeds, and boxes of curves."""
    number = np.concatenate([np.nonzero(~dead)[0], len(xy) + np.arange(len(seeds) + len(low))])
    low, high = (np.concatenate([xy, seeds, boxes]) for boxes in (low, high))
    tree = BoxTree(low[number], high[number])
    leaves = len(tree.low) // 2
    leaf = np.full(len(low), -1)
    leaf[number[tree.order]] = leaves + np.arange(len(number)) // BOXES_IN_LEAF
    alive = np.bincount(leaf[leaf >= 0], minlength=2 * leaves)
    half = leaves
    while half > 1:
        half //= 2
        alive[half : 2 * half] = alive[2 * half : 4 * half].reshape(-1, 2).sum(axis=1)
    begin, at = _around(chains.tips, len(xy))
    stack = np.empty(128, dtype=np.int64)
    return Blockers(tree.low, tree.high, number[tree.order], low, high, leaf, alive, begin, at, stack)


def _account(
    outline: Outline, rings: Rings, gone: np.ndarray, bare: np.ndarray, kept: np.ndarray
) -> list[Repair]:
    found = []
    for ring in np.nonzero(gone)[0].tolist():
        vertices = rings.vertices(ring)
        x, y = outline.points[vertices[0]].tolist()
        what = f"the ring of {len(vertices)} vertices near ({x:.6g}, {y:.6g})"
        text = f"{what} is smaller than the tolerance; it was dropped"
        found.append(Repair("dropped ring", text, (x, y), (), tuple(vertices.tolist())))
    vertices = np.nonzero(bare)[0]
    if len(vertices):
        x, y = outline.points[vertices[0]].tolist()
        text = f"{len(vertices)} vertices were dropped from straight pieces; {len(kept)} of these are left"
        found.append(Repair("dropped vertices", text, (x, y), (), tuple(vertices.tolist())))
    return found


def _assembled(
    outline: Outline, ends: np.ndarray, rows: np.ndarray, stays: np.ndarray, repairs: list[Repair]
) -> Simplified:
    """The new arguments: straight pieces ``rows`` with their ends, and the curves, in the order of before."""
    pieces = outline.pieces.astype(np.int64)
    left = np.zeros(len(pieces), dtype=bool)
    left[list(outline.curves)] = left[rows] = True
    turned = pieces[rows, 1] == ends[:, 0]  # chains have a direction of their own, and keep first ends
    pieces[rows] = np.where(turned[:, None], ends[:, ::-1], ends)
    number = np.cumsum(left) - 1
    pieces = (np.cumsum(stays) - 1)[pieces[left]].astype(np.int32)
    many = int(left[: len(outline.facets)].sum())
    parts = {
        "points": outline.points[stays],
        "facets": pieces[:many],
        "inner": pieces[many:],
        "curves": {int(number[piece]): curve for piece, curve in outline.curves.items()},
        "markers": {name: number[rows[left[rows]]] for name, rows in outline.markers.items()},
        "regions": outline.regions,
    }
    return Simplified(parts, np.nonzero(stays)[0], np.nonzero(left)[0], repairs)
