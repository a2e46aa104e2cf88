"""Views of objects in space: a widget that the reader can turn, and the same picture by matplotlib.

A scene is a list of items like those of a frame, but with their own points ``(n, 3)``:
``{"kind": …, "role": …, "points": …, "data": …}``. The rows of *data* are corners (indices) of ``cells``
(tetrahedra), ``polygons`` or ``segments``, or coordinates of ``points`` and ``labels``, or ``[x, y, z, r]``
of ``spheres``. Both renderers paint from back to front, which needs no graphics card. If large faces overlap
in depth, that order can be wrong.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import anywidget
import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import traitlets
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize, to_hex, to_rgb

from ...base.errors import DomainError, InputError
from ...geometry.outline import Outline
from ...mesh.cells import incident_facets
from .bodies import body_parts
from .colors import line_style, styles
from .colors import role as style_of
from .stills import STILL_DPI, picture_of, with_still
from .strips import fit, flat_axes, marks
from .strips import label as write_label

__all__ = ["Space", "item3", "mesh_items3", "picture", "view3d"]

DRAW_FOLDER = Path(__file__).parent
SPACE_KINDS = ("cells", "polygons", "segments", "points", "labels", "spheres")
TETRAHEDRON_FACES = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))
MANY_CELLS = 2500  # with more tetrahedra than this, only the boundary is drawn
MOST_FACES = 20000  # the largest number of faces in the widget; with more, turning is not smooth
THIN = 0.6  # the width of the edges of faces, relative to the role's width, because many are visible at once
Item = dict[str, Any]


class Space(anywidget.AnyWidget):
    """A scene in space that is turned by dragging or with the arrow keys; see `view3d`."""

    _esm = DRAW_FOLDER / "space.js"
    _css = DRAW_FOLDER / "player.css"
    scene = traitlets.Dict().tag(sync=True)
    azimuth = traitlets.Float(-55.0).tag(sync=True)
    elevation = traitlets.Float(22.0).tag(sync=True)
    zoom = traitlets.Float(1.0).tag(sync=True)
    explode = traitlets.Float(0.0).tag(sync=True)
    caption = traitlets.Unicode().tag(sync=True)
    number = traitlets.Unicode().tag(sync=True)
    alt = traitlets.Unicode().tag(sync=True)
    size = traitlets.Int(420).tag(sync=True)
    styles = traitlets.Dict().tag(sync=True)

    def still(self) -> bytes:
        """The scene as it is turned now, as the bytes of a PNG file."""
        ax = plt.subplots(figsize=(self.size / STILL_DPI, self.size / STILL_DPI), dpi=STILL_DPI)[1]
        items = self.scene["items"]
        picture(items, ax, azimuth=self.azimuth, elevation=self.elevation, explode=self.explode)
        ax.set_title(self.caption, wrap=True)
        return picture_of(ax)

    def _repr_mimebundle_(self, **_: Any) -> Any:
        return with_still(super()._repr_mimebundle_(), self.still())

    def __repr__(self) -> str:
        return f"Space({self.alt})"


def item3(
    kind: str,
    role: str,
    data: Any,
    points: Any = (),
    *,
    text: Sequence[Any] | None = None,
    opacity: float = 1.0,
) -> Item:
    """One item of a scene; see the top of this module.

    Raises
    ------
    InputError
        For an unknown kind, an index outside ``points``, or coordinates that are not finite.
    """
    style_of(role)
    if kind not in SPACE_KINDS:
        raise InputError(f"no kind {kind!r} in space; use one of {', '.join(SPACE_KINDS)}")
    places = np.asarray(points, dtype=float).reshape(-1, 3)
    if kind in ("cells", "polygons", "segments"):
        rows = [[int(v) for v in row] for row in data]
        for j, row in enumerate(rows):
            if not row or min(row) < 0 or max(row) >= len(places):
                raise InputError(f"row {j} of {kind} is {row}, but there are {len(places)} points")
    else:
        rows = np.asarray(data, dtype=float).reshape(-1, 4 if kind == "spheres" else 3).tolist()
    if not (np.isfinite(places).all() and np.isfinite(np.concatenate([[0], *rows])).all()):
        raise InputError(f"{kind} must have finite coordinates")
    made: Item = {
        "kind": kind,
        "role": role,
        "points": places.tolist(),
        "data": rows,
        "opacity": float(opacity),
    }
    if kind == "labels":
        if text is None or len(text) != len(rows):
            raise InputError(f"{len(rows)} labels need the same number of texts")
        made["text"] = [str(t) for t in text]
    return made


def mesh_items3(mesh: Any, role: str = "cell", values: Any = None, *, only: Any = None) -> list[Item]:
    """A mesh in space as items: tetrahedra, or faces and edges; large solids are shown by their boundary.

    Other solids and mixtures are always shown by their boundary. ``values`` gives the cells colors, in that
    case by their faces; ``only`` selects some of the cells (indices or a mask).
    """
    if isinstance(mesh, Outline | DomainError):
        return domain_items3(mesh)
    points = np.asarray(mesh.points, dtype=float)
    if points.shape[1] not in (2, 3):
        raise InputError(
            f"a view in space cannot show {points.shape[1]} dimensions; project the points first"
        )
    points = np.column_stack([points, np.zeros((len(points), 3 - points.shape[1]))])
    blocks = dict(getattr(mesh, "cells", None) or {"": mesh.simplices})
    if only is not None and not getattr(mesh, "is_simplicial", True):
        return mesh_items3(mesh.select(only), role, values)
    if only is not None:
        blocks = {"": np.asarray(mesh.simplices)[only]}
    large = sum(map(len, blocks.values())) > MANY_CELLS and values is None and only is None
    items = []
    for name, block in blocks.items():
        size = len(block[0]) if len(block) else 3
        kind = {1: "points", 2: "segments", 4: "cells"}.get(size, "polygons")
        if name in ("quad", "polygon"):
            kind = "polygons"
        elif name in ("hexahedron", "wedge", "pyramid") or (kind == "cells" and large):
            return [_skin(mesh, role, points, values)]
        items.append(item3(kind, role, points[np.ravel(block)] if kind == "points" else block, points))
    if values is not None:
        _color(items, np.asarray(values, dtype=float))
    return items


def domain_items3(domain: Outline | DomainError) -> list[Item]:
    """A body in space, or the one that an error refused with its faults marked, as items."""
    outline: Outline = domain.outline if isinstance(domain, DomainError) else domain
    if outline.points.shape[1] != 3:
        raise InputError("a view in space shows bodies in space; plot draws planar domains")
    faults = domain.faults if isinstance(domain, DomainError) else ()
    parts = body_parts(outline, faults=faults)
    return [item3(kind, role, *rest, **more) for kind, role, *rest, more in parts]


def _skin(mesh: Any, role: str, points: np.ndarray, values: Any) -> Item:
    """The boundary of a solid as an item; each face has the color of its cell."""
    rows, owner, group = incident_facets(mesh.cells)
    outer = np.bincount(group)[group] == 1
    item = item3("polygons", role, [[v for v in row if v >= 0] for row in rows[outer].tolist()], points)
    if values is not None:
        values = np.asarray(values, dtype=float)
        if values.shape != (mesh.size,):
            raise InputError(f"values must have one entry per cell, shape ({mesh.size},), not {values.shape}")
        _color([item], values[owner[outer]], _scale(values))
    return item


def _color(items: list[Item], values: np.ndarray, scale: Normalize | None = None) -> None:
    count = sum(len(i["data"]) for i in items)
    if values.shape != (count,):
        raise InputError(f"values must have one entry per cell, shape ({count},), not {values.shape}")
    colors = iter([to_hex(c) for c in matplotlib.colormaps["cividis"]((scale or _scale(values))(values))])
    for one in items:
        one["colors"] = [next(colors) for _ in one["data"]]


def _scale(values: np.ndarray) -> Normalize:
    finite = values[np.isfinite(values)]
    return Normalize(float(finite.min()), float(finite.max())) if len(finite) else Normalize(0, 1)


def view3d(
    mesh: Any,
    *,
    alt: str,
    role: str = "cell",
    values: Any = None,
    caption: str = "",
    number: str = "",
    azimuth: float = -55.0,
    elevation: float = 22.0,
    explode: float = 0.0,
    size: int = 420,
) -> Space:
    """Show a mesh, a body or a scene that the reader turns by dragging or with the arrow keys.

    A slider moves the cells apart.

    Parameters
    ----------
    mesh : Mesh, Domain, DomainError or list of dict
        Tetrahedra, a surface or edges; a body in space, or the error that refused it, with its faults marked;
        or items made by `item3` and `mesh_items3`.
    alt : str
        A sentence for readers who cannot see the picture.
    role, values
        As in `unstruct.view.plot`.
    caption, number : str
        Texts above and below the picture.
    azimuth, elevation : float
        The direction from which the reader looks at first, in degrees.
    explode : float
        How far cells are moved apart, from 0 (not at all) to 1.5.
    size : int
        The side length of the picture in pixels.

    Raises
    ------
    InputError
        If ``alt`` is empty, or if there are more than 20,000 faces; `unstruct.view.plot` can draw these.
    """
    if not alt.strip():
        raise InputError("alt must describe the picture for readers who cannot see it")
    items = mesh if isinstance(mesh, list) else mesh_items3(mesh, role, values)
    faces = sum(len(i["data"]) * (4 if i["kind"] == "cells" else 1) for i in items)
    if faces > MOST_FACES:
        raise InputError(f"{faces} faces are too many to turn smoothly (at most {MOST_FACES}); use plot")
    ball = _ball(items)
    digits = 5 - int(np.floor(np.log10(ball[3])))
    scene = {"ball": ball, "items": [{**i, "points": np.round(i["points"], digits).tolist()} for i in items]}
    return Space(
        scene=scene,
        alt=alt.strip(),
        styles=styles(),
        caption=caption,
        number=number,
        azimuth=azimuth,
        elevation=elevation,
        explode=explode,
        size=size,
    )


def _ball(items: list[Item]) -> list[float]:
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
    radius = float(np.linalg.norm(flat - center, axis=1).max())
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
) -> Axes:
    """The static form of `view3d`, with the same parameters and a color bar ``label`` for ``values``."""
    items = mesh if isinstance(mesh, list) else mesh_items3(mesh, role, values)
    ax = flat_axes(ax)
    x, y, z, radius = _ball(items)
    center, turn = np.array([x, y, z]), axes3(azimuth, elevation)
    things = _things(items, center, radius, turn, explode)
    things.sort(key=lambda thing: thing[0])
    start = 0
    for k in range(1, len(things) + 1):  # consecutive things of one item and kind are drawn together
        if k == len(things) or things[k][1] is not things[start][1] or things[k][2] != things[start][2]:
            _paint(ax, things[start:k], center, turn, z=2 + start)
            start = k
    corners = [(np.asarray(t[3]) - center) @ turn[:2].T for t in things]
    corners += [c + t[4][0] * s for c, t in zip(corners, things) if t[2] == "spheres" for s in (-1, 1)]
    fit(ax, np.concatenate(corners) if corners else np.zeros((1, 2)), 0.06)
    if values is not None:
        scale = matplotlib.cm.ScalarMappable(_scale(np.asarray(values, dtype=float)), "cividis")
        ax.figure.colorbar(scale, ax=ax, shrink=0.75, label=label, pad=0.02)
    return ax


def _things(
    items: list[Item], center: np.ndarray, radius: float, turn: np.ndarray, explode: float
) -> list[tuple]:
    """The things to be drawn, as tuples ``(depth, item, kind, corners, extra)``."""
    things: list[tuple] = []
    # Faces are ordered by their middles. Edges, points and texts are moved forward by so many radii of the
    # scene, so that faces do not cover them.
    lift = {"segments": 0.05, "points": 0.45, "spheres": 9.0, "labels": 10.0}
    for item in items:
        points = np.reshape(item["points"], (-1, 3))
        for j, row in enumerate(item["data"]):
            kind, extra = item["kind"], item.get("colors", [None] * (j + 1))[j]
            if kind == "cells":
                moved = points[row] + explode * (points[row].mean(axis=0) - center)
                parts = [("polygons", moved[list(face)], extra) for face in TETRAHEDRON_FACES]
            elif kind in ("polygons", "segments"):
                parts = [(kind, points[row], extra)]
            else:
                extra = item["text"][j] if kind == "labels" else row[3:]
                parts = [(kind, np.reshape(row[:3], (1, 3)), extra)]
            for name, corners, more in parts:
                depth = float((corners.mean(axis=0) - center) @ turn[2]) + lift.get(name, 0.0) * radius
                things.append((depth, item, name, corners, more))
    return things


def _paint(ax: Axes, things: list[tuple], center: np.ndarray, turn: np.ndarray, z: int) -> None:
    """Draw a run of things of one item and kind, from back to front."""
    _, item, kind, _, _ = things[0]
    style, line, opacity = style_of(item["role"]), line_style(item["role"]), item.get("opacity", 1.0)
    flat = [(np.asarray(t[3]) - center) @ turn[:2].T for t in things]
    if kind == "polygons":
        faces = [_shade(style, t[4], t[3], turn) for t in things]
        ax.add_collection(
            PolyCollection(
                flat,
                facecolors=faces,
                edgecolors=style.color,
                linewidths=THIN * style.width,
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
            write_label(ax, place, thing[4], style.color, opacity, z)
    else:
        circle = np.linspace(0, 2 * np.pi, 73)
        ring = np.column_stack([np.cos(circle), np.sin(circle)])
        for middle, thing in zip(np.concatenate(flat), things):
            around = middle + thing[4][0] * ring
            ax.fill(*around.T, color=style.fill, alpha=0.1 * opacity, linewidth=0, zorder=z)
            ax.plot(*around.T, alpha=opacity, zorder=z, **line)
            equator = middle + thing[4][0] * ring * [1, abs(turn[1, :2] @ turn[1, :2]) ** 0.5]
            ax.plot(*equator.T, alpha=0.6 * opacity, zorder=z, **{**line, "linewidth": 0.6 * style.width})


def _shade(style: Any, color: str | None, corners: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """The fill color; faces toward the light, which is above the reader's left shoulder, are brighter."""
    first, second = corners[1] - corners[0], corners[2] - corners[0]
    longest = max(np.abs(first).max(), np.abs(second).max()) or 1.0  # so that squares do not overflow
    normal = np.cross(first / longest, second / longest)
    light = np.array([-0.35, 0.5, 1.0]) @ turn
    facing = abs(normal @ light) / (np.linalg.norm(normal) * np.linalg.norm(light) or 1)
    base = (
        np.array(to_rgb(color)) if color else 1 + (np.array(to_rgb(style.fill)) - 1) * max(style.alpha, 0.35)
    )
    return base * (0.66 + 0.34 * facing)
