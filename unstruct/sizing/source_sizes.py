"""Sizes that grow from sources: points, lines, polygons.

A source i is a place x_i with a size h_i. Away from it the size may be larger by no more than ``growth``
times the distance. The minimum over all sources, min_i (h_i + growth * |x - x_i|), is the largest function
that is at most h_i at every source and changes by no more than ``growth`` per unit of length (McShane's
extension). See the book, chapter 2.3.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arguments import as_number, finite
from ..base.arrays import as_numbers, as_points
from ..base.errors import InputError
from ..geometry.segment_tree import SegmentTree
from .field import SizeField

__all__ = ["lines", "points", "polygons", "sources"]

Array = NDArray[np.float64]


def sources(
    segments: ArrayLike,
    size: ArrayLike,
    *,
    growth: float = 0.2,
    far: float | None = None,
    name: str = "sources",
) -> SizeField:
    """A size that is given on segments or at points and grows with the distance from them.

    Parameters
    ----------
    segments : array_like, shape (s, 2, d), or points of shape (s, d)
    size : float, or array_like of shape (s,)
        The size of each source.
    growth : float
        How much larger the size may be per unit of distance; at least 0.
    far : float, optional
        The cut-off, an upper bound of the size. Without it, the size grows without bound.
    name : str
        The name that `repr` shows.

    Returns
    -------
    SizeField
        min(far, min_i (size_i + growth * distance to source i)). It is Lipschitz with the constant
        ``growth``. On a source that lies near a finer one, it may be less than ``size_i``.

    Raises
    ------
    InputError
        For sizes that are not positive, wrong shapes, or a cut-off below the largest size.

    Notes
    -----
    A value costs about O(log s), because a tree of boxes (`SegmentTree`) is searched.
    """
    array = np.asarray(segments)
    rows = len(array) if array.ndim else 0
    values = as_numbers(size, "size")
    if values.ndim == 0:
        values = np.full(rows, float(values))
    if values.shape != (rows,):
        raise InputError(f"give one size, or one for each of {rows} sources, not shape {values.shape}")
    bad = ~(np.isfinite(values) & (values > 0))
    if bad.any():
        row = int(np.argmax(bad))
        raise InputError(f"size[{row}] = {float(values[row])!r} at source {row} must be positive and finite")
    if finite(growth, "growth") < 0:
        raise InputError(f"growth must be a finite number of at least 0, not {growth!r}")
    cap = np.inf if far is None else as_number(far, "far")
    if not cap >= values.max(initial=0.0):
        raise InputError(f"the cut-off far = {far!r} must not be below the size {values.max():g} of a source")
    tree = SegmentTree(array, values)
    ends = array.reshape(-1, array.shape[-1])
    if array.ndim == 3:
        ends = np.concatenate([ends, array.mean(axis=1)])
    return _Sources(tree, growth, cap, ends, f"{len(values)} {name}, growth {growth:g}")


class _Sources(SizeField):
    """The result of `sources`."""

    def __init__(self, tree: SegmentTree, growth: float, cap: float, landmarks: Array, name: str):
        super().__init__(partial(_grown, tree, growth, cap), landmarks=landmarks, name=name, growth=growth)
        self.tree, self.most, self.change = tree, cap, growth

    def below(self, x: Array, bound: Array) -> Array:
        """As `SizeField.below`: the tree looks only for what is below the bound."""
        found = np.minimum(bound, self.most)
        self.tree.lower(x, self.change, found)
        return found


def _grown(tree: SegmentTree, growth: float, cap: float, x: Array) -> Array:
    found = np.full(len(x), cap)
    tree.lower(x, growth, found)
    return found


def points(places: ArrayLike, size: ArrayLike, *, growth: float = 0.2, far: float | None = None) -> SizeField:
    """Point sources: `sources` at places of shape (s, d).

    Parameters
    ----------
    places : array_like, shape (s, d)
    size : float, or array_like of shape (s,)
    growth, far : float
        As for `sources`.

    Returns
    -------
    SizeField
    """
    return sources(as_points(places, "places"), size, growth=growth, far=far, name="points")


def lines(path: ArrayLike, size: float, *, growth: float = 0.2, far: float | None = None) -> SizeField:
    """A line source: `sources` along a chain of segments.

    Parameters
    ----------
    path : array_like, shape (s + 1, d)
        The corners of the chain.
    size : float
    growth, far : float
        As for `sources`.

    Returns
    -------
    SizeField
    """
    corners = as_points(path, "path")
    if len(corners) < 2:
        raise InputError(f"a line source needs at least two points, not {len(corners)}")
    segments = np.stack([corners[:-1], corners[1:]], axis=1)
    return sources(segments, size, growth=growth, far=far, name="segments")


def polygons(
    rings: ArrayLike | list[ArrayLike], size: float, *, growth: float = 0.2, far: float | None = None
) -> SizeField:
    """An area source in the plane: the size is constant inside polygons and grows outside them.

    Parameters
    ----------
    rings : array_like of shape (s, 2), or a list of such arrays
        Closed polygons. A point in an even number of them is outside, so a ring within a ring is a hole.
    size : float
    growth, far : float
        As for `sources`.

    Returns
    -------
    SizeField
    """
    loops = [as_points(ring, "ring") for ring in _rings(rings)]
    for ring in loops:
        if len(ring) < 3 or ring.shape[1] != 2:
            raise InputError(f"a polygon needs at least three points in the plane, not shape {ring.shape}")
    segments = np.concatenate([np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in loops])
    border = sources(segments, size, growth=growth, far=far, name="sides of polygons")

    return SizeField(
        partial(_filled, border, segments, size), landmarks=border.landmarks, name=border.name, growth=growth
    )


def _filled(border: SizeField, segments: Array, size: float, x: Array) -> Array:
    """The size, with inside and outside decided in floating point; at the border both give the same size."""
    result = border(x)
    result[_inside(segments, x)] = size
    return result


def _rings(rings: Any) -> list[Any]:
    try:
        first = rings[0] if len(rings) else ()
        return list(rings) if np.ndim(first) == 2 else [rings]
    except (TypeError, ValueError, KeyError, IndexError):
        raise InputError(f"rings must be corners (s, 2) or a list of these, not {rings!r:.60}") from None


def _inside(segments: Array, x: Array) -> NDArray[np.bool_]:
    """Whether a ray to the right from each point crosses an odd number of segments."""
    inside = np.zeros(len(x), dtype=bool)
    with np.errstate(divide="ignore", invalid="ignore"):
        for a, b in segments:
            over = (a[1] <= x[:, 1]) != (b[1] <= x[:, 1])
            inside ^= over & (x[:, 0] < a[0] + (x[:, 1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
    return inside
