"""Scenes in space painted by matplotlib, from back to front; see `unstruct.view.draw.space`."""

from __future__ import annotations

from itertools import groupby
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb

from ...base.errors import DomainError, InputError
from ...geometry.outline import Outline
from .coloring import Coloring, cell_coloring, legend, value_scale
from .colors import line_style
from .colors import role as style_of
from .items import Item, mesh_items3, needs_faces, solid_items
from .sections import FACES, as_plane, face_normals
from .strips import fit, flat_axes, marks
from .strips import label as write_label

__all__ = ["axes3", "ball_around", "picture", "things_of"]

THIN = 0.6  # the width of the edges of faces, relative to the role's width, because many are visible at once
MANY_FACES = 1500  # with more faces than this, their edges become thinner, down to 0.2 of that width
CUTS = ("cells", "flat")


def ball_around(items: list[Item]) -> list[float]:
    """Center and radius of a ball around all items; spheres much larger than the rest do not count."""
    rows = [
        np.reshape(i["points"], (-1, 3))[np.unique(np.concatenate(i["data"]).astype(int))]
        for i in items
        if i["kind"] in ("cells", "polygons", "segments") and i["data"]
    ]
    rows += [np.reshape(i["data"], (-1, 3)) for i in items if i["kind"] in ("points", "labels")]
    flat = np.concatenate(rows) if rows else np.zeros((0, 3))
    reach = 2 * np.ptp(flat, axis=0).max() if len(flat) else np.inf
    balls = np.reshape(
        [b for i in items if i["kind"] == "spheres" for b in i["data"] if b[3] <= reach], (-1, 4)
    )
    ends = balls[:, None, :3] + balls[:, None, 3:] * np.vstack([np.eye(3), -np.eye(3)])
    flat = np.concatenate([flat, ends.reshape(-1, 3)])
    if not len(flat):
        return [0.0, 0.0, 0.0, 1.0]
    center = (flat.min(axis=0) + flat.max(axis=0)) / 2
    size = np.abs(flat - center).max() or 1.0  # so that squares do not overflow
    radius = float(size * np.linalg.norm((flat - center) / size, axis=1).max())
    return [*map(float, center), radius or 1.0]


def axes3(azimuth: float, elevation: float) -> np.ndarray:
    """The directions right, up and toward the reader, as rows; angles are as in matplotlib."""
    a, e = np.radians([azimuth, elevation])
    return np.array(
        [
            [-np.sin(a), np.cos(a), 0],
            [-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e)],
            [np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)],
        ]
    )


def picture(
    mesh: Any,
    ax: Axes | None = None,
    *,
    role: str = "cell",
    values: Any = None,
    label: str = "",
    azimuth: float = -55.0,
    elevation: float = 22.0,
    explode: float = 0.0,
    section: Any = None,
    cut: str = "cells",
    together: Any = None,
) -> Axes:
    """The static form of `view3d`, with the same parameters and a color bar ``label`` for ``values``.

    A mesh has the options of `unstruct.view.plot` as well; a list of items has neither ``section`` nor
    ``together``.
    """
    coloring = None
    if isinstance(mesh, list):
        items = mesh
        if values is not None:
            given = np.asarray(values, dtype=float)
            coloring = Coloring(given, False, value_scale(given), {}, label)
    else:
        items, coloring = _seen(mesh, role, values, label, explode, section, cut, together)
    ax = flat_axes(ax)
    x, y, z, radius = ball_around(items)
    center, turn = np.array([x, y, z]), axes3(azimuth, elevation)
    things = things_of(items, center, radius, turn, explode)
    things.sort(key=lambda thing: thing[0])
    start = 2
    for _, group in groupby(things, key=lambda thing: (id(thing[1]), thing[2])):  # one item and kind
        run = list(group)
        _paint(ax, run, center, turn, z=start)
        start += len(run)
    corners = [(np.asarray(t[3]) - center) @ turn[:2].T for t in things]
    corners += [c + t[4][0] * s for c, t in zip(corners, things) if t[2] == "spheres" for s in (-1, 1)]
    fit(ax, np.concatenate(corners) if corners else np.zeros((1, 2)), 0.06)
    if coloring is not None:
        legend(ax, coloring)
    return ax


def _seen(
    mesh: Any, role: str, values: Any, label: str, explode: float, section: Any, cut: str, together: Any
) -> tuple[list[Item], Coloring | None]:
    """What is seen of a mesh or a body, and the colors of its cells."""
    if cut not in CUTS:
        raise InputError(f"cut must be 'cells' or 'flat', not {cut!r}")
    cells = not isinstance(mesh, Outline | DomainError)
    if not cells and (section is not None or together is not None):
        raise InputError("section and together are options of meshes, not of a Domain")
    coloring = cell_coloring(mesh, values, label) if cells and values is not None else None
    faces = cells and (
        section is not None
        or together is not None
        or (coloring is not None and coloring.by_vertex)
        or needs_faces(mesh, colored=coloring is not None)
    )
    if not faces:
        return mesh_items3(mesh, role, values), coloring
    plane = None if section is None else as_plane(section)
    parts = None
    if explode:
        size = mesh.size
        parts = np.arange(size)
        if isinstance(together, str):
            parts = np.asarray(mesh.markers.get(together, ()))
        elif together is not None:
            parts = np.asarray(together)
        if parts.shape != (size,) or parts.dtype.kind not in "iu":
            raise InputError(
                f"together must be a marker of cells, or one integer per cell, shape ({size},), "
                f"not {together!r}"
            )
    flat = cut == "flat"
    items = solid_items(mesh, role, coloring, plane=plane, flat=flat, parts=parts, explode=explode)
    return items, coloring


