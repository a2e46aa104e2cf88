"""How one point enters a planar Delaunay triangulation: circle after circle, ghosts included (section 2.4a).

A ghost is a triangle on an edge of the hull whose third corner is at infinity. Here it is drawn as a strip
beyond its edge. `search_history` asks one cell a frame; `captured_state` shows the same insertion in the
Voronoi diagram, where the cell of the new point captures the centers of the triangles that go.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from typing import Any

import numpy as np

from ...connect.insertion.delaunay import delaunay
from ...connect.voronoi.diagram import Voronoi
from ...geometry.simplex import circumcenter, circumradius
from ...mesh.mesh import Mesh
from ...predicates.batch import in_sphere, orient
from ..draw import frames as fr
from ..draw.plots import dual_segments
from .choices import preset_named, within

__all__ = ["CAPTURES", "INSERTION_CASES", "captured_state", "search_history"]

Cell = tuple[int, int, int]
AT_INFINITY = -1

EIGHT = [(0, 0), (6, -1), (9, 3), (6, 7), (1, 6), (3, 2), (6, 3), (4, 5)]
INSERTION_CASES: dict[str, dict[str, Any]] = {
    "inside of the hull": {"points": EIGHT, "P": (3, 3)},
    "outside of the hull": {"points": EIGHT, "P": (9, 5)},
    "on an edge of the hull": {"points": EIGHT, "P": (7.5, 5)},
    "ties: a lattice": {
        "points": [(x, y) for y in (0, 2, 4) for x in (0, 2, 4, 6) if (x, y) != (2, 2)],
        "P": (2, 2),
    },
    "nasty: not Delaunay at first": {
        "points": [(6, 3), (0, 0), (5, 0), (1, 2), (3, 1)],
        "cells": [(0, 4, 2), (0, 3, 1), (1, 2, 4), (1, 4, 0)],
        "P": (5, 2),
    },
}


def search_history(preset: str = "inside of the hull") -> list[fr.Frame]:
    """The insertion of P, one cell a frame: locate, ask the neighbors of each cell that goes, join.

    Parameters
    ----------
    preset : str
        A key of `INSERTION_CASES`. The nasty one starts from a triangulation that is not Delaunay, where a
        search from neighbor to neighbor misses a circle that contains P.

    Returns
    -------
    list of dict
        Between 7 and 14 frames. Ghosts are asked only if P is not strictly inside of the hull.
    """
    given = preset_named(INSERTION_CASES, preset)
    points = np.array(given["points"], dtype=float)
    p = np.array(given["P"], dtype=float)
    mesh = Mesh(points, given["cells"]).oriented() if "cells" in given else delaunay(points)
    real: list[Cell] = [(int(a), int(b), int(c)) for a, b, c in mesh.simplices]
    sides = {edge: cell for cell in real for edge in edges_of(cell)}
    ghosts: list[Cell] = [(b, a, AT_INFINITY) for a, b in sides if (b, a) not in sides]
    hit = {cell for cell in real + ghosts if _contains(points, cell, p)}
    shown = ghosts if any(AT_INFINITY in cell for cell in hit) else []
    sides |= {edge: cell for cell in shown for edge in edges_of(cell)}
    whole = np.vstack([points, p])

    def picture(text: str, *items: fr.Item, number: str = "", kept: Iterable[Cell] = real) -> fr.Frame:
        base = [
            _polygons("muted", points, shown if kept is real else []),
            fr.polygons("cell", [points[list(cell)] for cell in kept]),
        ]
        top = [*fr.numbered(points), fr.dots("inserted", p), fr.labels("inserted", [p], ["P"])]
        return fr.frame(text, *base, *items, *top, number=number)

    first = next(cell for cell in real + shown if _located(points, cell, p))
    made = [picture("P arrives"), picture(_place(first), _polygons("highlight", points, [first]))]
    gone: list[Cell] = []
    waiting, seen = [first], {first}
    for cell in waiting:
        circle = [] if AT_INFINITY in cell else [_circle(points, cell)]
        asked = [_polygons("cavity", points, gone), _polygons("highlight", points, [cell]), *circle]
        if cell in hit:
            gone.append(cell)
            beside = [sides[edge[::-1]] for edge in edges_of(cell) if edge[::-1] in sides]
            waiting += [other for other in dict.fromkeys(beside) if other not in seen]
            seen |= set(beside)
        text = _verdict(points, cell, p, cell in hit)
        made.append(picture(text, *asked, number=f"{len(gone)} in the cavity"))
    apart = sorted(hit - set(gone) - set(ghosts))
    if apart:
        name = " ".join(map(str, sorted(apart[0])))
        extra = [
            _polygons("cavity", points, gone),
            _polygons("bad", points, apart),
            _circle(points, apart[0]),
        ]
        made.append(picture(f"but the circle of {name} contains P, too, and {name} lies apart", *extra))
        gone += apart
    rim = _rim(gone)
    edges = [edge for edge in rim if AT_INFINITY not in edge]
    text = f"the cavity: P sees its {len(edges)} edges"
    outline = fr.segments("front", [points[list(edge)] for edge in edges])
    if apart:
        text = f"the {len(edges)} edges around both: P does not see all of them"
    made.append(picture(text, _polygons("cavity", points, gone), outline))
    star = [(a, b, len(points)) for a, b in edges]
    turned = [int(orient(whole[list(cell)])) for cell in star]
    good = [cell for cell, sign in zip(star, turned) if sign > 0]
    wrong = [cell for cell, sign in zip(star, turned) if sign <= 0]
    text = "the star: each edge joined to P" if not wrong else "joined all the same: triangles overlap"
    number = f"{len(star)} new triangles" if not wrong else f"{len(wrong)} of {len(star)} turned over"
    items = [_polygons("accepted", whole, good), _polygons("bad", whole, wrong)]
    rest = [cell for cell in real if cell not in gone]
    made.append(picture(text, *items, number=number, kept=rest))
    low, high = whole.min(axis=0) - 1.9, whole.max(axis=0) + 1.9
    return [{**one, "view": [low[0], high[0], low[1], high[1]]} for one in made]


def edges_of(cell: Cell) -> list[tuple[int, int]]:
    """The directed edges of a cell, which lies on their left."""
    a, b, c = cell
    return [(a, b), (b, c), (c, a)]


def _rim(cells: Iterable[Cell]) -> list[tuple[int, int]]:
    """The directed edges of cells that no neighbor among them has in the other direction."""
    edges = [edge for cell in cells for edge in edges_of(cell)]
    both = set(edges)
    return [edge for edge in edges if edge[::-1] not in both]


def _contains(points: np.ndarray, cell: Cell, p: np.ndarray) -> bool:
    """Whether P is in the circle of a triangle; of a ghost: beyond its edge, or on the open edge."""
    if AT_INFINITY not in cell:
        return bool(in_sphere(points[list(cell)], p) > 0)
    a, b = points[cell[0]], points[cell[1]]
    side = int(orient(np.array([a, b, p])))
    return side > 0 or (side == 0 and bool((p - a) @ (p - b) < 0))


def _located(points: np.ndarray, cell: Cell, p: np.ndarray) -> bool:
    """Whether P is in the closed triangle, or strictly beyond the edge of the ghost."""
    if AT_INFINITY in cell:
        return bool(orient(np.array([points[cell[0]], points[cell[1]], p])) > 0)
    return all(int(orient(np.array([points[a], points[b], p]))) >= 0 for a, b in edges_of(cell))


def _name(cell: Cell) -> str:
    return " ".join(map(str, sorted(v for v in cell if v != AT_INFINITY)))


def _place(cell: Cell) -> str:
    if AT_INFINITY in cell:
        return f"locate: beyond the edge {_name(cell)} of the hull, in its ghost"
    return f"locate: P is in {_name(cell)}"


def _verdict(points: np.ndarray, cell: Cell, p: np.ndarray, goes: bool) -> str:
    name = _name(cell)
    if AT_INFINITY in cell:
        on = int(orient(np.array([points[cell[0]], points[cell[1]], p]))) == 0
        if goes:
            return f"P is {'on' if on else 'beyond'} the edge {name}: its ghost goes"
        return f"P is not beyond the edge {name}: its ghost stays"
    if goes:
        return f"the circle of {name} contains P: it goes"
    on = int(in_sphere(points[list(cell)], p)) == 0
    return f"P is on the circle of {name}: it stays" if on else f"the circle of {name} does not: it stays"


def _polygons(role: str, points: np.ndarray, cells: Iterable[Cell]) -> fr.Item:
    """Triangles; ghosts as strips beyond their edges, away from the middle of all points."""
    middle, shapes = points.mean(axis=0), []
    for cell in cells:
        corners = points[[v for v in cell if v != AT_INFINITY]]
        if AT_INFINITY in cell:
            away = (corners - middle) / np.sqrt(((corners - middle) ** 2).sum(axis=1))[:, None]
            corners = np.vstack([corners, (corners + 1.3 * away)[::-1]])
        shapes.append(corners)
    return fr.polygons(role, shapes)


def _circle(points: np.ndarray, cell: Cell) -> fr.Item:
    corners = points[list(cell)]
    return fr.circles("circumcircle", [circumcenter(corners)], [float(circumradius(corners))])


# ---- the same insertion in the Voronoi diagram --------------------------------------------------------

CAPTURES: dict[str, list[tuple[float, float]]] = {
    "twelve sites": [(0, 0), (7.5, 0), (7.5, 5), (0, 5), (1.6, 1.1), (4.1, 0.8), (6.2, 1.9), (4.8, 3.1),
                     (2.7, 3.8), (1.1, 2.8), (6.5, 4.1), (3.3, 2.1)],
    "nasty: a lattice": [(x, y) for y in (0, 2.5, 5) for x in (0, 2.5, 5, 7.5)],
}  # fmt: skip


def captured_state(preset: str = "twelve sites", x: float = 4.0, y: float = 2.0) -> fr.Frame:
    """The Voronoi cell of a new site P, the old corners in it, and the triangles whose circles contain P.

    Parameters
    ----------
    preset : str
        A key of `CAPTURES`.
    x, y : float
        The place of P, strictly inside of the hull: between 0.1 and 7.4, and between 0.1 and 4.9. In the
        lattice, P is on circles at some multiples of 1/4.

    Returns
    -------
    dict
        A frame. Its number counts the centers in the new cell and the triangles that go: as many.
    """
    points = np.array(preset_named(CAPTURES, preset), dtype=float)
    within("x", x, 0.1, 7.4)
    within("y", y, 0.1, 4.9)
    p = np.array([x, y], dtype=float)
    mesh, lines, centers = _diagram_of(preset)
    signs = np.asarray(in_sphere(mesh.corners, p))
    gone = np.flatnonzero(signs > 0)
    items = [
        fr.polygons("cell", mesh.corners),
        fr.polygons("cavity", mesh.corners[gone]),
        fr.segments("voronoi", lines),
    ]
    if (points == p).all(axis=1).any():
        caption, inside = "P is a vertex: no circle contains it", 0
    else:
        after = delaunay(np.vstack([points, p]))
        around = after.corners[(after.simplices == len(points)).any(axis=1)]
        new = np.array([circumcenter(corners) for corners in around]) - p
        cell = new[np.argsort(np.arctan2(new[:, 1], new[:, 0]))]
        items.append(fr.polygons("accepted", [p + cell]))
        away = p - centers  # a center is in the cell if it is nearer to P than to its own sites
        reach = ((centers - mesh.corners[:, 0]) ** 2).sum(axis=1)
        inside = int(((away**2).sum(axis=1) < reach * (1 - 1e-9)).sum())
        caption = "the cell of P takes the centers of the triangles that go"
        if (signs == 0).any():
            caption = "P is on a circle: that center is on the boundary of P's cell, and the triangle stays"
    stays = np.setdiff1d(np.arange(mesh.size), gone)
    items += [
        fr.dots("voronoi", centers[stays]),
        fr.dots("bad", centers[gone]),
        fr.dots("vertex", points),
        fr.dots("inserted", p, handles=["P"]),
        fr.labels("inserted", [p], ["P"]),
    ]
    number = f"triangles with their center in the cell of P: {inside}; that go: {len(gone)}"
    return fr.frame(caption, *items, number=number, view=[-1.2, 8.7, -1.2, 6.2])


@lru_cache(maxsize=4)
def _diagram_of(preset: str) -> tuple[Mesh, np.ndarray, np.ndarray]:
    """The triangles of the given sites, the Voronoi edges as segments, the center of each triangle."""
    diagram = Voronoi(delaunay(np.array(CAPTURES[preset], dtype=float)))
    lines, nodes, _ = dual_segments(diagram, reach=40.0)
    return diagram.mesh, lines, nodes[diagram.simplex_vertex]
