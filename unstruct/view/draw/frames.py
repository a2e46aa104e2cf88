"""Frames: one picture of a history as a plain dictionary, which every renderer here can draw.

A frame is ``{"caption": str, "number": str, "items": [item, …]}``, with an optional entry
``"view": [xmin, xmax, ymin, ymax]``. An item is ``{"kind": …, "role": …, "data": …}``, where *kind* is one of
`KINDS` and *role* one of `unstruct.view.ROLES`. matplotlib draws frames side by side (`strip`); the player
steps through them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from ...base.errors import InputError
from .colors import ROLES

__all__ = [
    "KINDS",
    "bounds",
    "check_frame",
    "circles",
    "dots",
    "frame",
    "labels",
    "mesh_items",
    "numbered",
    "polygons",
    "segments",
]

KINDS = ("points", "segments", "polygons", "circles", "labels")
Frame = dict[str, Any]
Item = dict[str, Any]
View = list[float]


def frame(caption: str, *items: Item, number: str = "", view: Sequence[float] | None = None) -> Frame:
    """One frame: a short caption, the items from back to front, and a text with the current numbers."""
    made: Frame = {"caption": caption, "number": number, "items": list(items)}
    if view is not None:
        made["view"] = [float(v) for v in view]
    return made


def dots(role: str, points: Any, *, handles: Sequence[str] | None = None, opacity: float = 1.0) -> Item:
    """Markers at points ``(k, 2)``; ``handles`` are names of the points, which the reader can then drag."""
    item = _item("points", role, np.asarray(points, dtype=float).reshape(-1, 2).tolist(), opacity)
    return item if handles is None else {**item, "handles": list(handles)}


def segments(role: str, ends: Any, *, opacity: float = 1.0) -> Item:
    """Segments from an array ``(k, 2, 2)`` of end points."""
    return _item("segments", role, np.asarray(ends, dtype=float).reshape(-1, 2, 2).tolist(), opacity)


def polygons(role: str, corners: Iterable[Any], *, opacity: float = 1.0) -> Item:
    """Filled polygons, each an array ``(corners, 2)``."""
    data = [np.asarray(c, dtype=float).reshape(-1, 2).tolist() for c in corners]
    return _item("polygons", role, data, opacity)


def circles(role: str, centers: Any, radii: Any, *, opacity: float = 1.0) -> Item:
    """Circles from centers ``(k, 2)`` and radii ``(k,)``."""
    rows = np.column_stack([np.asarray(centers, dtype=float).reshape(-1, 2), np.ravel(radii)])
    return _item("circles", role, rows.tolist(), opacity)


def labels(role: str, points: Any, text: Iterable[Any], *, opacity: float = 1.0) -> Item:
    """Short texts beside points ``(k, 2)``."""
    item = _item("labels", role, np.asarray(points, dtype=float).reshape(-1, 2).tolist(), opacity)
    return {**item, "text": [str(t) for t in text]}


def numbered(points: Any) -> list[Item]:
    """Points ``(k, 2)`` as vertices, each with its number."""
    return [dots("vertex", points), labels("vertex", points, range(len(points)))]


def _item(kind: str, role: str, data: list, opacity: float) -> Item:
    item: Item = {"kind": kind, "role": role, "data": data}
    return item if opacity == 1.0 else {**item, "opacity": float(opacity)}


def mesh_items(points: Any, cells: Any, *, role: str = "cell", names: bool = False) -> list[Item]:
    """The cells of a planar mesh as polygons, and the vertices that they use, with numbers if ``names``."""
    points = np.asarray(points, dtype=float)
    cells = [list(map(int, cell)) for cell in cells]
    used = sorted({v for cell in cells for v in cell})
    items = [polygons(role, [points[cell] for cell in cells]), dots("vertex", points[used])]
    return [*items, labels("vertex", points[used], used)] if names else items


def bounds(frames: Iterable[Frame], margin: float = 0.08) -> View:
    """The fixed window of a history: the first ``view`` of a frame, or else all items except circles.

    Circles count only if there is nothing else, because one huge circumcircle would shrink the rest.
    """
    frames = list(frames)
    for one in frames:
        if "view" in one:
            return [float(v) for v in one["view"]]
    corners = [
        np.reshape(rows, (-1, 2))
        for one in frames
        for i in one["items"]
        if i["kind"] != "circles"
        for rows in i["data"]
    ]
    if not corners:
        for one in frames:
            for item in one["items"]:
                for x, y, r in item["data"]:
                    corners.append(np.array([[x - r, y - r], [x + r, y + r]]))
    if not corners:
        return [0.0, 1.0, 0.0, 1.0]
    flat = np.concatenate(corners)
    low, high = flat.min(axis=0), flat.max(axis=0)
    size = max(float((high - low).max()), 1e-300)
    pad = np.maximum(margin * size, (0.25 * size - (high - low)) / 2)  # collinear points get a window, too
    low, high = low - pad, high + pad
    return [float(low[0]), float(high[0]), float(low[1]), float(high[1])]


def arc(circle: Sequence[float], view: Sequence[float]) -> np.ndarray:
    """The part of a huge circle near the window, as a polyline ``(49, 2)``; drawing the whole is slow."""
    x, y, r = circle
    middle = np.array([(view[0] + view[1]) / 2, (view[2] + view[3]) / 2])
    toward = middle - [x, y]
    far = float(np.hypot(*toward))
    turn = np.array([toward, [-toward[1], toward[0]]]) / far
    half = min(math.pi, 2 * (view[1] - view[0] + view[3] - view[2]) / r)
    angle = np.linspace(-half, half, 49)
    # Points are computed relative to the window, so that r and ``far`` are the only huge numbers subtracted.
    return middle + np.column_stack([(r - far) - 2 * r * np.sin(angle / 2) ** 2, r * np.sin(angle)]) @ turn


def outline(polygons: Sequence[Any]) -> list[list[Any]]:
    """The sides of polygons as segments; a common side of two neighbors is listed once."""
    sides = {}
    for corners in polygons:
        for p, q in zip(corners, [*corners[1:], corners[0]]):
            ends = sorted([tuple(map(float, p)), tuple(map(float, q))])
            sides[tuple(f"{v:.9g}" for end in ends for v in end)] = [list(end) for end in ends]
    return list(sides.values())


def check_frame(one: Any) -> None:
    """Raise `InputError`, naming the item, unless ``one`` is a frame that every renderer can draw."""
    if not isinstance(one, dict) or not {"caption", "number", "items"} <= set(one):
        raise InputError("a frame must be a dictionary with caption, number and items")
    if set(one) - {"caption", "number", "items", "view"}:
        raise InputError(
            f"a frame must not have an entry {sorted(set(one) - {'caption', 'number', 'items', 'view'})[0]!r}"
        )
    if not isinstance(one["caption"], str) or not isinstance(one["number"], str):
        raise InputError("the caption and the number of a frame must be strings")
    if "view" in one and not (
        _numbers(one["view"], 4) and one["view"][0] < one["view"][1] and one["view"][2] < one["view"][3]
    ):
        raise InputError(
            f"view must be [xmin, xmax, ymin, ymax] with xmin < xmax and ymin < ymax, not {one['view']!r}"
        )
    for k, item in enumerate(one["items"]):
        problem = _problem(item)
        if problem:
            raise InputError(f"item {k} of the frame {one['caption']!r}: {problem}")


def _problem(item: Item) -> str:
    """What is wrong with an item, or an empty string."""
    kind, data = item.get("kind"), item.get("data")
    if kind not in KINDS:
        return f"kind is {kind!r}; use one of {', '.join(KINDS)}"
    if item.get("role") not in ROLES:
        return f"role is {item.get('role')!r}; use one of {', '.join(ROLES)}"
    if not isinstance(data, list):
        return "data is not a list; use .tolist()"
    width = 3 if kind == "circles" else 2
    for j, row in enumerate(data):
        rows = row if kind in ("segments", "polygons") else [row]
        if kind == "segments" and len(rows) != 2:
            return f"segment {j} does not have two ends"
        if not rows or not all(_numbers(r, width) for r in rows):
            return f"row {j} does not consist of {width} finite numbers: {row!r}"
        if kind == "circles" and row[2] < 0:
            return f"circle {j} has the negative radius {row[2]}"
    for extra in ("text", "handles"):
        if extra in item and len(item[extra]) != len(data):
            return f"there are {len(item[extra])} entries of {extra} for {len(data)} points"
    if kind == "labels" and "text" not in item:
        return "labels need an entry text"
    if not 0 <= item.get("opacity", 1) <= 1:
        return f"opacity is {item['opacity']}; it must be between 0 and 1"
    return ""


def _numbers(row: Any, count: int) -> bool:
    return (
        isinstance(row, list)
        and len(row) == count
        and all(isinstance(v, (int, float)) and math.isfinite(v) for v in row)
    )
