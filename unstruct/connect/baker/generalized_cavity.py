"""Kernels of Baker's insertion: locate, principal component, visibility, reduction, star.

A triangulation is ``cells`` (m, d + 1) and ``neighbors`` of the same shape; a free row of ``cells`` starts
with -1. Two dimensions and three share one code: a facet is (cell, k), opposite corner k; a ridge is
(cell, {j, k}), what remains without corners j and k.
"""

from __future__ import annotations

import numpy as np

from ...base.codes import DONE, HIDDEN, OUTSIDE, ROOM
from ...base.jit import inline, kernel
from ...predicates.kernels import conflict, moved

__all__ = ["FIXED", "HELD", "insert_vertices"]

HELD = 8  # by a fixed cell: what `insert_vertices` stopped for, or DONE, OUTSIDE, HIDDEN, ROOM
# states of a cell during one insertion; a fixed one is never in a cavity
OUT, IN, DROPPED, PENDING, FIXED = 0, 1, 2, 3, 4
# columns of the record
TWIN, COMPONENT, HIDDEN_FACETS, DROP_ROUNDS, CELLS_LOST, CELLS_KEPT, CELLS_MADE = range(7)


@kernel
def locate(points, cells, neighbors, count, p, start):
    """A closed cell that holds p, or -1.

    A walk, whose first facet changes with every step. In a triangulation that is not Delaunay it may
    run in circles, in a region that is not convex it may leave: then every cell is looked at.
    """
    width = cells.shape[1]
    c = start
    for step in range(200 + count // 8):
        following = -2
        for i in range(width):
            k = (i + step) % width
            if moved(points, cells[c], k, p) < 0:
                following = neighbors[c, k]
                break
        if following == -2:
            return c
        if following == -1:
            break
        c = following
    for c in range(count):
        if cells[c, 0] >= 0:
            inside = True
            for k in range(width):
                if moved(points, cells[c], k, p) < 0:
                    inside = False
                    break
            if inside:
                return c
    return -1


@kernel
def fixed_holder(points, cells, neighbors, p, holder, state, cavity):
    """A fixed cell that holds p, p on its boundary included; -1 for none. (``cavity``: work space.)

    The closed cells with p in them hang together through facets that hold p.
    """
    cavity[0] = holder
    size, i, found = 1, 0, -1
    while i < size and found < 0:
        c = cavity[i]
        if state[c] == FIXED:
            found = c
            break
        state[c] = PENDING
        for k in range(cells.shape[1]):
            n = neighbors[c, k]
            if n >= 0 and state[n] != PENDING and moved(points, cells[c], k, p) == 0:
                known = False
                for j in range(i, size):
                    known = known or cavity[j] == n
                if not known:
                    cavity[size] = n
                    size += 1
        i += 1
    for j in range(i):
        state[cavity[j]] = OUT
    return found


@kernel
def principal_component(points, cells, neighbors, p, holder, state, cavity, sides):
    """List the cells that can be reached from the holder through facets within open balls round p.

    sides[c, k] tells for each of them on which side of its facet k p lies: positive for within.

    They hold every closed cell with p in it: those are joined through facets that hold p, and p is in
    the open ball of each, as it is a vertex of none.
    """
    cavity[0] = holder
    state[holder] = IN
    size = 1
    i = 0
    while i < size:
        c = cavity[i]
        for k in range(cells.shape[1]):
            sides[c, k] = moved(points, cells[c], k, p)
            n = neighbors[c, k]
            if n >= 0 and state[n] == OUT and conflict(points, cells[n], p) > 0:
                state[n] = IN
                cavity[size] = n
                size += 1
        i += 1
    return size


@inline
def is_rim(neighbors, state, c, k):
    """Is facet (c, k) on the boundary of the cavity, c being within?"""
    n = neighbors[c, k]
    return n < 0 or state[n] != IN


@inline
def around(cells, neighbors, state, c, k, j):
    """Turn about the ridge (c, {j, k}) through the cavity, from rim facet (c, k) to the other one.

       v_k ___ w          The rim facet is (ridge, v_j). c is left through (ridge, v_k) into the cell
       /  \\ n /          n with the new corner w, which is left through (ridge, w), and so on. The
      / c  \\ /           result is (cell, j', k'): the rim facet (cell, j'), whose corner off the
    v_j___ridge           ridge is k'.
    """
    while not is_rim(neighbors, state, c, j):
        n = neighbors[c, j]
        following = 0
        for i in range(cells.shape[1]):
            if cells[n, i] == cells[c, k]:
                following = i
        for i in range(cells.shape[1]):
            if neighbors[n, i] == c:
                k = i
        c, j = n, following
    return c, j, k


@kernel
def is_hidden(cells, neighbors, state, sides, c, k):
    """Does p fail to see the rim facet (c, k) from within? (``sides``: of `principal_component`.)

    A facet in a plane with p is hidden, unless it lies on the boundary of the mesh in a patch that p
    sees in that plane: such a patch is covered anew. Seen in the plane from p, a ridge of the patch is
    right way round where the corner off the ridge, moved to p, leaves c positive.
    """
    if sides[c, k] != 0:
        return sides[c, k] < 0
    if neighbors[c, k] >= 0:
        return True
    for j in range(cells.shape[1]):
        if j != k and sides[c, j] < 0:
            t, i, _ = around(cells, neighbors, state, c, k, j)
            if sides[t, i] != 0:
                return True
    return False


@kernel
def drop_owners(cells, neighbors, state, sides, kept, size):
    """Mark the owners of hidden facets; return the numbers of hidden facets and of owners."""
    hidden = owners = 0
    owner = np.zeros(size, dtype=np.bool_)
    for i in range(size):
        c = kept[i]
        for k in range(cells.shape[1]):
            if is_rim(neighbors, state, c, k) and is_hidden(cells, neighbors, state, sides, c, k):
                hidden += 1
                owner[i] = True
    for i in range(size):  # only now: the rim must not change meanwhile
        if owner[i]:
            state[kept[i]] = DROPPED
            owners += 1
    return hidden, owners


@kernel
def reduce_component(cells, neighbors, state, sides, kept, size, record):
    """Drop owners of hidden facets and take the component again until p sees every facet.

    A facet hidden from p stays so while its cell stays, since the cavity only shrinks: so every order of
    dropping ends at the same cells, the largest star-shaped part. The cells that hold p have no hidden
    facet; together they are star-shaped, and the loop ends there at the latest.
    """
    while True:
        hidden, owners = drop_owners(cells, neighbors, state, sides, kept, size)
        if record[DROP_ROUNDS] == 0:
            record[HIDDEN_FACETS] = hidden
        if owners == 0:
            return size
        record[DROP_ROUNDS] += 1
        record[CELLS_LOST] += owners
        for i in range(size):
            if state[kept[i]] == IN:
                state[kept[i]] = PENDING
        state[kept[0]] = IN  # the holder
        size, i = 1, 0
        while i < size:
            for k in range(cells.shape[1]):
                n = neighbors[kept[i], k]
                if n >= 0 and state[n] == PENDING:
                    state[n] = IN
                    kept[size] = n
                    size += 1
            i += 1


@kernel
def number_rim(cells, neighbors, state, sides, kept, size, place, slot):
    """Number the facets of the star: slot[i, k], -1 for flat ones on the hull, -2 within the cavity."""
    made = 0
    for i in range(size):
        c = kept[i]
        place[c] = i
        for k in range(cells.shape[1]):
            slot[i, k] = -2
            if is_rim(neighbors, state, c, k):
                if neighbors[c, k] < 0 and sides[c, k] == 0:
                    slot[i, k] = -1
                else:
                    slot[i, k] = made
                    made += 1
    return made


@kernel
def build_star(cells, neighbors, state, kept, size, p, place, slot, number, rows, links, back):
    """Write the new cells and their neighbors aside, while the old ones still stand.

    Cell (c, k) of the star is c with corner k moved to p. Its neighbor across the ridge (c, {j, k}) is
    the cell over the rim facet that turning about the ridge leads to.
    """
    width = cells.shape[1]
    for i in range(size):
        c = kept[i]
        for k in range(width):
            q = slot[i, k]
            if q < 0:
                continue
            n = neighbors[c, k]
            links[q, k] = n
            back[q] = -1
            for j in range(width):
                rows[q, j] = cells[c, j]
                if n >= 0 and neighbors[n, j] == c:
                    back[q] = j
                if j != k:
                    t, other, _ = around(cells, neighbors, state, c, k, j)
                    s = slot[place[t], other]
                    links[q, j] = number[s] if s >= 0 else -1
            rows[q, k] = p


@kernel
def replace(cells, neighbors, source, kept, size, made, slot, number, rows, links, back, free, counters):
    """Write the star over the cavity."""
    origin = np.empty(made, dtype=np.int64)
    for i in range(size):
        for k in range(cells.shape[1]):
            if slot[i, k] >= 0:
                origin[slot[i, k]] = source[kept[i]]
                n = links[slot[i, k], k]
                if n >= 0:
                    neighbors[n, back[slot[i, k]]] = number[slot[i, k]]
    for q in range(made):
        c = number[q]
        source[c] = origin[q]
        for k in range(cells.shape[1]):
            cells[c, k] = rows[q, k]
            neighbors[c, k] = links[q, k]
    for q in range(made, size):  # more cells went than came
        cells[kept[q], 0] = -1
        free[counters[1]] = kept[q]
        counters[1] += 1


@kernel
def allot(kept, size, made, free, counters):
    """Row numbers for the new cells: those of the old ones, then free ones, then new ones."""
    number = np.empty(made, dtype=np.int64)
    for q in range(made):
        if q < size:
            number[q] = kept[q]
        elif counters[1] > 0:
            counters[1] -= 1
            number[q] = free[counters[1]]
        else:
            number[q] = counters[0]
            counters[0] += 1
    return number


@inline
def paint(state, cells, size, value):
    """Set the state of the first ``size`` listed cells."""
    for i in range(size):
        state[cells[i]] = value


@kernel
def first_hidden(cells, neighbors, state, sides, cavity, size):
    """The first hidden facet of the component, for the report."""
    c, k = -1, -1
    paint(state, cavity, size, IN)
    for i in range(size):
        for j in range(cells.shape[1]):
            n = cavity[i]
            if c < 0 and is_rim(neighbors, state, n, j):
                if is_hidden(cells, neighbors, state, sides, n, j):
                    c, k = n, j
    paint(state, cavity, size, OUT)
    return c, k


@kernel
def insert_vertices(
    points, first, last, reduce, cells, neighbors, source, state, sides, place, free, counters, records
):
    """Insert vertices first..last - 1; return where it stopped, and what for (for HIDDEN, also the facet; for
    HELD, the fixed cell).

    ``counters``: rows of ``cells`` in use, free rows among them, a cell near the last vertex. A vertex
    that cannot be inserted leaves everything as it was before it.
    """
    width = cells.shape[1]
    cavity = np.empty(cells.shape[0], dtype=np.int64)
    for p in range(first, last):
        record = records[p - first]
        record[:] = 0
        record[TWIN] = -1
        holder = locate(points, cells, neighbors, counters[0], p, counters[2])
        if holder < 0:
            return p, OUTSIDE, -1, -1
        counters[2] = holder
        for k in range(width):
            if (points[cells[holder, k]] == points[p]).all():
                record[TWIN] = cells[holder, k]
        if record[TWIN] >= 0:
            continue
        wall = fixed_holder(points, cells, neighbors, p, holder, state, cavity)
        if wall >= 0:
            return p, HELD, wall, -1
        size = principal_component(points, cells, neighbors, p, holder, state, cavity, sides)
        record[COMPONENT] = size
        kept = cavity[:size].copy()
        left = reduce_component(cells, neighbors, state, sides, kept, size, record)
        status = DONE
        if record[HIDDEN_FACETS] > 0 and not reduce:
            status = HIDDEN
        slot = np.empty((left, width), dtype=np.int64)
        made = number_rim(cells, neighbors, state, sides, kept, left, place, slot)
        if counters[0] - counters[1] + made > cells.shape[0] and status == DONE:
            status = ROOM
        if status == DONE:
            number = allot(kept, left, made, free, counters)
            rows, links = np.empty((made, width), np.int64), np.empty((made, width), np.int64)
            back = np.empty(made, np.int64)
            build_star(cells, neighbors, state, kept, left, p, place, slot, number, rows, links, back)
            replace(
                cells, neighbors, source, kept, left, made, slot, number, rows, links, back, free, counters
            )
            record[CELLS_KEPT], record[CELLS_MADE] = left, made
            counters[2] = number[0]
        paint(state, cavity, size, OUT)
        if status == HIDDEN:
            c, k = first_hidden(cells, neighbors, state, sides, cavity, size)
            return p, HIDDEN, c, k
        if status == ROOM:
            return p, ROOM, -1, -1
    return last, DONE, -1, -1
