"""Meshes joined at their common vertices: layers and what is beyond them, blocks, parts."""

from __future__ import annotations

from itertools import islice
from typing import Any

import numpy as np

from ..base.errors import InputError, MeshError
from ..base.telling import tell
from .adjacency import two_cells
from .cells import cell_rows
from .complex import CellComplex
from .contact import contacts
from .gmsh import stacked
from .grouping import group_rows
from .mesh import Mesh
from .naming import names_by_number
from .periodic import renumbered

__all__ = ["join"]

MOST_CONTACTS = 5  # pairs of meshes, and names, that a warning lists


def join(*meshes: Mesh) -> Mesh:
    """One mesh of the cells of several, in which vertices at the same place are one.

    Parameters
    ----------
    *meshes : Mesh
        Of equal dimensions, in the plane or in space, with cells of any kinds: wedges over a body, for
        example, and tetrahedra beyond their outer faces.

    Returns
    -------
    Mesh
        The first mesh keeps the numbers of its vertices and, within each kind, of its cells; the others
        follow. ``origin`` has the numbers that vertices have when all meshes are counted one after the other.
        Faces of equal names are one marker, and regions of equal names one region; regions without a name
        stay apart. "facets" has the named ends that are ends still; where the meshes meet, they are "inner".
        Markers of cells that a mesh does not have are 0, False or nan there.

    Raises
    ------
    InputError
        Without a mesh, and for meshes of different dimensions.
    MeshError
        If more than two cells would have a common facet (also where meshes overlap), if two vertices of one
        mesh are at a place of another one's, and if a name stands for cells here and for faces there.

    Notes
    -----
    Vertices are compared bit for bit, and those that no cell uses stay as they are. A warning says where
    meshes touch without common facets: whose corners are not quite at the same places, or which are divided
    differently, such as two triangles on a quadrilateral (up to a millionth of their length; `unstruct.check`
    is exact). Bodies that touch are meshed alike where they do if they are one domain: give common facets
    once, as ``inner``, and name the parts by ``regions``. O(n log n). Weights and hidden vertices are not
    kept.
    """
    for i, mesh in enumerate(meshes):
        if not isinstance(mesh, CellComplex):
            raise InputError(f"meshes[{i}] must be a Mesh, not a {type(mesh).__name__}")
        if (mesh.dimension, mesh.points.shape[1]) != (meshes[0].dimension, meshes[0].points.shape[1]):
            raise InputError(
                f"meshes[{i}] has cells of dimension {mesh.dimension} in {mesh.points.shape[1]} dimensions, "
                f"the first mesh {meshes[0].dimension} in {meshes[0].points.shape[1]}: they cannot be joined"
            )
    if not meshes:
        raise InputError("give at least one mesh to join")
    number, first = _numbered(meshes)
    ends = np.cumsum([len(mesh.points) for mesh in meshes])[:-1]
    numbers = np.split(number, ends)
    cells, places = _cells(meshes, numbers)
    if meshes[0].dimension == meshes[0].points.shape[1]:
        two_cells(cells)  # an error for facets of more than two cells
    duplicates = [n[mesh.duplicates] for mesh, n in zip(meshes, numbers)]
    markers, regions = _cell_markers(meshes, places)
    bare = CellComplex(np.concatenate([mesh.points for mesh in meshes])[first], cells=cells)
    joined = Mesh(
        bare.points,
        cells=bare.cells,
        origin=first,
        duplicates=np.concatenate(duplicates),
        markers=markers | _face_markers(meshes, numbers, bare, set(markers)),
        regions=regions,
        periodic=[each for mesh, n in zip(meshes, numbers) for each in renumbered(mesh.periodic, n)],
    )
    _tell_contacts(joined, places)
    return joined


