"""Meshes in files and in other libraries: meshio, Triangle's .node/.ele, scikit-fem.

Files keep points, cells, `origin`, `duplicates`, cell markers, and named faces (as cells of lower dimension
with the data "faces:<name>"), as far as the format can store them. See the book, chapter 1.
"""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import InputError, MeshError
from .cells import cell_dimension
from .complex import CellComplex
from .formats import fits
from .gmsh import FACE_NAMES, coded, decoded, face_blocks, from_groups, is_ours, stacked, to_groups
from .grouping import group_rows

__all__ = ["read", "to_meshio", "to_skfem", "write"]

FACES_HEADER = "faces:"
SKFEM_HEX = [0, 4, 3, 1, 7, 5, 2, 6]  # the corners of a hexahedron in the order of scikit-fem
WITH_DATA = {".vtu", ".vtk", ".msh", ".xdmf"}  # formats that keep data at points and cells
ORDER = "polygon:number"  # cell data: the numbers of polygons before a file grouped them by size
GMSH = {".msh"}  # meshio would take the suffix for Ansys; we write version 2.2 of Gmsh's format


def to_meshio(mesh: CellComplex) -> Any:
    """The mesh as a `meshio.Mesh`.

    Returns
    -------
    meshio.Mesh
        Kinds without cells are left out. Polygons are grouped by their number of corners; if there are
        several groups, ``cell_data`` has the number of each cell as "polygon:number". ``point_data`` contains
        "origin" and "kept" (the vertex itself, or the vertex that it duplicates); ``cell_data`` contains the
        markers. Named faces follow as blocks of lower dimension; "faces:<name>" is 1 on them and 0 elsewhere.
        For a name of k vertices per face that has no faces, it is -k everywhere.
    """
    import meshio

    blocks: list[tuple[str, np.ndarray]] = []
    rows: list[np.ndarray] = []  # the cells of each block
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
                    f"meshio has no cells of dimension {mesh.dimension}: write .node/.ele instead"
                )
            blocks.append((name, np.asarray(block)))
            rows.append(start + np.arange(len(block)))
        start += len(block)
    named = _named_faces(mesh)
    faces = face_blocks(named)
    for _, array in faces:
        blocks.append((FACE_NAMES[array.shape[1]], np.asarray(array)))
    data: dict[str, list[np.ndarray]] = {}
    for name, values in mesh.markers.items():
        if values.ndim == 1:
            values = values.astype(np.int8) if values.dtype == bool else values
            missing = np.zeros(1, dtype=values.dtype)
            data[name] = [values[r] for r in rows] + [np.repeat(missing, len(a)) for _, a in faces]
    for i, (name, _) in enumerate(faces):
        flags = data.setdefault(
            FACES_HEADER + name, [np.zeros(len(block), dtype=np.int8) for _, block in blocks]
        )
        flags[len(rows) + i][:] = 1
    if sum(name == "polygon" for name, _ in blocks) > 1:
        data[ORDER] = [r.astype(np.int32) for r in rows] + [
            np.zeros(len(a), dtype=np.int32) for _, a in faces
        ]
    for name, array in named.items():
        if len(array) == 0:
            data[FACES_HEADER + name] = [
                np.full(len(block), -array.shape[1], dtype=np.int8) for _, block in blocks
            ]
    kept = np.arange(len(mesh.points), dtype=np.int32)
    kept[mesh.duplicates[:, 0]] = mesh.duplicates[:, 1]
    return meshio.Mesh(
        np.asarray(mesh.points),
        blocks,
        point_data={"origin": np.asarray(mesh.origin), "kept": kept},
        cell_data=data,
    )


def write(mesh: CellComplex, path: str | Path) -> None:
    """Write a file; see `Mesh.write`.

    Raises
    ------
    InputError
        For a suffix that no format has, and for meshes that a format cannot store.
    """
    path = Path(path)
    if path.suffix in (".node", ".ele"):
        return _write_node_ele(mesh, path)
    fits([name for name, block in mesh.cells.items() if len(block)], path)
    other = to_meshio(mesh)
    if (
        mesh.points.shape[1] < 3
    ):  # most formats have three coordinates; a zero third one is dropped on reading
        other.points = np.pad(other.points, ((0, 0), (0, 3 - mesh.points.shape[1])))
    if path.suffix not in WITH_DATA:
        _drop(mesh, f"{path.suffix} stores points and cells only", mesh.markers)
        other.point_data, other.cell_data = {}, {}
        del other.cells[len(other.cells) - len(face_blocks(_named_faces(mesh))) :]
    elif path.suffix in GMSH:
        _for_gmsh(mesh, other)
    else:
        spaces = path.suffix == ".vtk"
        other.cell_data = {coded(name, spaces=spaces): v for name, v in other.cell_data.items()}
    if path.suffix in WITH_DATA:
        whole = [k for k, v in mesh.markers.items() if v.ndim == 2 and k not in _named_faces(mesh)]
        _drop(mesh, "markers of faces have 1 to 4 vertices, and lower dimension than the cells", whole)
    new = not path.exists()
    try:
        other.write(path, file_format="gmsh22" if path.suffix in GMSH else None)
    except Exception as error:  # meshio raises many kinds of errors for suffixes and cells alike
        if new:  # it may have begun
            path.unlink(missing_ok=True)
        raise InputError(f"meshio cannot write this mesh as {path.suffix or path.name!r}: {error}") from error
    return None


