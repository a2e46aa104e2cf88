"""The format of SU2, a solver of flows: cells, points, and the named parts of the boundary.

Each facet of the boundary has one marker, the first one other than "facets" that names it; facets that have
no other name are "facets". Source: the SU2 documentation, "Mesh file".
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from ..base.decimals import numbers_of, rows_as_text
from ..base.errors import InputError
from ..base.files import text_of
from .complex import CellComplex
from .exchange import border_groups, plain_names, rows_in_runs
from .gmsh import stacked

__all__ = ["read_su2", "write_su2"]

SU2_TYPES = {
    3: ("line", 2),
    5: ("triangle", 3),
    9: ("quad", 4),
    10: ("tetra", 4),
    12: ("hexahedron", 8),
    13: ("wedge", 6),
    14: ("pyramid", 5),
}
SU2_NUMBERS = {kind: number for number, (kind, _) in SU2_TYPES.items()}
WIDTH_NUMBERS = {2: 3, 3: 5, 4: 9}  # facets with so many corners


def write_su2(mesh: CellComplex, path: Path) -> tuple[list[str], dict[str, str]]:
    """Write a file; return the markers that it does not hold completely, and the names in it by names."""
    n, d = mesh.points.shape
    if mesh.dimension != d or d not in (2, 3):
        raise InputError(
            f"SU2 has meshes of the plane and of space, not cells of dimension {mesh.dimension} in {d} "
            "dimensions"
        )
    parts = [f"NDIME= {d}\nNELEM= {mesh.size}\n".encode()]
    start = 0
    for kind, block in mesh.cells.items():
        m = len(block)
        columns = [np.full(m, SU2_NUMBERS[kind]), np.asarray(block), np.arange(start, start + m)]
        parts.append(rows_as_text(np.column_stack(columns)))
        start += m
    parts += [f"NPOIN= {n}\n".encode(), rows_as_text(None, mesh.points)]
    border = np.asarray(mesh.boundary)
    groups, lost = border_groups(mesh, border)
    tags = plain_names(groups)
    parts.append(f"NMARK= {len(groups)}\n".encode())
    at = 0
    lines = _lines_of(border, list(groups.values()))
    for name, rows in groups.items():
        parts.append(f"MARKER_TAG= {tags[name]}\nMARKER_ELEMS= {len(rows)}\n".encode())
        parts += lines[at : at + len(rows)]
        at += len(rows)
    path.write_bytes(b"".join(parts))
    return lost, tags


def _lines_of(border: np.ndarray, groups: list[np.ndarray]) -> list[bytes]:
    """The line of each facet, group by group, facets with fewer corners first: all groups at once."""
    if not groups:
        return []
    faces = border[np.concatenate(groups)]
    sizes = (faces >= 0).sum(axis=1)
    order = np.lexsort((sizes, np.repeat(np.arange(len(groups)), [len(rows) for rows in groups])))
    faces, sizes = faces[order], sizes[order]
    lines = np.empty(len(faces), dtype=object)
    for size in np.unique(sizes).tolist():
        some = np.flatnonzero(sizes == size)
        rows = np.column_stack([np.full(len(some), WIDTH_NUMBERS[size]), faces[some, :size]])
        lines[some] = rows_as_text(rows).splitlines(keepends=True)
    return lines.tolist()


# ---------------------------------------------------------------------- reading


def read_su2(path: Path) -> dict[str, Any]:
    """Read a file: the arguments of a `Mesh`; each marker names faces.

    Raises
    ------
    InputError
        For files that are incomplete or wrong; the message names file and line.
    """
    text = re.sub(r"%[^\r\n]*|^[ \t]*SEND_[A-Z]+[ \t]*=[^\r\n]*", "", text_of(path), flags=re.MULTILINE)
    entries = list(re.finditer(r"^[ \t]*([A-Z_]+)[ \t]*=[ \t]*([^\r\n]*)", text, re.MULTILINE))
    if not any(entry[1] == "NDIME" for entry in entries):
        raise InputError(f"{path.name} is not in SU2's format: there is no line 'NDIME= 2' or 'NDIME= 3'")
    file = _File(path, text)
    d, tag = 0, ""
    cells: dict[str, np.ndarray] | None = None
    points: np.ndarray | None = None
    markers: dict[str, np.ndarray] = {}
    ends = [entry.start() for entry in entries[1:]] + [len(text)]
    for entry, end in zip(entries, ends, strict=True):
        key, value, body = entry[1], entry[2].strip(), text[entry.end() : end]
        file.at = entry.start()
        if key == "NZONE" and value != "1":
            raise file.error(f"there are {value} zones; write each to a file of its own")
        elif key == "NDIME":
            d = file.count(value)
            if d not in (2, 3):
                raise file.error(f"the dimension is {d}, not 2 or 3")
        elif key == "NPOIN":
            points = file.points(file.count(value), d, body)
        elif key == "NELEM":
            cells = file.cells(file.count(value), body)
        elif key == "MARKER_TAG":
            tag = value
        elif key == "MARKER_ELEMS":
            found = list(file.cells(file.count(value), body).values())
            markers[tag] = stacked(
                [markers[tag], *found] if tag in markers else found or [np.empty((0, d), int)]
            )
    if cells is None or points is None:
        raise InputError(f"{path.name} has no {'NELEM' if cells is None else 'NPOIN'}: it is incomplete")
    every = [*cells.items(), *markers.items()]
    for name, rows in every:
        if rows.size and not -1 <= rows.min() <= rows.max() < len(points):
            raise InputError(
                f"{path.name}: {name!r} has the vertex {int(rows.max())}, but NPOIN says {len(points)}; SU2 "
                "counts from 0"
            )
    if not cells:
        return {"points": points, "simplices": np.empty((0, d + 1), dtype=np.int32), "markers": markers}
    return {"points": points, "cells": cells, "markers": markers}


class _File:
    """A text that is being read: errors name the line."""

    def __init__(self, path: Path, text: str):
        self.path, self.text, self.at = path, text, 0

    def error(self, what: str) -> InputError:
        line = self.text.count("\n", 0, self.at) + 1
        return InputError(f"{self.path.name}, line {line}: {what}")

    def count(self, value: str) -> int:
        words = value.split()
        if not words or not words[0].isdigit():
            raise self.error(f"{value!r} is no count")
        return int(words[0])

    def _numbers(self, body: str, kind: type) -> np.ndarray:
        found = numbers_of(body, kind)
        if found is None:
            for i, line in enumerate(body.splitlines()):
                if numbers_of(line, kind) is None:
                    number = self.text.count("\n", 0, self.at) + 1 + i
                    what = f"a row of {'whole ' if kind is int else ''}numbers"
                    raise InputError(f"{self.path.name}, line {number}: {line.strip()!r} is not {what}")
        return found  # type: ignore[return-value]

    def points(self, n: int, d: int, body: str) -> np.ndarray:
        if not d:
            raise self.error("NDIME must come before NPOIN")
        flat = self._numbers(body, float)
        width = len(flat) // n if n else d
        if width < d or len(flat) != n * width:
            raise self.error(f"{n} points of {d} coordinates are announced, but {len(flat)} numbers follow")
        return np.ascontiguousarray(flat.reshape(n, width)[:, :d])

    def cells(self, n: int, body: str) -> dict[str, np.ndarray]:
        flat = self._numbers(body, int)
        first = next((line.split() for line in body.splitlines() if line.strip()), [])
        extra = len(first) - 1 - self._known(first[0])[1] if first else 0
        result: dict[str, list[np.ndarray]] = {}
        try:
            for rows in rows_in_runs(
                flat, n, slice(0, 1), lambda head: 1 + self._known(head[0])[1] + extra, "cells"
            ):
                kind, width = self._known(rows[0, 0])
                result.setdefault(kind, []).append(rows[:, 1 : 1 + width])
        except InputError as error:
            raise error if self.path.name in str(error) else self.error(str(error)) from None
        return {kind: np.concatenate(parts) for kind, parts in result.items()}

    def _known(self, number: Any) -> tuple[str, int]:
        if not str(number).isdigit() or int(number) not in SU2_TYPES:
            raise self.error(f"cells of type {number} are not known; known are {sorted(SU2_TYPES)}")
        return SU2_TYPES[int(number)]
