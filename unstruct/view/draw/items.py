"""Meshes and bodies as items of scenes in space; see `unstruct.view.draw.space`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from ...base.errors import DomainError, InputError
from ...geometry.outline import Outline
from ...mesh.cells import cell_rows
from .bodies import body_parts
from .coloring import Coloring, cell_coloring
from .colors import role as style_of
from .sections import FACES, SOLIDS, Plane, shown_faces

__all__ = ["cut_items", "item3", "mesh_items3", "needs_faces", "solid_items"]

SPACE_KINDS = ("cells", "polygons", "segments", "points", "labels", "spheres")
MANY_CELLS = 2500  # with more tetrahedra than this, only the boundary is drawn
INNER = "#a9cfe6"  # the color of faces that a section uncovers, unless cells have colors
CAP_LIFT = 4.0  # the section of a plane is painted after everything behind it: so many radii of the scene
Item = dict[str, Any]


def item3(
    kind: str,
    role: str,
    data: Any,
    points: Any = (),
    *,
    text: Sequence[Any] | None = None,
    opacity: float = 1.0,
) -> Item:
    """One item of a scene; see `unstruct.view.draw.space`.

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
            if kind == "cells" and len(row) not in SOLIDS:
                raise InputError(f"row {j} of cells has {len(row)} corners; a solid has 4, 5, 6 or 8")
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


def mesh_items3(
    mesh: Any, role: str = "cell", values: Any = None, *, only: Any = None, whole: bool = False
) -> list[Item]:
    """A mesh in space as items: tetrahedra, or faces and edges; large solids are shown by their boundary.

    Other solids and mixtures are shown by their boundary, too, unless all cells are wanted ``whole``.
    ``values`` gives the cells colors, as in `unstruct.view.plot`; ``only`` selects some of the cells (indices
    or a mask).
    """
    if isinstance(mesh, Outline | DomainError):
        return domain_items3(mesh)
    points, blocks = _points3(mesh), _blocks(mesh)
    if only is not None and not getattr(mesh, "is_simplicial", True):
        return mesh_items3(mesh.select(only), role, values, whole=whole)
    if only is not None:
        blocks = {next(iter(blocks)): np.asarray(mesh.simplices)[only]}
    coloring = None
    if values is not None:
        coloring = cell_coloring(mesh, values, count=sum(map(len, blocks.values())))
    if not whole and only is None and needs_faces(mesh, colored=values is not None):
        return solid_items(mesh, role, coloring)
    items = []
    for name, block in blocks.items():
        size = len(block[0]) if len(block) else 3
        kind = {1: "points", 2: "segments"}.get(size, "polygons")
        if name not in ("quad", "polygon") and size in SOLIDS:
            kind = "cells"
        items.append(item3(kind, role, points[np.ravel(block)] if kind == "points" else block, points))
    if coloring is not None:
        colors = coloring.of_cells(blocks)
        start = 0
        for one in items:
            one["colors"] = colors[start : start + len(one["data"])]
            start += len(one["data"])
    return items


def _points3(mesh: Any) -> np.ndarray:
    """The points of a mesh, those of the plane with the third coordinate zero."""
    points = np.asarray(mesh.points, dtype=float)
    if points.shape[1] not in (2, 3):
        raise InputError(
            f"a view in space cannot show {points.shape[1]} dimensions; project the points first"
        )
    return np.column_stack([points, np.zeros((len(points), 3 - points.shape[1]))])


def _blocks(mesh: Any) -> dict[str, Any]:
    """The cells of a mesh by kind; of other objects with simplices, by those."""
    given = getattr(mesh, "cells", None)
    return dict(given) if given else {"": np.asarray(mesh.simplices)}


def needs_faces(mesh: Any, *, colored: bool = False) -> bool:
    """Whether a mesh is shown by its boundary: many tetrahedra, and solids of other kinds."""
    blocks = _blocks(mesh)
    other = any(name in ("hexahedron", "wedge", "pyramid") for name in blocks)
    sizes = {
        len(block[0]) for name, block in blocks.items() if len(block) and name not in ("quad", "polygon")
    }
    return other or (not colored and 4 in sizes and sum(map(len, blocks.values())) > MANY_CELLS)


def domain_items3(domain: Outline | DomainError) -> list[Item]:
    """A body in space, or the one that an error refused with its faults marked, as items."""
    outline: Outline = domain.outline if isinstance(domain, DomainError) else domain
    if outline.points.shape[1] != 3:
        raise InputError("a view in space shows bodies in space; plot draws planar domains")
    faults = domain.faults if isinstance(domain, DomainError) else ()
    parts = body_parts(outline, faults=faults)
    return [item3(kind, role, *rest, **more) for kind, role, *rest, more in parts]


