"""Kernels of Baker's insertion: point location, principal component, visibility, reduction, star.

A triangulation is ``cells`` (m, d + 1) and ``neighbors`` of the same shape; a free row of ``cells`` starts
with -1. The code is the same for two and three dimensions. A facet is (cell, k), the one opposite corner k. A
ridge is (cell, {j, k}), the face of the cell without corners j and k.
"""

from __future__ import annotations

import numpy as np

from ...base.codes import DONE, HIDDEN, OUTSIDE, ROOM
from ...base.jit import inline, kernel
from ...predicates.kernels import conflict, moved
from .records import Star

__all__ = ["FIXED", "HELD", "insert_vertices"]

HELD = 8  # `insert_vertices` stops because of a fixed cell; its other results are DONE, OUTSIDE, HIDDEN, ROOM
# The states of a cell during one insertion. A fixed cell is never in a cavity.
OUT, IN, DROPPED, PENDING, FIXED = 0, 1, 2, 3, 4
# The columns of the records; see `modernized.Record`.
TWIN, COMPONENT, HIDDEN_FACETS, DROP_ROUNDS, CELLS_LOST, CELLS_KEPT, CELLS_NEW = range(7)


@kernel
def locate(points, cells, neighbors, count, p, start):
    """A closed cell that contains p, or -1.

    A walk leads to the cell; the facet that is tested first changes with every step. The walk may run in
    circles if the triangulation is not Delaunay, and may leave the mesh if the region is not convex. In
    these cases every cell is tested.
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
    """A fixed closed cell that contains p, or -1; ``cavity`` is a work array.

    The closed cells that contain p are connected through facets that contain p.
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
    """List the cells that can be reached from the holder through facets and whose open balls contain p.

    For each of them, sides[c, k] receives the side of its facet k on which p lies, positive for the inner
    side.

    The list contains every closed cell with p in it: these cells are connected through facets that contain p,
    and p is in the open ball of each, because it is not a vertex of any.
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
def on_boundary(neighbors, state, c, k):
    """Whether facet (c, k) of a cell c in the cavity is on the boundary of the cavity."""
    n = neighbors[c, k]
    return n < 0 or state[n] != IN


@inline
def around(cells, neighbors, state, c, k, j):
    """Turn around the ridge (c, {j, k}) through the cavity, from boundary facet (c, k) to the other one.

       v_k ___ w          The boundary facet is (ridge, v_j). The turn leaves c through (ridge, v_k) into
       /  \\ n /          the cell n with the new corner w, leaves n through (ridge, w), and so on. The
      / c  \\ /           result is (cell, j', k'): the boundary facet is (cell, j'), and its corner that is
    v_j___ridge           not on the ridge is k'.
    """
    while not on_boundary(neighbors, state, c, j):
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
    """Whether the boundary facet (c, k) is hidden from p; ``sides`` are from `principal_component`.

    A facet is hidden if p does not see it from within. A facet that is coplanar with p is hidden, too, unless
    it lies on the boundary of the mesh in a coplanar patch whose boundary p sees within that plane; the patch
    is then divided at p. In the plane, p sees a ridge of the patch from within if cell c remains positive
    when its corner in the facet opposite the ridge is moved to p.
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
    """Mark the cells of hidden facets (their owners); return the numbers of hidden facets and of owners."""
    hidden = owners = 0
    owner = np.zeros(size, dtype=np.bool_)
    for i in range(size):
        c = kept[i]
        for k in range(cells.shape[1]):
            if on_boundary(neighbors, state, c, k) and is_hidden(cells, neighbors, state, sides, c, k):
                hidden += 1
                owner[i] = True
    for i in range(size):  # states change only now, because the loop above needs the boundary unchanged
        if owner[i]:
            state[kept[i]] = DROPPED
            owners += 1
    return hidden, owners


@kernel
def reduce_component(cells, neighbors, state, sides, kept, size, record):
    """Drop the owners of hidden facets and compute the component again, until p sees every facet.

    A facet that is hidden from p remains hidden as long as its cell remains, because the cavity only shrinks.
    So every order of dropping ends with the same cells, the largest star-shaped part. The cells that contain
    p have no hidden facet; their union is star-shaped, and the loop ends there at the latest.
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
def number_facets(cells, neighbors, state, sides, kept, size, place, slot):
    """Number the cells of the star, one for each boundary facet of the cavity; return how many there are.

    slot[i, k] is -1 for facets on the boundary of the mesh that are coplanar with p, and -2 for facets inside
    the cavity.
    """
    made = 0
    for i in range(size):
        c = kept[i]
        place[c] = i
        for k in range(cells.shape[1]):
            slot[i, k] = -2
            if on_boundary(neighbors, state, c, k):
                if neighbors[c, k] < 0 and sides[c, k] == 0:
                    slot[i, k] = -1
                else:
                    slot[i, k] = made
                    made += 1
    return made


@kernel
def build_star(grown, star, kept, size, p):
    """Write the new cells and their neighbors to work arrays, without changing the old cells.

    Cell (c, k) of the star is c with corner k moved to p. Its neighbor across the ridge (c, {j, k}) is the
    cell of the star on the boundary facet to which the turn around the ridge leads.
    """
    cells, neighbors, state, place = grown.cells, grown.neighbors, grown.state, grown.place
    slot, number, rows, links, back = star
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
def replace(grown, star, kept, size, made):
    """Replace the cavity by the star."""
    cells, neighbors, source = grown.cells, grown.neighbors, grown.source
    slot, number, rows, links, back = star
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
    for q in range(made, size):  # if the star has fewer cells than the cavity, rows become free
        cells[kept[q], 0] = -1
        grown.free[grown.counters[1]] = kept[q]
        grown.counters[1] += 1


@kernel
def allot(kept, size, made, free, counters):
    """Row numbers for the new cells: those of the old cells first, then free rows, then new rows."""
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
    """The first hidden facet of the component, for the error message."""
    c, k = -1, -1
    paint(state, cavity, size, IN)
    for i in range(size):
        for j in range(cells.shape[1]):
            n = cavity[i]
            if c < 0 and on_boundary(neighbors, state, n, j):
                if is_hidden(cells, neighbors, state, sides, n, j):
                    c, k = n, j
    paint(state, cavity, size, OUT)
    return c, k


@kernel
def insert_vertices(points, first, last, reduce, grown, records):
    """Insert vertices first..last - 1; return the vertex where it stopped, the reason, a cell and a corner.

    The cell and the corner are the hidden facet for HIDDEN; the cell is the fixed one for HELD. ``counters``
    are the number of used rows of ``cells``, the number of free rows among them, and a cell near the previous
    vertex. A vertex that cannot be inserted leaves the triangulation unchanged.
    """
    cells, neighbors, _, state, sides, place, free, counters = grown
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
        made = number_facets(cells, neighbors, state, sides, kept, left, place, slot)
        if counters[0] - counters[1] + made > cells.shape[0] and status == DONE:
            status = ROOM
        if status == DONE:
            number = allot(kept, left, made, free, counters)
            rows, links = np.empty((made, width), np.int64), np.empty((made, width), np.int64)
            star = Star(slot, number, rows, links, np.empty(made, np.int64))
            build_star(grown, star, kept, left, p)
            replace(grown, star, kept, left, made)
            record[CELLS_KEPT], record[CELLS_NEW] = left, made
            counters[2] = number[0]
        paint(state, cavity, size, OUT)
        if status == HIDDEN:
            c, k = first_hidden(cells, neighbors, state, sides, cavity, size)
            return p, HIDDEN, c, k
        if status == ROOM:
            return p, ROOM, -1, -1
    return last, DONE, -1, -1
