"""An alternating digital tree of boxes in the plane that come and go, for kernels.

Every node of the tree *is* an item, and every node owns a rectangle: the root that of all coordinates, a
child one half of that of its parent, which is divided across its longer side. A new item walks down, always
into the half that contains its center, to the first free place. So the shape of the tree follows from the
centers, as that of a trie follows from digits, and it adapts to graded sizes without any choice of a cell
width. If an item leaves, a leaf from below takes its place. Items have a half width, and each node knows the
largest one below it: a search leaves out all nodes whose rectangle, widened by it, does not meet the window.

One step down halves a rectangle, so that the depth is about log2 n for even distributions, and at most n for
any. Source: J. Bonet, J. Peraire, International Journal for Numerical Methods in Engineering 31 (1991) 1-17,
where boxes are points of a space of four dimensions; widths replace two of them here. Book: 3.1.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, lean

__all__ = ["LOWER", "UPPER", "DigitalTree", "gather", "larger_tree", "new_tree", "plant", "planted", "pull"]

LOWER, UPPER, PARENT = range(3)  # columns of the links: the two children, and the parent
X, Y, HALF_WIDTH, WIDEST_BELOW = range(4, 8)  # columns of the places, after the rectangle
NOT_PLANTED = -2  # instead of a parent
PLACE_ROUNDING = (
    1e-15  # more than the center and the half width of an item can be wrong, as |coordinates| <= 1
)


class DigitalTree(NamedTuple):
    """The arrays of a tree; the row of an item is its number."""

    # (., 8) The rectangle of the node (smallest x and y, largest x and y), the center of the item and its
    # half width, and the largest half width at the node and below: one line of the cache.
    place: NDArray[np.float64]
    links: NDArray[np.int32]  # (., 3)
    root: NDArray[np.int64]  # (1,) -1 if the tree is empty
    stack: NDArray[np.int32]
    found: NDArray[np.int32]  # the result of `gather`


def new_tree(capacity: int) -> DigitalTree:
    """An empty tree with room for items 0 to ``capacity`` - 1."""
    links = np.full((capacity, 3), NOT_PLANTED, dtype=np.int32)
    stack, found = np.empty(capacity + 4, dtype=np.int32), np.empty(capacity, dtype=np.int32)
    root = np.full(1, -1, dtype=np.int64)
    return DigitalTree(np.empty((capacity, 8)), links, root, stack, found)


def larger_tree(tree: DigitalTree, capacity: int) -> DigitalTree:
    """The same tree with more room."""
    fresh = new_tree(capacity)
    n = len(tree.links)
    fresh.place[:n], fresh.links[:n] = tree.place, tree.links
    fresh.root[0] = tree.root[0]
    return fresh


@inline
def planted(tree, i):
    """Whether item i is in the tree."""
    return tree.links[i, PARENT] != NOT_PLANTED


@inline
def half_of(tree, node, x, y):
    """On which side of the dividing line of a node a point lies, and the rectangle of that side."""
    x0, y0, x1, y1 = tree.place[node, 0], tree.place[node, 1], tree.place[node, 2], tree.place[node, 3]
    if x1 - x0 >= y1 - y0:
        middle = 0.5 * (x0 + x1)
        if x < middle:
            return LOWER, x0, y0, middle, y1
        return UPPER, middle, y0, x1, y1
    middle = 0.5 * (y0 + y1)
    if y < middle:
        return LOWER, x0, y0, x1, middle
    return UPPER, x0, middle, x1, y1


@lean
def plant(tree, i, x, y, half):
    """Put item i into the tree: its center, with |x|, |y| <= 1, and its half width."""
    links, place = tree.links, tree.place
    place[i, X], place[i, Y], place[i, HALF_WIDTH], place[i, WIDEST_BELOW] = x, y, half, half
    links[i, LOWER] = links[i, UPPER] = -1
    node = tree.root[0]
    if node < 0:
        tree.root[0] = i
        links[i, PARENT] = -1
        place[i, 0], place[i, 1], place[i, 2], place[i, 3] = -1.0, -1.0, 1.0, 1.0
        return
    while True:
        place[node, WIDEST_BELOW] = max(place[node, WIDEST_BELOW], half)
        side, x0, y0, x1, y1 = half_of(tree, node, x, y)
        child = links[node, side]
        if child < 0:
            links[node, side] = i
            links[i, PARENT] = node
            place[i, 0], place[i, 1], place[i, 2], place[i, 3] = x0, y0, x1, y1
            return
        node = np.int64(child)


@lean
def pull(tree, i):
    """Take item i out of the tree; a leaf from below takes its place."""
    links, place = tree.links, tree.place
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
        for k in range(4):
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
        widest = place[up, HALF_WIDTH]
        for k in range(2):
            if links[up, k] >= 0:
                widest = max(widest, place[links[up, k], WIDEST_BELOW])
        settled = settled or up == leaf
        if settled and up != leaf and widest == place[up, WIDEST_BELOW]:
            break
        place[up, WIDEST_BELOW] = widest
        up = np.int64(links[up, PARENT])


@inline
def misses(place, node, x0, y0, x1, y1):
    """Whether no item at a node and below meets the window."""
    r = place[node, WIDEST_BELOW] + PLACE_ROUNDING
    return (
        place[node, 0] - r > x1
        or place[node, 2] + r < x0
        or place[node, 1] - r > y1
        or place[node, 3] + r < y0
    )


@lean
def gather(tree, x0, y0, x1, y1):
    """Write the items that meet a window (smallest x and y, largest x and y) to ``found``; return how many.

    Items next to the window may be among them.
    """
    links, place, stack, found = tree.links, tree.place, tree.stack, tree.found
    count = depth = 0
    if tree.root[0] >= 0:
        stack[0] = tree.root[0]
        depth = 1
    while depth > 0:
        depth -= 1
        node = np.int64(stack[depth])
        h, x, y = place[node, HALF_WIDTH] + PLACE_ROUNDING, place[node, X], place[node, Y]
        if x - h <= x1 and x + h >= x0 and y - h <= y1 and y + h >= y0:
            found[count] = node
            count += 1
        for k in range(2):
            child = np.int64(links[node, k])
            if child >= 0 and not misses(place, child, x0, y0, x1, y1):
                stack[depth] = child
                depth += 1
    return count
