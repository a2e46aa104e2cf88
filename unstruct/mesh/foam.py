"""OpenFOAM's ``polyMesh``: solid cells of all kinds, and the cells of a planar mesh as prisms of one layer.

Faces between two cells come first, in the order of their lower and then of their higher cell ("upper
triangular"), each with its normal from the lower to the higher. Then come the patches, with normals outward,
and for a planar mesh last "frontAndBack" of type empty, which makes OpenFOAM solve in two dimensions. Regions
are zones of cells; named faces between cells are zones of faces. Source: the OpenFOAM user guide, "Mesh
description".
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from ..base.decimals import rows_as_text
from ..base.errors import InputError, MeshError
from .cells import equal_rows, incident_facets
from .complex import CellComplex
from .exchange import border_groups, plain_names
from .grouping import group_rows
from .measures import cell_volumes
from .naming import names_by_number
from .orientation import cell_signs, turned_cells

__all__ = ["write_foam"]

FRONT_AND_BACK = "frontAndBack"
MOST_LETTERS = 200  # of a name; OpenFOAM reads words of up to 1,000
HEADER = """FoamFile
{{
    version 2.0;
    format ascii;
    class {kind};
    location "constant/polyMesh";
    object {name};
}}
"""


def write_foam(mesh: CellComplex, folder: Path, thickness: float | None) -> tuple[list[str], dict[str, str]]:
    """Write points, faces, owner, neighbour, boundary and zones.

    Returns the names of markers that are lost, and those that the others have in the files.

    Parameters
    ----------
    mesh : Mesh
        Of the plane, or solid cells in space.
    folder : Path
    thickness : float or None
        Of the layer of a planar mesh; by default a tenth of the longer side of the bounding box.

    Raises
    ------
    InputError
        For surfaces and curves in space, for meshes without cells, and for a thickness of solid cells.
    MeshError
        For cells without area or volume, and facets of more than two cells.
    """
    flat = mesh.dimension == 2 and mesh.points.shape[1] == 2
    if not (flat or mesh.dimension == mesh.points.shape[1] == 3) or not mesh.size:
        raise InputError(
            "polyMesh is made of planar meshes, extruded by one layer, and of solid cells, not of "
            f"{mesh.size} cells of dimension {mesh.dimension} in {mesh.points.shape[1]} dimensions"
        )
    if thickness is not None and not flat:
        raise InputError("thickness is that of the layer over a planar mesh; these cells are solid")
    rows, cells = _sides(mesh) if flat else _solid_sides(mesh)
    owner, other, paired = _matched(rows, cells)
    inside, border = owner[paired], owner[~paired]
    upper = np.lexsort((other, cells[inside]))
    inside, other = inside[upper], other[upper]
    groups, _ = border_groups(mesh, rows[border])
    patches = [border[part[np.argsort(cells[border[part]], kind="stable")]] for part in groups.values()]
    zones, _ = border_groups(mesh, rows[inside])
    zones.pop("facets", None)  # those without a name
    faces = np.concatenate([inside, *patches])
    used = np.unique(rows[rows >= 0])
    place = np.full(len(mesh.points) + 1, -1)
    place[used] = np.arange(len(used))
    owners, kinds, sizes = cells[faces], ["patch"] * len(patches), [len(part) for part in patches]
    patch_names = _words(groups, taken=[FRONT_AND_BACK] if flat else [])
    names = list(patch_names.values())
    if flat:
        points = _layer(mesh.points[used], thickness)
        text = _prisms(mesh, place, rows[faces], len(used))
        beneath = [which for kind in _turned(mesh) for which, _ in kind] * 2
        owners = np.concatenate([owners, *beneath])
        names, kinds, sizes = [*names, FRONT_AND_BACK], [*kinds, "empty"], [*sizes, 2 * mesh.size]
    else:
        points, text = mesh.points[used], _listed(place[rows[faces]])
    _put(folder, "points", "vectorField", len(points), _bracketed(rows_as_text(None, points), b""))
    _put(folder, "faces", "faceList", len(owners), text)
    _put(folder, "owner", "labelList", len(owners), rows_as_text(owners[:, None]))
    _put(folder, "neighbour", "labelList", len(other), rows_as_text(other[:, None]))
    _put_patches(folder, names, kinds, sizes, len(inside))
    cell_zones = _cell_zones(mesh)
    zone_names, cell_names = _words(zones), _words(cell_zones)
    _put_zones(folder, "faceZone", zones, zone_names)
    _put_zones(folder, "cellZone", cell_zones, cell_names)
    named = {name: cell_names[name] for name in mesh.regions if name in cell_names}
    return _lost(mesh, groups, zones), {**named, **zone_names, **patch_names}


def _words(names: Iterable[str], taken: Iterable[str] = ()) -> dict[str, str]:
    """Names that OpenFOAM reads as words: one that begins with a digit, - or . it reads as a number."""
    return plain_names(names, taken=taken, words=True, most=MOST_LETTERS)


def _matched(rows: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """For each facet, its row in its lower cell; the higher cells; which facets have two cells."""
    group, _ = group_rows(np.sort(rows, axis=1) + 1)
    order = np.lexsort((cells, group))
    key = group[order]
    first = np.flatnonzero(np.append(True, key[1:] != key[:-1]))
    count = np.diff(np.append(first, len(key)))
    if count.max() > 2:
        facet = rows[order[first[int(np.argmax(count > 2))]]]
        what = "edge" if rows.shape[1] == 2 else "face"
        raise MeshError(f"the {what} {facet[facet >= 0].tolist()} belongs to more than two cells")
    paired = count == 2
    return order[first], cells[order[first[paired] + 1]], paired


def _solid_sides(mesh: CellComplex) -> tuple[np.ndarray, np.ndarray]:
    """The facets of all cells, counterclockwise from outside, padded by -1, and their cells."""
    flat = cell_signs(mesh) == 0
    if flat.any():
        raise MeshError(f"cell {int(np.argmax(flat))} has no volume")
    rows, cells, _ = incident_facets(turned_cells(mesh))
    return rows, cells


def _sides(mesh: CellComplex) -> tuple[np.ndarray, np.ndarray]:
    """The sides of planar cells, each with its cell on the left, and these cells."""
    parts = [part for kind in _turned(mesh) for part in kind]
    cells = np.concatenate([np.repeat(which, rows.shape[1]) for which, rows in parts])
    start = np.concatenate([rows.ravel() for _, rows in parts])
    end = np.concatenate([np.roll(rows, -1, axis=1).ravel() for _, rows in parts])
    return np.column_stack([start, end]).astype(np.int32), cells


def _turned(mesh: CellComplex) -> list[list[tuple[np.ndarray, np.ndarray]]]:
    """Planar cells, counterclockwise, by kinds and numbers of corners: (numbers of cells, their rows)."""
    areas = cell_volumes(mesh)
    if not (areas != 0).all():
        raise MeshError(f"cell {int(np.argmax(areas == 0))} has no area")
    result, first = [], 0
    for block in mesh.cells.values():
        parts = [(first + which, rows) for which, rows in equal_rows(block)]
        result.append([(w, np.where(areas[w][:, None] > 0, rows, rows[:, ::-1])) for w, rows in parts])
        first += len(block)
    return result


def _layer(points: np.ndarray, thickness: float | None) -> np.ndarray:
    """Planar points on both sides of the layer."""
    if thickness is None:
        thickness = 0.1 * float(np.ptp(points, axis=0).max())
    zero = np.zeros(len(points))
    return np.concatenate([np.column_stack([points, zero]), np.column_stack([points, zero + thickness])])


def _prisms(mesh: CellComplex, place: np.ndarray, sides: np.ndarray, n: int) -> bytes:
    """The faces of the layer: walls over sides, then the bottoms and the tops of all cells."""
    a, b = place[sides].T
    ground = [place[rows] for kind in _turned(mesh) for _, rows in kind]
    lids = [rows[:, ::-1] for rows in ground] + [rows + n for rows in ground]
    return b"".join(_listed(rows) for rows in [np.column_stack([a, b, b + n, a + n]), *lids])


def _cell_zones(mesh: CellComplex) -> dict[str, np.ndarray]:
    """The cells of each region, unless there is one without a name."""
    region = mesh.markers.get("region")
    if region is None or region.ndim != 1 or region.dtype.kind not in "iu":
        return {}
    called, values = names_by_number(mesh.regions), np.unique(region).tolist()
    if not called and len(values) == 1:
        return {}
    return {called.get(value, f"region {value}"): np.flatnonzero(region == value) for value in values}


def _lost(mesh: CellComplex, groups: dict[str, np.ndarray], zones: dict[str, np.ndarray]) -> list[str]:
    """Markers that are not stored completely; where the mesh ends, and where it does not, is no marker's."""
    lost = []
    for name, values in mesh.markers.items():
        if values.ndim == 1:
            if name != "region" or values.dtype.kind not in "iu":
                lost.append(name)
        elif name not in ("facets", "inner"):
            stored = len(groups.get(name, ())) + len(zones.get(name, ()))
            if stored < len(values) or not len(values):
                lost.append(name)
    return lost


