"""Markers as Gmsh's physical groups, and back.

Files are written so that each cell and each face has the number of one group, which is all that version 2.2
of the format knows.
A face in several markers goes to the first of them that is not "facets" or "inner"; these two follow from the
others, because facets are where the mesh ends. Groups of cells have the names of the regions; those without
one are "region 0", "region 1", ..., by the values of the marker "region". Without that marker, they are
Boolean markers that have no cell in common, which are read as regions. Other cell data are kept only if the
file contains nothing but cells of one kind.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any
from urllib.parse import quote, unquote

import numpy as np

from .complex import CellComplex
from .grouping import group_rows
from .marked import marked_facets
from .naming import names_by_number

__all__ = ["brief", "coded", "decoded", "face_blocks", "from_groups", "is_ours", "stacked", "to_groups"]

OWN_NAMES = ("facets", "inner")
MOST_BYTES = 127  # of a name, by the manual; Gmsh does not open files with names of more than some 250
MOST_GROUPS = 2**31 - 1  # numbers of groups are of 32 bits
REGION = r"region (-?\d+)"  # the name of a group of cells whose region has none
FACE_NAMES = {1: "vertex", 2: "line", 3: "triangle", 4: "quad"}


def coded(name: str, *, spaces: bool = False) -> str:
    """A name with percent codes for what files cannot store: quotes, brackets, control characters, spaces."""
    bad = [c in '%<>&"\\' or not c.isprintable() or (c == " " and spaces) for c in name]
    return "".join(quote(c, safe="") if b else c for c, b in zip(name, bad))


def decoded(name: str) -> str:
    """The name that `coded` was given."""
    return unquote(name)


def quote_first(name: str) -> str:
    """Another code of a name: its first character is one, too."""
    return "".join(f"%{byte:02X}" for byte in name[:1].encode()) + coded(name[1:])


def brief(names: Iterable[str]) -> dict[str, str]:
    """Names that Gmsh can read, by names: with codes they have at most 127 bytes. All are different."""
    every = list(dict.fromkeys(names))
    used = {name for name in every if _is_brief(name)}
    found = {name: name for name in every}
    for name in every:
        if name not in used:
            word, count = _cut(name, ""), 1
            while word in used:
                count += 1
                word = _cut(name, f"_{count}")
            used.add(word)
            found[name] = word
    return found


def _is_brief(name: str) -> bool:
    return len(coded(name).encode()) <= MOST_BYTES


def _cut(name: str, end: str) -> str:
    """The longest beginning of a name that is brief together with an end."""
    start = name[:MOST_BYTES]
    while not _is_brief(start + end):
        start = start[:-1]
    return start + end


def is_ours(other: Any) -> bool:
    """Whether `Mesh.write` wrote the file that meshio read."""
    return {"origin", "kept"} <= set(other.point_data)


def face_blocks(faces: dict[str, np.ndarray]) -> list[tuple[str, np.ndarray]]:
    """Markers of faces as blocks without padding: (name, rows of equal length), none of them empty."""
    blocks = []
    for name, rows in faces.items():
        sizes = (rows >= 0).sum(axis=1)
        for size in np.unique(sizes).tolist():
            blocks.append((name, np.ascontiguousarray(rows[sizes == size, :size])))
    return blocks


def stacked(parts: list[np.ndarray]) -> np.ndarray:
    """Rows of different lengths in one array, the shorter ones padded by -1 at the end."""
    width = max(part.shape[1] for part in parts)
    pads = [((0, 0), (0, width - part.shape[1])) for part in parts]
    return np.concatenate([np.pad(part, pad, constant_values=-1) for part, pad in zip(parts, pads)])


def to_groups(mesh: CellComplex, other: Any, faces: dict[str, np.ndarray]) -> tuple[list[str], list[str]]:
    """Put markers into the physical groups of ``other``, a meshio.Mesh.

    Parameters
    ----------
    mesh : Mesh
    other : meshio.Mesh
        As `to_meshio` makes it: its last blocks are the faces of each marker. They are replaced.
    faces : dict of str to array
        The markers that name faces.

    Returns
    -------
    cells : list of str
        Markers of cells that the groups keep.
    lost : list of str
        Markers of faces that the groups do not keep completely.
    """
    blocks = face_blocks(faces)
    top = len(other.cells) - len(blocks)
    tags, names, cells = _cell_groups(mesh, other, top, {coded(name) for name in faces})
    other.field_data = {name: np.array([tag, mesh.dimension]) for name, tag in names.items()}
    del other.cells[top:]
    lost = [name for name in faces if coded(name) in other.field_data]
    count = dict.fromkeys(range(3), 0)
    for width in sorted(FACE_NAMES):
        part = {k: v for k, v in faces.items() if v.shape[1] == width and len(v) == 0}
        part |= {k: v for k, v in blocks if v.shape[1] == width}
        some = [name for name in faces if name in part and name not in lost]
        some.sort(key=lambda name: name in OWN_NAMES)
        groups = _split({name: part[name] for name in some})
        for name, rows in groups.items():
            if len(rows) < len(part[name]) and len(rows) == 0 and name not in OWN_NAMES:
                continue  # no group without faces: the marker is lost
            dimension = min(width - 1, 2)
            if coded(name) not in other.field_data:  # otherwise its triangles are there
                count[dimension] += 1
                other.field_data[coded(name)] = np.array([count[dimension], dimension])
            if len(rows):
                other.cells.append(type(other.cells[0])(FACE_NAMES[width], rows))
                tags.append(np.full(len(rows), other.field_data[coded(name)][0]))
        again = _joined(groups, _border(mesh, width), len(mesh.points))
        lost += [name for name in some if _keys(again[name]) != _keys(part[name])]
    other.cell_data = {"gmsh:physical": tags, "gmsh:geometrical": [np.maximum(tag, 1) for tag in tags]}
    return cells, lost


def _split(faces: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The markers, with each face only in the first marker that contains it."""
    if not faces:
        return {}
    rows = np.concatenate(list(faces.values()))
    owner = np.repeat(np.arange(len(faces)), [len(part) for part in faces.values()])
    _, first = group_rows(np.sort(rows, axis=1))
    first = first[np.argsort(owner[first], kind="stable")]
    ends = np.searchsorted(owner[first], np.arange(1, len(faces)))
    return dict(zip(faces, np.split(rows[first], ends)))


