"""The gradation limit: the largest size that is at most a wanted one and has a limited growth per length.

This is h*(x) = min_y (h(y) + growth * |x - y|), McShane's extension: the formula for sources, with every
place as a source. A function can be evaluated at finitely many places only. So h is replaced by its
interpolant on a Delaunay triangulation of the places where it was evaluated, which is continuous and linear
in each triangle. For the interpolant, the minimum is exact. See the book, chapter 2.3.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arguments import finite
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
# These constants decide in `_Looks.deeper` which leaves of the table are not divided further.
# A leaf is not divided if growth * (its longer side) <= FINEST * tolerance * (the smallest size in it).
FINEST = 0.5
# If the sizes in a leaf jump, it is not divided even if its side is COARSER times as large.
COARSER = 4.0
# The sizes in a leaf jump if the gap between two consecutive ones, in the order of size, is more than this
# fraction of their range. In a valley the places are too close to each other for such a gap.
JUMP = 0.6
# A size in a leaf that was not seen is assumed to be below the smallest one that was seen by at most this
# fraction of their range.
UNSEEN_SHARE = 0.25
# Every straight valley along a side of a leaf is within this fraction of the side of a place that was seen.
SPACING = 0.125


class LimitedSize(SizeField):
    """A size field whose growth is limited, computed from sizes at places; `limited` creates it.

    Attributes
    ----------
    growth : float
        The limit.
    places : ndarray, shape (c, 2)
        Where the wanted size was evaluated.
    values : ndarray, shape (c,)
        The wanted sizes at these places, which are upper bounds of the limited size.
    capped : dict of str to int
        The numbers of leaves whose error remains above the tolerance, as in `SizeTable`. Leaves counted as
        "resolved" need no more samples for the limited size (for example at a jump). Leaves counted as
        "depth" and "nodes" may contain details that were not seen.
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
        else:  # the box has no interior, so the places form a chain
            order = np.lexsort(places.T)
            pairs = np.stack([order[:-1], order[1:]], axis=1)
        self._sources = _sources(places, values, pairs, growth) if len(pairs) else None
        super().__init__(self._limited, landmarks=landmarks, name=name, growth=growth)

    def _limited(self, x: Array) -> Array:
        # Moving two points to their nearest points of the box does not increase their distance, so the limit
        # also holds outside the box.
        inside = np.clip(x, self._lower, self._upper)
        start = np.full(len(x), np.inf) if self._seen is None else self._seen(inside)
        return start if self._sources is None else self._sources.least(inside, self.growth, start)[0]


def _steep_edges(mesh: Mesh, values: Array, growth: float) -> NDArray[np.int64]:
    """The edges of the triangles in which the interpolant is steeper than the limit, (e, 2).

    Only points y in these triangles can give another point x less than the interpolant at x: on the segment
    from y to x the interpolant must rise faster than the limit from the beginning.
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
    """A tree of the points and edges that determine the limited size, without those that others undercut."""
    used = np.zeros(len(places), dtype=bool)
    used[pairs] = True
    x, wanted = places[used], values[used]
    i, j = (np.cumsum(used) - 1)[pairs.T]
    length = growth * np.hypot(*(x[i] - x[j]).T)
    least = wanted.copy()  # the minimum over each point and its neighbors; a neighbor undercuts most points
    np.minimum.at(least, i, wanted[j] + length)
    np.minimum.at(least, j, wanted[i] + length)
    alone = least == wanted
    tree = SegmentTree(x[alone], wanted[alone])
    ends = alone.copy()  # a point that matters for the exact minimum also matters for this upper bound
    some = _lower(wanted, least, i, j, length)
    ends[i[some]] = ends[j[some]] = True
    asked = np.flatnonzero(ends)
    found, which = tree.least(x[asked], growth, wanted[asked] * (1 - 1e-12))
    least[asked] = np.where(which < 0, wanted[asked], found)
    kept = np.zeros(len(x), dtype=bool)
    kept[asked[which < 0]] = True
    lower = _lower(wanted, least, i, j, length)
    kept[np.concatenate([i[lower], j[lower]])] = False  # these ends are part of an edge that is kept
    points = np.repeat(x[kept, None], 2, axis=1)
    edges = np.stack([x[i[lower]], x[j[lower]]], axis=1)
    weights = np.stack([wanted[i[lower]], wanted[j[lower]]], axis=1)
    return SegmentTree(
        np.concatenate([points, edges]), np.concatenate([np.repeat(wanted[kept, None], 2, axis=1), weights])
    )


def _lower(
    wanted: Array, least: Array, i: NDArray[np.int64], j: NDArray[np.int64], length: Array
) -> NDArray[np.bool_]:
    """Which edges give a lower value somewhere than ``least`` at both ends does.

    The bounds from the two ends are equal at the fraction t of the way from i to j.
    """
    with np.errstate(divide="ignore", invalid="ignore"):  # places may be equal
        t = ((least[j] - least[i]) / length + 1) / 2
        meet = least[i] + t * length
        return (np.abs(wanted[i] - wanted[j]) < length) & (meet > wanted[i] + t * (wanted[j] - wanted[i]))


class _Looks:
    """A wanted size as a function that stores all samples, and decides which leaves need more of them."""

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
        """Whether leaves may hide a size that matters.

        ``x`` are the places that were sampled in the leaves, (m, 13, 2), and ``values`` the sizes there.
        """
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
    """A size whose growth is limited: lowered near small sizes, and at no sampled place above the given size.

    Parameters
    ----------
    size : float, callable, or SizeField
    growth : float
        The largest wanted change of the size per unit of length; positive.
    lower, upper : array_like, shape (2,)
        A box. The size is evaluated only inside it; outside, the result is that at the nearest point of the
        box.
    tolerance, max_nodes : float, int
        As for `SizeField.table`, by which the size is sampled.

    Returns
    -------
    SizeField
        A `LimitedSize`: min_y (h(y) + growth * |x - y|) over all y of the box, where h is interpolated
        linearly between the sampled places on their Delaunay triangulation. A field that is known to grow by
        no more than ``growth`` is returned unchanged: constants, sources, feature sizes, limited sizes, and
        minima, maxima and clipped values of such fields.

    Notes
    -----
    Two statements hold everywhere, up to rounding. The result changes by no more than ``growth`` per unit of
    length. It is the largest function with this property that is at most the interpolant. In particular it
    is at most h at all sampled places (`LimitedSize.places`), which are nine points of each leaf of a table
    of h and the landmarks. Where nothing is too steep, it equals the interpolant, whose error is about a
    quarter of the tolerance. Between the sampled places it may exceed h by as much as the interpolant does,
    because any function may have details there that were not seen.

    Where h is too steep, leaves are divided until one of three conditions holds. They resolve h to the
    tolerance; or they seem to hide no size that is below the known sizes by more than the tolerance; or
    their side is ``tolerance * h / (2 * growth)``, or four times that at a jump, where h is the smallest size
    in them. So the place of a jump is known to about half a size times ``tolerance / growth``. The bottom of
    a valley whose sides are k times steeper than the limit is missed by about the tolerance, or k / 16 of it
    if that is more. `LimitedSize.capped` reports leaves that were not divided because a limit was reached.

    Distances are straight, also across holes and notches; if that is not wanted, use `limit_nodes` on a
    mesh. A value costs O(log c) for c places.

    Source: Borouchaki, Hecht and Frey, *Mesh gradation control* (1998); McShane (1934) for the formula. See
    the book, chapter 2.3.
    """
    field = as_size(size)
    if not finite(growth, "growth") > 0:
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
