"""Where each ray stops: by match, by proximity, or because its neighbors have stopped."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel
from ...geometry.boxes import BoxTree
from ...sizing.field import SizeField
from .heights import Fronts
from .rays import FAN_RAY, SLIDING_RAY, TAPER_RAY, Rays
from .spring import is_ahead, meet

__all__ = [
    "BY_COUNT",
    "BY_END",
    "BY_EXACTNESS",
    "BY_FRONT",
    "BY_MATCH",
    "BY_SHAPE",
    "BY_STEP",
    "STOP_REASONS",
    "Stops",
    "chains_of",
    "leveled",
    "stops_of",
]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

BY_COUNT, BY_MATCH, BY_FRONT, BY_STEP, BY_EXACTNESS, BY_SHAPE, BY_END = range(7)
STOP_REASONS = ("count", "match", "near", "step", "exactness", "shape", "end")
MATCHED = 0.95  # a ray stops before a step of so many spacings
SHRUNK = 0.5  # ... or before its front is so much shorter than the wall
STRETCHED = 1.5  # ... or so many wanted sizes
ASK_SIZE_FROM = 0.25  # steps shorter than this share of the spacing cannot match a size
FAR_ALONG = 1 << 60
OWN_VERTICES = 4  # vertices of a wall: what is nearer along it is no opposing front


class Stops(NamedTuple):
    """For each ray the number of its layers, and the reason why it has no more."""

    level: Integers
    reason: NDArray[np.int8]


def leveled(stops: Stops, rays: Rays) -> Stops:
    """Levels of neighbors differ by at most 1."""
    level, reason = stops.level.copy(), stops.reason.copy()
    _level(rays.before, rays.after, level, reason)
    return Stops(level, reason)


@kernel
def _level(before, after, level, reason):
    """Lower levels, forward and back along the fronts, until those of neighbors differ by at most 1."""
    n, changed = len(level), True
    while changed:
        changed = False
        for step in range(2 * n):
            r = step if step < n else 2 * n - 1 - step
            for other in (before[r], after[r]):
                if other >= 0 and level[other] + 1 < level[r]:
                    level[r], reason[r], changed = level[other] + 1, BY_STEP, True


def stops_of(
    rays: Rays, fronts: Fronts, size: SizeField, rest: tuple[Array, Integers], spring: bool,
    slides: Integers,
) -> Stops:  # fmt: skip
    """Where rays stop, before the exact tests.

    Parameters
    ----------
    rays : Rays
    fronts : Fronts
    size : SizeField
        The wanted edge length.
    rest : (j, 2) float64 and (j,) int64
        Points of what is no wall, and their pieces (-1: loose).
    spring : bool
        Whether springs decide, or the nearest point.
    slides : (r,) int64
        The piece that each sliding ray follows, else -1.
    """
    level, reason = _matched(rays, fronts, size)
    level[rays.kind == TAPER_RAY], reason[rays.kind == TAPER_RAY] = 0, BY_END
    stops = leveled(Stops(level, reason), rays)
    return leveled(_near(rays, fronts, stops, rest, spring, slides), rays)


def _matched(rays: Rays, fronts: Fronts, size: SizeField) -> tuple[Integers, NDArray[np.int8]]:
    """The first layer of each ray whose step would match the spacing or the size."""
    apart, steps = fronts.apart, fronts.steps
    wall = _wall_spacing(rays, apart)
    fan = rays.kind == FAN_RAY
    first, asked = np.empty((2, len(wall)), dtype=np.int64)
    _first_steps(steps, apart, wall, fan, first, asked)
    # Of the layers from `asked` on the last one before `first` is looked at first. Where the growth of the
    # size is known, this tells of most others that the size stops no ray there.
    rows = np.flatnonzero(asked < first)
    if len(rows):
        last = np.full(len(wall), np.inf)
        at = fronts.places[rows, first[rows] - 1]
        last[rows] = size(at)
        change = np.inf if size.growth is None else size.growth
        ray, layer = np.empty((2, int((first - asked)[rows].sum())), dtype=np.int64)
        wanted = np.empty(len(ray))
        many = _to_ask(
            (fronts.places, steps, apart), wall, fan, (first, asked), last, change, (ray, layer), wanted
        )
        ray, layer, wanted = ray[:many], layer[:many], wanted[:many]
        open_ = np.flatnonzero(wanted < 0.0)
        if len(open_):
            wanted[open_] = size(fronts.places[ray[open_], layer[open_]])
        stop = (steps[ray, layer] >= MATCHED * wanted) | (
            (apart[ray, layer + 1] > STRETCHED * np.maximum(wanted, wall[ray])) & ~fan[ray]
        )
        np.minimum.at(first, ray[stop], layer[stop])
    level = np.minimum(first, fronts.most)
    reason = np.where(first <= fronts.most, BY_MATCH, np.where(rays.kind == SLIDING_RAY, BY_END, BY_COUNT))
    reason[first == steps.shape[1]] = BY_MATCH if fronts.endless else BY_COUNT
    return level, reason.astype(np.int8)


@kernel
def _first_steps(steps, apart, wall, fan, first, asked):
    """The first layer of each ray that matches the spacing, and the first one for which the size matters."""
    for r in range(steps.shape[0]):
        first[r] = asked[r] = steps.shape[1]
        for k in range(steps.shape[1]):
            here = max(apart[r, k], wall[r]) if fan[r] else apart[r, k]
            if steps[r, k] >= MATCHED * here or (apart[r, k + 1] < SHRUNK * wall[r] and not fan[r]):
                first[r] = k
                break
            if asked[r] > k and (steps[r, k] >= ASK_SIZE_FROM * here or here > STRETCHED * wall[r]):
                asked[r] = k


@kernel
def _to_ask(tables, wall, fan, range_, last, change, rows, wanted):
    """Write the rays and layers at which the size could stop a ray; how many there are.

    ``wanted`` gets the size where it is known, else -1. ``last`` is the size at the last layer of each range,
    ``change`` the growth of the size.
    """
    places, steps, apart = tables
    first, asked = range_
    ray, layer = rows
    many = 0
    for r in range(len(wall)):
        for k in range(asked[r], first[r]):
            here = max(apart[r, k], wall[r]) if fan[r] else apart[r, k]
            if not (steps[r, k] >= ASK_SIZE_FROM * here or here > STRETCHED * wall[r]):
                continue
            end = first[r] - 1
            x, y = places[r, k, 0] - places[r, end, 0], places[r, k, 1] - places[r, end, 1]
            least = last[r] if k == end else last[r] - change * math.hypot(x, y)
            ahead = apart[r, k + 1] > STRETCHED * max(least, wall[r]) and not fan[r]
            if steps[r, k] >= MATCHED * least or ahead:
                ray[many], layer[many], wanted[many] = r, k, last[r] if k == end else -1.0
                many += 1
    return many


def _wall_spacing(rays: Rays, apart: Array) -> Array:
    """The mean length of the sides at each ray's base; rays of a fan share that of their vertex."""
    found = np.where(np.isfinite(apart[:, 0]), apart[:, 0], 0.0)
    fan = np.flatnonzero(rays.kind == FAN_RAY)
    if len(fan):
        values, group = np.unique(rays.base[fan], return_inverse=True)
        most = np.zeros(len(values))
        np.maximum.at(most, group, 2 * found[fan])  # only one neighbor of an outer ray is elsewhere
        found[fan] = most[group]
    return found


