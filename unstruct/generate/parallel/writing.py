"""Meshes of parts as files of their own, with an index that programs open as one mesh (parallel VTU)."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from ...base.errors import InputError
from ...base.files import as_path
from ...mesh.domain_mesh import DomainMesh
from ...mesh.mesh import Mesh
from .records import Part

__all__ = ["write_index", "write_part"]

SECTIONS = ("PointData", "CellData", "Points")


def write_part(mesh: DomainMesh, part: Part, path: str) -> list[tuple[str, str, str, str]]:
    """Write the mesh of one part as .vtu; return what arrays the file has: section, type, name, components.

    Its cells have the number of the part, and that of their region in the whole.
    """
    markers: dict[str, Any] = {"part": np.full(mesh.size, part.number, dtype=np.int32)}
    if part.regions:
        names = {number: int(name) for name, number in mesh.regions.items()}
        markers["region"] = np.array([names[int(r)] for r in mesh.markers["region"]], dtype=np.int32)
    Mesh(mesh.points, cells=mesh.cells, markers=markers).write(path)
    found = []
    for section in ElementTree.parse(path).iter():
        if section.tag in SECTIONS:
            for array in section.iter("DataArray"):
                name, many = array.get("Name", ""), array.get("NumberOfComponents", "1")
                found.append((section.tag, array.get("type", ""), name, many))
    return found


def write_index(
    parts: list[Part], meshes: list[Any], path: str | Path, map_: Callable[..., Iterable[Any]]
) -> list[Path]:
    """Write the files of all parts through ``map_``, then the index; return the paths, the index first."""
    index = as_path(path)
    if index.suffix != ".pvtu":
        raise InputError(f"parts are written as .pvtu, not as {index.suffix!r}")
    width = len(str(len(parts) - 1))
    files = [index.with_name(f"{index.stem}_{part.number:0{width}d}.vtu") for part in parts]
    arrays = list(map_(write_part, meshes, parts, [str(file) for file in files]))
    common = [row for row in arrays[0] if all(row in others for others in arrays[1:])]
    root = ElementTree.Element("VTKFile", type="PUnstructuredGrid", version="0.1", byte_order="LittleEndian")
    grid = ElementTree.SubElement(root, "PUnstructuredGrid", GhostLevel="0")
    for section in SECTIONS:
        under = ElementTree.SubElement(grid, f"P{section}")
        for tag, kind, name, many in common:
            if tag == section:
                row = {"type": kind, "Name": name, "NumberOfComponents": many}
                ElementTree.SubElement(under, "PDataArray", row)
    for file in files:
        ElementTree.SubElement(grid, "Piece", Source=file.name)
    ElementTree.indent(root)
    ElementTree.ElementTree(root).write(index, encoding="utf-8", xml_declaration=True)
    return [index, *files]
