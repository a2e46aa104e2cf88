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
    stops = leveled(Stops(*_matched(rays, fronts, size)), rays)
    return leveled(_near(rays, fronts, stops, rest, spring, slides), rays)


def _matched(rays: Rays, fronts: Fronts, size: SizeField) -> tuple[Integers, NDArray[np.int8]]:
    """The first layer of each ray whose step would match the spacing or the size."""
    places, steps, apart = tables = fronts.places, fronts.steps, fronts.apart
    n = len(rays.base)
    (wall, last), (first, asked, level) = np.empty((2, n)), np.empty((3, n), dtype=np.int64)
    _wall_spacing(rays.base, rays.kind, apart, wall, np.zeros(int(rays.base.max(initial=-1)) + 1))
    at, spaces = np.empty((n, 2)), (wall, rays.kind)
    many, room = _first_steps(tables, spaces, (first, asked), at)
    # Of the layers from `asked` on the last one before `first` is looked at first. Where the growth of the
    # size is known, this tells of most others that the size stops no ray there.
    ray, layer = np.empty((2, room), dtype=np.int64)
    wanted, places = np.empty(room), np.empty((room, 2))
    if many:
        change = np.inf if size.growth is None else size.growth
        known = size(at[:many])
        many, unknown = _to_ask(
            tables, spaces, (first, asked), (known, last), change, (ray, layer, wanted), places
        )
        _stop_short(tables, spaces, (ray, layer, wanted), many, size(places[:unknown]), first)
    reason = np.empty(n, dtype=np.int8)
    _reasons(rays.kind, fronts.most, first, steps.shape[1], fronts.endless, level, reason)
    return level, reason


@kernel
def _wall_spacing(base, kind, apart, found, most):
    """Write the mean length of the sides at each ray's base; rays of a fan share that of their vertex."""
    for r in range(len(base)):
        found[r] = apart[r, 0] if math.isfinite(apart[r, 0]) else 0.0
        if kind[r] == FAN_RAY:  # only one neighbor of an outer ray is elsewhere
            most[base[r]] = max(most[base[r]], 2 * found[r])
    for r in range(len(base)):
        if kind[r] == FAN_RAY:
            found[r] = most[base[r]]


@kernel
def _first_steps(tables, spaces, range_, at):
    """The first layer of each ray that matches the spacing, and the first one for which the size matters.

    Writes the last places of such ranges to ``at``. Returns how many there are, and how many layers in all.
    """
    places, steps, apart = tables
    wall, kind = spaces
    first, asked = range_
    many, layers = 0, 0
    for r in range(steps.shape[0]):
        fan = kind[r] == FAN_RAY
        first[r] = asked[r] = steps.shape[1]
        for k in range(steps.shape[1]):
            here = max(apart[r, k], wall[r]) if fan else apart[r, k]
            if steps[r, k] >= MATCHED * here or (apart[r, k + 1] < SHRUNK * wall[r] and not fan):
                first[r] = k
                break
            if asked[r] > k and (steps[r, k] >= ASK_SIZE_FROM * here or here > STRETCHED * wall[r]):
                asked[r] = k
        if asked[r] < first[r]:
            at[many, 0], at[many, 1] = places[r, first[r] - 1, 0], places[r, first[r] - 1, 1]
            many, layers = many + 1, layers + first[r] - asked[r]
    return many, layers


@kernel
def _to_ask(tables, spaces, range_, sizes, change, rows, asked_at):
    """Write the rays and layers at which the size could stop a ray; how many there are.

    ``sizes`` are those at the last layers of ranges, and room for one a ray; ``change`` is the growth of the
    size. The third of the rows gets the size where it is known, else -1, and ``asked_at`` the places where it
    is not; their number is returned, too.
    """
    places, steps, apart = tables
    wall, kind = spaces
    first, asked = range_
    known, last = sizes
    ray, layer, wanted = rows
    some, many, unknown = 0, 0, 0
    for r in range(len(wall)):
        last[r] = np.inf
        if asked[r] < first[r]:
            last[r] = known[some]
            some += 1
        fan = kind[r] == FAN_RAY
        for k in range(asked[r], first[r]):
            here = max(apart[r, k], wall[r]) if fan else apart[r, k]
            if not (steps[r, k] >= ASK_SIZE_FROM * here or here > STRETCHED * wall[r]):
                continue
            end = first[r] - 1
            x, y = places[r, k, 0] - places[r, end, 0], places[r, k, 1] - places[r, end, 1]
            least = last[r] if k == end else last[r] - change * math.hypot(x, y)
            ahead = apart[r, k + 1] > STRETCHED * max(least, wall[r]) and not fan
            if steps[r, k] >= MATCHED * least or ahead:
                ray[many], layer[many], wanted[many] = r, k, last[r] if k == end else -1.0
                many += 1
                if k != end:
                    asked_at[unknown, 0], asked_at[unknown, 1] = places[r, k, 0], places[r, k, 1]
                    unknown += 1
    return many, unknown


@kernel
def _stop_short(tables, spaces, rows, many, sizes, first):
    """Lower ``first`` to the first layer at which the size stops a ray."""
    _, steps, apart = tables
    wall, kind = spaces
    ray, layer, wanted = rows
    unknown = 0
    for i in range(many):
        r, k, size = ray[i], layer[i], wanted[i]
        if size < 0.0:
            size = sizes[unknown]
            unknown += 1
        wide = apart[r, k + 1] > STRETCHED * max(size, wall[r]) and kind[r] != FAN_RAY
        if steps[r, k] >= MATCHED * size or wide:
            first[r] = min(first[r], k)


@kernel
def _reasons(kind, most, first, layers, endless, level, reason):
    """Write how many layers rays may have, and why no more. Tapered rays have none."""
    for r in range(len(level)):
        level[r] = min(first[r], most[r])
        if first[r] == layers:
            reason[r] = BY_MATCH if endless else BY_COUNT
        elif first[r] <= most[r]:
            reason[r] = BY_MATCH
        else:
            reason[r] = BY_END if kind[r] == SLIDING_RAY else BY_COUNT
        if kind[r] == TAPER_RAY:
            level[r], reason[r] = 0, BY_END


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
    n, many = len(rays.base), len(rest[0])
    low, high, query_low, query_high = np.empty((4, n + many, 2))
    low[n:] = high[n:] = rest[0]
    base = np.empty((n, 2))
    _reach(
        (fronts.places, fronts.steps, fronts.apart), stops.level, base, (low, high), (query_low, query_high)
    )
    p, q = BoxTree(low, high).pairs(query_low[:n], query_high[:n])
    kept = np.empty(len(p), dtype=bool)
    front = (*chains_of(rays), rays.direction, base, stops.level)
    _may_meet(p, q, front, slides, rest[1], np.flatnonzero(slides >= 0), kept)
    return p[kept], q[kept]


@kernel
def _reach(tables, level, base, boxes, queries):
    """Write where rays start, the boxes of their places, and wider ones that what is near a ray meets."""
    places, steps, apart = tables
    for r in range(len(level)):
        top = level[r]
        wide = max(apart[r, top], 0.0) if math.isfinite(apart[r, top]) else 0.0
        wide = max(wide, apart[r, 0]) if math.isfinite(apart[r, 0]) else wide
        reach = 2.5 * steps[r, min(top, steps.shape[1] - 1)] + 2.0 * wide
        for k in range(2):
            a, b = places[r, 0, k], places[r, top, k]
            base[r, k], boxes[0][r, k], boxes[1][r, k] = a, min(a, b), max(a, b)
            queries[0][r, k], queries[1][r, k] = min(a, b) - reach, max(a, b) + reach


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
