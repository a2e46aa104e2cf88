"""Delaunay triangulation of given points, face by face (section 2.2a of the book).

A face is a tuple of d vertex numbers; its *free side* is where ``orient(face + apex) > 0``. The front is
the list of faces whose free side still waits for a cell.

Ties: where more than d + 1 points lie on an empty sphere, each face could choose its own apex, and the
choices would not fit. So every vertex v is thought lifted to |p_v|^2 + e_v with infinitely small
e_0 << e_1 << ... in the order of a fixed rank. Then no d + 2 lifted points lie in a hyperplane, there is
one triangulation below the lifted points, and every face finds the same one. (H. Edelsbrunner and
E. P. Muecke, ACM Transactions on Graphics 9 (1990) 66-104; this order gives the *placing* triangulation
of each cospherical set.)

Source: M. Tanemura, T. Ogawa, N. Ogita, Journal of Computational Physics 51 (1983) 191-207.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
from typing import Any

from unstruct.base.errors import DegenerateInputError, InputError
from unstruct.plain.predicates import in_sphere, orient

__all__ = ["Step", "apex", "first_simplex", "gift_wrap", "wrap"]

Cell = tuple[int, ...]
Face = tuple[int, ...]
Points = Sequence[Sequence[Any]]


@dataclass(frozen=True)
class Step:
    """One face treated: it found its apex, or it lies on the hull (``cell`` is None)."""

    face: Face
    cell: Cell | None
    front: tuple[Face, ...]  # the faces that wait afterwards


def gift_wrap(points: Points) -> list[Cell]:
    """The cells of a Delaunay triangulation in the order of making, each positively oriented.

    Raises
    ------
    InputError
        In one dimension, and where two points are equal.
    DegenerateInputError
        Where the points lie in a hyperplane.

    Notes
    -----
    O(n) sign tests a face: made to be read.
    """
    return [step.cell for step in wrap(points) if step.cell is not None]


def wrap(points: Points) -> Iterator[Step]:
    """Take the face that has waited longest, find its apex, until none waits."""
    start = first_simplex(points)
    rank = {v: (v not in start, v) for v in range(len(points))}
    face = start[:-1]
    front = {canonical(face): None, canonical(turned(face)): None}  # in this order
    while front:
        face = next(iter(front))
        q = apex(points, rank, face)
        if q is None:
            del front[face]
            yield Step(face, None, tuple(front))
            continue
        cell = (*face, q)
        for outer in facets(cell):  # one that waits is met, or a new one waits
            if turned_canonical(outer) in front:
                del front[turned_canonical(outer)]
            else:
                front[canonical(outer)] = None
        yield Step(face, cell, tuple(front))


def apex(points: Points, rank: dict[int, Any], face: Face) -> int | None:
    """The vertex on the free side whose sphere holds no other vertex there."""
    best = None
    for q in range(len(points)):
        if orient([points[v] for v in (*face, q)]) > 0:
            if best is None or inside(points, rank, (*face, best), q) > 0:
                best = q
    return best


def inside(points: Points, rank: dict[int, Any], cell: Cell, q: int) -> int:
    """The in-sphere sign; on the sphere, that of infinitesimally lifted points."""
    sign = in_sphere([points[v] for v in cell], points[q])
    for v in sorted((*cell, q), key=rank.__getitem__, reverse=True):  # by e
        if sign:
            break
        if v == q:
            return -1
        sign = orient([points[q if u == v else u] for u in cell])
    return sign


def facets(cell: Cell) -> list[Face]:
    """The facets of a positively oriented cell, with the free side outside."""
    result = []
    for k in range(len(cell)):
        face = cell[:k] + cell[k + 1 :]
        result.append(turned(face) if (len(cell) - 1 - k) % 2 == 0 else face)
    return result


def turned(face: Face) -> Face:
    """The same face with its free side on the other side."""
    return (face[1], face[0], *face[2:])


def canonical(face: Face) -> Face:
    """The one name of an oriented face: sorted, but for the last two where the orientation asks for it."""
    odd = sum(a > b for a, b in combinations(face, 2)) % 2
    *head, a, b = sorted(face)
    return (*head, b, a) if odd else (*head, a, b)


def turned_canonical(face: Face) -> Face:
    """The canonical name of the other side."""
    return canonical(turned(face))


def first_simplex(points: Points) -> Cell:
    """A closest pair, then again and again the point of the smallest circumsphere with those taken.

    Every sphere on the way is empty: see the book.
    """
    exact = [tuple(Fraction(x.item() if hasattr(x, "item") else x) for x in p) for p in points]
    d, everyone = len(exact[0]), range(len(exact))
    if d < 2:
        raise InputError("on a line there are no faces to turn about: sort the numbers")
    if len(set(exact)) < len(exact):
        raise InputError("two points are equal: remove the copies first")
    chosen = list(min(combinations(everyone, 2), key=lambda e: squared_radius([exact[v] for v in e])))
    while len(chosen) <= d:
        radii = {v: squared_radius([exact[u] for u in (*chosen, v)]) for v in everyone if v not in chosen}
        radii = {v: r for v, r in radii.items() if r is not None}
        if not radii:
            k = len(chosen) - 1
            raise DegenerateInputError(f"all points lie in a flat of dimension {k}: add points", k)
        chosen.append(min(radii, key=radii.__getitem__))
    cell = tuple(chosen)
    return cell if orient([exact[v] for v in cell]) > 0 else turned(cell)


def squared_radius(simplex: Sequence[tuple[Fraction, ...]]) -> Any:
    """R^2 of the smallest sphere through k + 1 points, None where they lie in a flat of dimension < k.

    The center is p_0 + sum m_i e_i with e_i = p_i - p_0 and G m = b, G_ij = e_i e_j, b_i = G_ii / 2.
    """
    edges = [[x - y for x, y in zip(p, simplex[0])] for p in simplex[1:]]
    rows: list[list[Any]] = [[sum(x * y for x, y in zip(e, f)) for f in edges] for e in edges]
    half = [row[i] / 2 for i, row in enumerate(rows)]
    rows = [[*row, b] for row, b in zip(rows, half)]
    for k in range(len(rows)):  # G is positive semidefinite: a zero pivot means dependence
        if rows[k][k] == 0:
            return None
        rows[k] = [x / rows[k][k] for x in rows[k]]
        for i in range(len(rows)):
            if i != k:
                rows[i] = [x - rows[i][k] * y for x, y in zip(rows[i], rows[k])]
    return sum(row[-1] * b for row, b in zip(rows, half))
