"""Gmsh's format ``.msh``, versions 2.2 and 4.1, as text or binary: reading. `msh_writing` writes it.

Cells of higher order are read by their corners, which come first. An entity of version 4.1 may be in several
physical groups, or in none (Mesh.SaveAll). Source: the Gmsh reference manual, chapter "File formats".
"""

from __future__ import annotations

import re
from codecs import BOM_UTF8
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..base.errors import InputError
from ..base.files import bytes_of
from .exchange import Block, Exchange, rows_in_runs
from .grouping import group_rows
from .msh_parts import MSH_DIMENSIONS, MshSource, msh_data, values_of_cells
from .msh_periodic import read_links, read_old_links

__all__ = ["MSH_TYPES", "msh_version", "read_msh"]

# number of the type -> (kind of the corners, number of nodes)
MSH_TYPES: dict[int, tuple[str, int]] = {
    **{1: ("line", 2), 8: ("line", 3), 26: ("line", 4), 27: ("line", 5), 28: ("line", 6)},
    **{2: ("triangle", 3), 9: ("triangle", 6), 20: ("triangle", 9), 21: ("triangle", 10)},
    **{22: ("triangle", 12), 23: ("triangle", 15), 24: ("triangle", 15), 25: ("triangle", 21)},
    **{3: ("quad", 4), 10: ("quad", 9), 16: ("quad", 8), 36: ("quad", 16), 37: ("quad", 25)},
    **{4: ("tetra", 4), 11: ("tetra", 10), 29: ("tetra", 20), 30: ("tetra", 35), 31: ("tetra", 56)},
    **{5: ("hexahedron", 8), 12: ("hexahedron", 27), 17: ("hexahedron", 20), 92: ("hexahedron", 64)},
    **{6: ("wedge", 6), 13: ("wedge", 18), 18: ("wedge", 15), 90: ("wedge", 40)},
    **{7: ("pyramid", 5), 14: ("pyramid", 14), 19: ("pyramid", 13), 118: ("pyramid", 30)},
    15: ("vertex", 1),
}
MSH_CORNERS = {kind: min(n for k, n in MSH_TYPES.values() if k == kind) for kind, _ in MSH_TYPES.values()}


class _Cells(NamedTuple):
    """Cells of one kind from one place of a file."""

    kind: str
    numbers: np.ndarray  # (m,) tags of the elements
    nodes: np.ndarray  # (m, k) tags of the nodes
    groups: list[np.ndarray]  # physical groups: columns (m,), 0 for none


def _sections(path: Path, data: bytes) -> dict[str, list[bytes]]:
    """The contents of sections by name; unknown ones too."""
    found: dict[str, list[bytes]] = {}
    at = 0
    while match := re.compile(rb"^[ \t]*\$(\w+)[ \t]*\r?\n", re.MULTILINE).search(data, at):
        name = match[1].decode()
        end = data.find(b"$End" + match[1], match.end())
        if end < 0:
            raise InputError(f"{path.name} ends within the section ${name}: it is incomplete")
        found.setdefault(name, []).append(data[match.end() : end])
        at = end + len(name) + 4
    return found


def msh_version(path: Path) -> tuple[str, dict[str, list[bytes]], str]:
    """The version of a file, its sections, and the order of bytes ("" for text)."""
    sections = _sections(path, bytes_of(path).removeprefix(BOM_UTF8))
    if "MeshFormat" not in sections:
        raise InputError(
            f"{path.name} is not in Gmsh's format: there is no section $MeshFormat; if it comes from Ansys "
            "Fluent, convert it first"
        )
    head, _, rest = sections["MeshFormat"][0].partition(b"\n")
    words = head.decode("latin-1").split()
    if len(words) != 3 or words[1] not in ("0", "1"):
        raise InputError(f"{path.name}: {' '.join(words)!r} is not a version, 0 or 1, and a size")
    order = ("<" if rest[:4] == b"\x01\0\0\0" else ">") if words[1] == "1" else ""
    return words[0], sections, order


