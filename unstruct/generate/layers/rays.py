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

from ...base.elementary import cosines, sines, turns
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
    "directed",
    "rays_of",
]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

FREE_RAY, HELD_RAY, FAN_RAY, SLIDING_RAY, TAPER_RAY = range(5)  # kinds of rays
FAN_FROM = np.radians(230.0)  # the angle of the fluid from which on a vertex has a fan
FAN_STEP = np.radians(20.0)  # the largest angle between two rays of a fan
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


def directed(walls: Walls) -> tuple[Array, Array, Array]:
    """The unit vectors along sides, the normals to their left, and their lengths."""
    a, b = walls.points[walls.ends].transpose(1, 0, 2)
    along = b - a
    length = np.hypot(*along.T)
    along = along / length[:, None]
    return along, np.column_stack([-along[:, 1], along[:, 0]]), length


def _clockwise(back: Array, out: Array) -> Array:
    """The angle from ``back`` clockwise to ``out``, in (0, 2 pi]."""
    cross = back[:, 1] * out[:, 0] - back[:, 0] * out[:, 1]
    angle = turns(cross, (back * out).sum(axis=1))
    return np.where(angle <= 0.0, angle + 2 * np.pi, angle)


class _Rows:
    """Rays while they are collected."""

    def __init__(self) -> None:
        self.base: list[Integers] = []
        self.direction: list[Array] = []
        self.kind: list[Integers] = []
        self.slide: list[Integers] = []
        self.count = 0

    def add(self, base: Integers, direction: Array, kind: Integers, slide: Integers) -> Integers:
        """Append rows; their numbers."""
        self.base.append(base)
        self.direction.append(direction)
        self.kind.append(kind)
        self.slide.append(slide)
        self.count += len(base)
        return np.arange(self.count - len(base), self.count)


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
    along, normal, _ = directed(walls)
    rows, m = _Rows(), len(walls.ends)
    left, right = np.full(m, -1, dtype=np.int64), np.full(m, -1, dtype=np.int64)
    joined = np.flatnonzero(walls.after >= 0)
    follow = walls.after[joined]
    angle = _clockwise(-along[joined], along[follow])
    fan = angle > FAN_FROM
    end = walls.wake[joined] & walls.wake[follow] & (walls.segment[joined] == walls.segment[follow])
    fan &= ~end
    tapered = end | (angle < SHARPEST)
    if single is not None:
        alone = fan & single[walls.ends[joined, 1]]
        fan &= ~alone
        tapered |= alone & (angle > SHARPEST_BODY)
    plain = ~fan
    kind = np.where(
        tapered, TAPER_RAY, np.where((angle < np.radians(150.0)) | (angle > FAN_FROM), HELD_RAY, FREE_RAY)
    )
    (x, y), c, s = -along[joined].T, cosines(angle / 2), sines(angle / 2)
    bisector = np.column_stack([x * c + y * s, y * c - x * s])
    number = rows.add(
        walls.ends[joined[plain], 1], bisector[plain], kind[plain], np.full(plain.sum(), -1, dtype=np.int64)
    )
    right[joined[plain]] = number
    left[follow[plain]] = number
    strips = _fans(walls, (joined[fan], follow[fan], angle[fan]), normal, rows, (left, right))
    _open_ends(domain, walls, along, other, piece, rows, (left, right))
    direction = np.concatenate([*rows.direction, np.empty((0, 2))])
    left, right = np.concatenate([left, strips[0]]), np.concatenate([right, strips[1]])
    before, after = np.full((2, rows.count), -1, dtype=np.int64)
    after[left], before[right] = right, left
    found = Rays(
        np.concatenate([*rows.base, np.empty(0, dtype=np.int64)]).astype(np.int64),
        direction / np.hypot(*direction.T)[:, None],
        np.ones(rows.count),
        np.concatenate([*rows.kind, np.empty(0, dtype=np.int64)]).astype(np.int8),
        np.concatenate([*rows.slide, np.empty(0, dtype=np.int64)]).astype(np.int64),
        np.ones(rows.count),
        left,
        right,
        np.concatenate([np.arange(m), strips[2]]),
        before,
        after,
    )
    return _smoothed(walls, found, normal)


