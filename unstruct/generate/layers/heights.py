"""All points that rays could make: a table of places by ray and layer, on the curve where a ray slides."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...base.jit import kernel
from ...domain.domain import Domain
from ...sizing.stretching import Layers
from .rays import SLIDING_RAY, TAPER_RAY, Rays
from .walls import Walls

__all__ = ["Fronts", "fronts_of"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

MOST_LEVELS = 400  # layers of a sequence without an end
BEYOND = 3.0  # it is followed until a step is so many times the longest side of a wall
SLIDE_SAMPLES = 513  # points along a curve to measure it
SLIDE_SHARE = 0.85  # how much of a piece a sliding ray may use


class Fronts(NamedTuple):
    """The places of rays after 0, 1, ..., k layers.

    Attributes
    ----------
    places : (r, k + 1, 2) float64
    steps : (r, k) float64
        The distances between places that follow each other.
    parameter : (r, k + 1) float64
        Where the places of sliding rays are on their pieces.
    most : (r,) int64
        The largest number of layers that a ray can have.
    apart : (r, k + 1) float64
        The mean distance to the neighbors at the same layer.
    endless : bool
        Whether the layers have no count of their own.
    """

    places: Array
    steps: Array
    parameter: Array
    most: Integers
    apart: Array
    endless: bool


def fronts_of(
    domain: Domain, walls: Walls, rays: Rays, layers: Layers, subsegments: tuple[Integers, Integers, Array]
) -> Fronts:
    """The table for all rays; ``subsegments`` are the ends, pieces and spans of all subsegments."""
    x = walls.points[rays.base]
    given = _heights(layers, x, _longest(walls.points, walls.ends))
    shape = len(x), given.shape[1]
    heights, parameter, places = np.empty(shape), np.zeros(shape), np.empty((*shape, 2))
    most = np.empty(len(x), dtype=np.int64)
    _lay_straight(x, rays, given, heights, places, most)
    sliding = np.flatnonzero(rays.kind == SLIDING_RAY)
    ends, piece, span = subsegments
    users = np.bincount(piece[rays.slide[sliding]], minlength=len(domain.pieces))
    for r in sliding.tolist():
        s = int(rays.slide[r])
        k, base = int(piece[s]), int(rays.base[r])
        start = float(span[s, 0] if ends[s, 0] == base else span[s, 1])
        share = SLIDE_SHARE / max(int(users[k]), 1)
        t, length = _along(domain, k, start < 0.5, heights[r])
        fits = heights[r] <= share * length
        many = int(fits.sum()) - 1
        most[r] = min(many, int(most[r]))
        parameter[r] = np.where(fits, t, t[many])
        places[r] = domain.points_at(np.full(len(t), k), parameter[r])
        places[r, 0] = x[r]
    steps, apart = np.empty((len(x), heights.shape[1] - 1)), np.empty(heights.shape)
    _distances(places, rays.kind, rays.before, rays.after, steps, apart)
    return Fronts(places, steps, parameter, most, apart, layers.count is None)


def _heights(layers: Layers, x: Array, longest: float) -> Array:
    """Total heights at each base, (r, k + 1), or at all of them, (1, k + 1), as many as could be needed."""
    given = [
        np.size(value) for name, value in layers.given.items() if name != "count" and not callable(value)
    ]
    if max(given, default=1) > 1:
        raise InputError(
            "layers in the plane take one value for all, or functions of the place (k, 2) -> (k,): the "
            "vertices of the walls follow only from the size"
        )
    at = x if layers.varies else None
    count = layers.count
    found = layers.cumulative(MOST_LEVELS if count is None else count, at=at)
    if count is None:  # what is not needed is cut off
        wanted = (np.diff(found).reshape(-1, MOST_LEVELS) < BEYOND * longest).sum(axis=1).max() + 1
        found = found[..., : int(min(wanted, MOST_LEVELS)) + 1]
    return np.ascontiguousarray(found.reshape(-1, found.shape[-1]))


def _along(domain: Domain, piece: int, forward: bool, heights: Array) -> tuple[Array, float]:
    """Parameters at these lengths along a piece from its first vertex or its last, and its whole length."""
    if piece in domain.curves:
        t = np.linspace(0.0, 1.0, SLIDE_SAMPLES)
        if not forward:
            t = t[::-1]
        x = domain.points_at(np.full(len(t), piece), t)
        total = np.append(0.0, np.cumsum(np.hypot(*np.diff(x, axis=0).T)))
        return np.interp(heights, total, t), float(total[-1])
    a, b = domain.points[domain.pieces[piece]]
    length = float(np.hypot(*(b - a)))
    share = np.minimum(heights / length, 1.0)
    return share if forward else 1.0 - share, length


@kernel
def _longest(points, ends):
    """The length of the longest side."""
    found = 0.0
    for i in range(len(ends)):
        a, b = ends[i, 0], ends[i, 1]
        found = max(found, math.hypot(points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]))
    return found


@kernel
def _lay_straight(x, rays, given, heights, places, most):
    """Fill heights, the places of rays that do not slide, and how many layers a ray can have."""
    for r in range(places.shape[0]):
        most[r] = 0 if rays.kind[r] == TAPER_RAY else places.shape[1] - 1
        row = r if len(given) > 1 else 0
        for k in range(places.shape[1]):
            heights[r, k] = given[row, k] * rays.scale[r]
            for j in range(2):
                places[r, k, j] = x[r, j] + rays.direction[r, j] * heights[r, k] if k > 0 else x[r, j]


@kernel
def _distances(places, kind, before, after, steps, apart):
    """Fill ``steps`` and ``apart`` of `Fronts`. Tapered rays are no neighbors."""
    following = np.empty(apart.shape)  # the distance to the ray after each
    for r in range(places.shape[0]):
        for k in range(places.shape[1]):
            x, y, o = places[r, k, 0], places[r, k, 1], after[r]
            if k > 0:
                steps[r, k - 1] = math.hypot(x - places[r, k - 1, 0], y - places[r, k - 1, 1])
            following[r, k] = math.hypot(x - places[o, k, 0], y - places[o, k, 1]) if o >= 0 else 0.0
    for r in range(places.shape[0]):
        p, q = before[r], after[r]
        one, two = p >= 0 and kind[p] != TAPER_RAY, q >= 0 and kind[q] != TAPER_RAY
        for k in range(places.shape[1]):
            total = 0.0
            if one and after[p] == r:
                total += following[p, k]
            elif one:
                total += math.hypot(places[r, k, 0] - places[p, k, 0], places[r, k, 1] - places[p, k, 1])
            total += following[r, k] if two else 0.0
            apart[r, k] = total / (int(one) + int(two)) if one or two else np.inf
