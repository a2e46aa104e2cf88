"""The rest, beside and beyond the layers, as a domain of its own."""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...domain.domain import Domain
from ...geometry.curves import Curve, CurveLike
from .scene import Scene, bare, slid_ranges
from .strips import Numbering, tops

__all__ = ["Remainder", "remainder"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


class Remainder(NamedTuple):
    """A domain of what layers leave, and where its pieces and points come from.

    Attributes
    ----------
    domain : Domain
    vertex : (n,) int64
        The number of each of its points in a `Numbering`.
    piece : (p,) int64
        The piece of the whole domain that each piece is a part of; -1 for edges of the envelope.
    span : (p, 2) float64
        The part of that piece.
    top : (e, 2) int64
        The edges of the envelope, as numbers of points.
    region : (p,) int64
        For edges of the envelope the region on their left; -1 for others.
    """

    domain: Domain
    vertex: Integers
    piece: Integers
    span: Array
    top: Integers
    region: Integers


def _part(domain: Domain, piece: int, t: Array) -> Array:
    return domain.points_at(np.full(len(t), piece), np.clip(t, 0.0, 1.0))


def remainder(scene: Scene, level: Integers, numbers: Numbering) -> Remainder:
    """The rest as a domain: edges of the envelope, which no method may split, and what is left of the pieces.

    Raises
    ------
    UnstructError
        If it is no valid domain; then the envelope touches a curve.
    """
    domain = scene.domain
    strip, top = tops(scene.rays, level, numbers)
    ends, piece, span, inner, held = _runs(scene, level, numbers)
    many, f = len(top), int((~inner).sum())
    order = np.argsort(inner, kind="stable")  # facets first
    ends, piece, span, held = ends[order], piece[order], span[order], held[order]
    every = np.concatenate([top, ends])
    used = flagged(len(numbers.points), every, scene.loose)
    vertex, rows = np.flatnonzero(used), (np.cumsum(used) - 1)[every]
    curves: dict[int, CurveLike] = {}
    for i in np.flatnonzero(flagged(len(domain.pieces), list(domain.curves))[piece]).tolist():
        p, (t0, t1) = int(piece[i]), span[i].tolist()
        whole = (t0, t1) == (0.0, 1.0)
        curves[many + i] = domain.curves[p] if whole else Curve(partial(_part, domain, p), t0, t1)
    made = Domain(
        numbers.points[vertex], rows[: many + f], inner=rows[many + f :] if len(rows) > many + f else None,
        curves=curves,
    )  # fmt: skip
    full = np.array([0.0, 1.0])
    made.spacings = {i: full for i in range(many)}
    made.spacings |= {many + i: full for i in np.flatnonzero(held).tolist()}
    none = np.full(many, -1, dtype=np.int64)
    region = np.concatenate([scene.walls.region[scene.rays.side[strip]], np.full(len(ends), -1)])
    return Remainder(
        made,
        vertex,
        np.concatenate([none, piece]),
        np.concatenate([np.tile(full, (many, 1)), span]),
        top,
        region,
    )


def _runs(
    scene: Scene, level: Integers, numbers: Numbering
) -> tuple[Integers, Integers, Array, NDArray[np.bool_], NDArray[np.bool_]]:
    """What is left of the pieces: ends, piece, span, whether inside, and whether it must stay as it is.

    Subsegments of one piece that follow each other are one again, except where a layer is on the other side
    or where the piece has given points.
    """
    rest, layer = bare(scene, level)
    ranges = slid_ranges(scene, level)
    rows = np.flatnonzero(rest & ~flagged(len(scene.domain.pieces), list(ranges))[scene.piece])
    p, span, ends = scene.piece[rows], scene.span[rows], scene.ends[rows]
    facets = len(scene.domain.facets)
    beside = layer[rows]  # a layer on the other side of an inner piece
    held = scene.domain.held()[p] | beside
    # Subsegments come in the order of their pieces.
    joined = (p[1:] == p[:-1]) & (ends[1:, 0] == ends[:-1, 1]) & ~held[1:] & ~held[:-1]
    first = np.flatnonzero(np.concatenate([[True], ~joined])) if len(rows) else np.empty(0, dtype=np.int64)
    last = np.append(first[1:], len(rows))[: len(first)] - 1
    ends = np.column_stack([ends[first, 0], ends[last, 1]])
    span = np.column_stack([span[first, 0], span[last, 1]])
    inner = (p[first] >= facets) & ~beside[first]
    p, held = p[first], held[first]
    for piece, tips in ranges.items():
        low, high = 0.0, 1.0
        a, b = scene.domain.pieces[piece].tolist()
        for r, t, forward in tips:
            tip = int(numbers.at(np.array([r]), level[[r]])[0])
            if forward:
                low, a = t, tip
            else:
                high, b = t, tip
        ends, span = np.concatenate([ends, [[a, b]]]), np.concatenate([span, [[low, high]]])
        inner, p, held = np.append(inner, piece >= facets), np.append(p, piece), np.append(held, False)
    return ends, p, span, inner, held