def _joined(groups: dict[str, np.ndarray], border: np.ndarray, n: int) -> dict[str, np.ndarray]:
    """Add faces of other groups to "facets", if the mesh ends there, and to "inner", if it does not."""
    result = dict(groups)
    width = border.shape[1]
    others = [rows for name, rows in groups.items() if name not in OWN_NAMES and rows.shape[1] == width]
    if others and len(border):
        rows = np.concatenate(others)
        ends = marked_facets(rows, border, n)
        for own, part in zip(OWN_NAMES, (rows[ends], rows[~ends])):
            if own in groups:
                result[own] = np.concatenate([result[own], part])
    return result


def _of_width(faces: dict[str, np.ndarray], width: int) -> dict[str, np.ndarray]:
    """The faces of some width, without padding, of the markers that have such, or none in their dimension."""
    result = {}
    for name, rows in faces.items():
        part = rows[(rows >= 0).sum(axis=1) == width][:, :width]
        alike = rows.shape[1] == width if len(rows) else min(rows.shape[1], 3) == min(width, 3)
        if len(part) or alike or (name in OWN_NAMES and width > 2 and rows.shape[1] > 2):
            result[name] = part if part.shape[1] == width else np.empty((0, width), dtype=rows.dtype)
    return result


def _border(mesh: CellComplex, width: int) -> np.ndarray:
    """The facets with ``width`` vertices where the mesh ends."""
    rows = np.asarray(mesh.boundary)
    return rows[(rows >= 0).sum(axis=1) == width][:, :width]


def _keys(rows: np.ndarray) -> set[tuple[int, ...]]:
    return set(map(tuple, np.sort(rows, axis=1).tolist()))


def _cell_groups(
    mesh: CellComplex, other: Any, top: int, taken: set[str]
) -> tuple[list[np.ndarray], dict[str, int], list[str]]:
    """The group of each cell of each block, the groups' numbers by name, and the markers that they keep.

    The group of region k is k + 1, unless numbers are negative. Names in ``taken`` belong to faces.
    """
    region = mesh.markers.get("region")
    if region is not None and region.ndim == 1 and region.dtype.kind in "iu":
        values = np.union1d(region.astype(np.int64), np.array([*mesh.regions.values()], dtype=np.int64))
        usual = len(values) and 0 <= values[0] and values[-1] < MOST_GROUPS
        number = values + 1 if usual else np.arange(len(values)) + 1
        tags = [number[np.searchsorted(values, rows)] for rows in other.cell_data["region"][:top]]
        called = names_by_number(mesh.regions)
        names = {}
        for value, tag in zip(values.tolist(), number.tolist()):
            name = coded(called[value]) if value in called else f"region {value}"
            if value in called and (name in taken or re.fullmatch(REGION, name)):
                name = quote_first(called[value])
            names[name] = tag
        return tags, names, ["region"]
    tags = [np.zeros(len(block.data), dtype=np.int64) for block in other.cells[:top]]
    held: list[str] = []
    for name, values in mesh.markers.items():
        if values.ndim == 1 and values.dtype == bool and values.any():
            chosen = [part == 1 for part in other.cell_data[name][:top]]
            if not any((tag[rows] > 0).any() for tag, rows in zip(tags, chosen)):
                held.append(name)
                for tag, rows in zip(tags, chosen):
                    tag[rows] = len(held)
    return tags, {coded(name): i + 1 for i, name in enumerate(held)}, held


