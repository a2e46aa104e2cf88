"""The convex hull without its holes: parts that a seed names or that facets enclose outside of the domain."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from .complex import PlanarComplex
from .flood import flood, hold_seeds

__all__ = ["eat_holes"]


def eat_holes(c: PlanarComplex, facets: int, seeds: NDArray[np.float64], names: list[str]) -> None:
    """Take the holes out of a complex whose whole hull was marked, and number the other regions anew.

    Parameters
    ----------
    c : PlanarComplex
        After `mark_regions` with ``hull=True``.
    facets : int
        A part that lies outside by the even-odd rule of the facets is a hole if segments enclose it.
    seeds : ndarray, shape (h, 2)
        A part with one of these points is a hole, too; points beyond the hull have no effect.
    names : list of str
        The named regions.

    Raises
    ------
    InputError
        If nothing is left, or a named region is a hole.
    """
    count = c.triangles
    part = c.region[:count]
    slots = hold_seeds(c.xy, c.vertex, c.mark, count, np.ascontiguousarray(seeds * c.factor))
    eaten = np.zeros(c.parts(), dtype=bool)
    eaten[part[slots[slots >= 0]]] = True
    if facets:
        eaten |= _enclosed(c, facets)
    for k, name in enumerate(names):
        if eaten[k]:
            raise InputError(f"region {name!r} lies in a hole: drop its seed or that of the hole")
    if eaten.all():
        raise InputError("the holes leave nothing of the convex hull: move their seeds")
    number = np.where(eaten, -1, np.cumsum(~eaten) - 1).astype(np.int32)
    inside = part >= 0
    part[inside] = number[part[inside]]


def _enclosed(c: PlanarComplex, facets: int) -> NDArray[np.bool_]:
    """The parts outside by the even-odd rule from which segments bar the way to infinity."""
    count = c.triangles
    part, other = c.region[:count], np.empty(count, dtype=np.int32)
    stack = np.empty(3 * count + 3, dtype=np.int32)
    flood(c.plane(), facets, False, other, stack, np.empty(count, dtype=np.int32))
    found = np.zeros(c.parts(), dtype=bool)
    found[part[(part >= 0) & (other < 0)]] = True
    free = np.flatnonzero(c.mark[: 3 * count] < 0)
    beyond = free[(part[free // 3] >= 0) & (part[c.twin[free] // 3] < 0)]
    found[part[beyond // 3]] = False
    return found
