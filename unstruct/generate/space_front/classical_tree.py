"""An alternating digital tree of boxes in space that come and go, for kernels.

As that of the plane (`generate.front.digital_tree`): every node *is* an item and owns a box; the root that of
all coordinates, a child one half of that of its parent, which is divided across its longest side. A new item
walks down into the halves that contain its center, to the first free place; if an item leaves, a leaf from
below takes its place. Each node knows the largest half width at it and below, so that a search leaves out all
nodes whose box, widened by it, does not meet the window. Source: J. Bonet, J. Peraire, International Journal
for Numerical Methods in Engineering 31 (1991) 1-17. Book: 3.5.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, lean

__all__ = [
    "SpaceTree", "gather_in_space", "is_planted", "larger_space_tree", "new_space_tree", "plant_in_space",
    "pull_from_space",
]  # fmt: skip

LOW_CHILD, HIGH_CHILD, PARENT_NODE = range(3)  # columns of the links: the two children, and the parent
CENTER, OWN_WIDTH, MOST_WIDTH = 6, 9, 10  # columns of the places, after the box
NOT_THERE = -2  # instead of a parent
ROUNDED_PLACE = 1e-15  # more than the center and the half width can be wrong, as |coordinates| <= 1


class SpaceTree(NamedTuple):
    """The arrays of a tree; the row of an item is its number."""

    # (., 11) The box of the node (smallest and largest corner), the center of the item, its half width, and
    # the largest half width at the node and below.
    place: NDArray[np.float64]
    links: NDArray[np.int32]  # (., 3)
    root: NDArray[np.int64]  # (1,) -1 if the tree is empty
    stack: NDArray[np.int32]
    found: NDArray[np.int32]  # the result of `gather_in_space`


def new_space_tree(capacity: int) -> SpaceTree:
    """An empty tree with room for items 0 to ``capacity`` - 1."""
    links = np.full((capacity, 3), NOT_THERE, dtype=np.int32)
    stack, found = np.empty(capacity + 4, dtype=np.int32), np.empty(capacity, dtype=np.int32)
    return SpaceTree(np.empty((capacity, 11)), links, np.full(1, -1, dtype=np.int64), stack, found)


def larger_space_tree(tree: SpaceTree, capacity: int) -> SpaceTree:
    """The same tree with more room."""
    fresh, n = new_space_tree(capacity), len(tree.links)
    fresh.place[:n], fresh.links[:n] = tree.place, tree.links
    fresh.root[0] = tree.root[0]
    return fresh


@inline
def is_planted(tree, i):
    """Whether item i is in the tree."""
    return tree.links[i, PARENT_NODE] != NOT_THERE


@inline
def longest_axis(place, node):
    """The axis across which the box of a node is divided."""
    x, y, z = (
        place[node, 3] - place[node, 0],
        place[node, 4] - place[node, 1],
        place[node, 5] - place[node, 2],
    )
    if x >= y and x >= z:
        return 0
    return 1 if y >= z else 2


@lean
def plant_in_space(tree, i, x, y, z, half):
    """Put item i into the tree: its center, with |coordinates| <= 1, and its half width."""
    links, place = tree.links, tree.place
    place[i, CENTER], place[i, CENTER + 1], place[i, CENTER + 2] = x, y, z
    place[i, OWN_WIDTH] = place[i, MOST_WIDTH] = half
    links[i, LOW_CHILD] = links[i, HIGH_CHILD] = -1
    for k in range(3):
        place[i, k], place[i, k + 3] = -1.0, 1.0
    node = tree.root[0]
    if node < 0:
        tree.root[0] = i
        links[i, PARENT_NODE] = -1
        return
    while True:
        place[node, MOST_WIDTH] = max(place[node, MOST_WIDTH], half)
        axis = longest_axis(place, node)
        middle = 0.5 * (place[node, axis] + place[node, axis + 3])
        high = place[i, CENTER + axis] >= middle
        place[i, axis if high else axis + 3] = middle
        side = HIGH_CHILD if high else LOW_CHILD
        child = links[node, side]
        if child < 0:
            links[node, side] = i
            links[i, PARENT_NODE] = node
            return
        node = np.int64(child)


@lean
def pull_from_space(tree, i):
    """Take item i out of the tree; a leaf from below takes its place."""
    links, place = tree.links, tree.place
    leaf = np.int64(i)
    while True:
        child = links[leaf, HIGH_CHILD] if links[leaf, HIGH_CHILD] >= 0 else links[leaf, LOW_CHILD]
        if child < 0:
            break
        leaf = np.int64(child)
    up = np.int64(links[leaf, PARENT_NODE])
    if up < 0:
        tree.root[0] = -1
    else:
        links[up, HIGH_CHILD if links[up, HIGH_CHILD] == leaf else LOW_CHILD] = -1
    if leaf != i:
        for k in range(6):
            place[leaf, k] = place[i, k]
        for k in range(3):
            links[leaf, k] = links[i, k]
        for k in range(2):
            if links[leaf, k] >= 0:
                links[links[leaf, k], PARENT_NODE] = leaf
        above = links[leaf, PARENT_NODE]
        if above < 0:
            tree.root[0] = leaf
        else:
            links[above, HIGH_CHILD if links[above, HIGH_CHILD] == i else LOW_CHILD] = leaf
        if up == i:
            up = leaf
    links[i, PARENT_NODE] = NOT_THERE
    settled = leaf == i  # whether all places that have changed are below
    while up >= 0:
        widest = place[up, OWN_WIDTH]
        for k in range(2):
            if links[up, k] >= 0:
                widest = max(widest, place[links[up, k], MOST_WIDTH])
        settled = settled or up == leaf
        if settled and up != leaf and widest == place[up, MOST_WIDTH]:
            break
        place[up, MOST_WIDTH] = widest
        up = np.int64(links[up, PARENT_NODE])


@lean
def gather_in_space(tree, window):
    """Write the items that meet a window (smallest, then largest corner) to ``found``; return how many.

    Items next to the window may be among them.
    """
    links, place, stack, found = tree.links, tree.place, tree.stack, tree.found
    x0, y0, z0, x1, y1, z1 = window
    count = depth = 0
    if tree.root[0] >= 0:
        stack[0] = tree.root[0]
        depth = 1
    while depth > 0:
        depth -= 1
        node = np.int64(stack[depth])
        h = place[node, OWN_WIDTH] + ROUNDED_PLACE
        x, y, z = place[node, CENTER], place[node, CENTER + 1], place[node, CENTER + 2]
        if x - h <= x1 and x + h >= x0 and y - h <= y1 and y + h >= y0 and z - h <= z1 and z + h >= z0:
            found[count] = node
            count += 1
        for k in range(2):
            child = np.int64(links[node, k])
            if child >= 0:
                r = place[child, MOST_WIDTH] + ROUNDED_PLACE
                if not (
                    place[child, 0] - r > x1
                    or place[child, 3] + r < x0
                    or place[child, 1] - r > y1
                    or place[child, 4] + r < y0
                    or place[child, 2] - r > z1
                    or place[child, 5] + r < z0
                ):
                    stack[depth] = child
                    depth += 1
    return count