def from_groups(
    mesh: CellComplex, other: Any, main: list[int], dimensions: list[int]
) -> tuple[dict[str, np.ndarray], dict[str, int]]:
    """The markers that physical groups stand for.

    Parameters
    ----------
    mesh : Mesh
        The cells.
    other : meshio.Mesh
    main : list of int
        The blocks of ``other`` that contain the cells, in order.
    dimensions : list of int
        The dimension of each block.

    Returns
    -------
    markers : dict of str to array
        Faces by the names of their groups, or by their kind and number. Cells: "region" if groups of cells
        have names, and "gmsh:physical" for numbers, if some have none.
    regions : dict of str to int
        The number in "region" of each group of cells whose name is not "region 0", "region 1", ...
    """
    physical = other.cell_data.get("gmsh:physical")
    fields = {name: np.ravel(row).tolist() for name, row in other.field_data.items() if np.size(row) == 2}
    names = {(int(tag), int(d)): name for name, (tag, d) in fields.items()}
    markers, regions = _of_cells(mesh, other, main, names)
    faces: dict[str, np.ndarray] = {
        decoded(name): np.empty((0, d + 1), dtype=np.int32)
        for (_, d), name in names.items()
        if d < mesh.dimension
    }
    for i, block in enumerate(other.cells):
        if i in main:
            continue
        rows, kind = np.asarray(block.data), block.type
        tags = np.zeros(len(rows), dtype=int) if physical is None else np.asarray(physical[i])
        for tag in np.unique(tags).tolist():
            name = decoded(names.get((tag, dimensions[i]), kind if tag == 0 else f"{kind} {tag}"))
            part = rows[tags == tag]
            known = name in faces and len(faces[name])
            faces[name] = stacked([faces[name], part]) if known else part
    if is_ours(other):
        found = [
            _joined(_of_width(faces, width), _border(mesh, width), len(mesh.points)) for width in FACE_NAMES
        ]
        for name in faces:
            parts = [some[name] for some in found if name in some]
            faces[name] = stacked([part for part in parts if len(part)] or parts[:1] or [faces[name]])
    return markers | faces, regions


def _of_cells(
    mesh: CellComplex, other: Any, main: list[int], names: dict[tuple[int, int], str]
) -> tuple[dict[str, np.ndarray], dict[str, int]]:
    """The markers of cells, and the numbers of named regions.

    A number is that in "region 3", one less than that of the group in files of `Mesh.write`, or otherwise the
    place of the group among all.
    """
    physical = other.cell_data.get("gmsh:physical")
    if physical is None:
        return {}, {}
    tags = np.concatenate([np.asarray(physical[i]) for i in main]).astype(np.int64)
    used = set(np.unique(tags).tolist())
    called = {tag: name for (tag, d), name in names.items() if d == mesh.dimension}
    without = used - set(called)
    markers = {"gmsh:physical": tags} if without - {0} else {}
    if not used & set(called):
        return markers, {}
    groups = sorted(used | set(called), key=lambda tag: (tag == 0, tag))
    plain = {tag: match for tag in groups if (match := re.fullmatch(REGION, called.get(tag, "")))}
    if is_ours(other) or len(plain) == len(groups):
        number = {tag: int(plain[tag][1]) if tag in plain else tag - 1 for tag in groups}
    if not (is_ours(other) or len(plain) == len(groups)) or len(set(number.values())) < len(groups):
        number = {tag: i for i, tag in enumerate(groups)}
    place = np.array(sorted(groups))
    values = np.array([number[tag] for tag in place.tolist()])
    regions = {decoded(name): number[tag] for tag, name in called.items() if tag not in plain}
    return {"region": values[np.searchsorted(place, tags)], **markers}, regions