def _fans(
    walls: Walls,
    corners: tuple[Integers, Integers, Array],
    normal: Array,
    rows: _Rows,
    rays: tuple[Integers, Integers],
) -> tuple[Integers, Integers, Integers]:
    """Add the rays of fans; the strips between them."""
    sides, follow, angle = corners
    left, right = rays
    parts = np.ceil((angle - np.pi) / FAN_STEP - 1e-9).astype(np.int64)
    owner = np.repeat(np.arange(len(sides)), parts + 1)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(parts + 1) - parts - 1, parts + 1)
    turn = -(angle[owner] - np.pi) * place / np.maximum(parts[owner], 1)
    (x, y), c, s = normal[sides[owner]].T, cosines(turn), sines(turn)
    direction = np.column_stack([x * c - y * s, x * s + y * c])
    base = walls.ends[sides[owner], 1]
    number = rows.add(base, direction, np.full(len(owner), FAN_RAY), np.full(len(owner), -1, dtype=np.int64))
    right[sides] = number[place == 0]
    left[follow] = number[place == parts[owner]]
    inner = place < parts[owner]
    return number[inner], number[inner] + 1, sides[owner[inner]]


def _open_ends(
    domain: Domain,
    walls: Walls,
    along: Array,
    other: Integers,
    piece: Integers,
    rows: _Rows,
    rays: tuple[Integers, Integers],
) -> None:
    """Add the rays where walls end at other pieces: along these, where that is possible."""
    left, right = rays
    ends = np.flatnonzero(walls.after < 0)
    starts = np.flatnonzero(walls.before < 0)
    side = np.concatenate([ends, starts])
    if not len(side):
        return
    vertex = np.concatenate([walls.ends[ends, 1], walls.ends[starts, 0]])
    bound = np.concatenate([walls.bound_after[ends], walls.bound_before[starts]])
    far = np.where(other[bound, 0] == vertex, other[bound, 1], other[bound, 0])
    away = walls.points[far] - walls.points[vertex]
    away = away / np.hypot(*away.T)[:, None]
    is_end = np.arange(len(side)) < len(ends)
    angle = np.where(is_end, _clockwise(-along[side], away), _clockwise(away, along[side]))
    slides = (angle >= SLIDING_ANGLES[0]) & (angle <= SLIDING_ANGLES[1]) & ~domain.held()[piece[bound]]
    inner = piece[bound] >= len(domain.facets)
    # Points on an inner piece are seen from both sides: both must be walls along which layers end there.
    key = bound * 2 + (other[bound, 0] == vertex)
    values, group = np.unique(key, return_inverse=True)
    good = np.bincount(group, weights=slides, minlength=len(values))
    slides &= ~inner | (good[group] == 2)
    shared = np.flatnonzero(slides)
    first = np.unique(group[shared], return_index=True)[1]
    some = shared[first]
    kinds = np.full(len(some), SLIDING_RAY)
    number = np.full(len(values), -1, dtype=np.int64)
    number[group[some]] = rows.add(vertex[some], away[some], kinds, bound[some])
    ray = number[group]
    rest = np.flatnonzero(~slides)
    mean = np.where(is_end[rest, None], -along[side[rest]], along[side[rest]]) + away[rest]
    mean[np.hypot(*mean.T) == 0.0] = 1.0
    ray[rest] = rows.add(vertex[rest], mean, np.full(len(rest), TAPER_RAY), np.full(len(rest), -1))
    right[ends], left[starts] = ray[: len(ends)], ray[len(ends) :]


def _smoothed(walls: Walls, rays: Rays, normal: Array) -> Rays:
    """The rays with smoothed directions, and the factors of their heights."""
    sides = len(walls.ends)
    coming, going = np.full((2, len(rays.base)), -1, dtype=np.int64)
    coming[rays.right[:sides]] = np.arange(sides)
    going[rays.left[:sides]] = np.arange(sides)
    coming, going = np.where(coming < 0, going, coming), np.where(going < 0, coming, going)
    direction = rays.direction.copy()
    scale, cosine = np.empty((2, len(rays.base)))
    around = rays.before, rays.after, coming, going, rays.kind
    _smooth(walls.points[rays.base], normal, around, direction)
    _stretch(normal, around, direction, scale, cosine)
    return rays._replace(direction=direction, scale=scale, cosine=cosine)


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
def _smooth(x, normal, around, direction):
    """Turn free rays towards the mean of their neighbors, as long as both sides stay well visible."""
    before, after, coming, going, kind = around
    n = len(before)
    share, least = np.empty(n), np.empty(n)
    for r in range(n):
        if _is_free(before, after, kind, r):
            p, q = before[r], after[r]
            to_p = math.hypot(x[p, 0] - x[r, 0], x[p, 1] - x[r, 1])
            to_q = math.hypot(x[q, 0] - x[r, 0], x[q, 1] - x[r, 1])
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
