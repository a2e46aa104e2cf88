"""The gradation limit: the largest size below a wanted one that grows by no more than so much per length.

That is h*(x) = min_y (h(y) + growth * |x - y|), McShane's extension: the formula of the sources, with every
place a source. A function can be asked at finitely many places only, so h here is what interpolates the
places looked at, on a Delaunay triangulation: continuous, and linear in each triangle. Of that the minimum is
exact. See the book, chapter 2.3.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import distinct
from ..base.errors import InputError
from ..connect.insertion.delaunay import delaunay
from ..geometry.segment_tree import SegmentTree
from ..mesh.mesh import Mesh
from .background_mesh import Background
from .field import SizeField, as_size
from .table import build

__all__ = ["LimitedSize", "limited"]

Array = NDArray[np.float64]
FINEST = 0.5  # a leaf whose longer side times the growth is below this part of the tolerance is not divided,
COARSER = 4.0  # nor one this many times as large, if the sizes in it jump:
JUMP = 0.6  # if this part of their range is between two next ones; places are too close for that in a valley
UNSEEN_SHARE = 0.25  # of the range of the sizes seen in a leaf: how much less than their least there may be
SPACING = 0.125  # sides of a leaf: no straight valley along it is further from all that was looked at


class LimitedSize(SizeField):
    """A size field whose growth is limited, from sizes at places; made by `limited`.

    Attributes
    ----------
    growth : float
        The limit.
    places : ndarray, shape (c, 2)
        Where the wanted size was looked at.
    values : ndarray, shape (c,)
        The wanted sizes there. The limited size is at most that.
    capped : dict of str to int
        Where the look stopped short of the tolerance, as in `SizeTable`. "resolved" are leaves that need no
        closer look for the limited size (as at a jump); "depth" and "nodes" may hide something.
    """

    growth: float

    def __init__(
        self,
        growth: float,
        places: Array,
        values: Array,
        *,
        capped: dict[str, int],
        landmarks: Array,
        name: str,
    ):
        self.places, self.values, self.capped = places, values, capped
        self._lower, self._upper = places.min(axis=0), places.max(axis=0)
        self._seen: Background | None = None
        if (self._lower < self._upper).all():
            self._seen = Background(delaunay(places), values)
            pairs = _steep_edges(self._seen.mesh, values, growth)
        else:  # a box without an inside: a chain
            order = np.lexsort(places.T)
            pairs = np.stack([order[:-1], order[1:]], axis=1)
        self._sources = _sources(places, values, pairs, growth) if len(pairs) else None
        super().__init__(self._limited, landmarks=landmarks, name=name, growth=growth)

    def _limited(self, x: Array) -> Array:
        # a nearest point of the box is no further from another one than the points themselves
        inside = np.clip(x, self._lower, self._upper)
        start = np.full(len(x), np.inf) if self._seen is None else self._seen(inside)
        return start if self._sources is None else self._sources.least(inside, self.growth, start)[0]


def _steep_edges(mesh: Mesh, values: Array, growth: float) -> NDArray[np.int64]:
    """The edges of the triangles in which the interpolant is steeper than the limit, (e, 2).

    Only there can the way to x begin from a y that gives x less than its own value: on that way the
    interpolant must rise faster than the limit, at once.
    """
    a, b, c = np.moveaxis(mesh.corners, 1, 0)
    u, v = b - a, c - a
    first, second, third = values[mesh.simplices].T
    p, q = second - first, third - first
    det = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    slope = np.hypot(p * v[:, 1] - q * u[:, 1], q * u[:, 0] - p * v[:, 0])
    cells = mesh.simplices[slope > growth * det].astype(np.int64)
    edges = np.sort(cells[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    return np.stack(np.divmod(distinct(edges @ np.array([len(values), 1])), len(values)), axis=1)


def _sources(places: Array, values: Array, pairs: NDArray[np.int64], growth: float) -> SegmentTree:
    """The least of all that the edges give, as a tree of those points and edges that no others undercut."""
    used = np.zeros(len(places), dtype=bool)
    used[pairs] = True
    x, wanted = places[used], values[used]
    i, j = (np.cumsum(used) - 1)[pairs.T]
    length = growth * np.hypot(*(x[i] - x[j]).T)
    least = wanted.copy()  # what each point and its neighbors give: most are undercut by a neighbor
    np.minimum.at(least, i, wanted[j] + length)
    np.minimum.at(least, j, wanted[i] + length)
    alone = least == wanted
    tree = SegmentTree(x[alone], wanted[alone])
    ends = alone.copy()  # what matters with the least of all matters with this bound, too
    some = _lower(wanted, least, i, j, length)
    ends[i[some]] = ends[j[some]] = True
    asked = np.flatnonzero(ends)
    found, which = tree.least(x[asked], growth, wanted[asked] * (1 - 1e-12))
    least[asked] = np.where(which < 0, wanted[asked], found)
    kept = np.zeros(len(x), dtype=bool)
    kept[asked[which < 0]] = True
    lower = _lower(wanted, least, i, j, length)
    kept[np.concatenate([i[lower], j[lower]])] = False  # an edge gives what its ends give
    points = np.repeat(x[kept, None], 2, axis=1)
    edges = np.stack([x[i[lower]], x[j[lower]]], axis=1)
    weights = np.stack([wanted[i[lower]], wanted[j[lower]]], axis=1)
    return SegmentTree(
        np.concatenate([points, edges]), np.concatenate([np.repeat(wanted[kept, None], 2, axis=1), weights])
    )


def _lower(
    wanted: Array, least: Array, i: NDArray[np.int64], j: NDArray[np.int64], length: Array
) -> NDArray[np.bool_]:
    """Which edges give somewhere less than both ends' ``least``, which meet at t of the way from i to j."""
    with np.errstate(divide="ignore", invalid="ignore"):  # places may be equal
        t = ((least[j] - least[i]) / length + 1) / 2
        meet = least[i] + t * length
        return (np.abs(wanted[i] - wanted[j]) < length) & (meet > wanted[i] + t * (wanted[j] - wanted[i]))


