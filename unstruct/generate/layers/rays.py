"""The directions along which the points of layers advance: one ray from a vertex of a wall, or a fan of them.

At a vertex the ray is the mean of the normals of both sides. Where a body has a sharp corner, so that the
angle of the fluid is large, a fan of rays starts at one vertex. Ordinary rays are then smoothed, as long as
both sides stay well visible along them. At an open end of a wall a ray follows the neighboring piece.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.elementary import angle_of, cosine, sine
from ...base.jit import inline, kernel
from ...domain.domain import Domain
from .walls import Walls

__all__ = [
    "FAN_RAY",
    "FREE_RAY",
    "HELD_RAY",
    "SLIDING_RAY",
    "TAPER_RAY",
    "Rays",
    "rays_of",
]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

FREE_RAY, HELD_RAY, FAN_RAY, SLIDING_RAY, TAPER_RAY = range(5)  # kinds of rays
FAN_FROM = np.radians(230.0)  # the angle of the fluid from which on a vertex has a fan
FAN_STEP = np.radians(20.0)  # the largest angle between two rays of a fan
MOST_IN_FAN = 10  # rays: the angle between the first and the last is at most a half turn
BLUNT = np.radians(150.0)  # at corners of the fluid below this angle rays are not smoothed
SLIDING_ANGLES = np.radians(50.0), np.radians(130.0)  # angles at which a ray may follow the neighboring piece
SHARPEST = np.radians(30.0)  # corners of the fluid below this get no layers
SHARPEST_BODY = np.radians(285.0)  # the angle of the fluid up to which one ray may stand for a fan
SMOOTHING_ROUNDS = 10  # of smoothing
VISIBLE = 0.35  # the least cosine between a smoothed ray and the normals beside it
MOST_SCALE = 1.6  # the largest factor by which heights along an oblique ray are longer
CORNER_SCALE = 4.0  # in concave corners, where the front of both walls meets farther away


class Rays(NamedTuple):
    """Rays, and the strips of cells between them.

    Attributes
    ----------
    base : (r,) int64
        The vertex where a ray starts.
    direction : (r, 2) float64
        Of unit length.
    scale : (r,) float64
        Heights along the ray are multiplied by it.
    kind : (r,) int8
        FREE_RAY; HELD_RAY, which is not smoothed; FAN_RAY; SLIDING_RAY along a piece; TAPER_RAY, which gets
        no layer.
    slide : (r,) int64
        The subsegment that a sliding ray follows from its vertex on; else -1.
    cosine : (r,) float64
        The least cosine between the ray and the normals of its sides.
    left, right : (t,) int64
        The rays of each strip, at the start and at the end of its side. Strips of fans come last.
    side : (t,) int64
        The side of each strip; strips of a fan belong to the side before it.
    before, after : (r,) int64
        The rays before and after each one, through the strips; -1 for none.
    """

    base: Integers
    direction: Array
    scale: Array
    kind: NDArray[np.int8]
    slide: Integers
    cosine: Array
    left: Integers
    right: Integers
    side: Integers
    before: Integers
    after: Integers


@inline
def _clockwise(back_x, back_y, out_x, out_y):
    """The angle from a vector clockwise to another one, in (0, 2 pi]."""
    dot = 0.0 + back_x * out_x + back_y * out_y  # no negative zero
    angle = angle_of(back_y * out_x - back_x * out_y, dot)
    return angle + 2 * math.pi if angle <= 0.0 else angle


@kernel
def _direct(points, ends, along, normal):
    """Write the unit vectors along sides, and the normals to their left."""
    for i in range(len(ends)):
        a, b = ends[i, 0], ends[i, 1]
        u, v = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
        length = math.hypot(u, v)
        along[i, 0], along[i, 1] = u / length, v / length
        normal[i, 0], normal[i, 1] = -along[i, 1], along[i, 0]


@kernel
def _at_joints(sides, vectors, single, angle, rows, strips):
    """Write the rays where a side follows another one, and the strips; returns how many there are of each.

    First come the single rays, then those of fans; strips of sides come first, in their order.
    ``angle`` is room for that of the fluid at the end of each side.
    """
    ends, after, segment, wake = sides
    along, normal = vectors
    base, direction, kind = rows
    left, right, owner = strips
    many, count = 0, len(ends)
    for i in range(len(ends)):
        owner[i], angle[i], j, v = i, 0.0, after[i], ends[i, 1]
        if j < 0:
            continue
        x, y = -along[i, 0], -along[i, 1]
        turn = _clockwise(x, y, along[j, 0], along[j, 1])
        end = wake[i] and wake[j] and segment[i] == segment[j]
        tapered = end or turn < SHARPEST
        if turn > FAN_FROM and not end:
            if not single[v]:
                angle[i] = turn  # for a fan
                continue
            tapered = tapered or turn > SHARPEST_BODY
        held = turn < BLUNT or turn > FAN_FROM
        c, s = cosine(turn / 2), sine(turn / 2)
        base[many], kind[many] = v, TAPER_RAY if tapered else HELD_RAY if held else FREE_RAY
        direction[many, 0], direction[many, 1] = x * c + y * s, y * c - x * s
        right[i] = left[j] = many
        many += 1
    for i in range(len(ends)):
        if angle[i] == 0.0:
            continue
        parts = math.ceil((angle[i] - math.pi) / FAN_STEP - 1e-9)
        x, y = normal[i, 0], normal[i, 1]
        right[i], left[after[i]] = many, many + parts
        for place in range(parts + 1):
            turn = -(angle[i] - math.pi) * place / max(parts, 1)
            c, s = cosine(turn), sine(turn)
            base[many], kind[many] = ends[i, 1], FAN_RAY
            direction[many, 0], direction[many, 1] = x * c - y * s, x * s + y * c
            if place < parts:
                left[count], right[count], owner[count] = many, many + 1, i
                count += 1
            many += 1
    return many, count


def rays_of(
    domain: Domain, walls: Walls, other: Integers, piece: Integers, single: NDArray[np.bool_] | None = None
) -> Rays:
    """The rays of all sides.

    Parameters
    ----------
    domain : Domain
    walls : Walls
    other : (s, 2) int64
        The ends of all subsegments.
    piece : (s,) int64
        The pieces of all subsegments.
    single : (n,) bool, optional
        Vertices that get one ray in place of a fan, or none if the body is sharper than a right angle there.
    """
    m = len(walls.ends)
    along, normal = np.empty((2, m, 2))
    _direct(walls.points, walls.ends, along, normal)
    single = np.zeros(len(walls.points), dtype=bool) if single is None else single
    most = m * (MOST_IN_FAN + 1)  # room that is not used costs nothing
    (base, left, right, owner), kinds = np.empty((4, most), dtype=np.int64), np.empty(most, dtype=np.int8)
    left[:m], right[:m], direction = -1, -1, np.empty((most, 2))
    sides = walls.ends, walls.after, walls.segment, walls.wake
    rows, strips = (base, direction, kinds), (left, right, owner)
    count, many = _at_joints(sides, (along, normal), single, np.empty(m), rows, strips)
    slide: Integers = np.full(count, -1, dtype=np.int64)
    base, direction, kinds = base[:count], direction[:count], kinds[:count]
    if (walls.after < 0).any() or (walls.before < 0).any():
        more = _open_ends(domain, walls, along, other, piece, count, (left, right))
        base, direction = np.concatenate([base, more[0]]), np.concatenate([direction, more[1]])
        kinds, slide = np.concatenate([kinds, more[2].astype(np.int8)]), np.concatenate([slide, more[3]])
    return _smoothed(
        walls, normal, (base, direction, kinds, slide), (left[:many], right[:many], owner[:many])
    )


def _open_ends(
    domain: Domain,
    walls: Walls,
    along: Array,
    other: Integers,
    piece: Integers,
    many: int,
    rays: tuple[Integers, Integers],
) -> tuple[Integers, Array, Integers, Integers]:
    """The rays where walls end at other pieces: along these, where that is possible.

    Returns their bases, directions, kinds, and the subsegments that they follow; ``many`` is how many rays
    there are before these.
    """
    left, right = rays
    ends = np.flatnonzero(walls.after < 0)
    starts = np.flatnonzero(walls.before < 0)
    side = np.concatenate([ends, starts])
    vertex = np.concatenate([walls.ends[ends, 1], walls.ends[starts, 0]])
    bound = np.concatenate([walls.bound_after[ends], walls.bound_before[starts]])
    far = np.where(other[bound, 0] == vertex, other[bound, 1], other[bound, 0])
    away = walls.points[far] - walls.points[vertex]
    away = away / np.hypot(*away.T)[:, None]
    is_end = np.arange(len(side)) < len(ends)
    angle = np.empty(len(side))
    _measure_ends(along[side], away, is_end, angle)
    slides = (angle >= SLIDING_ANGLES[0]) & (angle <= SLIDING_ANGLES[1]) & ~domain.held()[piece[bound]]
    inner = piece[bound] >= len(domain.facets)
    # Points on an inner piece are seen from both sides: both must be walls along which layers end there.
    key = bound * 2 + (other[bound, 0] == vertex)
    values, group = np.unique(key, return_inverse=True)
    good = np.bincount(group, weights=slides, minlength=len(values))
    slides &= ~inner | (good[group] == 2)
    shared = np.flatnonzero(slides)
    first = np.unique(group[shared], return_index=True)[1]
    some, rest = shared[first], np.flatnonzero(~slides)
    number = np.full(len(values), -1, dtype=np.int64)
    number[group[some]] = many + np.arange(len(some))
    ray = number[group]
    mean = np.where(is_end[rest, None], -along[side[rest]], along[side[rest]]) + away[rest]
    mean[np.hypot(*mean.T) == 0.0] = 1.0
    ray[rest] = many + len(some) + np.arange(len(rest))
    right[ends], left[starts] = ray[: len(ends)], ray[len(ends) :]
    kinds = np.repeat([SLIDING_RAY, TAPER_RAY], [len(some), len(rest)])
    slide = np.concatenate([bound[some], np.full(len(rest), -1)])
    return vertex[np.concatenate([some, rest])], np.concatenate([away[some], mean]), kinds, slide


@kernel
def _measure_ends(along, away, is_end, angle):
    """Write the angles of the fluid between sides and the pieces at which they end."""
    for i in range(len(angle)):
        x, y, u, v = along[i, 0], along[i, 1], away[i, 0], away[i, 1]
        angle[i] = _clockwise(-x, -y, u, v) if is_end[i] else _clockwise(u, v, x, y)


def _smoothed(
    walls: Walls,
    normal: Array,
    rows: tuple[Integers, Array, NDArray[np.int8], Integers],
    strips: tuple[Integers, Integers, Integers],
) -> Rays:
    """The rays with directions of unit length, which are smoothed, and the factors of their heights."""
    base, direction, kinds, slide = rows
    before, after, coming, going = np.empty((4, len(base)), dtype=np.int64)
    direction, (scale, cosine_) = direction.copy(), np.empty((2, len(base)))
    around = before, after, coming, going, kinds
    _surround(strips, len(walls.ends), around, direction)
    _smooth(walls.points, base, normal, around, direction)
    _stretch(normal, around, direction, scale, cosine_)
    left, right, side = (array.copy() for array in strips)
    return Rays(base.copy(), direction, scale, kinds.copy(), slide, cosine_, left, right, side, before, after)


@kernel
def _surround(strips, sides, around, direction):
    """Write what is around each ray, -1 for none, and scale the directions to unit length."""
    left, right, _ = strips
    before, after, coming, going, _ = around
    for r in range(len(before)):
        before[r] = after[r] = coming[r] = going[r] = -1
        length = math.hypot(direction[r, 0], direction[r, 1])
        direction[r, 0], direction[r, 1] = direction[r, 0] / length, direction[r, 1] / length
    for s in range(len(left)):
        after[left[s]], before[right[s]] = right[s], left[s]
        if s < sides:
            coming[right[s]], going[left[s]] = s, s
    for r in range(len(before)):
        if coming[r] < 0:
            coming[r] = going[r]
        elif going[r] < 0:
            going[r] = coming[r]


@inline
def _is_free(before, after, kind, r):
    return kind[r] == FREE_RAY and before[r] >= 0 and after[r] >= 0


@inline
def _seen(normal, coming, going, kind, r, x, y):
    """The cosines of the angles between a direction of ray r and the normals of its sides.

    The inner rays of a fan have no side of their own and look at none.
    """
    if coming[r] < 0 or kind[r] == FAN_RAY:
        return 1.0, 1.0
    i, j = coming[r], going[r]
    return x * normal[i, 0] + y * normal[i, 1], x * normal[j, 0] + y * normal[j, 1]


@kernel
def _smooth(points, base, normal, around, direction):
    """Turn free rays towards the mean of their neighbors, as long as both sides stay well visible."""
    before, after, coming, going, kind = around
    n = len(before)
    share, least = np.empty(n), np.empty(n)
    for r in range(n):
        if _is_free(before, after, kind, r):
            p, q = before[r], after[r]
            x, y = points[base[r], 0], points[base[r], 1]
            to_p = math.hypot(points[base[p], 0] - x, points[base[p], 1] - y)
            to_q = math.hypot(points[base[q], 0] - x, points[base[q], 1] - y)
            share[r] = to_q / max(to_p + to_q, 1e-300)
            one, two = _seen(normal, coming, going, kind, r, direction[r, 0], direction[r, 1])
            least[r] = max(min(one, two, VISIBLE), VISIBLE * 0.5)
    old = np.empty((n, 2))
    for _ in range(SMOOTHING_ROUNDS):
        for r in range(n):
            old[r, 0], old[r, 1] = direction[r, 0], direction[r, 1]
        for r in range(n):
            if not _is_free(before, after, kind, r):
                continue
            # Tapered rays have no say.
            p = r if kind[before[r]] == TAPER_RAY else before[r]
            q = r if kind[after[r]] == TAPER_RAY else after[r]
            u = share[r] * old[p, 0] + (1 - share[r]) * old[q, 0] + old[r, 0]
            v = share[r] * old[p, 1] + (1 - share[r]) * old[q, 1] + old[r, 1]
            size = math.hypot(u, v)
            u, v = u / max(size, 1e-300), v / max(size, 1e-300)
            one, two = _seen(normal, coming, going, kind, r, u, v)
            if size > 1e-9 and min(one, two) >= least[r]:
                direction[r, 0], direction[r, 1] = u, v


@kernel
def _stretch(normal, around, direction, scale, cosine):
    """Fill ``scale`` and ``cosine`` of `Rays`; the heights of free rays are a mean with their neighbors'."""
    before, after, coming, going, kind = around
    n = len(before)
    own = np.empty(n)
    for r in range(n):
        one, two = _seen(normal, coming, going, kind, r, direction[r, 0], direction[r, 1])
        cosine[r], most = min(one, two), MOST_SCALE
        if kind[r] == HELD_RAY and coming[r] >= 0:
            i, j = coming[r], going[r]
            if normal[i, 0] * normal[j, 1] - normal[i, 1] * normal[j, 0] > 0.0:
                most = CORNER_SCALE
        own[r] = scale[r] = min(max(1.0 / max((one + two) / 2, 1e-9), 1.0), most)
    for r in range(n):
        if _is_free(before, after, kind, r):
            p, q = min(own[before[r]], MOST_SCALE), min(own[after[r]], MOST_SCALE)
            scale[r] = (2 * own[r] + p + q) / 4