def _listed(rows: np.ndarray) -> bytes:
    """Faces, padded by -1: the number of corners before the corners in brackets; runs of equal length."""
    sizes = (rows >= 0).sum(axis=1)
    ends = np.flatnonzero(np.diff(sizes)) + 1
    parts = np.split(np.arange(len(rows)), ends) if len(rows) else []
    return b"".join(
        _bracketed(rows_as_text(rows[part, : sizes[part[0]]]), str(sizes[part[0]]).encode()) for part in parts
    )


def _bracketed(text: bytes, before: bytes) -> bytes:
    """Each line in brackets."""
    return before + b"(" + text[:-1].replace(b"\n", b")\n" + before + b"(") + b")\n" if text else b""


def _put(folder: Path, name: str, kind: str, many: int, text: bytes) -> None:
    header = HEADER.format(kind=kind, name=name).encode()
    (folder / name).write_bytes(header + f"{many}\n(\n".encode() + text + b")\n")


def _put_patches(folder: Path, names: list[str], kinds: list[str], sizes: list[int], at: int) -> None:
    """The patches; ``at`` is the first face of the first one."""
    text = ""
    for name, kind, size in zip(names, kinds, sizes):
        text += f"    {name}\n    {{\n        type {kind};\n        nFaces {size};\n"
        text += f"        startFace {at};\n    }}\n"
        at += size
    _put(folder, "boundary", "polyBoundaryMesh", len(names), text.encode())


def _put_zones(folder: Path, kind: str, zones: dict[str, np.ndarray], names: dict[str, str]) -> None:
    """Zones of cells or faces; a file without any replaces one of an earlier mesh."""
    text = b""
    for name, rows in zones.items():
        text += f"{names[name]}\n{{\n    type {kind};\n    {kind[:4]}Labels List<label>\n".encode()
        text += f"{len(rows)}\n(\n".encode() + rows_as_text(rows[:, None]) + b")\n;\n"
        if kind == "faceZone":  # the faces have the direction in which they are stored
            text += f"    flipMap List<bool> {len(rows)}{{0}};\n".encode()
        text += b"}\n"
    _put(folder, f"{kind}s", "regIOobject", len(zones), text)