def _named_faces(mesh: CellComplex) -> dict[str, np.ndarray]:
    """Markers of faces, including empty ones, but not of whole cells, which would be read as more cells."""
    lower = {width: min(width - 1, 2) < mesh.dimension for width in FACE_NAMES}
    faces = {name: rows for name, rows in mesh.markers.items() if rows.ndim == 2}
    return {name: rows for name, rows in faces.items() if lower.get(rows.shape[1], False)}


def _drop(mesh: CellComplex, why: str, names: Any) -> None:
    lost = [repr(name) for name in names]
    if len(mesh.duplicates) and names is mesh.markers:
        lost.append("duplicates")
    if lost:
        warnings.warn(f"not written: {', '.join(lost)}; {why}", stacklevel=5)


def _for_gmsh(mesh: CellComplex, other: Any) -> None:
    """Make regions and named faces physical groups; keep real data if there is only one block of cells."""
    faces = _named_faces(mesh)
    data = {name: v for name, v in other.cell_data.items() if not name.startswith(FACES_HEADER)}
    held, lost = to_groups(mesh, other, faces)
    why = ".msh stores each face in one group, that of its first marker other than facets and inner"
    _drop(mesh, why, lost)
    rest = [name for name in data if name not in held and not name.startswith("gmsh:")]
    if len(other.cells) > 1:  # meshio cannot read such data back
        _drop(mesh, ".msh keeps other cell data only where there is one kind of cell and no named face", rest)
        rest = []
    other.point_data = {name: values.astype(float) for name, values in other.point_data.items()}
    other.cell_data |= {coded(name): [v.astype(float) for v in data[name]] for name in rest}


def read(path: str | Path) -> dict[str, Any]:
    """Read a file: the arguments of a `Mesh`; see `Mesh.read`.

    The cells of the highest dimension are the mesh; lower ones become markers. A third coordinate that is
    zero throughout is dropped if the cells are plane.
    """
    path = Path(path)
    if path.suffix in (".node", ".ele"):
        return _read_node_ele(path)
    import meshio

    try:
        other = meshio.read(path, file_format="gmsh" if path.suffix in GMSH else None)
    except FileNotFoundError:
        raise
    except (Exception, SystemExit) as error:  # meshio exits on what it cannot read
        raise InputError(f"meshio cannot read {path.name}: {error}") from None
    kinds = [block.type for block in other.cells]
    dimensions = [0 if kind == "vertex" else cell_dimension(kind) for kind in kinds]
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
    markers = _markers(other, order, dimensions, top, typed=is_ours(other) and path.suffix not in GMSH)
    if is_ours(other) and ORDER in markers:
        number = markers.pop(ORDER)
        place = _in_order(cells, number)
        markers = {name: values[place] if values.ndim == 1 else values for name, values in markers.items()}
    bare = CellComplex(points, cells=cells)
    if not any(name.startswith(FACES_HEADER) for name in other.cell_data):
        markers |= from_groups(bare, other, order, dimensions)
    return {
        "points": points,
        "cells": bare.cells,
        "origin": origin,
        "duplicates": duplicates,
        "markers": markers,
    }


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
            warnings.warn(
                f"cell data {name!r} of shape {column.shape} is not read: markers have one value per cell",
                stacklevel=4,
            )
        elif column.ndim == 1 and (not name.startswith("gmsh:") or column.any()):
            whole = not typed and column.dtype.kind == "f"
            whole = whole and bool(np.isfinite(column).all() and (column == np.round(column)).all())
            flags = ours and column.dtype == np.int8 and np.isin(column, (0, 1)).all()
            markers[name] = column.astype(np.int64) if whole else column.astype(bool) if flags else column
    return markers


# ---------------------------------------------------------------------- Triangle and TetGen


def _write_node_ele(mesh: CellComplex, path: Path) -> None:
    """Write .node and .ele, numbered from 0, with as many digits as restore each double exactly."""
    if not mesh.is_simplicial:
        kinds = ", ".join(mesh.cells)
        raise MeshError(
            f".node and .ele store simplices of one kind, not {kinds}: write .vtu, or select them"
        )
    simplices = mesh.simplices
    _drop(mesh, ".node and .ele store points and cells only", mesh.markers)
    n, d = mesh.points.shape
    lines = [f"{n} {d} 0 0"]
    lines += [f"{i} {' '.join(map(repr, row))}" for i, row in enumerate(mesh.points.tolist())]
    path.with_suffix(".node").write_text("\n".join(lines) + "\n")
    lines = [f"{mesh.size} {simplices.shape[1]} 0"]
    lines += [f"{t} {' '.join(map(str, row))}" for t, row in enumerate(simplices.tolist())]
    path.with_suffix(".ele").write_text("\n".join(lines) + "\n")


