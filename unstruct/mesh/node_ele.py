"""Triangle's and TetGen's ``.node`` and ``.ele``: points with their numbers, simplices by these numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..base.decimals import rows_as_text
from ..base.errors import InputError, MeshError
from ..base.files import suffix_of, text_of
from ..base.tables import Rows, table
from .complex import CellComplex
from .second_order import without_middles

__all__ = ["read_node_ele", "read_points", "write_node_ele"]


def write_node_ele(mesh: CellComplex, path: Path) -> None:
    """Write .node and .ele, numbered from 0, with as many digits as restore each double exactly."""
    if not mesh.is_simplicial:
        kinds = ", ".join(mesh.cells)
        raise MeshError(
            f".node and .ele store simplices of one kind, not {kinds}: write .vtu, or select them"
        )
    n, d = mesh.points.shape
    points = rows_as_text(np.arange(n)[:, None], mesh.points)
    node, ele = (
        path if suffix_of(path) == name else path.with_suffix(_like(path.suffix, name))
        for name in (".node", ".ele")
    )
    node.write_bytes(f"{n} {d} 0 0\n".encode() + points)
    rows = rows_as_text(np.column_stack([np.arange(mesh.size), mesh.simplices]))
    ele.write_bytes(f"{mesh.size} {mesh.dimension + 1} 0\n".encode() + rows)


def _like(given: str, suffix: str) -> str:
    return suffix.upper() if given.isupper() else suffix


def _partner(path: Path, suffix: str) -> Path:
    """The file of the same name with another suffix, whatever its case."""
    if suffix_of(path) == suffix:
        return path
    for name in (_like(path.suffix, suffix), suffix, suffix.upper()):
        if path.with_suffix(name).exists():
            return path.with_suffix(name)
    return path.with_suffix(_like(path.suffix, suffix))


def read_points(path: Path) -> tuple[np.ndarray, dict[int, np.ndarray], int]:
    """Read a .node file: points, vertices by boundary mark other than 0, and the number of the first."""
    header, rows, first = table(path, text_of(path), "vertex", lambda head: _node_width(path, head))
    d, attributes, marks = (*header[1:], 0, 0)[:3]
    found: dict[int, np.ndarray] = {}
    if marks:
        values = rows[:, d + attributes].astype(np.int64)
        found = {value: np.nonzero(values == value)[0] for value in np.unique(values[values != 0]).tolist()}
    return np.ascontiguousarray(rows[:, :d], dtype=np.float64), found, first


def _node_width(path: Path, header: list[int]) -> int:
    if len(header) < 2 or min(header) < 0 or header[1] < 1:
        raise InputError(
            f"{path.name}: the header must be the number of vertices, the dimension, the number of "
            f"attributes and that of boundary marks, not {' '.join(map(str, header))!r}"
        )
    return 1 + sum(header[1:4])


def _ele_width(path: Path, header: list[int]) -> int:
    if len(header) < 2 or min(header) < 0 or header[1] < 2:
        raise InputError(
            f"{path.name}: the header must be the number of cells, the number of vertices of each and that "
            f"of attributes, not {' '.join(map(str, header))!r}"
        )
    return 1 + sum(header[1:3])


def read_node_ele(path: Path) -> dict[str, Any]:
    """Read .node and .ele, numbered like their first vertex; attributes and boundary marks become markers.

    A .node file without its .ele is a set of points: a mesh without cells.
    """
    node, ele = _partner(path, ".node"), _partner(path, ".ele")
    points, marks, first = read_points(node)
    n, d = points.shape
    markers: dict[str, np.ndarray] = {f"vertices {mark}": rows[:, None] for mark, rows in marks.items()}
    if path == node and not ele.exists():
        return {"points": points, "simplices": np.empty((0, d + 1), dtype=np.int32), "markers": markers}
    text = text_of(ele)
    header, rows, _ = table(ele, text, "cell", lambda head: _ele_width(ele, head))
    corners = _corners(ele, header[1], d)
    cells = rows[:, : header[1]].astype(np.int64) - first
    wrong = ((cells < 0) | (cells >= n)).any(axis=1)
    if wrong.any():
        row = int(np.argmax(wrong))
        line = Rows(ele, text).lines[1 + row][0]
        raise InputError(
            f"{ele.name}, line {line}: cell {(cells[row] + first).tolist()} has a vertex that {node.name} "
            f"does not have; it has {first} to {first + n - 1}"
        )
    for i in range(header[1], rows.shape[1]):
        name = "attribute" if i == header[1] else f"attribute{i - header[1]}"
        markers[name] = rows[:, i].astype(np.float64)
    result = {"points": points, "simplices": cells[:, :corners], "markers": markers}
    return result if corners == header[1] else without_middles(ele.name, result, cells[:, corners:])


def _corners(path: Path, nodes: int, d: int) -> int:
    """The number of corners of cells with so many nodes."""
    for k in range(1, d + 1):
        if nodes == k + 1 or (nodes == (k + 1) * (k + 2) // 2 and k == d):
            return k + 1
    raise InputError(
        f"{path.name}: cells have {nodes} nodes, but simplices in {d} dimensions have {d + 1}, or "
        f"{(d + 1) * (d + 2) // 2} of second order"
    )