def solid_items(
    mesh: Any,
    role: str = "cell",
    coloring: Coloring | None = None,
    *,
    plane: Plane | None = None,
    flat: bool = False,
    parts: np.ndarray | None = None,
    explode: float = 0.0,
) -> list[Item]:
    """The faces that can be seen of a solid or a surface, each with the color of its cell or its vertices.

    Faces that a plane uncovers have another color than the boundary, unless all have colors.

    Parameters
    ----------
    mesh : Mesh
    role : str
    coloring : Coloring, optional
    plane, flat
        As in `shown_faces`.
    parts : ndarray of int, shape (m,), optional
        The part of each cell; parts are moved away from the middle by ``explode`` times their distance.
    """
    points, cells = _points3(mesh), _blocks(mesh)
    if "" in cells:
        cells = {SOLIDS.get(cells[""].shape[1], "triangle"): cells[""]}
    shown = shown_faces(points, cells, plane, flat=flat, parts=parts)
    places, rows = shown.extended(points), shown.rows
    if parts is not None and explode and len(rows):
        part = np.unique(parts, return_inverse=True)[1]
        centers = np.column_stack([np.bincount(part, column) for column in _centers(points, cells).T])
        moved = explode * (centers / np.bincount(part)[:, None] - places[np.unique(rows[rows >= 0])].mean(0))
        pairs, again = np.unique(
            part[shown.owner][:, None] * len(places) + np.maximum(rows, 0), return_inverse=True
        )
        places = places[pairs % len(places)] + moved[pairs // len(places)]
        rows = np.where(rows < 0, -1, again.reshape(rows.shape))
    colors: list[str | None] | None = None if coloring is None else [*coloring.of_faces(shown)]
    if colors is None and plane is not None:
        colors = [INNER if inner else None for inner in shown.inner.tolist()]
    solid = all(name in SOLIDS.values() for name in cells)
    items = []
    for cap in (False, True):
        which = shown.cap == cap
        if which.any() or not cap:
            data = [[v for v in row if v >= 0] for row in rows[which].tolist()]
            one: Item = {"kind": "polygons", "role": role, "points": places.tolist(), "data": data}
            one |= {"opacity": 1.0, "closed": solid, "lift": CAP_LIFT * (cap and parts is None)}
            if colors is not None:
                one["colors"] = [color for color, mine in zip(colors, which.tolist()) if mine]
            items.append(one)
    return items


def _centers(points: np.ndarray, cells: dict[str, Any]) -> np.ndarray:
    """The mean of the corners of each cell."""
    indptr, corners = cell_rows(cells)
    return np.add.reduceat(points[corners], indptr[:-1]) / np.diff(indptr)[:, None]


def cut_items(items: list[Item], plane: Plane, explode: float) -> list[Item]:
    """A scene without the solid cells beyond a plane, and without the faces between those that touch."""
    made = []
    for item in items:
        if item["kind"] != "cells":
            made.append(item)
            continue
        points = np.reshape(item["points"], (-1, 3))
        kept = [j for j, row in enumerate(item["data"]) if plane.heights(points[row].mean(axis=0)) <= 0]
        colors = item.get("colors")
        one = {**item, "data": [item["data"][j] for j in kept]}
        if colors is not None:
            one["colors"] = [colors[j] for j in kept]
        made.append(one if explode else _joined(one, points, item["data"]))
    return made


def _joined(item: Item, points: np.ndarray, every: list[list[int]]) -> Item:
    """Solid cells as the faces that can be seen of them; of all cells, some can be hidden."""
    sides = Counter(frozenset(row[v] for v in face) for row in every for face in FACES[len(row)])
    order = sorted(range(len(item["data"])), key=lambda j: len(item["data"][j]))
    cells = {}
    for size, name in SOLIDS.items():
        rows = [item["data"][j] for j in order if len(item["data"][j]) == size]
        if rows:
            cells[name] = np.array(rows)
    shown = shown_faces(points, cells)
    data = [[v for v in row if v >= 0] for row in shown.rows.tolist()]
    one = {**item, "kind": "polygons", "data": data, "closed": item.get("opacity", 1.0) == 1.0}
    one["colors"] = [INNER if sides[frozenset(row)] > 1 else None for row in data]
    if "colors" in item:
        one["colors"] = [item["colors"][order[cell]] for cell in shown.owner.tolist()]
    return one
