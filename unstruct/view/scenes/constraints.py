"""Constrained triangulation as frames: a segment is inserted; a cavity with fixed triangles (section 2.5).

The states come from the library: a frame only shows the differences between two meshes, or the sets of cells
that `unstruct.connect.baker.fixed` finds.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...base.errors import InputError
from ...connect.baker.fixed import boundary_facets, cavities, hidden_facets
from ...connect.insertion.delaunay import delaunay
from ...generate.boundary.edge_recovery import recover_edges
from ...geometry.simplex import circumcenter, circumradius
from ...mesh.domain_mesh import DomainMesh
from ...mesh.mesh import Mesh
from ..draw import frames as fr
from .choices import preset_named, within

__all__ = ["COMPONENTS", "SEGMENT_EXAMPLES", "principal_component_state", "segment_history", "segment_state"]

# ---- a segment is inserted -------------------------------------------------------------------------

SEGMENT_EXAMPLES: dict[str, dict[str, Any]] = {
    "one segment": {
        "points": [(0, 3), (10, 3), (2, 5), (5, 4), (8, 6), (2, 0), (4, 2), (6.5, 1), (8.5, 0.5)],
        "segments": [(0, 1)],
    },
    "a vertex on the way": {
        "points": [(0, 2), (10, 2), (5, 2), (2.5, 3.2), (2.4, 1), (7.5, 2.8), (7.7, 0.8), (5, 5), (5, -1)],
        "segments": [(0, 1)],
    },
    "two segments": {
        "points": [(0, 0), (9, 1), (1, 5), (9, 5), (3, 2), (5, 3.4), (6, 1.8), (4, 6), (5, -1), (7.5, 3.6)],
        "segments": [(0, 3), (8, 9)],
    },
    "nasty: an edge that hangs in": {
        "points": [(-9, 0), (9, 0), (0, 4), (0, 1.2), (-2, -3), (2, -3)],
        "cells": [(0, 4, 2), (2, 4, 3), (4, 5, 3), (3, 5, 2), (2, 5, 1)],
        "segments": [(0, 1)],
    },
    "nasty: two that cross": {
        "points": [(0, 0), (6, 0), (6, 5), (0, 5), (3, 1), (2.2, 3)],
        "segments": [(0, 2), (1, 3)],
    },
}


def segment_history(preset: str = "one segment") -> list[fr.Frame]:
    """All frames of the insertion of segments into a Delaunay triangulation.

    Parameters
    ----------
    preset : str
        A key of `SEGMENT_EXAMPLES`.

    Returns
    -------
    list of dict
        Frames: the triangles that a segment crosses, one after another; the two polygons beside it; and
        their new triangles with their circles.
    """
    given = preset_named(SEGMENT_EXAMPLES, preset)
    rows = np.array(given["points"], dtype=float)
    mesh = Mesh(rows, given["cells"]).oriented() if "cells" in given else delaunay(rows)
    first = "A triangulation" if "cells" in given else "The Delaunay triangulation"
    made = [fr.frame(first, *_scene(rows, mesh))]
    done: list[tuple[int, int]] = []
    for pair in given["segments"]:
        try:
            after = recover_edges(mesh, [*done, pair])
        except InputError:
            wanted = fr.segments("bad", rows[[pair]])
            names = " and ".join(f"{a} {b}" for a, b in [*done, pair])
            text = f"{pair[0]} {pair[1]} is refused: it crosses an earlier segment"
            made.append(
                fr.frame(
                    text, *_scene(rows, mesh, done), wanted, *fr.numbered(rows), number=f"segments = {names}"
                )
            )
            continue
        made += _passage(rows, mesh, after, done, pair)
        mesh, done = after, [*done, pair]
    view = fr.bounds([fr.frame("", fr.dots("vertex", rows))], 0.12)
    return [{**one, "view": view} for one in made]


def segment_state(step: int, preset: str = "one segment") -> fr.Frame:
    """One frame of `segment_history`; steps beyond its ends give the first or the last frame."""
    frames = segment_history(preset)
    return frames[min(max(int(step), 0), len(frames) - 1)]


def _passage(rows: np.ndarray, before: Mesh, after: DomainMesh, done: Sequence, pair: Any) -> list[fr.Frame]:
    """The frames of one segment: the old triangles, those that are deleted, and the new ones."""
    old, new = _set(before), _set(after)
    a, b = pair
    wanted = fr.segments("front", rows[[pair]])
    name, names = f"{a} {b}", fr.numbered(rows)
    base = _scene(rows, before, done)
    if old == new:
        text = f"{name} is already an edge: it is marked"
        return [fr.frame(text, *_scene(rows, after, [*done, pair]), number="triangles crossed = 0")]
    crossed = sorted(old - new, key=lambda c: _entry(rows, c, a, b))
    made = [fr.frame(f"{name} is to be an edge", *base, wanted, *names)]
    shown = range(1, len(crossed) + 1) if len(crossed) <= 4 else (1, 2, len(crossed))
    for k in shown:
        text = f"the segment enters triangle {_text(crossed[0])}"
        text = "it leaves through the opposite edge, and so on" if k > 1 else text
        text = "it reaches the other end: all these triangles are deleted" if k == len(crossed) else text
        cells = fr.polygons("cavity", [rows[list(c)] for c in crossed[:k]])
        made.append(fr.frame(text, *base, cells, wanted, *names, number=f"triangles crossed = {k}"))
    parts = after.segments[after.piece == len(done)].tolist()
    rest = fr.polygons("cell", [rows[list(c)] for c in old & new])
    walls = fr.segments("constrained", rows[[*done, *parts]])
    text = "two polygons remain, above and below the segment"
    if len(parts) > 1:
        text = "a vertex lies on the segment: each part has its two polygons"
    around = fr.segments("edge", rows[sorted(_edges(old - new) & _edges(new - old))])
    made.append(fr.frame(text, rest, around, walls, *names, number=f"triangles crossed = {len(crossed)}"))
    come: list[tuple[int, ...]] = []
    for base_edge, cell in _from_bases(new - old, parts):
        come.append(cell)
        (apex,) = set(cell) - set(base_edge)
        name = f"{base_edge[0]} {base_edge[1]}"
        text = f"edge {name} is joined to {apex}: no other corner of the polygon is in the circle"
        circle = fr.circles(
            "circumcircle", [circumcenter(rows[list(cell)])], [circumradius(rows[list(cell)])]
        )
        cells = fr.polygons("accepted", [rows[list(c)] for c in come])
        number = f"new triangles = {len(come)} of {len(crossed)}"
        made.append(fr.frame(text, rest, around, cells, circle, walls, *names, number=number))
    return made


def _entry(rows: np.ndarray, cell: Sequence[int], a: int, b: int) -> float:
    """The place along ab, from 0 to 1, where a triangle is entered; it is used only for drawing."""
    along = rows[b] - rows[a]
    side = (rows[list(cell)] - rows[a]) @ [-along[1], along[0]]
    place = (rows[list(cell)] - rows[a]) @ along / (along @ along)
    found = [place[k] for k in range(3) if abs(side[k]) < 1e-12]
    for k in range(3):
        if side[k] * side[k - 1] < 0:
            found.append(place[k] + (place[k - 1] - place[k]) * side[k] / (side[k] - side[k - 1]))
    return float(np.mean(found))


def _from_bases(cells: set, parts: Sequence) -> list[tuple[tuple[int, int], tuple[int, ...]]]:
    """New triangles, each with the edge from which it was built, from the segment outward."""
    waiting, found, left = [tuple(part) for part in parts for _ in (0, 1)], [], set(cells)
    while waiting:
        edge = waiting.pop(0)
        for cell in sorted(left):
            if set(edge) <= set(cell):
                left.discard(cell)
                found.append((edge, cell))
                (apex,) = set(cell) - set(edge)
                waiting[:0] = [(edge[0], apex), (apex, edge[1])]
                break
    return found


def _edges(cells: set) -> set[tuple[int, int]]:
    return {pair for c in cells for pair in ((c[0], c[1]), (c[0], c[2]), (c[1], c[2]))}


def _scene(rows: np.ndarray, mesh: Mesh, done: Sequence = ()) -> list[fr.Item]:
    cells = fr.polygons("cell", rows[mesh.simplices])
    return [cells, fr.segments("constrained", rows[np.array(done, int).reshape(-1, 2)]), *fr.numbered(rows)]


def _set(mesh: Mesh) -> set[tuple[int, ...]]:
    return {tuple(sorted(row)) for row in mesh.simplices.tolist()}


def _text(cell: Sequence[int]) -> str:
    return " ".join(map(str, cell))


# ---- the principal component, with fixed triangles -------------------------------------------------

COMPONENTS: dict[str, dict[str, Any]] = {
    "two pieces": {
        "points": [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0)],
        "cells": [(0, 1, 2), (1, 2, 3), (2, 3, 4)],
        "start": (1.6, 0.5),
    },
    "nasty: touching in a vertex": {
        "points": [(6, 2), (5, 5), (6, 7), (3, 7), (2, 1), (1, 1)],
        "cells": [(0, 1, 2), (0, 1, 4), (1, 2, 3), (1, 3, 5), (1, 4, 5)],
        "start": (4.2, 2.2),
    },
    "Delaunay": {
        "points": [(0, 0), (8, 0), (8, 6), (0, 6), (4, -1), (9, 3), (4, 7), (-1, 3),
                   (2, 1.5), (6, 1.8), (5.6, 4.4), (2.4, 4.2), (4, 3)],
        "start": (4.6, 1.2),
    },
}  # fmt: skip
COMPONENTS["Delaunay, boundary triangles fixed"] = {**COMPONENTS["Delaunay"], "fixed": True}


def principal_component_state(x: float, y: float, preset: str = "two pieces") -> fr.Frame:
    """Γ(P), its principal component and, with fixed triangles, Υ_P; and the edges that P sees.

    Parameters
    ----------
    x, y : float
        The place of P in the box of the mesh, between 0 and 1.
    preset : str
        A key of `COMPONENTS`.

    Returns
    -------
    dict
        A frame; its number counts the edges of the component, and those that P does not see, which are always
        0.
    """
    given = preset_named(COMPONENTS, preset)
    mesh, fixed = component_mesh(given)
    within("x", x, 0, 1)
    within("y", y, 0, 1)
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    p = low + np.array([x, y]) * (high - low)
    base = [fr.polygons("cell", mesh.corners), fr.polygons("layer", mesh.corners[fixed])]
    point = [
        fr.dots("vertex", mesh.points),
        fr.dots("inserted", p, handles=["P"]),
        fr.labels("inserted", [p], "P"),
    ]
    pad = 0.15 * (high - low).max()
    view = [low[0] - pad, high[0] + pad, low[1] - pad, high[1] + pad]
    if mesh.find_simplex(p) < 0:
        return fr.frame("P is outside: there is no cavity", *base, *point, number="Γ(P) unused", view=view)
    if (mesh.points == p).all(axis=1).any():
        return fr.frame(
            "P is already a vertex: nothing to do", *base, *point, number="Γ(P) unused", view=view
        )
    sets = cavities(mesh, p, fixed=fixed)
    apart = np.setdiff1d(sets.gamma, sets.gamma_component)
    used = sets.upsilon_component
    items = [
        *base,
        fr.polygons("waiting", mesh.corners[np.setdiff1d(sets.gamma, used)]),
        fr.polygons("cavity", mesh.corners[used]),
    ]
    if len(sets.refused_by):
        items.append(fr.polygons("bad", mesh.corners[sets.refused_by]))
        text = "P lies in a closed fixed triangle: it is refused"
        return fr.frame(text, *items, *point, number="Υ_P does not exist", view=view)
    facets, hidden = boundary_facets(mesh, used), hidden_facets(mesh, used, p)
    ends = np.array([[mesh.simplices[c, (k + 1) % 3], mesh.simplices[c, (k + 2) % 3]] for c, k in facets])
    items.append(fr.segments("inserted", [[p, q] for q in mesh.points[np.unique(ends)]], opacity=0.6))
    text = f"Γ(P): {len(sets.gamma)} triangles" + (f", {len(apart)} of them separate" if len(apart) else "")
    if len(fixed):
        text += f"; Υ_P: {len(used)}"
    number = f"edges of the component = {len(facets)}, hidden from P = {len(hidden)}"
    return fr.frame(text, *items, *point, number=number, view=view)


def component_mesh(given: dict[str, Any]) -> tuple[Mesh, np.ndarray]:
    points = np.array(given["points"], dtype=float)
    mesh = Mesh(points, given["cells"]).oriented() if "cells" in given else delaunay(points)
    at_boundary = (mesh.neighbors < 0).any(axis=1)
    return mesh, np.flatnonzero(at_boundary & given.get("fixed", False))