def _tell_contacts(mesh: Mesh, places: list[np.ndarray]) -> None:
    """Warn where meshes touch and have no common faces there."""
    if len(places) < 2 or mesh.dimension not in (2, 3) or mesh.points.shape[1] > 3:
        return
    owner = np.empty(mesh.size, dtype=np.int64)
    for i, place in enumerate(places):
        owner[place] = i
    what = "edges" if mesh.dimension == 2 else "faces"
    for found in islice(contacts(mesh.points, mesh.cells, owner), MOST_CONTACTS):
        parts = []
        for which, rows in ((found.first, found.faces), (found.second, found.others)):
            names = [name for name, faces in mesh.markers.items() if faces.ndim == 2 and _any_in(rows, faces)]
            names = [repr(name) for name in names if name not in ("facets", "inner")] or ["no name"]
            parts.append(f"{len(rows)} {what} of meshes[{which}] ({', '.join(names[:MOST_CONTACTS])})")
        row = found.faces[0]
        place = mesh.points[row[row >= 0]].mean(axis=0)
        remedy = (
            f"their corners are up to {found.gap:.2g} apart: give them the same coordinates"
            if np.isfinite(found.gap)
            else "they are divided differently: mesh one with the faces of the other"
        )
        tell(
            f"not joined: {' lie on '.join(parts)}, first at {np.round(place, 6).tolist()} (vertices "
            f"{row[row >= 0].tolist()}); {remedy}"
        )


def _any_in(rows: np.ndarray, faces: np.ndarray) -> bool:
    """Whether some of the rows are among the faces of a marker."""
    return faces.shape[1] <= rows.shape[1] and len(faces) > 0 and bool(_among(rows, faces).any())


def _numbered(meshes: tuple[Mesh, ...]) -> tuple[np.ndarray, np.ndarray]:
    """The number in the whole of each vertex of all meshes; and the first vertex that each number is of."""
    points = np.concatenate([mesh.points for mesh in meshes])
    sizes = [len(mesh.points) for mesh in meshes]
    starts = np.cumsum([0, *sizes[:-1]])
    of = np.repeat(np.arange(len(meshes)), sizes)
    used = np.zeros(len(points), dtype=bool)
    for mesh, start in zip(meshes, starts.tolist()):
        used[cell_rows(mesh.cells)[1] + start] = True
    rows = np.flatnonzero(used)
    order = rows[np.lexsort((rows, *points[rows].T[::-1]))]
    same = np.append(False, (points[order[1:]] == points[order[:-1]]).all(axis=1)) if len(order) else used[:0]
    group = np.cumsum(~same)
    begin = np.flatnonzero(~same)
    low, high = np.minimum.reduceat(of[order], begin), np.maximum.reduceat(of[order], begin)
    shared = (low < high)[group - 1]  # a place of several meshes
    twice = same & shared & np.append(False, of[order[1:]] == of[order[:-1]])
    if twice.any():
        at = int(np.argmax(twice))
        v, owner = int(order[at]), int(of[order[at]])
        one, two = (int(w) - int(starts[owner]) for w in (order[at - 1], v))
        raise MeshError(
            f"vertices {one} and {two} of meshes[{owner}] are both at {points[v].tolist()}, where another "
            "mesh has a vertex: join vertices of one mesh first, or move them"
        )
    keeper = np.arange(len(points))
    keeper[order] = np.where(shared, order[begin][group - 1], order)
    first = np.flatnonzero(keeper == np.arange(len(points)))
    place = np.full(len(points), -1)
    place[first] = np.arange(len(first))
    return place[keeper].astype(np.int32), first.astype(np.int32)


def _cells(meshes: tuple[Mesh, ...], numbers: list[np.ndarray]) -> tuple[dict[str, Any], list[np.ndarray]]:
    """All cells by kind, and the place among them of each cell of each mesh."""
    blocks: dict[str, list[tuple[int, Any]]] = {}
    for i, (mesh, n) in enumerate(zip(meshes, numbers)):
        for kind, block in mesh.cells.items():
            rows = [n[row] for row in block] if kind == "polygon" else n[block]
            blocks.setdefault(kind, []).append((i, rows))
    if len(blocks) > 1:  # empty kinds are for meshes without any cell
        blocks = {k: parts for k, parts in blocks.items() if any(len(rows) for _, rows in parts)} or blocks
    place: dict[tuple[int, str], np.ndarray] = {}
    cells: dict[str, Any] = {}
    start = 0
    for kind, parts in blocks.items():
        cells[kind] = (
            [row for _, rows in parts for row in rows]
            if kind == "polygon"
            else np.concatenate([rows for _, rows in parts])
        )
        for i, rows in parts:
            place[i, kind] = start + np.arange(len(rows))
            start += len(rows)
    places = [
        np.concatenate([np.empty(0, dtype=np.int64), *(place[i, k] for k in mesh.cells if (i, k) in place)])
        for i, mesh in enumerate(meshes)  # in the order of the mesh's own kinds
    ]
    return cells, places


