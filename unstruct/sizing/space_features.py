"""The local feature size of a body: the smallest ball around a point that touches two parts that are apart.

See `apart` for the parts, and the book, 2.8c.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.heap import pop, push
from ..base.jit import inline, kernel, lean
from ..geometry.boxes import BOXES_IN_LEAF
from ..geometry.ordering import hilbert_order
from ..geometry.segment_tree import to_box
from ..geometry.triangle_tree import onto
from .apart import OPPOSED_BITS, parts_of, tree_of_parts

__all__ = ["SpaceFeatures"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
SOME_PLACES = 64  # from so many on they are asked along a curve, as neighbors bound each other
UP_TO_ROUNDING = 1.0 + 1e-12


@inline
def _common(a, i, b, j):
    """Whether two rows of bits have one in common."""
    for k in range(a.shape[1]):
        if a[i, k] & b[j, k]:
            return True
    return False


@lean
def _touch(parts, one, other):
    """Whether two parts have a vertex in common."""
    if one == other:
        return True
    first, last = parts.start[one], parts.start[one + 1]
    if parts.start[other + 1] - parts.start[other] < last - first:
        one, other = other, one
        first, last = parts.start[one], parts.start[one + 1]
    end = last
    while first < last:
        middle = (first + last) // 2
        if parts.touching[middle] < other:
            first = middle + 1
        else:
            last = middle
    return first < end and parts.touching[first] == other


@inline
def _no_common_vertex(parts, i, j):
    """Whether two elements have no vertex in common."""
    for a in range(3):
        for b in range(3):
            if parts.vertices[i, a] == parts.vertices[j, b]:
                return False
    return True


class Search(NamedTuple):
    """What a search knows: elements that were found, by their parts, and nodes that wait.

    Attributes
    ----------
    part, bits : (m,), (m, w) int64
        The parts of the elements found, and the directions of these.
    element, slot : (m,) int64
        The elements, and the place of their part in ``part``.
    node : (k,) int64
        The nodes that wait.
    opened : (k,) int64
        Nodes to be opened.
    numbers : (4,) int64
        How many parts, elements, waiting nodes and nodes to be opened there are.
    """

    part: Integers
    bits: Integers
    element: Integers
    slot: Integers
    node: Integers
    opened: Integers
    numbers: Integers


PARTS_SEEN, ELEMENTS_SEEN, NODES_WAITING, NODES_OPENED = range(4)  # places in ``numbers``


@lean
def _slot_of(search, part):
    """The place of a part among those found; their number if it is new."""
    for k in range(search.numbers[PARTS_SEEN]):
        if search.part[k] == part:
            return k
    return search.numbers[PARTS_SEEN]


@lean
def _meets_found(parts, search, part, against, row):
    """Whether elements of a part, with directions against row ``row``, may be apart from one found."""
    for k in range(search.numbers[PARTS_SEEN]):
        if search.part[k] == part:
            if _common(against, row, search.bits, k):
                return True
        elif not _touch(parts, part, search.part[k]):
            return True
    return False


@lean
def _is_apart(parts, search, i, opposed):
    """Whether element i is apart from one that was found."""
    if not _meets_found(parts, search, parts.part[i], opposed, parts.direction[i]):
        return False
    for k in range(search.numbers[PARTS_SEEN]):
        if search.part[k] != parts.part[i] and not _touch(parts, parts.part[i], search.part[k]):
            return True
    own = _slot_of(search, parts.part[i])
    for k in range(search.numbers[ELEMENTS_SEEN]):
        if search.slot[k] == own:
            j = search.element[k]
            bit = parts.direction[j]
            if (opposed[parts.direction[i], bit >> 6] >> (bit & 63)) & 1 and _no_common_vertex(parts, i, j):
                return True
    return False


@lean
def _choose(tree, parts, search, w, part, against, row):
    """List the waiting nodes that may be apart from node w, or from an element (w = 0), as to be opened.

    Of two nodes only the larger one is opened; returns whether that is w. Those listed wait no longer.
    """
    count, k, smaller = search.numbers, 0, False
    while k < count[NODES_WAITING]:
        v = search.node[k]
        if tree.part[v] == part:
            meet = _common(against, row, tree.facing, v)
        else:
            meet = not _touch(parts, part, tree.part[v])
        if meet and w > 0 and tree.extent[v] < tree.extent[w]:
            smaller = True
        elif meet:
            search.opened[count[NODES_OPENED]] = v
            count[NODES_OPENED] += 1
            count[NODES_WAITING] -= 1
            search.node[k] = search.node[count[NODES_WAITING]]
            continue
        k += 1
    return smaller


@lean
def _look_at(tree, parts, search, w, opposed):
    """Look at a node (w > 0) or an element (-1 - w): 1 if that ends the search, 2 if it is to come again.

    Else it waits, was found, or is listed as to be opened.
    """
    count = search.numbers
    count[NODES_OPENED] = 0
    if w > 0:
        part = tree.part[w]
        if (
            part < 0
            or _common(tree.against, w, tree.facing, w)
            or _meets_found(parts, search, part, tree.against, w)
            or _choose(tree, parts, search, w, part, tree.against, w)
        ):
            search.opened[count[NODES_OPENED]] = w
            count[NODES_OPENED] += 1
            return 0
        if count[NODES_OPENED] > 0:
            return 2
        search.node[count[NODES_WAITING]] = w
        count[NODES_WAITING] += 1
        return 0
    i = -1 - w
    if _is_apart(parts, search, i, opposed):
        return 1
    part, direction = parts.part[i], parts.direction[i]
    _choose(tree, parts, search, 0, part, opposed, direction)
    if count[NODES_OPENED] > 0:
        return 2
    own = _slot_of(search, part)
    if own == count[PARTS_SEEN]:
        search.part[own] = part
        for k in range(search.bits.shape[1]):
            search.bits[own, k] = 0
        count[PARTS_SEEN] += 1
    search.bits[own, direction >> 6] |= np.int64(1) << (direction & 63)
    search.element[count[ELEMENTS_SEEN]], search.slot[count[ELEMENTS_SEEN]] = i, own
    count[ELEMENTS_SEEN] += 1
    return 0


@kernel
def _space_feature_sizes(x, tree, parts, search, opposed, far, result):
    """The smallest radius of a ball around x[q] that touches two elements that are apart.

    A heap of nodes and elements (element i is stored as -1 - i) gives the nearest first. A node that cannot
    be apart from what was seen waits, unopened, until something turns up that may be apart from it.
    """
    leaves, m = tree.low.shape[0] // 2, parts.part.shape[0]
    heap = np.empty(tree.low.shape[0] + m + 2)
    what = np.empty(len(heap), dtype=np.int64)
    place = np.empty(3)
    for q in range(x.shape[0]):
        bound = far
        if q > 0:  # the radius is at most that at the previous point plus the distance from it
            way = 0.0
            for k in range(3):
                way += (x[q, k] - x[q - 1, k]) ** 2
            bound = min(far, (result[q - 1] + np.sqrt(way)) * UP_TO_ROUNDING)
        result[q] = np.inf
        size = push(heap, what, 0, to_box(x, q, tree.low, tree.high, 1), np.int64(1))
        search.numbers[:] = 0
        while size > 0:
            d, w = heap[0], what[0]
            size = pop(heap, what, size)
            if d > bound:
                break
            code = _look_at(tree, parts, search, w, opposed)
            if code == 1:
                result[q] = d
                break
            if code == 2:  # when what is nearer has come
                size = push(heap, what, size, d, w)
            for k in range(search.numbers[NODES_OPENED]):
                node = search.opened[k]
                if node < leaves:
                    for child in (2 * node, 2 * node + 1):
                        d = to_box(x, q, tree.low, tree.high, child)
                        if d <= bound:
                            size = push(heap, what, size, d, child)
                else:
                    first = (node - leaves) * BOXES_IN_LEAF
                    for j in range(first, min(first + BOXES_IN_LEAF, m)):
                        i = tree.order[j]
                        d = np.sqrt(onto(x[q], parts.corners[i], place))
                        if d <= bound:
                            size = push(heap, what, size, d, -1 - np.int64(i))


class SpaceFeatures:
    """The local feature size of a body as a function; see `local_feature_size`.

    Parameters
    ----------
    domain : Domain
        In space.

    Attributes
    ----------
    places : ndarray, shape (k, 3)
        The vertices of its pieces.
    """

    def __init__(self, domain: Any):
        self._parts, self._factor = parts_of(domain)
        self._tree = tree_of_parts(self._parts)
        used = np.zeros(len(domain.points), dtype=bool)
        used[self._parts.vertices.ravel()] = True
        self.places = domain.points[used]

    def __call__(self, x: Array, far: float) -> Array:
        """The local feature size at points (k, 3); infinite where it would be larger than ``far``."""
        scaled = np.ascontiguousarray(x * self._factor)
        result = np.empty(len(x))
        if len(self._parts.part) == 0:
            result.fill(np.inf)
            return result
        order = hilbert_order(scaled) if len(x) >= SOME_PLACES else np.arange(len(x))
        found = np.empty(len(x))
        nodes, many = len(self._tree.part), len(self._parts.part)
        search = Search(
            *(np.empty(shape, dtype=np.int64) for shape in (many, (many, OPPOSED_BITS.shape[1]), many, many)),
            *(np.empty(size, dtype=np.int64) for size in (nodes, nodes + 1, 4)),
        )
        _space_feature_sizes(
            scaled[order], self._tree, self._parts, search, OPPOSED_BITS, far * self._factor, found
        )
        result[order] = found
        return result / self._factor
