"""OpenFOAM's ``polyMesh`` of a planar mesh: its cells as prisms of one layer.

Faces between two cells come first, in the order of their lower and then of their higher cell ("upper
triangular"), each with its normal from the lower to the higher. Then come the patches, and last
"frontAndBack" of type empty, which makes OpenFOAM solve in two dimensions. Source: the OpenFOAM user guide,
"Mesh description".
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..base.decimals import rows_as_text
from ..base.errors import InputError, MeshError
from .cells import equal_rows
from .complex import CellComplex
from .exchange import border_groups, plain_names
from .measures import cell_volumes

__all__ = ["write_foam"]

HEADER = """FoamFile
{{
    version 2.0;
    format ascii;
    class {kind};
    location "constant/polyMesh";
    object {name};
}}
"""


def write_foam(mesh: CellComplex, folder: Path, thickness: float | None) -> list[str]:
    """Write points, faces, owner, neighbour and boundary; return the names of markers that are lost.

    Parameters
    ----------
    mesh : Mesh
        Of the plane.
    folder : Path
    thickness : float or None
        Of the layer; by default a tenth of the longer side of the bounding box.

    Raises
    ------
    InputError
        For meshes that are not planar, or have no cells.
    MeshError
        For cells without area, and edges of more than two cells.
    """
    if mesh.dimension != 2 or mesh.points.shape[1] != 2 or not mesh.size:
        raise InputError(
            f"polyMesh is made of planar meshes, extruded by one layer, not of {mesh.size} cells of "
            f"dimension {mesh.dimension} in {mesh.points.shape[1]} dimensions"
        )
    cells, start, end = _directed_edges(mesh)
    used = np.unique(start)
    n = len(used)
    place = np.full(len(mesh.points), -1)
    place[used] = np.arange(n)
    low, high = np.minimum(start, end).astype(np.int64), np.maximum(start, end)
    order = np.lexsort((cells, low * len(mesh.points) + high))
    key = (low * len(mesh.points) + high)[order]
    first = np.flatnonzero(np.append(True, key[1:] != key[:-1]))
    count = np.diff(np.append(first, len(key)))
    if count.max() > 2:
        edge = order[first[int(np.argmax(count > 2))]]
        raise MeshError(f"the edge {[int(start[edge]), int(end[edge])]} belongs to more than two cells")
    owner = order[first]  # the incidence of each edge in its lower cell
    paired = count == 2
    other = cells[order[first[paired] + 1]]
    inside, border = owner[paired], owner[~paired]
    upper = np.lexsort((other, cells[inside]))
    inside, other = inside[upper], other[upper]
    groups, lost = border_groups(mesh, np.column_stack([start[border], end[border]]).astype(np.int32))
    patches = [border[rows[np.argsort(cells[border[rows]], kind="stable")]] for rows in groups.values()]
    sides = np.concatenate([inside, *patches])
    a, b = place[start[sides]], place[end[sides]]
    walls = np.column_stack([a, b, b + n, a + n])
    ground = [(which, place[rows]) for kind in _turned(mesh) for which, rows in kind]
    lids = [rows[:, ::-1] for _, rows in ground] + [rows + n for _, rows in ground]
    beneath = [which for which, _ in ground] * 2
    if thickness is None:
        thickness = 0.1 * float(np.ptp(mesh.points[used], axis=0).max())
    _put(folder, "points", "vectorField", 2 * n, _points(mesh.points[used], thickness))
    faces = b"".join(_listed(rows) for rows in [walls, *lids])
    _put(folder, "faces", "faceList", len(walls) + 2 * mesh.size, faces)
    owners = np.concatenate([cells[sides], *beneath])
    _put(folder, "owner", "labelList", len(owners), rows_as_text(owners[:, None]))
    _put(folder, "neighbour", "labelList", len(other), rows_as_text(other[:, None]))
    names = plain_names([*groups, "frontAndBack"])
    text, at = "", len(inside)
    for name, rows in zip(names.values(), [*patches, np.empty(2 * mesh.size)]):
        kind = "empty" if at == len(walls) else "patch"
        text += f"    {name}\n    {{\n        type {kind};\n        nFaces {len(rows)};\n"
        text += f"        startFace {at};\n    }}\n"
        at += len(rows)
    _put(folder, "boundary", "polyBoundaryMesh", len(names), text.encode())
    return lost


def _turned(mesh: CellComplex) -> list[list[tuple[np.ndarray, np.ndarray]]]:
    """The cells, counterclockwise, by kinds and numbers of corners: (numbers of cells, rows of vertices)."""
    areas = cell_volumes(mesh)
    if not (areas != 0).all():
        raise MeshError(f"cell {int(np.argmax(areas == 0))} has no area")
    result, first = [], 0
    for block in mesh.cells.values():
        parts = [(first + which, rows) for which, rows in equal_rows(block)]
        result.append([(w, np.where(areas[w][:, None] > 0, rows, rows[:, ::-1])) for w, rows in parts])
        first += len(block)
    return result


def _directed_edges(mesh: CellComplex) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """All sides of all cells, with the cell on the left: cell, start, end."""
    parts = [part for kind in _turned(mesh) for part in kind]
    cells = np.concatenate([np.repeat(which, rows.shape[1]) for which, rows in parts])
    start = np.concatenate([rows.ravel() for _, rows in parts])
    end = np.concatenate([np.roll(rows, -1, axis=1).ravel() for _, rows in parts])
    return cells, start, end


def _points(points: np.ndarray, thickness: float) -> bytes:
    zero = np.zeros(len(points))
    both = [np.column_stack([points, zero]), np.column_stack([points, zero + thickness])]
    return _bracketed(rows_as_text(None, np.concatenate(both)), b"")


def _listed(rows: np.ndarray) -> bytes:
    return _bracketed(rows_as_text(rows), str(rows.shape[1]).encode())


def _bracketed(text: bytes, before: bytes) -> bytes:
    """Each line in brackets."""
    return before + b"(" + text[:-1].replace(b"\n", b")\n" + before + b"(") + b")\n" if text else b""


def _put(folder: Path, name: str, kind: str, many: int, text: bytes) -> None:
    header = HEADER.format(kind=kind, name=name).encode()
    (folder / name).write_bytes(header + f"{many}\n(\n".encode() + text + b")\n")
