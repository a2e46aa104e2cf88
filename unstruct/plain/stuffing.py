"""Isosurface stuffing, told plainly: a lattice of one size, dictionaries, any numbers.

Vertices are triples of integers, the halves of coordinates: all even (corners of cubes) or all odd (centers).
Values are positive inside. See the book, chapter 4c.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import product
from typing import Any

__all__ = ["ALPHA_LONG", "ALPHA_SHORT", "cut_places", "lattice", "pieces", "stuff", "warp"]

Vertex = tuple[int, ...]
Signs = dict[Vertex, int]
Shares = dict[frozenset[Vertex], Any]
Rank = Callable[[Vertex], Any]
ALPHA_LONG, ALPHA_SHORT = 0.28511, 0.39882


def lattice(first: Vertex, last: Vertex) -> Iterator[tuple[Vertex, ...]]:
    """The tetrahedra between centers of neighboring cubes, for cubes from `first` to before `last`."""
    for low in product(*(range(i, j) for i, j in zip(first, last, strict=True))):
        center = tuple(2 * i + 1 for i in low)
        for a in range(3):
            if low[a] + 1 == last[a]:
                continue
            other = moved(center, a, 2)
            b, c = (a + 1) % 3, (a + 2) % 3
            middle = moved(center, a, 1)
            around = [moved(moved(middle, b, u), c, v) for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            for k in range(4):
                yield center, other, around[k - 1], around[k]


def moved(v: Vertex, axis: int, step: int) -> Vertex:
    """The vertex with one coordinate changed."""
    return (*v[:axis], v[axis] + step, *v[axis + 1 :])


def is_long(v: Vertex, w: Vertex) -> bool:
    """Whether an edge is parallel to an axis; the others are sqrt(3)/2 as long."""
    return sum(i != j for i, j in zip(v, w, strict=True)) == 1


def cut_places(cells: list[tuple[Vertex, ...]], value: dict[Vertex, Any]) -> Shares:
    """The zeros of linear interpolation: for each crossed edge the share of it, from its vertex inside."""
    share = {}
    for cell in cells:
        for v, w in product(cell, repeat=2):
            if value[v] > 0 > value[w]:
                share[frozenset((v, w))] = value[v] / (value[v] - value[w])
    return share


def warp(share: Shares, sign: Signs, rank: Rank) -> dict[Vertex, frozenset[Vertex]]:
    """The vertices that move, and edges with their targets; changes both tables."""
    target = {}
    for v in sorted({v for edge in share for v in edge}, key=rank):
        near = []
        for edge in [edge for edge in share if v in edge]:
            (w,) = edge - {v}
            part = share[edge] if sign[v] > 0 else 1 - share[edge]
            alpha, squared = (ALPHA_LONG, 4) if is_long(v, w) else (ALPHA_SHORT, 3)
            if part < alpha:
                near.append((part * squared**0.5, rank(w), edge))
        if near:
            target[v] = min(near, key=lambda row: row[:2])[2]
            sign[v] = 0
            for edge in [edge for edge in share if v in edge]:
                del share[edge]
    return target


def begins(p: Vertex, q: Vertex, d: Vertex) -> bool:
    """Whether the diagonal in the face p, q, d begins at p."""
    if is_long(p, d) != is_long(q, d):
        return is_long(q, d)
    larger = sum(i > j for i, j in zip(p, d, strict=True))
    return (larger + p[0]) % 2 == 1


def pieces(cell: tuple[Vertex, ...], sign: Signs) -> list[tuple[Any, ...]]:
    """What is inside: corners are vertices, or edges for their cut points."""
    plus, zero, minus = ([v for v in cell if sign[v] == s] for s in (1, 0, -1))
    if not plus:
        return []
    if not minus:
        return [cell]
    if len(plus) == 1:
        return [(plus[0], *zero, *(frozenset((plus[0], d)) for d in minus))]
    if len(plus) == 2 and len(minus) == 2:
        return pair_and_pair(plus, minus)
    d = minus[0]
    plus = sorted(plus, key=lambda p: sum(begins(q, p, d) for q in plus if q != p))
    cut = {p: frozenset((p, d)) for p in plus}
    if len(plus) == 2:
        p, q = plus
        return [(p, q, zero[0], cut[q]), (p, cut[p], cut[q], zero[0])]
    p, q, r = plus
    return [(p, q, r, cut[r]), (p, q, cut[r], cut[q]), (p, cut[q], cut[r], cut[p])]


def pair_and_pair(plus: list[Vertex], minus: list[Vertex]) -> list[tuple[Any, ...]]:
    """Two vertices inside and two outside: a prism."""
    a, b = plus
    c, d = minus
    if not begins(a, b, c):
        a, b = b, a
    if begins(a, b, d):
        raise AssertionError("both diagonals of a prism begin at the same vertex")
    ac, ad, bc, bd = (frozenset(edge) for edge in ((a, c), (a, d), (b, c), (b, d)))
    return [(a, b, bc, ad), (a, ac, ad, bc), (b, bc, ad, bd)]


def stuff(
    value: dict[Vertex, Any], first: Vertex, last: Vertex, rank: Callable[[Vertex], Any]
) -> tuple[list[tuple[Any, ...]], dict[Any, tuple[Any, ...]]]:
    """The tetrahedra inside, and the place of each of their corners, in halves of cubes."""
    cells = [cell for cell in lattice(first, last) if any(value[v] > 0 for v in cell)]
    sign = {v: (value[v] > 0) - (value[v] < 0) for cell in cells for v in cell}
    share = cut_places(cells, value)
    place: dict[Any, tuple[Any, ...]] = {v: v for v in sign}
    for edge, s in share.items():
        v, w = sorted(edge, key=lambda v: -sign[v])
        place[edge] = tuple(i + s * (j - i) for i, j in zip(v, w, strict=True))
    for v, edge in warp(share, sign, rank).items():
        place[v] = place[edge]
    found = [piece for cell in cells for piece in pieces(cell, sign)]
    return found, {v: place[v] for piece in found for v in piece}
