"""An alternating digital tree of boxes that come and go, in the plane or in space, for kernels.

Every node of the tree *is* an item, and every node owns a box: the root that of all coordinates, a child one
half of that of its parent, which is divided across its longest side. A new item walks down, always into the
half that contains its center, to the first free place. So the shape of the tree follows from the centers, as
that of a trie follows from digits, and it adapts to graded sizes without any choice of a cell width. If an
item leaves, a leaf from below takes its place. Items have a half width, and each node knows the largest one
below it: a search leaves out all nodes whose box, widened by it, does not meet the window.

One step down halves a box, so that the depth is about log2 n for even distributions, and at most n for any.
Centers and windows are tuples, and kernels are compiled for their length: the loops over axes are unrolled.
Source: J. Bonet, J. Peraire, International Journal for Numerical Methods in Engineering 31 (1991) 1-17, where
boxes are points of a space of twice the dimension; widths replace half of them here. Book: 3.1, 3.5.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, lean

__all__ = ["LOWER", "UPPER", "DigitalTree", "gather", "larger_tree", "new_tree", "plant", "planted", "pull"]

LOWER, UPPER, PARENT = range(3)  # columns of the links: the two children, and the parent
NOT_PLANTED = -2  # instead of a parent
PLACE_ROUNDING = (
    1e-15  # more than the center and the half width of an item can be wrong, as |coordinates| <= 1
)


class DigitalTree(NamedTuple):
    """The arrays of a tree in d dimensions; the row of an item is its number."""

    # (., 3 d + 2) The box of the node (its smallest, then its largest corner), the center of the item, its
    # half width, and the largest half width at the node and below: one line of the cache in the plane.
    place: NDArray[np.float64]
    links: NDArray[np.int32]  # (., 3)
    root: NDArray[np.int64]  # (1,) -1 if the tree is empty
    stack: NDArray[np.int32]
    found: NDArray[np.int32]  # the result of `gather`


def new_tree(capacity: int, dimension: int) -> DigitalTree:
    """An empty tree with room for items 0 to ``capacity`` - 1."""
    links = np.full((capacity, 3), NOT_PLANTED, dtype=np.int32)
    stack, found = np.empty(capacity + 4, dtype=np.int32), np.empty(capacity, dtype=np.int32)
    root, place = np.full(1, -1, dtype=np.int64), np.empty((capacity, 3 * dimension + 2))
    return DigitalTree(place, links, root, stack, found)


def larger_tree(tree: DigitalTree, capacity: int) -> DigitalTree:
    """The same tree with more room."""
    fresh = new_tree(capacity, dimension_of(tree.place))
    n = len(tree.links)
    fresh.place[:n], fresh.links[:n] = tree.place, tree.links
    fresh.root[0] = tree.root[0]
    return fresh


@inline
def dimension_of(place):
    """The dimension of a tree by its places."""
    return (place.shape[1] - 2) // 3


@inline
def planted(tree, i):
    """Whether item i is in the tree."""
    return tree.links[i, PARENT] != NOT_PLANTED


@inline
def longest_axis(place, node, d):
    """The axis across which the box of a node is divided: of equal sides the first one."""
    axis, longest = 0, place[node, d] - place[node, 0]
    for k in range(1, d):
        if place[node, d + k] - place[node, k] > longest:
            axis, longest = k, place[node, d + k] - place[node, k]
    return axis


@lean
def plant(tree, i, center, half):
    """Put item i into the tree: its center, a tuple with |coordinates| <= 1, and its half width."""
    links, place, d = tree.links, tree.place, len(center)
    own, below = 3 * d, 3 * d + 1
    for k in range(d):
        place[i, k], place[i, d + k], place[i, 2 * d + k] = -1.0, 1.0, center[k]
    place[i, own] = place[i, below] = half
    links[i, LOWER] = links[i, UPPER] = -1
    node = tree.root[0]
    if node < 0:
        tree.root[0] = i
        links[i, PARENT] = -1
        return
    while True:
        place[node, below] = max(place[node, below], half)
        axis = longest_axis(place, node, d)
        middle = 0.5 * (place[node, axis] + place[node, d + axis])
        upper = place[i, 2 * d + axis] >= middle
        place[i, axis if upper else d + axis] = middle
        side = UPPER if upper else LOWER
        child = links[node, side]
        if child < 0:
            links[node, side] = i
            links[i, PARENT] = node
            return
        node = np.int64(child)


@lean
def pull(tree, i):
    """Take item i out of the tree; a leaf from below takes its place."""
    links, place, d = tree.links, tree.place, dimension_of(tree.place)
    own, below = 3 * d, 3 * d + 1
    leaf = np.int64(i)
    while True:
        child = links[leaf, UPPER] if links[leaf, UPPER] >= 0 else links[leaf, LOWER]
        if child < 0:
            break
        leaf = np.int64(child)
    up = np.int64(links[leaf, PARENT])
    if up < 0:
        tree.root[0] = -1
    else:
        links[up, UPPER if links[up, UPPER] == leaf else LOWER] = -1
    if leaf != i:
        for k in range(2 * d):
            place[leaf, k] = place[i, k]
        for k in range(3):
            links[leaf, k] = links[i, k]
        for k in range(2):
            if links[leaf, k] >= 0:
                links[links[leaf, k], PARENT] = leaf
        above = links[leaf, PARENT]
        if above < 0:
            tree.root[0] = leaf
        else:
            links[above, UPPER if links[above, UPPER] == i else LOWER] = leaf
        if up == i:
            up = leaf
    links[i, PARENT] = NOT_PLANTED
    settled = leaf == i  # whether all places that have changed are below
    while up >= 0:
        widest = place[up, own]
        for k in range(2):
            if links[up, k] >= 0:
                widest = max(widest, place[links[up, k], below])
        settled = settled or up == leaf
        if settled and up != leaf and widest == place[up, below]:
            break
        place[up, below] = widest
        up = np.int64(links[up, PARENT])


@inline
def misses(place, node, d, window):
    """Whether no item at a node and below meets the window."""
    r = place[node, 3 * d + 1] + PLACE_ROUNDING
    for k in range(d):
        if place[node, k] - r > window[d + k] or place[node, d + k] + r < window[k]:
            return True
    return False


@inline
def meets(place, node, d, window):
    """Whether the item at a node meets the window, up to rounding."""
    h = place[node, 3 * d] + PLACE_ROUNDING
    for k in range(d):
        x = place[node, 2 * d + k]
        if not (x - h <= window[d + k] and x + h >= window[k]):
            return False
    return True


@lean
def gather(tree, window):
    """Write the items that meet a window to ``found``; return how many.

    The window is a tuple: its smallest corner, then the largest one. Items next to it may be among them.
    """
    links, place, stack, found = tree.links, tree.place, tree.stack, tree.found
    d, count, depth = len(window) // 2, 0, 0
    if tree.root[0] >= 0:
        stack[0] = tree.root[0]
        depth = 1
    while depth > 0:
        depth -= 1
        node = np.int64(stack[depth])
        if meets(place, node, d, window):
            found[count] = node
            count += 1
        for k in range(2):
            child = np.int64(links[node, k])
            if child >= 0 and not misses(place, child, d, window):
                stack[depth] = child
                depth += 1
    return count