# ---------------------------------------------------------------------- opposing fronts


def chains_of(rays: Rays) -> tuple[Integers, Integers, Integers]:
    """The chain of each ray, its place counted in vertices of the wall, and the length of closed chains."""
    before, after = rays.before, rays.after
    step = np.zeros(len(before), dtype=np.int64)  # fans count as one vertex
    step[rays.left] = rays.base[rays.left] != rays.base[rays.right]
    chain, place, around = np.full((3, len(before)), -1, dtype=np.int64)
    _follow(before, after, step, chain, place, around)
    return chain, place, around


@kernel
def _follow(before, after, step, chain, place, around):
    """Number the chains and the places on them; open chains come first, from their starts."""
    count = 0
    for closed in range(2):
        for start in range(len(before)):
            if chain[start] >= 0 or (before[start] >= 0 and not closed):
                continue
            r, at = start, 0
            while r >= 0 and chain[r] < 0:
                chain[r], place[r], around[r] = count, at, 0
                at += step[r]
                r = after[r]
            count += 1
            if r == start:
                around[r] = at
                while after[r] != start:
                    r = after[r]
                    around[r] = at


def _near(
    rays: Rays, fronts: Fronts, stops: Stops, rest: tuple[Array, Integers], spring: bool, slides: Integers
) -> Stops:
    """Let rays stop, layer by layer, where a point of another front or of the rest is near."""
    level, reason = stops.level.copy(), stops.reason.copy()
    stopped = np.zeros(len(level), dtype=bool)
    fan = rays.kind == FAN_RAY
    apart = fronts.apart
    if fan.any():
        apart = apart.copy()
        apart[fan, :-1] = fronts.apart[fan, 1:]
    meet(
        (fronts.places, fronts.steps, apart), (rays.direction, rays.before, rays.after),
        _candidates(rays, fronts, stops, rest, slides), np.ascontiguousarray(rest[0]), spring, level, stopped,
    )  # fmt: skip
    reason[stopped] = BY_FRONT
    return Stops(level, reason)


