"""Scenes in space as frames: projected, and painted from back to front, so that the player can step them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import Any

import numpy as np

from ..draw import frames as fr
from ..draw.painting import axes3
from ..draw.sections import FACES

__all__ = ["bodies", "space_frame"]

SHRINK = 0.82  # cells are shown a little smaller, so that one sees between them
Scene = Sequence[dict[str, Any]]


def space_frame(
    items: Scene, caption: str = "", *, number: str = "", azimuth: float = -55.0, elevation: float = 22.0
) -> fr.Frame:
    """A scene of `item3` as a frame, seen from a direction given in degrees.

    Faces are painted by the depths of their middles, edges and points a little in front of faces there; last
    come labels, spheres, and what is being inserted, which is seen inside of cells. A sphere is a circle.
    """
    turn = axes3(azimuth, elevation)
    lift = 0.02 * max((float(np.abs(row).max()) for i in items for row in i["points"]), default=1.0)
    things: list[tuple[float, int, str, Any]] = []
    for index, item in enumerate(items):
        points, kind = np.reshape(item["points"], (-1, 3)), item["kind"]
        for row_index, row in enumerate(item["data"]):
            if kind == "cells":
                parts = [("polygons", points[row][list(face)]) for face in FACES[len(row)]]
            elif kind in ("polygons", "segments"):
                parts = [(kind, points[row])]
            else:
                parts = [(kind, np.array([row[:3]]))]
            for name, corners in parts:
                depth = float(corners.mean(axis=0) @ turn[2])
                raised = {"polygons": 0.0, "segments": lift, "points": 3 * lift}.get(name, np.inf)
                depth += np.inf if item["role"] == "inserted" else raised
                flat = (corners @ turn[:2].T).tolist()
                if name == "labels":
                    flat = [*flat[0], item["text"][row_index]]
                elif name == "spheres":
                    flat = [*flat[0], row[3]]
                things.append((depth, index, name, flat))
    things.sort(key=lambda thing: thing[0])
    shown = [
        _item(items[index], name, [thing[3] for thing in group])
        for (index, name), group in groupby(things, key=lambda thing: (thing[1], thing[2]))
    ]
    return fr.frame(caption, *shown, number=number)


def _item(item: dict[str, Any], kind: str, data: list[Any]) -> fr.Item:
    """Things of one item that follow each other in depth, as an item of a frame."""
    role, opacity = item["role"], item.get("opacity", 1.0)
    if kind == "polygons":
        return fr.polygons(role, data, opacity=opacity)
    if kind == "segments":
        return fr.segments(role, data, opacity=opacity)
    if kind == "points":
        return fr.dots(role, [row[0] for row in data], opacity=opacity)
    if kind == "labels":
        return fr.labels(role, [row[:2] for row in data], [row[2] for row in data], opacity=opacity)
    return fr.circles(role, [row[:2] for row in data], [row[2] for row in data], opacity=opacity)


def bodies(
    role: str, cells: Any, points: Any, *, shrink: float = SHRINK, opacity: float = 1.0
) -> dict[str, Any]:
    """Tetrahedra, each shrunk toward its centroid, as an item of a scene; all of them may be none."""
    corners = np.asarray(points, dtype=float)[np.asarray(list(cells), dtype=int).reshape(-1, 4)]
    middle = corners.mean(axis=1, keepdims=True)
    moved = (middle + shrink * (corners - middle)).reshape(-1, 3)
    rows = np.arange(len(moved)).reshape(-1, 4)
    return {
        "kind": "cells",
        "role": role,
        "points": moved.tolist(),
        "data": rows.tolist(),
        "opacity": float(opacity),
    }
