"""When is a node of a tree divided: rules that look at all nodes of a level at once.

A rule takes the nodes of one level (`Level`) and returns a flag for each. A node is divided if any rule asks
for it. See the book, chapter 4a.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.asking import first_to_raise
from ...base.errors import InputError
from ...geometry.segment_tree import SegmentTree
from ...geometry.triangle_tree import TriangleTree
from ...sizing.field import SizeField
from .contacts import CUT, Boundary, Contacts
from .keys import Keys
from .lookup import boxes_of, centers_of

__all__ = ["Level", "Rule", "by_boundary", "by_count", "by_distance", "by_function", "by_size"]

Array = NDArray[np.float64]
NODES_AT_ONCE = 1 << 16  # nodes whose sizes are asked at once: what is computed for them stays in the caches
FINE_LEVEL = 4  # above this level, sizes are asked at as many places as that level has cells


class Level:
    """The nodes of one level.

    Attributes
    ----------
    level : int
    keys : (n,) uint64
    side : float
        Their longest edge.
    contacts : Contacts or None
        With the boundary of the domain, where there is one.
    """

    def __init__(self, level: int, keys: Keys, root: tuple[Array, Array]):
        self.level, self.keys, self._root = level, keys, root
        self.side = float(root[1].max()) / (1 << level)
        self.contacts: Contacts | None = None

    def __len__(self) -> int:
        return len(self.keys)

    @cached_property
    def boxes(self) -> tuple[Array, Array]:
        """Their lower and upper corners: (n, d) each."""
        return boxes_of(self.keys, *self._root, self.level)

    @cached_property
    def centers(self) -> Array:
        """(n, d)."""
        return centers_of(self.keys, *self._root, self.level)

    def part(self, begin: int, end: int) -> Level:
        """The nodes from `begin` to `end`, without their contacts."""
        return Level(self.level, self.keys[begin:end], self._root)

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return len(self._root[0])


Rule = Callable[[Level], NDArray[np.bool_]]


def by_size(field: SizeField) -> Rule:
    """Nodes whose longest edge exceeds the size wanted in them.

    The size is asked at centers. If the field's growth g is known, a node of half diagonal r may hold places
    where the size is smaller by g r: that bound is compared. Otherwise the first levels are asked at more
    places, and a landmark of the field is asked in every node that contains it.
    """

    def rule(nodes: Level) -> NDArray[np.bool_]:
        wanted = np.full(len(nodes), field.constant is not None and nodes.side > field.constant)
        if field.constant is None:
            for begin in range(0, len(nodes), NODES_AT_ONCE):
                wanted[begin : begin + NODES_AT_ONCE] = asked(nodes.part(begin, begin + NODES_AT_ONCE))
        return wanted

    def asked(nodes: Level) -> NDArray[np.bool_]:
        sizes = field(nodes.centers)
        if field.growth is not None:
            low, high = nodes.boxes
            half = 0.5 * (high - low)
            return sizes - field.growth * np.sqrt((half * half).sum(axis=1)) < nodes.side
        if nodes.level < FINE_LEVEL:
            further = _further(nodes)
            least = field(further.reshape(-1, further.shape[-1])).reshape(further.shape[:2]).min(axis=1)
            sizes = np.minimum(sizes, least)
        wanted = sizes < nodes.side
        for mark in field.landmarks:
            low, high = nodes.boxes
            holds = ((low <= mark) & (mark <= high)).all(axis=1)
            if holds.any() and not wanted[holds].all():
                wanted |= holds & (field(mark[None])[0] < nodes.side)
        return wanted

    return rule


def _further(nodes: Level) -> Array:
    """The centers of the cells of `FINE_LEVEL` in each of the nodes, which are above it: (n, m, d)."""
    count = 1 << (FINE_LEVEL - nodes.level)
    share = (np.arange(count) + 0.5) / count
    steps = np.stack(np.meshgrid(*[share] * nodes.dimension, indexing="ij"), axis=-1)
    low, high = nodes.boxes
    return low[:, None] + (high - low)[:, None] * steps.reshape(-1, steps.shape[-1])


def by_function(function: Callable[[Array, Array], Any], name: str = "divide") -> Rule:
    """Nodes for which a function of centers (n, d) and longest edges (n,) is true.

    Raises
    ------
    InputError
        If it raises an error, with the first cell concerned, or returns anything but n flags.
    """

    def rule(nodes: Level) -> NDArray[np.bool_]:
        def asked(centers: Array) -> Any:
            raw = function(centers, np.full(len(centers), nodes.side))
            return raw if isinstance(raw, np.ma.MaskedArray) else np.asarray(raw)

        try:
            answer = asked(nodes.centers)
        except InputError:  # of this package; it names the fault
            raise
        except Exception as error:
            place = nodes.centers[first_to_raise(asked, nodes.centers)].tolist()
            raise InputError(
                f"{name} raised {type(error).__name__} ({error}) for the cell about {place}, of side "
                f"{nodes.side:g}; it takes centers (k, {nodes.dimension}) and edges (k,), and returns k bools"
            ) from error
        if isinstance(answer, np.ma.MaskedArray):
            raise InputError(f"{name} must return plain bools, not a masked array; fill it first")
        if answer.shape != (len(nodes),) or answer.dtype != np.bool_:
            raise InputError(
                f"{name} must return one bool for each of {len(nodes)} cells, not an array of "
                f"{answer.dtype} of shape {answer.shape}"
            )
        return answer

    return rule


def by_boundary(side: float) -> Rule:
    """Nodes that the boundary cuts and whose longest edge exceeds `side`."""

    def rule(nodes: Level) -> NDArray[np.bool_]:
        assert nodes.contacts is not None
        return (nodes.contacts.state == CUT) & (nodes.side > side)

    return rule


def by_distance(boundary: Boundary, size: float, growth: float) -> Rule:
    """Nodes whose longest edge exceeds `size` plus `growth` times their distance from the boundary.

    The distance is bounded over the whole node, as every size of known growth is.
    """
    ends = boundary.points[boundary.pieces] / boundary.factor
    if ends.shape[2] == 2:
        distance: Callable[[Array], Array] = SegmentTree(ends).distance
    else:
        tree = TriangleTree(ends)

        def distance(x: Array) -> Array:
            which, weights = tree.nearest(x)
            away = x - (ends[which] * weights[:, :, None]).sum(axis=1)
            return np.sqrt((away * away).sum(axis=1))

    return by_size(SizeField(lambda x: size + growth * distance(x), growth=growth))


def by_count(sorted_keys: Keys, deepest: int, most: int) -> Rule:
    """Nodes with more than `most` points, given by the sorted keys of their cells of the level `deepest`."""

    def rule(nodes: Level) -> NDArray[np.bool_]:
        shift = np.uint64(nodes.dimension * (deepest - nodes.level))
        begin = np.searchsorted(sorted_keys, nodes.keys << shift)
        end = np.searchsorted(sorted_keys, (nodes.keys + np.uint64(1)) << shift)
        return end - begin > most

    return rule