def _candidates(
    rays: Rays, fronts: Fronts, stops: Stops, rest: tuple[Array, Integers], slides: Integers
) -> tuple[Integers, Integers]:
    """Pairs of a ray and a ray of another front, or a point of the rest, that may come near."""
    n = len(rays.base)
    top = stops.level
    row = np.arange(n)
    tip, base = fronts.places[row, top], fronts.places[:, 0]
    low, high = np.minimum(base, tip), np.maximum(base, tip)
    step = fronts.steps[row, np.minimum(top, fronts.steps.shape[1] - 1)]
    wide = np.maximum(
        *(np.where(np.isfinite(d), d, 0.0) for d in (fronts.apart[row, top], fronts.apart[:, 0]))
    )
    reach = (2.5 * step + 2.0 * wide)[:, None]
    tree = BoxTree(np.concatenate([low, rest[0]]), np.concatenate([high, rest[0]]))
    p, q = tree.pairs(low - reach, high + reach)
    kept = np.empty(len(p), dtype=bool)
    front = (*chains_of(rays), rays.direction, np.ascontiguousarray(base), top)
    _may_meet(p, q, front, slides, rest[1], np.flatnonzero(slides >= 0), kept)
    return p[kept], q[kept]


@inline
def _along(chain, place, around, i, j):
    """How many vertices of the wall two rays of one chain are apart; many for rays of different chains."""
    if chain[i] != chain[j]:
        return FAR_ALONG
    gap = abs(place[i] - place[j])
    return min(gap, around[i] - gap) if around[i] > 0 else gap


@kernel
def _may_meet(p, q, front, slides, piece, sliding, kept):
    """Which pairs of a ray p and a ray q, or the row q - n of the points of the rest, are to be looked at.

    Not rays without a layer, rays near each other along one front, rays that do not face each other, and
    points of the piece along which a neighboring ray slides.
    """
    chain, place, around, direction, base, top = front
    n = len(top)
    for row in range(len(p)):
        i, j = p[row], q[row]
        kept[row] = top[i] > 0 and i != j
        if not kept[row]:
            continue
        if j < n:
            x, y = base[j, 0] - base[i, 0], base[j, 1] - base[i, 1]
            kept[row] = (
                _along(chain, place, around, i, j) > OWN_VERTICES
                and is_ahead(x, y, direction, i)  # or both sides of a thin wall would stop
                and is_ahead(-x, -y, direction, j)
            )
            continue
        for s in sliding:
            if piece[j - n] == slides[s] and _along(chain, place, around, i, s) <= OWN_VERTICES:
                kept[row] = False
