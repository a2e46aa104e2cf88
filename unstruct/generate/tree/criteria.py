"""When is a node of a tree divided: rules that look at all nodes of a level at once.

A rule takes the nodes of one level (`Level`) and returns a flag for each. A node is divided if any rule asks
for it. See the book, chapter 4a.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...sizing.field import SizeField
from .contacts import CUT, Contacts
from .keys import Keys

__all__ = ["Level", "Rule", "by_boundary", "by_count", "by_function", "by_size", "by_turning"]

Array = NDArray[np.float64]
FINE_LEVEL = 4  # above this level, sizes are asked at as many places as that level has cells


class Level(NamedTuple):
    """The nodes of one level.

    Attributes
    ----------
    level : int
    keys : (n,) uint64
    low, high : (n, d) float64
        Their corners.
    side : float
        Their longest edge.
    contacts : Contacts or None
        With the boundary of the domain, where there is one.
    """

    level: int
    keys: Keys
    low: Array
    high: Array
    side: float
    contacts: Contacts | None

    @property
    def centers(self) -> Array:
        """(n, d)."""
        return self.low + 0.5 * (self.high - self.low)


Rule = Callable[[Level], NDArray[np.bool_]]


def by_size(field: SizeField) -> Rule:
    """Nodes whose longest edge exceeds the size wanted in them.

    The size is asked at centers. If the field's growth g is known, a node of half diagonal r may hold places
    where the size is smaller by g r: that bound is compared. Otherwise the first levels are asked at more
    places, and a landmark of the field is asked in every node that contains it.
    """

    def rule(nodes: Level) -> NDArray[np.bool_]:
        if field.constant is not None:
            return np.full(len(nodes.low), nodes.side > field.constant)
        half = 0.5 * (nodes.high - nodes.low)
        sizes = field(nodes.low + half)
        if field.growth is not None:
            return sizes - field.growth * np.sqrt((half * half).sum(axis=1)) < nodes.side
        for places in _further(nodes):
            sizes = np.minimum(sizes, field(places))
        wanted = sizes < nodes.side
        for mark in field.landmarks:
            holds = ((nodes.low <= mark) & (mark <= nodes.high)).all(axis=1)
            if holds.any() and not wanted[holds].all():
                wanted |= holds & (field(mark[None])[0] < nodes.side)
        return wanted

    return rule


def _further(nodes: Level) -> list[Array]:
    """The centers of the cells of `FINE_LEVEL` in the nodes, if they are above it: an array for each."""
    if nodes.level >= FINE_LEVEL:
        return []
    count = 1 << (FINE_LEVEL - nodes.level)
    share = (np.arange(count) + 0.5) / count
    steps = np.stack(np.meshgrid(*[share] * nodes.low.shape[1], indexing="ij"), axis=-1)
    return [nodes.low + (nodes.high - nodes.low) * step for step in steps.reshape(-1, steps.shape[-1])]


def by_function(function: Callable[[Array, Array], Any], name: str = "divide") -> Rule:
    """Nodes for which a function of centers (n, d) and longest edges (n,) is true.

    Raises
    ------
    InputError
        If it returns anything but n flags.
    """

    def rule(nodes: Level) -> NDArray[np.bool_]:
        answer = np.asarray(function(nodes.centers, np.full(len(nodes.low), nodes.side)))
        if answer.shape != (len(nodes.low),) or answer.dtype != np.bool_:
            raise InputError(
                f"{name} must return one bool for each of {len(nodes.low)} cells, not an array of "
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


def by_turning(normals: Array, angle: float) -> Rule:
    """Nodes in which two normals of pieces of the boundary differ by more than about `angle` radians.

    Compared is the angle of each normal with the mean of all of them in the node, to half of `angle`.
    """
    bound = np.cos(min(0.5 * angle, np.pi))

    def rule(nodes: Level) -> NDArray[np.bool_]:
        assert nodes.contacts is not None
        node, n = nodes.contacts.node, normals[nodes.contacts.piece]
        mean = np.stack([np.bincount(node, column, len(nodes.low)) for column in n.T], axis=1)
        length = np.sqrt((mean * mean).sum(axis=1))
        cosine = (n * mean[node]).sum(axis=1)
        turning = np.zeros(len(nodes.low), dtype=bool)
        turning[node[cosine < bound * length[node]]] = True
        return turning

    return rule


def by_count(sorted_keys: Keys, deepest: int, most: int) -> Rule:
    """Nodes with more than `most` points, given by the sorted keys of their cells of the level `deepest`."""

    def rule(nodes: Level) -> NDArray[np.bool_]:
        shift = np.uint64(nodes.low.shape[1] * (deepest - nodes.level))
        begin = np.searchsorted(sorted_keys, nodes.keys << shift)
        end = np.searchsorted(sorted_keys, (nodes.keys + np.uint64(1)) << shift)
        return end - begin > most

    return rule
