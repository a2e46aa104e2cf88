"""Gmsh's format ``.msh``, versions 2.2 and 4.1, as text or binary: writing. `msh` reads it.

Source: the Gmsh reference manual, chapter "File formats".
"""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

import numpy as np

from ..base.decimals import rows_as_text
from .exchange import Exchange
from .msh import MSH_TYPES
from .msh_parts import MSH_DIMENSIONS
from .msh_periodic import Link, links_of

__all__ = ["write_msh"]

TYPE_NUMBERS = {kind: number for number, (kind, _) in MSH_TYPES.items() if number < 8 or number == 15}


def write_msh(other: Exchange, path: Path, version: str, binary: bool) -> None:
    """Write a file; numbers of physical groups are the cell data "gmsh:physical".

    Parameters
    ----------
    other : Exchange
        Three coordinates. Further cell data are written for the whole mesh, and so are sides that match.
    path : Path
    version : str
        "2.2" or "4.1".
    binary : bool
    """
    tags = other.cell_data.get("gmsh:physical")
    if tags is None:
        tags = [np.zeros(len(block.data), dtype=np.int64) for block in other.cells]
    dimensions = [MSH_DIMENSIONS.get(block.type, 3) for block in other.cells]
    highest = max([int(physical.max(initial=0)) for physical in tags], default=0)
    free = 1 if version != "4.1" else highest + 1  # the entity of elements without a group
    entities = [np.where(physical > 0, physical, free).astype(np.int64) for physical in tags]
    links = links_of(other, max(dimensions, default=0), entities, tags)
    with path.open("wb") as file:
        file.write(f"$MeshFormat\n{version} {int(binary)} 8\n".encode())
        if binary:
            file.write(np.array([1], "<i4").tobytes() + b"\n")
        file.write(b"$EndMeshFormat\n")
        if other.field_data:
            file.write(f"$PhysicalNames\n{len(other.field_data)}\n".encode())
            for name, (tag, dimension) in other.field_data.items():
                file.write(f'{dimension} {tag} "{name}"\n'.encode())
            file.write(b"$EndPhysicalNames\n")
        if version == "4.1":
            _body4(file, other, tags, entities, links, binary)
        else:
            _body2(file, other, tags, entities, binary)
            _old_links(file, links)
        for name, values in other.point_data.items():
            _write_data(file, "NodeData", name, values, binary)
        for name, columns in other.cell_data.items():
            if not name.startswith("gmsh:"):
                _write_data(file, "ElementData", name, np.concatenate(columns), binary)


def _body2(
    file: BinaryIO, other: Exchange, tags: list[np.ndarray], entities: list[np.ndarray], binary: bool
) -> None:
    n = len(other.points)
    number = np.arange(1, n + 1)
    file.write(f"$Nodes\n{n}\n".encode())
    if binary:
        rows = np.empty(n, np.dtype([("tag", "<i4"), ("x", "<f8", 3)]))
        rows["tag"], rows["x"] = number, other.points
        file.write(rows.tobytes() + b"\n")
    else:
        file.write(rows_as_text(number[:, None], other.points))
    file.write(f"$EndNodes\n$Elements\n{sum(len(block.data) for block in other.cells)}\n".encode())
    start = 1
    for block, physical, entity in zip(other.cells, tags, entities):
        m = len(block.data)
        kind = TYPE_NUMBERS[block.type]
        part = [np.arange(start, start + m), physical, entity, block.data + 1]
        if binary and m:
            file.write(np.array([kind, m, 2], "<i4").tobytes())
            file.write(np.column_stack(part).astype("<i4").tobytes())
        elif m:
            file.write(rows_as_text(np.column_stack([part[0], np.full(m, kind), np.full(m, 2), *part[1:]])))
        start += m
    file.write(b"\n$EndElements\n" if binary else b"$EndElements\n")


def _old_links(file: BinaryIO, links: list[Link]) -> None:
    """The section $Periodic of version 2, always as text."""
    if not links:
        return
    lines = [f"$Periodic\n{len(links)}"]
    for link in links:
        lines.append(f"{link.dimension} {link.second} {link.first}")
        lines += [] if link.affine is None else [f"Affine {' '.join(map(repr, link.affine.tolist()))}"]
        lines.append(str(len(link.pairs)))
        lines += [f"{image} {vertex}" for vertex, image in (link.pairs + 1).tolist()]
    file.write("\n".join([*lines, "$EndPeriodic\n"]).encode())


