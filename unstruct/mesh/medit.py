"""Medit's format ``.mesh``, as text: written with a reference for each region and each name of faces.

The format has one number for each cell and face, and no names. They are comments here, which other programs
pass over: ``# unstruct 3 1 left`` says that the cells (of dimension 3) of number 1 are called "left". Source:
P. Frey, *MEDIT: an interactive mesh visualization software*, INRIA RT-0253 (2001).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..base.decimals import rows_as_text
from .exchange import Exchange

__all__ = ["with_names", "write_medit"]

MEDIT_KINDS = {
    "line": "Edges",
    "triangle": "Triangles",
    "quad": "Quadrilaterals",
    "tetra": "Tetrahedra",
    "pyramid": "Pyramids",
    "wedge": "Prisms",
    "hexahedron": "Hexahedra",
}
SIGN = "# unstruct"
REFERENCE = "medit:ref"  # what meshio calls the numbers
GROUP = "gmsh:physical"


def write_medit(other: Exchange, path: Path) -> None:
    """Write a file; numbers of physical groups are the cell data "gmsh:physical"."""
    lines = ["MeshVersionFormatted 2", f"Dimension {other.points.shape[1]}", SIGN]
    for name, row in other.field_data.items():
        number, dimension = np.ravel(row).tolist()
        if dimension == 0:
            continue  # there are no cells of one vertex
        lines.append(f"{SIGN} {dimension} {number} {name}")
    n = len(other.points)
    with path.open("wb") as file:
        file.write("\n".join([*lines, f"Vertices\n{n}\n"]).encode())
        file.write(rows_as_text(None, other.points).replace(b"\n", b" 0\n"))
        tags = other.cell_data[GROUP]
        for kind in dict.fromkeys(block.type for block in other.cells):  # each once, as the format wants it
            if kind not in MEDIT_KINDS:
                continue
            parts = [
                np.column_stack([block.data + 1, tag])
                for block, tag in zip(other.cells, tags)
                if block.type == kind
            ]
            if parts:
                cells = np.concatenate(parts)
                file.write(f"{MEDIT_KINDS[kind]}\n{len(cells)}\n".encode() + rows_as_text(cells))
        file.write(b"End\n")


def with_names(path: Path, other: Exchange) -> Exchange:
    """What meshio has read from a file, with the groups of `write_medit`; other files are as they were."""
    head = path.read_bytes().partition(b"Vertices")[0].decode(errors="replace").splitlines()
    if SIGN not in head:
        return other
    for line in head:
        if line.startswith(SIGN + " "):
            dimension, number, name = line.removeprefix(SIGN + " ").split(" ", 2)
            other.field_data[name] = np.array([int(number), int(dimension)])
    other.cell_data = {GROUP: other.cell_data.pop(REFERENCE)}
    every = np.arange(len(other.points))
    other.point_data = {"origin": every, "kept": every}
    return other