def _read_node_ele(path: Path) -> dict[str, Any]:
    """Read .node and .ele, numbered like their first vertex; attributes and boundary marks become markers."""
    header, rows = _table(path.with_suffix(".node"))
    d, attributes, marks = header[1], header[2], header[3] if len(header) > 3 else 0
    base = int(rows[0, 0]) if len(rows) else 0
    points = rows[:, 1 : 1 + d]
    head, elements = _table(path.with_suffix(".ele"))
    corners = elements[:, 1 : 1 + min(head[1], d + 1)].astype(np.int64) - base
    markers: dict[str, np.ndarray] = {}
    for i in range(head[2] if len(head) > 2 else 0):
        markers["attribute" if i == 0 else f"attribute{i}"] = elements[:, 1 + head[1] + i]
    if marks:
        values = rows[:, 1 + d + attributes].astype(np.int64)
        for value in np.unique(values[values != 0]).tolist():
            markers[f"vertices {value}"] = np.nonzero(values == value)[0][:, None]
    return {"points": points, "simplices": corners, "markers": markers}


def _table(path: Path) -> tuple[list[int], np.ndarray]:
    """Header and rows of numbers of a file in Triangle's format; # starts a comment."""
    lines = [line.split("#")[0].split() for line in path.read_text().splitlines()]
    lines = [line for line in lines if line]
    try:
        header = [int(word) for word in lines[0]]
        rows = np.array([[float(word) for word in line] for line in lines[1 : 1 + header[0]]])
        rows = rows if len(rows) else np.empty((0, 1 + header[1]))
    except (IndexError, ValueError) as error:
        raise InputError(f"{path.name} is not in Triangle's format: {error}") from None
    if len(rows) != header[0]:
        raise InputError(f"{path.name} announces {header[0]} rows but contains {len(rows)}")
    return header, rows


# ---------------------------------------------------------------------- scikit-fem


def to_skfem(mesh: CellComplex) -> Any:
    """The mesh as a scikit-fem mesh; named facets become boundaries, cell markers subdomains.

    A boolean marker of cells is one subdomain; one of integers has a subdomain for each value: "region 2".
    """
    import skfem

    kinds = {
        ("line", 1): "MeshLine",
        ("triangle", 2): "MeshTri",
        ("quad", 2): "MeshQuad",
        ("tetra", 3): "MeshTet",
        ("hexahedron", 3): "MeshHex",
    }
    name = next(iter(mesh.cells))
    kind = kinds.get((name, mesh.points.shape[1]))
    if len(mesh.cells) > 1 or kind is None:
        what = ", ".join(mesh.cells)
        raise MeshError(
            f"scikit-fem has no mesh for cells of kind {what} in {mesh.points.shape[1]} dimensions"
        )
    if mesh.size == 0:
        raise MeshError("scikit-fem has no mesh without cells")
    used = np.zeros(len(mesh.points), dtype=bool)
    used[mesh.cells[name]] = True
    number = np.cumsum(used) - 1
    number[~used] = -1
    cells = mesh.cells[name][:, SKFEM_HEX] if name == "hexahedron" else mesh.cells[name]
    result = getattr(skfem, kind)(mesh.points[used].T.copy(), number[cells].T.copy())
    boundaries, subdomains = _skfem_facets(mesh, result, number), {}
    for marker, values in mesh.markers.items():
        if values.ndim == 1 and values.dtype == bool:
            subdomains[marker] = np.nonzero(values)[0]
        elif values.ndim == 1 and values.dtype.kind in "iu":
            order = np.argsort(values, kind="stable")
            different, first = np.unique(values[order], return_index=True)
            for value, part in zip(different.tolist(), np.split(order, first[1:])):
                subdomains[f"{marker} {value}"] = part
    if boundaries:
        result = result.with_boundaries(boundaries)
    return result.with_subdomains(subdomains) if subdomains else result


def _skfem_facets(mesh: CellComplex, theirs: Any, number: np.ndarray) -> dict[str, np.ndarray]:
    """The numbers that scikit-fem gives to the facets of each marker."""
    named = {
        name: number[rows]
        for name, rows in mesh.markers.items()
        if rows.ndim == 2 and rows.shape[1] == len(theirs.facets) and (rows >= 0).all()
    }
    if not named:
        return {}
    wanted = np.concatenate(list(named.values()))
    marked = np.zeros(theirs.p.shape[1] + 1, dtype=bool)  # the last entry belongs to -1, an unused vertex
    marked[wanted] = True
    near = np.flatnonzero(marked[theirs.facets].all(axis=0))  # few, so that nothing large is sorted
    group, first = group_rows(np.sort(np.concatenate([theirs.facets.T[near], wanted]), axis=1))
    place = first[group[len(near) :]]
    lost = place >= len(near)
    if lost.any():
        every = np.concatenate([mesh.markers[name] for name in named])
        raise MeshError(f"{every[int(np.argmax(lost))].tolist()} has a marker, but is not a facet of a cell")
    parts = np.split(near[place], np.cumsum([len(rows) for rows in named.values()])[:-1])
    return dict(zip(named, parts))
