"""Triangles and tetrahedra of the leaves of a balanced tree, told plainly (sections 4b and 4c of the book).

A vertex that lies inside an edge or a face of a leaf *hangs* there. Where the levels of neighbors differ by
one at most, it lies in the middle. A square without such vertices becomes two triangles, any other square a
fan about its center. A cube is always a fan about its center, over triangles of its six faces.

Source: M. A. Yerry, M. S. Shephard, IEEE Computer Graphics and Applications 3 (1983) 39-46.
"""

from __future__ import annotations

from collections.abc import Collection
from fractions import Fraction
from itertools import pairwise, product

from unstruct.plain.tree import box, center

__all__ = ["corners", "face_triangles", "hanging", "outline", "tetrahedra", "triangles", "vertices"]

Cell = tuple[int, ...]
Point = tuple[Fraction, ...]
Simplex = tuple[Point, ...]
ROUND = [(0, 0), (1, 0), (1, 1), (0, 1)]  # counterclockwise around a square


def corners(cell: Cell) -> list[Point]:
    """The 2**d corners of a cell."""
    return list(product(*zip(*box(cell), strict=True)))


def vertices(leaves: Collection[Cell]) -> set[Point]:
    """The corners of all leaves."""
    return {corner for cell in leaves for corner in corners(cell)}


def middle(p: Point, q: Point) -> Point:
    """The point halfway between two."""
    return tuple((a + b) / 2 for a, b in zip(p, q, strict=True))


def outline(around: list[Point], known: set[Point]) -> list[Point]:
    """Four corners, and between them the middles of sides that are vertices."""
    ring = []
    for p, q in zip(around, around[1:] + around[:1], strict=True):
        ring += [p, middle(p, q)] if middle(p, q) in known else [p]
    return ring


def hanging(leaves: Collection[Cell]) -> set[Point]:
    """The vertices that lie in a leaf, of a balanced tree, without being one of its corners."""
    known = vertices(leaves)
    found: set[Point] = set()
    for cell in leaves:
        low, high = box(cell)
        sides = zip(low, center(cell), high, strict=True)
        found |= (set(product(*sides)) - set(corners(cell))) & known
    return found


def triangles(leaves: Collection[Cell]) -> set[Simplex]:
    """Triangles of the leaves of a quadtree that is balanced across faces."""
    known = vertices(leaves)
    found: set[Simplex] = set()
    for cell in leaves:
        bounds = list(zip(*box(cell), strict=True))
        ring = outline([(bounds[0][s], bounds[1][t]) for s, t in ROUND], known)
        if len(ring) == 4:  # diagonals alternate, like the colors of a chessboard
            odd = sum(cell[1:]) % 2
            ring = ring[odd:] + ring[:odd]
            found |= {(ring[0], ring[1], ring[2]), (ring[0], ring[2], ring[3])}
        else:
            pairs = zip(ring, ring[1:] + ring[:1], strict=True)
            found |= {(center(cell), p, q) for p, q in pairs}
    return found


def face_triangles(cell: Cell, axis: int, side: int, known: set[Point]) -> list[Simplex]:
    """Triangles of a face: they depend on the vertices of the face alone, not on the cell."""
    bounds = list(zip(*box(cell), strict=True))
    u, v = (axis + 1) % 3, (axis + 2) % 3
    place = {axis: bounds[axis][side]}
    rim = [{**place, u: bounds[u][s], v: bounds[v][t]} for s, t in ROUND]
    around = [(p[0], p[1], p[2]) for p in rim]
    ring = outline(list(around), known)
    inner = middle(around[0], around[2])
    if inner in known:
        return [(inner, p, q) for p, q in zip(ring, ring[1:] + ring[:1], strict=True)]
    hung = [k for k, p in enumerate(ring) if p not in around]
    start = hung[0] if hung else (cell[1 + u] + cell[1 + v]) % 2
    ring = ring[start:] + ring[:start]
    return [(ring[0], p, q) for p, q in pairwise(ring[1:])]


def tetrahedra(leaves: Collection[Cell]) -> set[Simplex]:
    """Tetrahedra of the leaves of an octree that is balanced across edges, positively oriented."""
    known = vertices(leaves)
    found: set[Simplex] = set()
    for cell in leaves:
        for axis, side in product(range(3), (0, 1)):
            for p, q, r in face_triangles(cell, axis, side, known):
                found.add((center(cell), p, q, r) if side else (center(cell), p, r, q))
    return found