def read_msh(path: Path, version: str, sections: dict[str, list[bytes]], order: str) -> Exchange:
    """Read a file; what the arguments are is said at `msh_version`.

    Raises
    ------
    InputError
        For a file that is incomplete, wrong, or of another version; the message names file and section.
    """
    if version not in ("2.2", "2.1", "2", "2.0", "4.1"):
        raise InputError(
            f"{path.name}: version {version} of Gmsh's format is not read; save it as 4.1 or 2.2"
        )
    missing = {"Nodes", "Elements"} - set(sections)
    if missing:
        raise InputError(f"{path.name} has no section ${min(missing)}: it contains no cells")
    nodes, elements = (MshSource(path, name, sections[name][0], order) for name in ("Nodes", "Elements"))
    if version == "4.1":
        entities = _entities(MshSource(path, "Entities", sections.get("Entities", [b""])[0], order))
        tags, points = _nodes4(nodes)
        parts = list(_elements4(elements, entities))
    else:
        tags, points = _nodes2(nodes)
        parts = [part for part in _elements2(elements) if len(part.numbers)]
    number = _Numbers(nodes, tags)
    blocks = _joined_parts(parts)
    if version != "4.1":
        blocks = [_once(part) for part in blocks]
    cells, groups, counts, middles = [], [], [], [np.empty(0, dtype=np.int64)]
    for part in blocks:
        rows = number(part.nodes, "Elements")
        corners = MSH_CORNERS[part.kind]
        middles.append(rows[:, corners:].ravel())
        cells.append(Block(part.kind, rows[:, :corners]))
        groups.append(part.groups)
        counts.append(part.numbers)
    result = Exchange(points, cells)
    result.middles = np.concatenate(middles)
    result.field_data = _names(path, sections)
    _add_groups(result, groups)
    for data in sections.get("Periodic", []):
        # Gmsh passes the section of version 2 on unread, also to files of version 4.1.
        old = version != "4.1" or b"Affine" in data
        links = read_old_links(path, data) if old else read_links(MshSource(path, "Periodic", data, order))
        result.links += [link._replace(pairs=number(link.pairs, "Periodic")) for link in links]
    for data in sections.get("NodeData", []):
        name, rows, values = msh_data(path, "NodeData", data, order)
        column = np.zeros((len(points), values.shape[1]))
        column[number(rows, "NodeData")] = values
        result.point_data[name] = column[:, 0] if values.shape[1] == 1 else column
    for data in sections.get("ElementData", []):
        name, rows, values = msh_data(path, "ElementData", data, order)
        result.cell_data[name] = values_of_cells(rows, values, counts)
    # faces in further groups are further blocks, without data of their own
    for columns in result.cell_data.values():
        for block in result.cells[len(columns) :]:
            columns.append(np.zeros((len(block.data), *columns[0].shape[1:]), dtype=columns[0].dtype))
    return result


class _Numbers:
    """The rows of nodes by their tags."""

    def __init__(self, source: MshSource, tags: np.ndarray):
        self.source, self.order = source, np.argsort(tags, kind="stable")
        self.tags = tags[self.order]
        self.plain = bool((tags == np.arange(1, len(tags) + 1)).all())
        twice = np.nonzero(np.diff(self.tags) == 0)[0]
        if len(twice):
            raise source.error(f"node {self.tags[twice[0]]} occurs twice")

    def __call__(self, tags: np.ndarray, section: str) -> np.ndarray:
        place = tags - 1 if self.plain else np.searchsorted(self.tags, tags)
        inside = (place >= 0) & (place < len(self.tags))
        known = inside & (self.tags[np.where(inside, place, 0)] == tags) if len(self.tags) else inside
        if not known.all():
            raise InputError(
                f"{self.source.path.name}, section ${section}: there is no node {tags[~known].flat[0]}"
            )
        return place if self.plain else self.order[place]


def _nodes2(source: MshSource) -> tuple[np.ndarray, np.ndarray]:
    n = source.line()
    if source.flat is not None:
        rows = source.reals(4 * n).reshape(n, 4)
        return rows[:, 0].astype(np.int64), rows[:, 1:].copy()
    kind = np.dtype([("tag", source.order + "i4"), ("x", source.order + "f8", 3)])
    data = source.data[source.at : source.at + n * kind.itemsize]
    if len(data) < n * kind.itemsize:
        raise source.error("it ends too early")
    rows = np.frombuffer(data, kind)
    return rows["tag"].astype(np.int64), rows["x"].astype(np.float64)


def _kind(source: MshSource, number: int) -> tuple[str, int]:
    if number not in MSH_TYPES:
        raise source.error(f"cells of type {number} are not known; known are {sorted(MSH_TYPES)}")
    return MSH_TYPES[number]


def _elements2(source: MshSource) -> Iterator[_Cells]:
    n = source.line()
    if source.flat is not None:
        flat = source.flat[source.at :].astype(np.int64)
        try:
            for rows in rows_in_runs(
                flat, n, slice(1, 3), lambda head: 3 + int(head[1]) + _kind(source, int(head[0]))[1], "cells"
            ):
                kind, tags = _kind(source, int(rows[0, 1]))[0], int(rows[0, 2])
                yield _Cells(kind, rows[:, 0], rows[:, 3 + tags :], [rows[:, 3]] if tags else [])
        except InputError as error:
            if source.path.name in str(error):
                raise
            raise source.error(str(error)) from None
        return
    done = 0
    while done < n:
        number, many, tags = source.ints(3).tolist()
        kind, width = _kind(source, number)
        rows = source.ints(many * (1 + tags + width)).reshape(many, -1)
        yield _Cells(kind, rows[:, 0], rows[:, 1 + tags :], [rows[:, 1]] if tags else [])
        done += many


def _entities(source: MshSource) -> dict[tuple[int, int], list[int]]:
    """The physical groups of each entity (dimension, tag)."""
    found: dict[tuple[int, int], list[int]] = {}
    if not source.data.strip():
        return found
    for dimension, count in enumerate(source.sizes(4).tolist()):
        for _ in range(count):
            tag = int(source.ints(1)[0])
            source.reals(3 if dimension == 0 else 6)
            found[dimension, tag] = np.abs(source.ints(source.sizes(1)[0])).tolist()
            if dimension:
                source.ints(source.sizes(1)[0])
    return found


