"""The stencils: what of a tetrahedron lies inside, as one, two or three tetrahedra.

Vertices are inside (+), on the surface (0) or outside (-); an edge from + to - has a cut point. What lies
inside is a tetrahedron, a pyramid or a prism. Its quadrilaterals in faces of the tetrahedron are divided by a
rule that looks at the face alone, so that both sides agree: the corners are two vertices p, q inside and the
cut points of their edges to a vertex d outside, and the diagonal begins at that of p and q whose edge to d is
shorter. So it ends at the cut point of the long edge. If both edges are equally long, the *parity rule*
decides: along how many axes is the coordinate of p larger than that of d? The diagonal begins at p if this
number is odd and p is a corner of cubes, or if it is even and p is a center. The third diagonal of a prism
has an end in common with another one. These are the stencils of Labelle and Shewchuk. See the book, chapter
4c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import apart, inline, kernel, lean

__all__ = ["Cuts", "stenciled"]

PIECES_OF_A_CELL = 3  # of a tetrahedron


class Cuts(NamedTuple):
    """The cut points of edges.

    Attributes
    ----------
    keys : (e,) int64
        ``i * n + j`` for the edge from vertex i to vertex j > i, with n vertices; increasing.
    first : int
        The number of the first cut point; the others follow in the order of the keys.
    """

    keys: NDArray[np.int64]
    first: int


@inline
def _cut(keys, first, n, i, j):
    """The number of the cut point between vertices i and j; -1 if there is none."""
    key = np.int64(min(i, j)) * n + max(i, j)
    low, high = 0, len(keys)
    while low < high:
        middle = (low + high) >> 1
        if keys[middle] < key:
            low = middle + 1
        else:
            high = middle
    if low < len(keys) and keys[low] == key:
        return np.int64(first + low)
    return np.int64(-1)


@lean
def _late(place, p, d):
    """0 if the parity rule lets diagonals begin at p in faces with d outside, otherwise 1."""
    larger = bits = np.int64(0)
    for a in range(3):
        step = np.int64(place[p, a]) - place[d, a]
        larger += 1 if step > 0 else 0
        bits |= step
    # the side of cubes is twice the lowest bit; p is a corner of cubes if d is a center
    if place[d, 0] & (bits & -bits):
        larger += 1
    return larger & 1


@lean
def _first(place, p, q, d):
    """Whether the diagonal in the face p, q, d begins at p (and not at q)."""
    one = two = np.int64(0)
    for a in range(3):
        u, v = np.int64(place[p, a]) - place[d, a], np.int64(place[q, a]) - place[d, a]
        one += u * u
        two += v * v
    if one != two:
        return one < two
    late, other = _late(place, p, d), _late(place, q, d)
    return late < other if late != other else p < q


@lean
def _write(out, count, odd, a, b, c, d):
    """Write a tetrahedron, of the other orientation if `odd`; returns the new count."""
    out[count, 0], out[count, 1] = a, b
    out[count, 2], out[count, 3] = (d, c) if odd else (c, d)
    return count + 1


@lean
def _sort(t, sign):
    """Vertices inside first, those outside last; whether the permutation is odd."""
    odd = False
    for i in range(1, 4):
        j = i
        while j > 0 and sign[t[j]] > sign[t[j - 1]]:
            t[j], t[j - 1] = t[j - 1], t[j]
            odd = not odd
            j -= 1
    return odd


@lean
def _three_inside(t, odd, place, cuts, n, out, count):
    """+++-: a prism. The vertex whose diagonals both begin there is first, the one with none last."""
    d = t[3]
    for i in range(1, 3):
        j = i
        while j > 0 and _first(place, t[j], t[j - 1], d):
            t[j], t[j - 1] = t[j - 1], t[j]
            odd = not odd
            j -= 1
    p, q, r = t[0], t[1], t[2]
    pd = _cut(cuts.keys, cuts.first, n, p, d)
    qd = _cut(cuts.keys, cuts.first, n, q, d)
    rd = _cut(cuts.keys, cuts.first, n, r, d)
    count = _write(out, count, odd, p, q, r, rd)
    count = _write(out, count, odd, p, q, rd, qd)
    return _write(out, count, odd, p, qd, rd, pd)


@lean
def _two_and_two(t, odd, place, cuts, n, out, count):
    """++--: a prism whose edges are that between a and b and two between cut points."""
    a, b, c, d = t[0], t[1], t[2], t[3]
    if not _first(place, a, b, c):
        a, b, odd = b, a, not odd
    ac, ad = _cut(cuts.keys, cuts.first, n, a, c), _cut(cuts.keys, cuts.first, n, a, d)
    bc, bd = _cut(cuts.keys, cuts.first, n, b, c), _cut(cuts.keys, cuts.first, n, b, d)
    if _first(place, b, a, d):  # diagonals a - bc and b - ad: the third one joins their ends
        count = _write(out, count, odd, a, b, bc, ad)
        count = _write(out, count, odd, a, ac, ad, bc)
        return _write(out, count, odd, b, bc, ad, bd)
    count = _write(out, count, odd, a, b, bc, bd)  # diagonals a - bc and a - bd: the third one is free
    count = _write(out, count, odd, a, bc, ac, bd)
    return _write(out, count, odd, a, bd, ac, ad)


@apart
def pieces_of(t, sign, place, cuts, n, out, count):
    """Write the pieces of the tetrahedron t, which is sorted for that; returns the new count."""
    plus = minus = 0
    for k in range(4):
        plus += sign[t[k]] > 0
        minus += sign[t[k]] < 0
    if plus == 0:
        return count
    if minus == 0:
        return _write(out, count, False, t[0], t[1], t[2], t[3])
    odd = _sort(t, sign)
    if plus == 3:
        return _three_inside(t, odd, place, cuts, n, out, count)
    if plus == 2 and minus == 2:
        return _two_and_two(t, odd, place, cuts, n, out, count)
    if plus == 2:
        a, b, z, d = t[0], t[1], t[2], t[3]
        if not _first(place, a, b, d):
            a, b, odd = b, a, not odd
        ad, bd = _cut(cuts.keys, cuts.first, n, a, d), _cut(cuts.keys, cuts.first, n, b, d)
        count = _write(out, count, odd, a, b, z, bd)
        return _write(out, count, odd, a, ad, bd, z)
    for k in range(4 - minus, 4):
        t[k] = _cut(cuts.keys, cuts.first, n, t[0], t[k])
    return _write(out, count, odd, t[0], t[1], t[2], t[3])


@kernel
def _stencils(cells, sign, place, cuts, out, owner):
    """The tetrahedra inside all `cells`, whose vertices have a `sign`; returns their number."""
    n = np.int64(len(sign))
    t = np.empty(4, dtype=np.int64)
    count = 0
    for row in range(len(cells)):
        for k in range(4):
            t[k] = cells[row, k]
        begin = count
        count = pieces_of(t, sign, place, cuts, n, out, count)
        for k in range(begin, count):
            owner[k] = row
    return count


def stenciled(
    cells: NDArray[np.int32], sign: NDArray[np.int8], place: NDArray[np.int64], cuts: Cuts
) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """The tetrahedra inside.

    Parameters
    ----------
    cells : (m, 4) int32
        Positively oriented.
    sign : (n,) int8
        Of vertices: 1 inside, 0 on the surface, -1 outside.
    place : (n, 3) int64
        Their places in the lattice, before any was moved.
    cuts : Cuts
        With an entry for every edge of a cell between vertices inside and outside.

    Returns
    -------
    cells : (k, 4) int32
        Positively oriented, if the lattice's vertices were not moved too far.
    owner : (k,) int64
        The row of the background's tetrahedron.
    """
    signs = sign[cells]
    mixed = (signs > 0).any(axis=1) & (signs < 0).any(axis=1)
    room = len(cells) + (PIECES_OF_A_CELL - 1) * int(np.count_nonzero(mixed))
    out, owner = np.empty((room, 4), dtype=np.int32), np.empty(room, dtype=np.int64)
    count = int(_stencils(cells, sign, place, cuts, out, owner))
    return out[:count], owner[:count]