def things_of(
    items: list[Item], center: np.ndarray, radius: float, turn: np.ndarray, explode: float
) -> list[tuple]:
    """The things to be drawn, as tuples ``(depth, item, kind, corners, extra)``.

    Faces of closed surfaces that point away from the reader are left out.
    """
    things: list[tuple] = []
    # Faces are ordered by their middles. Edges, points and texts are moved forward by so many radii of the
    # scene, so that faces do not cover them.
    lift = {"segments": 0.05, "points": 0.45, "spheres": 9.0, "labels": 10.0}
    for item in items:
        points, kind, data = np.reshape(item["points"], (-1, 3)), item["kind"], item["data"]
        colors, up = item.get("colors"), item.get("lift", 0.0) * radius
        if kind in ("cells", "polygons", "segments"):
            sizes = np.array([len(row) for row in data], dtype=int)
            for size in np.unique(sizes).tolist():
                which = np.flatnonzero(sizes == size)
                rows = np.array([data[j] for j in which.tolist()])
                if kind == "cells":
                    moved = points[rows] + explode * (points[rows].mean(axis=1, keepdims=True) - center)
                    sides = [(moved[:, face], which) for face in FACES[size]]
                else:
                    sides = [(points[rows], which)]
                for corners, mine in sides:
                    name = "polygons" if kind == "cells" else kind
                    if item.get("closed"):
                        flat = np.arange(corners.size // 3).reshape(len(corners), -1)
                        near = face_normals((corners.reshape(-1, 3) - center) / radius, flat) @ turn[2] > 0
                        corners, mine = corners[near], mine[near]
                    depth = (corners.mean(axis=1) - center) @ turn[2] + up + lift.get(name, 0.0) * radius
                    more = [None] * len(mine) if colors is None else [colors[j] for j in mine.tolist()]
                    things += [
                        (d, item, name, row, color) for d, row, color in zip(depth.tolist(), corners, more)
                    ]
            continue
        for j, row in enumerate(data):
            extra = item["text"][j] if kind == "labels" else row[3:]
            place = np.reshape(row[:3], (1, 3))
            depth = float((place[0] - center) @ turn[2]) + lift.get(kind, 0.0) * radius
            things.append((depth, item, kind, place, extra))
    return things


def _paint(ax: Axes, things: list[tuple], center: np.ndarray, turn: np.ndarray, z: int) -> None:
    """Draw a run of things of one item and kind, from back to front."""
    _, item, kind, _, _ = things[0]
    style, line, opacity = style_of(item["role"]), line_style(item["role"]), item.get("opacity", 1.0)
    flat = [(np.asarray(t[3]) - center) @ turn[:2].T for t in things]
    if kind == "polygons":
        thin = THIN * style.width * min(1.0, max(0.2, (MANY_FACES / len(things)) ** 0.5))
        ax.add_collection(
            PolyCollection(
                flat,
                facecolors=_shades(style, things, turn),
                edgecolors=style.color,
                linewidths=thin,
                linestyles=[line["linestyle"]],
                alpha=opacity,
                zorder=z,
                joinstyle="round",
            )
        )
    elif kind == "segments":
        ax.add_collection(LineCollection(flat, alpha=opacity, zorder=z, **line))
    elif kind == "points":
        marks(ax, np.concatenate(flat), item["role"], z, opacity)
    elif kind == "labels":
        for place, thing in zip(np.concatenate(flat), things):
            write_label(ax, place, thing[4], style.ink, opacity, z)
    else:
        circle = np.linspace(0, 2 * np.pi, 73)
        ring = np.column_stack([np.cos(circle), np.sin(circle)])
        for middle, thing in zip(np.concatenate(flat), things):
            around = middle + thing[4][0] * ring
            ax.fill(*around.T, color=style.fill, alpha=0.1 * opacity, linewidth=0, zorder=z)
            ax.plot(*around.T, alpha=opacity, zorder=z, **line)
            equator = middle + thing[4][0] * ring * [1, abs(turn[1, :2] @ turn[1, :2]) ** 0.5]
            ax.plot(*equator.T, alpha=0.6 * opacity, zorder=z, **{**line, "linewidth": 0.6 * style.width})


def _shades(style: Any, things: list[tuple], turn: np.ndarray) -> np.ndarray:
    """The fill colors; faces toward the light, which is above the reader's left shoulder, are brighter."""
    normals = np.zeros((len(things), 3))
    sizes = np.array([len(t[3]) for t in things])
    for size in np.unique(sizes).tolist():
        which = np.flatnonzero(sizes == size)
        corners = np.array([things[k][3] for k in which.tolist()])
        spokes = corners - corners[:, :1]
        longest = np.abs(spokes).max(axis=(1, 2), keepdims=True)  # so that squares do not overflow
        spokes /= np.where(longest > 0, longest, 1.0)
        normals[which] = face_normals(spokes.reshape(-1, 3), np.arange(spokes.size // 3).reshape(-1, size))
    light = np.array([-0.35, 0.5, 1.0]) @ turn
    length = np.linalg.norm(normals, axis=1) * np.linalg.norm(light)
    facing = np.abs(normals @ light) / np.where(length > 0, length, 1.0)
    plain = 1 + (np.array(to_rgb(style.fill)) - 1) * max(style.alpha, 0.35)
    known = {color: plain if color is None else to_rgb(color) for color in {t[4] for t in things}}
    return np.array([known[t[4]] for t in things]) * (0.66 + 0.34 * facing)[:, None]