def _nodes4(source: MshSource) -> tuple[np.ndarray, np.ndarray]:
    blocks = int(source.sizes(4)[0])
    tags, points = [np.empty(0, dtype=np.int64)], [np.empty((0, 3))]
    for _ in range(blocks):
        dimension, _, parametric = source.ints(3).tolist()
        n = int(source.sizes(1)[0])
        tags.append(source.sizes(n))
        width = 3 + (dimension if parametric else 0)
        points.append(source.reals(n * width).reshape(n, width)[:, :3])
    return np.concatenate(tags), np.concatenate(points)


def _elements4(source: MshSource, entities: dict[tuple[int, int], list[int]]) -> Iterator[_Cells]:
    for _ in range(int(source.sizes(4)[0])):
        dimension, tag, number = source.ints(3).tolist()
        many = int(source.sizes(1)[0])
        kind, width = _kind(source, number)
        rows = source.sizes(many * (1 + width)).reshape(many, -1)
        groups = [np.full(many, group) for group in entities.get((dimension, tag), [])]
        yield _Cells(kind, rows[:, 0], rows[:, 1:], groups)


def _joined_parts(parts: list[_Cells]) -> list[_Cells]:
    """Parts of the same kind and number of nodes as one, in the order of the elements' tags."""
    together: dict[tuple[str, int], list[_Cells]] = {}
    for part in parts:
        together.setdefault((part.kind, part.nodes.shape[1]), []).append(part)
    result = []
    for (kind, _), some in together.items():
        groups = []
        for i in range(max(len(part.groups) for part in some)):
            missing = [np.zeros(len(part.numbers), dtype=np.int64) for part in some]
            groups.append(
                np.concatenate([p.groups[i] if i < len(p.groups) else m for p, m in zip(some, missing)])
            )
        numbers, nodes = (np.concatenate([getattr(p, name) for p in some]) for name in ("numbers", "nodes"))
        order = np.argsort(numbers, kind="stable")
        result.append(_Cells(kind, numbers[order], nodes[order], [column[order] for column in groups]))
    return result


def _once(part: _Cells) -> _Cells:
    """Cells that are there several times, once for each of their groups, once with all these groups."""
    group, first = group_rows(np.sort(part.nodes, axis=1))
    if len(first) == len(group) or not part.groups:
        return part
    order = np.argsort(group, kind="stable")
    start = np.searchsorted(group[order], np.arange(len(first)))
    rank = np.arange(len(group)) - start[group[order]]
    columns = np.zeros((rank.max() + 1, len(first)), dtype=np.int64)
    columns[rank, group[order]] = part.groups[0][order]
    keep = np.argsort(first)
    return _Cells(part.kind, part.numbers[first[keep]], part.nodes[first[keep]], list(columns[:, keep]))


def _add_groups(result: Exchange, groups: list[list[np.ndarray]]) -> None:
    """Groups as "gmsh:physical"; further ones of faces as blocks; groups of cells that overlap as sets."""
    if not any(groups):
        return
    first = [g[0] if g else np.zeros(len(b.data), dtype=np.int64) for g, b in zip(groups, result.cells)]
    names = {(int(tag), int(d)): name for name, (tag, d) in result.field_data.items()}
    dimensions = [MSH_DIMENSIONS.get(block.type, 3) for block in result.cells]
    top = max(dimensions)
    overlap = any(len(groups[i]) > 1 for i, d in enumerate(dimensions) if d == top)
    for i, block in enumerate(list(result.cells)):
        for column in groups[i] if overlap and dimensions[i] == top else groups[i][1:]:
            if dimensions[i] < top:
                result.cells.append(Block(block.type, block.data[column > 0]))
                first.append(column[column > 0])
                continue
            for tag in np.unique(column[column > 0]).tolist():
                name = names.get((tag, dimensions[i]), f"{block.type} {tag}")
                sets = result.sets.setdefault(name, [np.zeros(len(b.data), dtype=bool) for b in result.cells])
                sets[i] |= column == tag
        if overlap and dimensions[i] == top:
            first[i] = np.zeros(len(block.data), dtype=np.int64)
    result.cell_data["gmsh:physical"] = first


def _names(path: Path, sections: dict[str, list[bytes]]) -> dict[str, np.ndarray]:
    found = {}
    for line in sections.get("PhysicalNames", [b"0"])[0].decode("utf-8", "replace").splitlines()[1:]:
        if line.strip():
            match = re.fullmatch(r'\s*(\d+)\s+(-?\d+)\s+"(.*)"\s*', line)
            if match is None:
                raise InputError(
                    f"{path.name}, section $PhysicalNames: {line!r} is not a dimension, a number and a name"
                )
            found[match[3]] = np.array([int(match[2]), int(match[1])])
    return found
