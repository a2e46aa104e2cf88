"""Views of objects in space: a widget that the reader can turn, and the same picture by matplotlib.

A scene is a list of items like those of a frame, but with their own points ``(n, 3)``:
``{"kind": …, "role": …, "points": …, "data": …}``. The rows of *data* are corners (indices) of ``cells``
(tetrahedra), ``polygons`` or ``segments``, or coordinates of ``points`` and ``labels``, or ``[x, y, z, r]``
of ``spheres``. Both renderers paint from back to front, which needs no graphics card. If large faces overlap
in depth, that order can be wrong.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import anywidget
import matplotlib.pyplot as plt
import numpy as np
import traitlets

from ...base.errors import InputError
from .colors import styles
from .items import Item, cut_items, mesh_items3
from .painting import ball_around, picture
from .sections import Plane, as_plane
from .stills import STILL_DPI, picture_of, with_still

__all__ = ["Space", "view3d"]

DRAW_FOLDER = Path(__file__).parent
FACES_OF = {4: 4, 5: 5, 6: 5, 8: 6}  # by the number of corners of a cell
MOST_FACES = 20000  # the largest number of faces in the widget; with more, turning is not smooth


class Space(anywidget.AnyWidget):
    """A scene in space that is turned by dragging or with the arrow keys; see `view3d`."""

    _esm = DRAW_FOLDER / "space.js"
    _css = DRAW_FOLDER / "player.css"
    scene = traitlets.Dict().tag(sync=True)
    azimuth = traitlets.Float(-55.0).tag(sync=True)
    elevation = traitlets.Float(22.0).tag(sync=True)
    zoom = traitlets.Float(1.0).tag(sync=True)
    explode = traitlets.Float(0.0).tag(sync=True)
    section = traitlets.Float(1.0).tag(sync=True)
    caption = traitlets.Unicode().tag(sync=True)
    number = traitlets.Unicode().tag(sync=True)
    alt = traitlets.Unicode().tag(sync=True)
    size = traitlets.Int(420).tag(sync=True)
    styles = traitlets.Dict().tag(sync=True)

    def still(self) -> bytes:
        """The scene as it is turned now, as the bytes of a PNG file."""
        ax = plt.subplots(figsize=(self.size / STILL_DPI, self.size / STILL_DPI), dpi=STILL_DPI)[1]
        items = self.scene["items"]
        if "section" in self.scene:
            normal, low, high = (np.array(self.scene["section"][k]) for k in ("normal", "low", "high"))
            plane = Plane((low + self.section * (high - low)) * normal, normal)
            items = cut_items(items, plane, self.explode)
        picture(items, ax, azimuth=self.azimuth, elevation=self.elevation, explode=self.explode)
        ax.set_title(self.caption, wrap=True)
        return picture_of(ax)

    def _repr_mimebundle_(self, **_: Any) -> Any:
        return with_still(super()._repr_mimebundle_(), self.still())

    def __repr__(self) -> str:
        return f"Space({self.alt})"


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
    section: Any = None,
    size: int = 420,
) -> Space:
    """Show a mesh, a body or a scene that the reader turns by dragging or with the arrow keys.

    A slider moves the cells apart, another one the plane of a section. Both move without a kernel, too.

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
    section : optional
        A plane as in `unstruct.view.plot`, which a second slider moves along its normal: solid cells whose
        middle is beyond it are hidden. The picture begins with this plane.
    size : int
        The side length of the picture in pixels.

    Raises
    ------
    InputError
        If ``alt`` is empty, if there is a section but no solid cell, or if there are too many faces to turn
        smoothly: more than 20,000, or under a section, for which all cells are there, 40,000, counted for
        each cell (10,000 tetrahedra or 6,666 hexahedra). Without a section larger meshes of solid cells are
        shown by their boundary, and only its faces count. `unstruct.view.plot` has no such limit.
    """
    if not alt.strip():
        raise InputError("alt must describe the picture for readers who cannot see it")
    whole = section is not None
    items = mesh if isinstance(mesh, list) else mesh_items3(mesh, role, values, whole=whole)
    faces, most = sum(map(_faces, items)), MOST_FACES * (1 + whole)
    if faces > most:
        cells = sum(len(i["data"]) for i in items if i["kind"] == "cells")
        what = f"the {faces} faces of {cells} cells" if cells else f"{faces} faces"
        raise InputError(
            f"{what} are too many to turn smoothly (at most {most}): draw them with view.plot, which has "
            "section=, too, or show a part, mesh.select(...)"
        )
    ball = ball_around(items)
    digits = 5 - int(np.floor(np.log10(ball[3])))
    scene = {"ball": ball, "items": [{**i, "points": np.round(i["points"], digits).tolist()} for i in items]}
    start = 1.0
    if section is not None:
        scene["section"], start = _range(items, as_plane(section))
    return Space(
        scene=scene,
        section=start,
        alt=alt.strip(),
        styles=styles(),
        caption=caption,
        number=number,
        azimuth=azimuth,
        elevation=elevation,
        explode=explode,
        size=size,
    )


def _faces(item: Item) -> int:
    """How many faces, or other things, of an item are drawn."""
    if item["kind"] != "cells":
        return len(item["data"])
    return sum(FACES_OF.get(len(row), 4) for row in item["data"])


def _range(items: list[Item], plane: Plane) -> tuple[dict[str, Any], float]:
    """Where a plane can be moved, from below all solid cells to above them, and where it is between."""
    heights = [
        np.reshape(i["points"], (-1, 3))[np.unique(np.concatenate(i["data"]))] @ plane.normal
        for i in items
        if i["kind"] == "cells" and len(i["data"])
    ]
    if not heights:
        raise InputError("there are no solid cells that a plane can cut")
    low, high = float(np.concatenate(heights).min()), float(np.concatenate(heights).max())
    start = (float(plane.point @ plane.normal) - low) / ((high - low) or 1.0)
    return {"normal": plane.normal.tolist(), "low": low, "high": high}, min(1.0, max(0.0, start))
