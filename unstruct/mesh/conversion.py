"""Meshes as files have them (`Exchange`), and the arguments of a mesh from what a file has.

Named faces are blocks of cells of lower dimension, with the data "faces:<name>".
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..base.arrays import frozen
from ..base.errors import InputError, MeshError
from ..base.files import suffix_of
from ..base.telling import tell
from .cells import CELL_TYPES, cell_dimension
from .complex import CellComplex
from .exchange import Block, Exchange
from .gmsh import FACE_NAMES, decoded, face_blocks, from_groups, is_ours, stacked
from .msh_periodic import periodic_of
from .naming import WITH_NAMES, found_names
from .second_order import FIRST_ORDER, without_middles

__all__ = ["FACES_HEADER", "arguments_of", "blocks_of", "exchange_of", "named_faces"]

FACES_HEADER = "faces:"
ORDER = "polygon:number"  # cell data: the numbers of polygons before a file grouped them by size


def blocks_of(mesh: CellComplex) -> tuple[list[tuple[str, np.ndarray]], list[np.ndarray]]:
    """The cells in blocks of equal rows, and the numbers of the cells of each block."""
    blocks: list[tuple[str, np.ndarray]] = []
    rows: list[np.ndarray] = []
    start = 0
    some = {name: block for name, block in mesh.cells.items() if len(block)}  # formats have no empty kinds
    for name, block in (some or mesh.cells).items():
        if name == "polygon":
            sizes = np.array([len(row) for row in block])
            for size in np.unique(sizes):
                chosen = np.nonzero(sizes == size)[0]
                blocks.append(("polygon", np.array([block[i] for i in chosen])))
                rows.append(start + chosen)
        else:
            if name.startswith("simplex"):
                raise MeshError(
                    f"this format has no cells of dimension {mesh.dimension}: write .node/.ele instead"
                )
            blocks.append((name, np.asarray(block)))
            rows.append(start + np.arange(len(block)))
        start += len(block)
    return blocks, rows


def exchange_of(mesh: CellComplex, *, flags: bool = True) -> Exchange:
    """The blocks and data of a mesh; see `to_meshio`. Without ``flags`` named faces have no data of cells."""
    blocks, rows = blocks_of(mesh)
    named = named_faces(mesh)
    faces = face_blocks(named)
    for _, array in faces:
        blocks.append((FACE_NAMES[array.shape[1]], np.asarray(array)))
    data: dict[str, list[np.ndarray]] = {}
    for name, values in mesh.markers.items():
        if values.ndim == 1:
            values = values.astype(np.int8) if values.dtype == bool else values
            missing = np.zeros(1, dtype=values.dtype)
            data[name] = [values[r] for r in rows] + [np.repeat(missing, len(a)) for _, a in faces]
    none = [frozen(np.zeros(len(block), dtype=np.int8)) for _, block in blocks]  # shared by all names
    for i, (name, array) in enumerate(faces if flags else ()):
        data.setdefault(FACES_HEADER + name, list(none))[len(rows) + i] = np.ones(len(array), dtype=np.int8)
    if sum(name == "polygon" for name, _ in blocks) > 1:
        data[ORDER] = [r.astype(np.int32) for r in rows] + [
            np.zeros(len(a), dtype=np.int32) for _, a in faces
        ]
    for name, array in named.items() if flags else ():
        if len(array) == 0:
            data[FACES_HEADER + name] = [
                np.full(len(block), -array.shape[1], dtype=np.int8) for _, block in blocks
            ]
    kept = np.arange(len(mesh.points), dtype=np.int32)
    kept[mesh.duplicates[:, 0]] = mesh.duplicates[:, 1]
    return Exchange(
        np.asarray(mesh.points),
        [Block(*block) for block in blocks],
        point_data={"origin": np.asarray(mesh.origin), "kept": kept},
        cell_data=data,
        field_data={name: np.array([number, mesh.dimension]) for name, number in mesh.regions.items()},
        periodic=mesh.periodic,
    )


def named_faces(mesh: CellComplex) -> dict[str, np.ndarray]:
    """Markers of faces, including empty ones, but not of whole cells, which would be read as more cells."""
    lower = {width: min(width - 1, 2) < mesh.dimension for width in FACE_NAMES}
    faces = {name: rows for name, rows in mesh.markers.items() if rows.ndim == 2}
    return {name: rows for name, rows in faces.items() if lower.get(rows.shape[1], False)}


def _first_order(other: Exchange) -> None:
    """Replace cells of higher order by their corners."""
    middles = [] if other.middles is None else [other.middles]
    for i, block in enumerate(other.cells):
        if block.type in FIRST_ORDER:
            corners = CELL_TYPES[FIRST_ORDER[block.type]][1]
            middles.append(block.data[:, corners:].ravel())
            other.cells[i] = Block(FIRST_ORDER[block.type], block.data[:, :corners])
    other.middles = np.concatenate(middles) if middles else np.empty(0, dtype=np.int64)


def arguments_of(path: Path, other: Exchange) -> dict[str, Any]:
    """The arguments of a `Mesh`."""
    _first_order(other)
    kinds = [block.type for block in other.cells]
    try:
        dimensions = [0 if kind == "vertex" else cell_dimension(kind) for kind in kinds]
    except InputError as error:
        raise InputError(f"{path.name}: {error}") from None
    if not kinds or max(dimensions) == 0:
        raise InputError(f"{path.name} contains no cells")
    top = max(dimensions)
    points = np.asarray(other.points, dtype=np.float64)
    if points.ndim != 2:
        raise InputError(f"{path.name} contains no points")
    while points.shape[1] > max(top, 1) and not points[:, -1].any():
        points = points[:, :-1]
    main = [i for i, dimension in enumerate(dimensions) if dimension == top]
    cells = _by_type([other.cells[i] for i in main])
    order = sorted(main, key=lambda i: list(cells).index(kinds[i]))
    n = len(points)
    origin = other.point_data.get("origin", np.arange(n)).astype(np.int32)
    kept = other.point_data.get("kept", np.arange(n)).astype(np.int32)
    copies = np.nonzero(kept != np.arange(n))[0]
    duplicates = np.column_stack([copies, kept[copies]])
    typed = is_ours(other) and suffix_of(path) != ".msh"
    markers = _markers(other, order, dimensions, top, typed=typed)
    if is_ours(other) and ORDER in markers:
        number = markers.pop(ORDER)
        place = _in_order(cells, number)
        markers = {name: values[place] if values.ndim == 1 else values for name, values in markers.items()}
    try:
        bare = CellComplex(points, cells=cells)
    except InputError as error:
        raise InputError(f"{path.name}: {error}") from None
    regions = found_names(path, other) if suffix_of(path) in WITH_NAMES and is_ours(other) else {}
    if not any(name.startswith(FACES_HEADER) for name in other.cell_data):
        groups, named = from_groups(bare, other, order, dimensions)
        markers, regions = markers | groups, regions | named
    for name, columns in other.sets.items():
        markers[decoded(name)] = np.concatenate([columns[i] for i in order])
    arguments = {
        "points": points,
        "cells": bare.cells,
        "origin": origin,
        "duplicates": duplicates,
        "markers": markers,
        "regions": regions if "region" in markers else {},
        "periodic": periodic_of(other.links, points.shape[1]),
    }
    if other.middles is not None and len(other.middles):
        return without_middles(path.name, arguments, other.middles)
    return arguments


def _in_order(cells: dict[str, Any], number: np.ndarray) -> np.ndarray:
    """Put polygons back in their order; return the place of each cell in the file."""
    start = sum(len(block) for block in list(cells.values())[: list(cells).index("polygon")])
    polygons = cells["polygon"]
    order = np.argsort(number[start : start + len(polygons)], kind="stable")
    cells["polygon"] = [polygons[i] for i in order.tolist()]
    place = np.arange(len(number))
    place[start : start + len(polygons)] = start + order
    return place


def _by_type(blocks: list[Any]) -> dict[str, Any]:
    """Cells by their type; blocks of the same type are joined."""
    cells: dict[str, Any] = {}
    for block in blocks:
        rows = np.asarray(block.data)
        if block.type == "polygon":
            cells.setdefault("polygon", []).extend(rows)
        else:
            cells[block.type] = np.concatenate([cells[block.type], rows]) if block.type in cells else rows
    return cells


def _markers(
    other: Any, main: list[int], dimensions: list[int], top: int, *, typed: bool
) -> dict[str, np.ndarray]:
    """The markers of cells, from cell data, and those of faces, in files that `write` wrote.

    Files that are not ``typed`` may store integers as floats; such data become integers again.
    """
    markers: dict[str, np.ndarray] = {}
    lower = [i for i, dimension in enumerate(dimensions) if dimension < top]
    ours = is_ours(other)
    for key, values in other.cell_data.items():
        name = decoded(key) if ours else key
        if name == "gmsh:physical" or (ours and name == "gmsh:geometrical"):
            continue  # see `from_groups`
        column = np.concatenate([np.asarray(values[i]) for i in main])
        if name.startswith(FACES_HEADER):
            chosen = [other.cells[i].data[np.asarray(values[i]) == 1] for i in lower]
            width = -int(column.min(initial=0))  # for a marker without faces, else 0
            chosen = [c for c in chosen if len(c)] or [np.empty((0, width), dtype=np.int32)]
            markers[name.removeprefix(FACES_HEADER)] = stacked(chosen)
        elif column.ndim > 1 and name != "facet_normals":  # STL: they follow from the points
            tell(f"cell data {name!r} of shape {column.shape} is not read: markers have one value per cell")
        elif column.ndim == 1 and (not name.startswith("gmsh:") or column.any()):
            whole = not typed and column.dtype.kind == "f"
            whole = whole and bool(np.isfinite(column).all() and (column == np.round(column)).all())
            flags = ours and column.dtype == np.int8 and np.isin(column, (0, 1)).all()
            markers[name] = column.astype(np.int64) if whole else column.astype(bool) if flags else column
    return markers