def _body4(
    file: BinaryIO, other: Exchange, tags: list[np.ndarray], numbers: list[np.ndarray], links: list[Link],
    binary: bool,
) -> None:  # fmt: skip
    """Each physical group is one entity of its number; cells without one are in an entity of their own.

    Only the sides of motions are entities of other numbers.
    """
    dimensions = [MSH_DIMENSIONS.get(block.type, 3) for block in other.cells]
    entities: dict[tuple[int, int], int] = {}  # (dimension, entity) -> physical group
    parts = []
    start = 1
    for block, physical, column, dimension in zip(other.cells, tags, numbers, dimensions):
        number = np.arange(start, start + len(block.data))
        start += len(block.data)
        for entity in np.unique(column).tolist():
            some = column == entity
            entities[dimension, entity] = int(physical[int(np.argmax(some))])
            parts.append(
                (
                    dimension,
                    entity,
                    TYPE_NUMBERS[block.type],
                    np.column_stack([number[some], block.data[some] + 1]),
                )
            )
    for tag, dimension in other.field_data.values():  # groups without cells
        entities.setdefault((int(dimension), int(tag)), int(tag))
    for link in links:  # sides without elements
        for entity in (link.first, link.second):
            entities.setdefault((link.dimension, entity), 0)
    put = _Sink(file, binary)
    n = len(other.points)
    box = np.concatenate([other.points.min(axis=0), other.points.max(axis=0)]) if n else np.zeros(6)
    file.write(b"$Entities\n")
    put.sizes([sum(d == dimension for d, _ in entities) for dimension in range(4)])
    for dimension, entity in sorted(entities):
        tag = entities[dimension, entity]
        put.mixed(
            [
                ("i4", [entity]),
                ("f8", box[: 3 if dimension == 0 else 6].tolist()),
                ("u8", [1 if tag else 0]),
                ("i4", [tag] if tag else []),
                *([("u8", [0])] if dimension else []),
            ]
        )
    file.write(b"\n$EndEntities\n$Nodes\n" if binary else b"$EndEntities\n$Nodes\n")
    top = max(entities, default=(0, 1))
    put.sizes([1 if n else 0, n, min(n, 1), n])
    if n:
        put.mixed([("i4", [*top, 0]), ("u8", [n])])
        put.rows(np.arange(1, n + 1)[:, None], None)
        put.rows(None, other.points)
    file.write(b"\n$EndNodes\n$Elements\n" if binary else b"$EndNodes\n$Elements\n")
    put.sizes([len(parts), start - 1, min(start - 1, 1), start - 1])
    for dimension, entity, kind, rows in parts:
        put.mixed([("i4", [dimension, entity, kind]), ("u8", [len(rows)])])
        put.rows(rows, None)
    file.write(b"\n$EndElements\n" if binary else b"$EndElements\n")
    if links:
        file.write(b"$Periodic\n")
        put.sizes([len(links)])
        for link in links:
            affine = [] if link.affine is None else link.affine.tolist()
            put.mixed([("i4", [link.dimension, link.second, link.first])])
            put.mixed([("u8", [len(affine)]), ("f8", affine)])
            put.sizes([len(link.pairs)])
            put.rows(link.pairs[:, ::-1] + 1, None)
        file.write(b"\n$EndPeriodic\n" if binary else b"$EndPeriodic\n")


class _Sink:
    """Writes the numbers of version 4.1 in either form."""

    def __init__(self, file: BinaryIO, binary: bool):
        self.file, self.binary = file, binary

    def sizes(self, values: list[int]) -> None:
        self.mixed([("u8", values)])

    def mixed(self, values: list[tuple[str, list]]) -> None:
        """A line of numbers of several types."""
        if self.binary:
            self.file.write(b"".join(np.array(part, "<" + kind).tobytes() for kind, part in values))
        else:
            words = [repr(value) for _, part in values for value in part]
            self.file.write(f"{' '.join(words)}\n".encode())

    def rows(self, integers: np.ndarray | None, reals: np.ndarray | None) -> None:
        if self.binary:
            self.file.write(
                integers.astype("<u8").tobytes() if integers is not None else reals.astype("<f8").tobytes()  # type: ignore[union-attr]
            )
        else:
            self.file.write(rows_as_text(integers, reals))


def _write_data(file: BinaryIO, section: str, name: str, values: np.ndarray, binary: bool) -> None:
    n = len(values)
    rows = np.asarray(values, dtype=np.float64).reshape(n, -1)
    width = rows.shape[1]
    file.write(f'${section}\n1\n"{name}"\n1\n0.0\n3\n0\n{width}\n{n}\n'.encode())
    number = np.arange(1, n + 1)
    if binary:
        packed = np.empty(n, np.dtype([("tag", "<i4"), ("value", "<f8", width)]))
        packed["tag"] = number
        packed["value"] = rows if width > 1 else rows[:, 0].reshape(packed["value"].shape)
        file.write(packed.tobytes() + f"\n$End{section}\n".encode())
    else:
        file.write(rows_as_text(number[:, None], rows) + f"$End{section}\n".encode())
