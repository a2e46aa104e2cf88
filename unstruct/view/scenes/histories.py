"""Histories as frames: insertion (locate, cavity, star), gift wrapping, diagonal swaps.

The states come from the kernels of the library, one insertion or swap at a time. A frame only shows the
differences between two states, so no algorithm is implemented twice.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations
from typing import Any

import numpy as np

from ...base.arrays import as_points
from ...base.errors import InputError
from ...connect.baker.modernized import Baker
from ...connect.insertion.delaunay import Triangulation
from ...connect.swapping import replay
from ...geometry.simplex import circumcenter, circumradius, quality
from ...mesh.mesh import Mesh
from ...predicates.batch import in_sphere
from ..draw import frames as fr

__all__ = ["baker_frames", "flip_frames", "gift_wrap_frames", "insertion_frames"]

Cell = tuple[int, ...]


def insertion_frames(points: Any, *, start: int | None = None, names: bool = True) -> list[fr.Frame]:
    """The history of a planar Bowyer–Watson construction, with three frames per point.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        The points, inserted in this order.
    start : int, optional
        How many points form the first triangulation; by default the fewest that are not collinear.
    names : bool
        Whether to write the number of each point.

    Returns
    -------
    list of dict
        One frame for the start; then, for each point, the triangle that contains it, the cavity with its
        circles, and the star.
    """
    rows = _planar(points)
    growing = Triangulation(rows[: start or 3])
    done = start or 3
    while not growing.spans and done < len(rows):
        growing.insert(rows[done])
        done += 1
    mesh = growing.mesh()
    view = fr.bounds([fr.frame("", fr.dots("vertex", rows))], 0.12)
    made = [
        fr.frame(
            f"Start with {done} points", *_cells(rows, _set(mesh)), *_names(rows[:done], names), view=view
        )
    ]
    for k in range(done, len(rows)):
        held = int(np.ravel(growing.locate(rows[k]))[0])
        growing.insert(rows[k])
        after = growing.mesh()
        made += _insertion(rows, k, mesh, after, held, names)
        mesh = after
    return [{**f, "view": view} for f in made]


def baker_frames(mesh: Mesh, points: Any, *, names: bool = True) -> list[fr.Frame]:
    """The history of Baker's insertion into any planar triangulation, with up to five frames per point.

    If the triangulation is not Delaunay, the point may also lie in circles of triangles that are not
    connected with the triangle that contains it. The connected ones may have edges that the point does not
    see. Separate frames show these cases.
    """
    new = _planar(points)
    rows = np.vstack([mesh.points, new])
    growing, before = Baker(mesh), mesh
    view = fr.bounds([fr.frame("", fr.dots("vertex", rows))], 0.12)
    start = len(mesh.points)
    made = [fr.frame("Start from any triangulation", *_cells(rows, _set(mesh)), *_names(rows[:start], names))]
    for k in range(start, len(rows)):
        held = int(before.find_simplex(rows[k]))
        growing.insert(rows[k : k + 1])
        after = growing.mesh()
        made += _insertion(rows, k, before, after, held, names)
        before = after
    return [{**f, "view": view} for f in made]


def _insertion(rows: np.ndarray, k: int, before: Mesh, after: Mesh, held: int, names: bool) -> list[fr.Frame]:
    """The frames of one insertion: the old triangles, those that are deleted, and the new ones."""
    old, new = _set(before), _set(after)
    point, marks = fr.dots("inserted", rows[k]), _names(rows[: k + 1], names)
    base = [*_cells(rows, old), point, *marks]
    if old == new:
        (twin,) = [kept for copy, kept in after.duplicates.tolist() if copy == k]
        return [fr.frame(f"Point {k} equals vertex {twin}: nothing to do", *base)]
    if held < 0:
        made = [fr.frame(f"Point {k} lies outside the hull", *base)]
    else:
        here = fr.polygons("highlight", [rows[before.simplices[held]]])
        made = [fr.frame(f"Locate point {k}", *_cells(rows, old), here, point, *marks)]
    hit = {
        c
        for c, sign in zip(map(_key, before.simplices), np.ravel(in_sphere(before.corners, rows[k])))
        if sign > 0
    }
    gone, come = old - new, new - old
    whole = _connected(hit, _key(before.simplices[held])) if held >= 0 else hit
    if hit != whole:
        parts = [_polygons("cavity", rows, whole), _polygons("bad", rows, hit - whole), _circles(rows, hit)]
        lie = "lies" if len(hit - whole) == 1 else "lie"
        text = f"{len(hit)} circles contain it, but {len(hit - whole)} of their triangles {lie} apart"
        made.append(fr.frame(text, *_cells(rows, old), *parts, point, *marks))
    if whole != gone:
        parts = [_polygons("cavity", rows, gone), _polygons("bad", rows, whole - gone)]
        text = f"{len(whole - gone)} of {len(whole)} triangles remain: an edge of them is hidden"
        made.append(fr.frame(text, *_cells(rows, old), *parts, point, *marks))
    if gone != hit:
        text = f"What goes: {_count(len(gone), 'triangle')} of the principal component"
    else:
        text = f"{len(gone)} circle{'s contain' if len(gone) != 1 else ' contains'} it: the cavity"
    text = text if gone else "It sees these edges"
    made.append(_cavity_frame(rows, old, gone, come, text, [point, *marks]))
    count = f"{_count(len(gone), 'triangle')} deleted, {len(come)} created"
    rest = [*_cells(rows, old & new), _polygons("accepted", rows, come)]
    made.append(fr.frame(f"Join point {k} to the edges around it", *rest, point, *marks, number=count))
    return made


def _cavity_frame(
    rows: np.ndarray, old: set[Cell], gone: set[Cell], come: set[Cell], text: str, front: list
) -> fr.Frame:
    """The triangles to be deleted, with their circles, and the edges that will be joined to the point."""
    k = max(map(max, come))  # the point that arrives has the last number
    edges = [sorted(set(c) - {k}) for c in come]
    boundary = fr.segments("front", rows[edges])
    parts = [_polygons("cavity", rows, gone), _circles(rows, gone)]
    return fr.frame(
        text, *_cells(rows, old), *parts, boundary, *front, number=f"{_count(len(edges), 'edge')} around it"
    )


def gift_wrap_frames(mesh: Mesh, *, names: bool = True) -> list[fr.Frame]:
    """The history of a construction face by face: the cells of ``mesh`` in the order of their creation.

    Parameters
    ----------
    mesh : Mesh
        A planar mesh from `unstruct.gift_wrap`.
    names : bool
        Whether to write the number of each point.

    Returns
    -------
    list of dict
        The points; then one frame per triangle, with its empty circle and the remaining front.
    """
    rows = _planar(mesh.points)
    hull = {frozenset(e) for e in mesh.boundary.tolist()}
    marks = [fr.dots("vertex", rows), *_names(rows, names)]
    made = [fr.frame("The points, not yet joined", *marks)]
    front: set[frozenset[int]] = set()
    for t, cell in enumerate(mesh.simplices.tolist()):
        sides = {frozenset(e) for e in combinations(cell, 2)}
        closed = sides & front
        front = (front ^ sides) - hull  # an edge met for the second time is closed
        new = sorted(set(cell) - set(next(iter(closed)))) if len(closed) == 1 else []
        if len(closed) > 1:
            text = f"Triangle {'–'.join(map(str, cell))} closes {len(closed)} edges"
        else:
            text = (
                f"Edge {'–'.join(map(str, sorted(set(cell) - set(new))))} takes point {new[0]}"
                if new
                else f"Begin with triangle {'–'.join(map(str, cell))}"
            )
        items = [
            fr.polygons("accepted", rows[mesh.simplices[:t]]),
            fr.polygons("highlight", rows[[cell]]),
            _circles(rows, {tuple(cell)}),
            fr.segments("front", rows[[sorted(e) for e in sorted(front, key=sorted)]] if front else []),
        ]
        made.append(fr.frame(text, *items, *marks, number=f"front: {_count(len(front), 'edge')}"))
    view = fr.bounds(made, 0.12)
    return [{**f, "view": view} for f in made]


def flip_frames(mesh: Mesh, swaps: Sequence[int] | np.ndarray, *, names: bool = False) -> list[fr.Frame]:
    """The history of `unstruct.swap_diagonals`: the start, one frame per swap, the end.

    Parameters
    ----------
    mesh : Mesh
        The mesh that was given to ``swap_diagonals(mesh, history=True)``.
    swaps : array of int
        The swaps that it returned. A swap is 3 t + i, where t is a triangle and i its corner opposite the
        edge.
    names : bool
        Whether to write the number of each point.
    """
    rows = _planar(mesh.points)
    marks = [fr.dots("vertex", rows), *_names(rows, names)]
    made = [fr.frame("Start", *_cells(rows, _set(mesh)), *marks, number=_least(mesh))]
    before = mesh
    for done, swap in enumerate(np.asarray(swaps).tolist(), start=1):
        t, i = divmod(swap, 3)
        after = replay(before, [swap])
        edge = before.simplices[t][[(i + 1) % 3, (i + 2) % 3]]
        other = set(before.simplices[before.neighbors[t, i]].tolist()) - set(edge.tolist())
        ends = [int(before.simplices[t, i]), *other]
        around = [ends[0], int(edge[0]), ends[1], int(edge[1])]
        items = [
            *_cells(rows, _set(after)),
            fr.polygons("highlight", [rows[around]], opacity=0.6),
            fr.segments("bad", [rows[edge]]),
            fr.segments("inserted", [rows[ends]]),
        ]
        made.append(fr.frame(f"Swap {done}: the other diagonal", *items, *marks, number=_least(after)))
        before = after
    text = "No more edge to swap: Delaunay" if len(made) > 1 else "Nothing to swap: Delaunay"
    made.append(fr.frame(text, *_cells(rows, _set(before)), *marks, number=_least(before)))
    view = fr.bounds(made, 0.12)
    return [{**f, "view": view} for f in made]


def _planar(points: Any) -> np.ndarray:
    rows = as_points(points)
    if rows.shape[1] != 2:
        raise InputError(f"histories are drawn in the plane, not in {rows.shape[1]} dimensions")
    return rows


def _key(cell: Any) -> Cell:
    return tuple(sorted(int(v) for v in cell))


def _set(mesh: Mesh) -> set[Cell]:
    return set(map(_key, mesh.simplices))


def _connected(cells: set[Cell], seed: Cell) -> set[Cell]:
    """The cells that are connected to ``seed`` through shared edges."""
    found, stack = {seed}, [seed]
    while stack:
        cell = set(stack.pop())
        near = {c for c in cells - found if len(cell & set(c)) == len(cell) - 1}
        found |= near
        stack += near
    return found


def _cells(rows: np.ndarray, cells: Iterable[Cell]) -> list[fr.Item]:
    return fr.mesh_items(rows, sorted(cells))


def _polygons(role: str, rows: np.ndarray, cells: Iterable[Cell]) -> fr.Item:
    return fr.polygons(role, [rows[list(c)] for c in sorted(cells)])


def _circles(rows: np.ndarray, cells: Iterable[Cell]) -> fr.Item:
    corners = rows[np.array(sorted(cells), dtype=int).reshape(-1, 3)]
    return fr.circles("circumcircle", circumcenter(corners), circumradius(corners))


def _names(rows: np.ndarray, names: bool) -> list[fr.Item]:
    return [fr.labels("vertex", rows, range(len(rows)))] if names else []


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def _least(mesh: Mesh) -> str:
    return f"minimum angle = {quality('min_angle', mesh.corners).min():.1f}°"
