"""A walk to a point, triangle after triangle, with the powers of the point (section 2.4a)."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...connect.insertion.delaunay import delaunay
from ...geometry.simplex import circumcenter, circumradius
from ...mesh.mesh import Mesh
from ...predicates.batch import orient
from ..draw import frames as fr
from .cavity_search import Cell, edges_of
from .choices import preset_named

__all__ = ["WALKS", "walk_history"]

_SPREAD = [(0, 1), (2, 4), (1, 7), (3, 9), (4, 2), (5, 6), (6, 0), (7, 4), (8, 8), (9, 1), (10, 5),
           (11, 9), (12, 2), (13, 6), (14, 0), (15, 8), (16, 4), (17, 1), (18, 7)]  # fmt: skip
WALKS: dict[str, dict[str, Any]] = {
    "nineteen points": {"points": _SPREAD, "P": (16.2, 6.1), "from": 0},
    "ties: a lattice": {
        "points": [(x, y) for y in (0, 2, 4, 6) for x in (0, 2, 4, 6, 8, 10)],
        "P": (9.2, 5.4),
        "from": 0,
    },
    "nasty: not Delaunay": {
        "points": [(9, 4.5), (3, 8), (3, 1), (7.5, 4), (4, 7), (3.5, 2.5)],
        "cells": [(0, 1, 3), (1, 4, 3), (1, 2, 4), (2, 5, 4), (2, 0, 5), (0, 3, 5), (3, 4, 5)],
        "P": (5, 4.5),
        "from": 0,
    },
}


def walk_history(preset: str = "nineteen points") -> list[fr.Frame]:
    """The triangles of a walk: out of each through the first edge that has P strictly on its other side.

    Parameters
    ----------
    preset : str
        A key of `WALKS`. In the nasty one, which is not Delaunay, the walk comes back to its beginning.

    Returns
    -------
    list of dict
        A frame for each triangle; its number is the power of P with respect to the circle.
    """
    given = preset_named(WALKS, preset)
    points, p = np.array(given["points"], dtype=float), np.array(given["P"], dtype=float)
    mesh = Mesh(points, given["cells"]) if "cells" in given else delaunay(points)
    cells: list[Cell] = [(int(a), int(b), int(c)) for a, b, c in mesh.simplices]
    sides = {edge: cell for cell in cells for edge in edges_of(cell)}
    start = min(cells, key=lambda cell: float(points[list(cell)].sum())) if "cells" not in given else cells[0]
    way, made = [start], []
    while True:
        cell = way[-1]
        corners = points[list(cell)]
        center, radius = circumcenter(corners), float(circumradius(corners))
        power = float(((p - center) ** 2).sum() - radius**2)
        ahead = [edge for edge in edges_of(cell) if orient(np.array([*points[list(edge)], p])) < 0]
        again = cell in way[:-1]
        name = " ".join(map(str, sorted(cell)))
        if again:
            text = f"in {name} again: this walk never ends"
        elif ahead:
            text = f"in {name}: P is beyond the edge " + " ".join(map(str, sorted(ahead[0])))
        else:
            text = f"P is in {name}: the walk ends"
        items = [
            fr.polygons("cell", mesh.corners),
            fr.polygons("waiting", points[np.array(way[:-1], int).reshape(-1, 3)]),
            fr.polygons("bad" if again else "highlight", [corners]),
            fr.circles("circumcircle", [center], [radius]),
            fr.segments("front", points[list(ahead[:1])].reshape(-1, 2, 2) if ahead else []),
            *fr.numbered(points),
            fr.dots("inserted", p),
            fr.labels("inserted", [p], ["P"]),
        ]
        made.append(fr.frame(text, *items, number=f"power of P = {power + 0.0:.2f}"))
        if again or not ahead:
            break
        way.append(sides[ahead[0][::-1]])
    view = fr.bounds([fr.frame("", fr.dots("vertex", points))], 0.12)
    return [{**one, "view": view} for one in made]
