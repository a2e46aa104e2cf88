"""Two proofs of section 2.5 step by step: along a line of sight, and around a point that sees everything.

`sight_history` walks from a place in a triangle to a vertex, and shows the power of the vertex with respect
to the circle of each triangle on the way. `fan_history` visits a cavity, triangle after triangle: what has
been visited is filled by the triangles from the point to its boundary edges.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...connect.baker.fixed import boundary_facets, cavities
from ...connect.insertion.delaunay import delaunay
from ...geometry.simplex import circumcenter, circumradius
from ...mesh.mesh import Mesh
from ..draw import frames as fr
from .choices import preset_named

__all__ = ["FANS", "SIGHTS", "fan_history", "sight_history"]

STRIP = [(0, 0.2), (0.6, 1.9), (1.7, -0.1), (2.4, 2.2), (3.5, 0.1), (4.3, 2.0), (5.4, 0.3), (6.6, 1.5)]
ZIGZAG = [(0, 2, 1), (1, 2, 3), (2, 4, 3), (3, 4, 5), (4, 6, 5), (5, 6, 7)]
SIGHTS: dict[str, dict[str, Any]] = {
    "a clear view": {"points": STRIP, "cells": ZIGZAG, "from": (0.5, 0.7), "to": 7, "segments": []},
    "a segment in between": {
        "points": [(0, 0), (3, -0.9), (3, 0.9), (3.2, 0.1), (5.5, 1.2), (5.5, -1.2)],
        "cells": [(0, 1, 2), (1, 3, 2), (2, 3, 4), (1, 5, 3), (3, 5, 4)],
        "from": (2.0, 0.1),
        "to": 3,
        "segments": [(1, 2)],
    },
    "nasty: an edge that should be swapped": {
        "points": [(0, 0), (3, -2), (3, 2), (3.6, -0.5), (4.1, 0.4)],
        "cells": [(0, 1, 2), (1, 3, 2), (2, 3, 4), (1, 4, 3)],
        "from": (1.6, 0.1),
        "to": 4,
        "segments": [],
    },
}


def sight_history(preset: str = "a clear view") -> list[fr.Frame]:
    """The triangles between a place X and a vertex q, with their circles and the power of q.

    Parameters
    ----------
    preset : str
        A key of `SIGHTS`.

    Returns
    -------
    list of dict
        The line of sight; then a frame for each triangle that it enters, up to q or to a segment. The number
        is the power of q: the square of its distance from the center, less that of the radius.
    """
    given = preset_named(SIGHTS, preset)
    rows, cells = np.array(given["points"], dtype=float), given["cells"]
    start, goal = np.array(given["from"]), rows[given["to"]]
    walls = {frozenset(pair) for pair in given["segments"]}
    others = [v for v in range(len(rows)) if v != given["to"]]
    base = [fr.polygons("cell", rows[np.array(cells)])]
    over = [
        fr.segments("constrained", rows[np.array(given["segments"], int).reshape(-1, 2)]),
        fr.dots("vertex", rows),
        fr.labels("vertex", rows[others], others),
        fr.dots("inserted", goal),
        fr.dots("front", start),
        fr.labels("inserted", [goal], "q"),
        fr.labels("front", [start], "X"),
    ]
    line = fr.segments("voronoi", [(start, goal)])
    made = [fr.frame("X is in a triangle; q is a vertex", *base, line, *over)]
    way = _way(rows, cells, start, given["to"])
    before = None
    for k, t in enumerate(way):
        corners = rows[list(cells[t])]
        center, radius = circumcenter(corners), float(circumradius(corners))
        power = float(((goal - center) ** 2).sum() - radius**2)
        name = " ".join(map(str, cells[t]))
        text = f"the triangle of X, and its circle: {name}"
        if before is not None:
            edge = " ".join(map(str, sorted(set(cells[way[k - 1]]) & set(cells[t]))))
            text = f"across {edge}: the power of q has " + ("fallen" if power <= before + 1e-12 else "RISEN")
        if given["to"] in cells[t]:
            text += "; q is a corner"
        ahead = set(cells[t]) & set(cells[way[k + 1]]) if k + 1 < len(way) else set()
        blocked = frozenset(ahead) in walls
        if blocked:
            text = "the edge ahead is a segment: q is inside the circle, but it is not seen"
        items = [
            *base,
            fr.polygons("highlight", [corners]),
            fr.circles("circumcircle", [center], [radius]),
            line,
            *over,
        ]
        made.append(fr.frame(text, *items, number=f"power of q = {power + 0.0:.2f}"))
        before = power
        if blocked:
            break
    view = fr.bounds([fr.frame("", fr.dots("vertex", rows))], 0.12)
    return [{**one, "view": view} for one in made]


def _way(rows: np.ndarray, cells: list, start: np.ndarray, goal: int) -> list[int]:
    """The triangles that the segment from a place to a vertex enters, in order; only for drawing."""
    found = []
    for t, cell in enumerate(cells):
        low, high = 0.0, 1.0
        for k in range(3):
            p, q = rows[cell[k]], rows[cell[(k + 1) % 3]]
            normal = np.array([p[1] - q[1], q[0] - p[0]])
            at, gain = normal @ (start - p), normal @ (rows[goal] - start)
            if gain > 0:
                low = max(low, -at / gain)
            elif gain < 0:
                high = min(high, -at / gain)
            elif at < 0:
                high = -1.0
        if high - low > 1e-9:
            found.append((low, t))
    return [t for _, t in sorted(found)]


# ---- the fan around P -------------------------------------------------------------------------------

NEARLY_ROUND = [(3, 0.25), (2.25, 2), (0.5, 3), (-1.5, 2.5), (-2.75, 1), (-3, -1), (-1.5, -2.5), (0.5, -3)]
NEARLY_ROUND += [(2.5, -2)]
FARTHER_OUT = [(4.5, 0.5), (2.5, 3.75), (-2.25, 4), (-4.5, 0.25), (-2.5, -3.75), (2.5, -4)]
FANS: dict[str, dict[str, Any]] = {
    "all of the cavity": {"points": [*NEARLY_ROUND, *FARTHER_OUT], "place": (0.3, 0.2)},
    "P on an edge": {"points": [*NEARLY_ROUND, *FARTHER_OUT], "place": None},
    "three triangles are fixed": {"points": [*NEARLY_ROUND, *FARTHER_OUT], "place": (0.3, 0.2), "fixed": 3},
    "nasty: far from Delaunay": {
        "points": [(0, 4), (0, 6), (0, 7), (1, 4), (2, 9), (2, 10), (3, 0), (3, 11), (6, 10), (7, 1),
                   (8, 10)],
        "cells": [(5, 4, 8), (2, 1, 5), (1, 0, 8), (5, 1, 4), (8, 4, 1), (10, 6, 9),
                  (3, 0, 6), (3, 10, 8), (0, 3, 8), (3, 6, 10), (8, 7, 5), (8, 10, 7)],
        "place": (2.75, 8.25),
    },
}  # fmt: skip


def fan_mesh(preset: str) -> tuple[Mesh, np.ndarray, list[int]]:
    """The mesh of a preset, the point P, and the triangles that are fixed."""
    given = preset_named(FANS, preset)
    points = np.array(given["points"], dtype=float)
    mesh = Mesh(points, given["cells"]).oriented() if "cells" in given else delaunay(points)
    inner = np.flatnonzero((mesh.simplices < len(NEARLY_ROUND)).all(axis=1))
    if given["place"] is None:
        t = int(inner[np.argmin((mesh.corners[inner].mean(axis=1) ** 2).sum(axis=1))])
        return mesh, mesh.points[mesh.simplices[t, :2]].mean(axis=0).round(12), []
    place = np.array(given["place"])
    whole = cavities(mesh, place)
    far = np.setdiff1d(whole.gamma_component, whole.holders)
    ends = far[np.argsort(-(mesh.corners[far].mean(axis=1) ** 2).sum(axis=1), kind="stable")]
    return mesh, place, sorted(ends[: given.get("fixed", 0)].tolist())


def fan_history(preset: str = "all of the cavity") -> list[fr.Frame]:
    """A cavity is visited from the triangle of P, and the fan of triangles from P grows with it.

    Parameters
    ----------
    preset : str
        A key of `FANS`.

    Returns
    -------
    list of dict
        A frame for each visited triangle, with its circle and the fan. The number counts visited triangles
        and their boundary edges, of which there are always two more.
    """
    mesh, p, fixed = fan_mesh(preset)
    sets = cavities(mesh, p, fixed=np.array(fixed, dtype=np.int32))
    free = set(sets.upsilon_component.tolist())
    order = [(t, -1) for t in sets.holders.tolist()]
    seen = {t for t, _ in order}
    for t, _ in order:
        for s in mesh.neighbors[t].tolist():
            if s in free - seen:
                seen.add(s)
                order.append((s, t))
    base = [fr.polygons("cell", mesh.corners), fr.polygons("layer", mesh.corners[fixed])]
    over = [fr.dots("vertex", mesh.points), fr.dots("inserted", p), fr.labels("inserted", [p], "P")]
    made = []
    first = len(sets.holders)
    for k in range(first, len(order) + 1):
        visited = sorted(t for t, _ in order[:k])
        facets = boundary_facets(mesh, visited)
        rim = mesh.points[[[mesh.simplices[t, i - 2], mesh.simplices[t, i - 1]] for t, i in facets]]
        fan = [[p, *edge] for edge in rim]
        items = [*base]
        text = "the triangle of P: three triangles from P fill it"
        if first == 2:
            text = "P is on an edge: four triangles from P fill its two"
        if k > first:
            t = order[k - 1][0]
            corners = mesh.corners[t]
            items.append(fr.polygons("highlight", [corners]))
            items.append(fr.circles("circumcircle", [circumcenter(corners)], [float(circumradius(corners))]))
            text = "one more: its circle contains P, and one triangle from P becomes two"
        items += [fr.polygons("accepted", fan, opacity=0.6), fr.segments("front", rim)]
        number = f"triangles = {k}, boundary edges = {len(rim)}"
        made.append(fr.frame(text, *items, *over, number=number))
    view = fr.bounds([fr.frame("", fr.dots("vertex", mesh.points))], 0.08)
    return [{**one, "view": view} for one in made]