def _cell_markers(
    meshes: tuple[Mesh, ...], places: list[np.ndarray]
) -> tuple[dict[str, np.ndarray], dict[str, int]]:
    """Markers of cells, and the numbers of regions by name."""
    size = sum(mesh.size for mesh in meshes)
    names = dict.fromkeys(name for mesh in meshes for name, rows in mesh.markers.items() if rows.ndim == 1)
    regions, region = _regions(meshes) if "region" in names else ({}, [])
    markers = {}
    for name in names:
        given = [mesh.markers.get(name) for mesh in meshes]
        for i, values in enumerate(given):
            if values is not None and values.ndim != 1:
                raise MeshError(f"{name!r} stands for faces in meshes[{i}], and for cells in another mesh")
        parts = region if name == "region" and region else given
        kind = np.result_type(*(values.dtype for values in parts if values is not None))
        column = np.full(size, np.nan, dtype=kind) if kind.kind == "f" else np.zeros(size, dtype=kind)
        for values, place in zip(parts, places):
            if values is not None:
                column[place] = values
        markers[name] = column
    return markers, regions


def _regions(meshes: tuple[Mesh, ...]) -> tuple[dict[str, int], list[np.ndarray]]:
    """One number for each name, then one for each region of each mesh without a name; those of the cells."""
    regions: dict[str, int] = {}
    for mesh in meshes:
        for name in mesh.regions:
            regions.setdefault(name, len(regions))
    free = len(regions)
    columns = []
    for mesh in meshes:
        given = mesh.markers.get("region")
        if given is not None and given.dtype.kind not in "iub":
            return {}, []  # these are no numbers of regions
        values = np.zeros(mesh.size, dtype=np.int64) if given is None else given.astype(np.int64)
        called = names_by_number(mesh.regions)
        different, which = np.unique(values, return_inverse=True)
        new = []
        for value in different.tolist():
            new.append(regions[called[value]] if value in called else free)
            free += value not in called
        columns.append(np.array(new, dtype=np.int64)[which])
    return regions, columns


def _face_markers(
    meshes: tuple[Mesh, ...], numbers: list[np.ndarray], bare: CellComplex, taken: set[str]
) -> dict[str, np.ndarray]:
    """Markers of faces, each face once; "facets" that have become faces between two cells are "inner"."""
    found: dict[str, list[np.ndarray]] = {}
    for i, (mesh, n) in enumerate(zip(meshes, numbers)):
        for name, rows in mesh.markers.items():
            if rows.ndim == 2:
                if name in taken:
                    raise MeshError(
                        f"{name!r} stands for faces in meshes[{i}], and for cells in another mesh"
                    )
                found.setdefault(name, []).append(np.where(rows < 0, -1, n[rows]))
    markers = {name: _once(stacked(parts)) for name, parts in found.items()}
    if "facets" in markers and len(markers["facets"]):
        ends = _among(markers["facets"], bare.boundary)
        met = markers["facets"][~ends]
        markers["facets"] = markers["facets"][ends]
        if len(met):
            markers["inner"] = _once(stacked([markers["inner"], met] if "inner" in markers else [met]))
    return markers


def _once(rows: np.ndarray) -> np.ndarray:
    """Faces without those that occurred before."""
    if not len(rows):
        return rows
    _, first = group_rows(np.sort(rows, axis=1) + 1)
    return rows[np.sort(first)]


def _among(rows: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Whether each face is one of the others."""
    both = stacked([rows, others])
    group, _ = group_rows(np.sort(both, axis=1) + 1)
    there = np.zeros(len(both), dtype=bool)
    there[group[len(rows) :]] = True
    return there[group[: len(rows)]]