class _Looks:
    """A wanted size as a function that keeps all that was seen, and says where a closer look matters."""

    def __init__(self, field: SizeField, growth: float, tolerance: float):
        self.field, self.growth, self.tolerance = field, growth, tolerance
        self.places: list[Array] = []
        self.values: list[Array] = []

    def __call__(self, x: Array) -> Array:
        values = self.field(x)
        self.places.append(x)
        self.values.append(values)
        return values

    def deeper(self, side: float, x: Array, values: Array) -> NDArray[np.bool_]:
        """Whether leaves may hide a size that matters; their places (m, 13, 2) and the sizes there."""
        least, span = values.min(axis=1), np.ptp(values, axis=1)
        jump = np.diff(np.sort(values, axis=1), axis=1).max(axis=1) > JUMP * span
        finest = np.where(jump, COARSER * FINEST, FINEST) * self.tolerance * least
        hidden = UNSEEN_SHARE * span
        if self.field.growth is not None:
            hidden = np.minimum(hidden, SPACING * side * self.field.growth)
        steep = (
            (span > self.growth * side) & (self.growth * side > finest) & (hidden > self.tolerance * least)
        )
        if steep.any():
            places = x[steep].reshape(-1, 2)
            known = SegmentTree(places, values[steep].ravel()).least(places, self.growth)[0].reshape(-1, 13)
            steep[steep] = (values[steep] - hidden[steep, None] <= known).any(axis=1)
        return steep


def limited(
    size: Any,
    growth: float,
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    tolerance: float = 0.02,
    max_nodes: int = 400_000,
) -> SizeField:
    """A size whose growth is limited: lowered near small sizes, nowhere larger than was seen.

    Parameters
    ----------
    size : float, callable, or SizeField
    growth : float
        The largest change of the size per unit of length that is wanted; positive.
    lower, upper : array_like, shape (2,)
        A box. The size is looked at there only; outside of it the result is that at the nearest point of it.
    tolerance, max_nodes : float, int
        As for `SizeField.table`, by which the size is sampled.

    Returns
    -------
    SizeField
        A `LimitedSize`: min_y (h(y) + growth * |x - y|) over all y of the box, where h interpolates the
        places looked at linearly, on their Delaunay triangulation. A field that is known to grow by no more
        than that (a constant; sources, features, and what is limited already; the smallest, the largest and
        the bounds of such) is returned as it is.

    Notes
    -----
    What holds everywhere, up to rounding: the result changes by no more than ``growth`` per unit of length.
    It is at most h at all places looked at (`LimitedSize.places`), which are nine points of each leaf of a
    table of h and the landmarks; and it is the largest function that is at most the interpolant and obeys
    the limit. Where nothing is too steep, it is the interpolant, which misses h by about a quarter of the
    tolerance. Between those places it may exceed h by as much as the interpolant does, for any function may
    have something there that was not seen.

    Where h is too steep, leaves are divided on until they resolve h to the tolerance, or seem to hide no
    size that would be less than what is known by more than the tolerance, or have a side of
    ``tolerance * h / (2 * growth)``, four times that at a jump, h being the least size in them. So the
    place of a jump is known to about half a size times ``tolerance / growth``, and the bottom of a valley
    whose sides are k times steeper than the limit is missed by about the tolerance, or k / 16 of it where
    that is more. `LimitedSize.capped` tells of leaves for which there was no room.

    Distances are straight: across holes and notches, too (use `limit_nodes` on a mesh where that is not
    wanted). A value costs O(log c) for c places.

    Source: Borouchaki, Hecht and Frey, *Mesh gradation control* (1998); McShane (1934) for the formula. See
    the book, chapter 2.3.
    """
    field = as_size(size)
    if not (np.isfinite(growth) and growth > 0):
        raise InputError(f"growth must be a positive number, not {growth!r}")
    if field.growth is not None and field.growth <= growth:
        return field
    looks = _Looks(field, growth, tolerance)
    table = build(
        SizeField(looks),
        lower,
        upper,
        landmarks=field.landmarks,
        factor=1.0,
        tolerance=tolerance,
        max_depth=24,
        max_nodes=max_nodes,
        deeper=looks.deeper,
    )
    return LimitedSize(
        growth,
        np.concatenate(looks.places),
        np.concatenate(looks.values),
        capped=table.capped,
        landmarks=field.landmarks,
        name=f"{field.name}, growth limited to {growth:g}",
    )
