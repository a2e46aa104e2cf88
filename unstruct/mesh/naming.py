"""Names of regions: what the numbers in the marker "region" are called."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote

import numpy as np

from ..base.errors import InputError
from ..base.files import suffix_of

__all__ = ["WITH_NAMES", "add_names", "as_region_names", "found_names", "names_by_number"]

WITH_NAMES = (".vtu", ".vtk", ".xdmf", ".xmf")  # formats whose names have no place in meshio's files
FIELD = "region:"  # before the name of a region among field data


def as_region_names(regions: Any, markers: Mapping[str, np.ndarray]) -> dict[str, int]:
    """Numbers by name, checked: whole numbers, all different, for cells that have the marker "region".

    Raises
    ------
    InputError
        The message names the first name that is wrong.
    """
    if not isinstance(regions, Mapping):
        raise InputError(f"regions must be a dict of numbers by name, not {type(regions).__name__}")
    number = markers.get("region")
    if number is None or number.ndim != 1:
        raise InputError("regions names values of the marker 'region', which this mesh does not have")
    found: dict[str, int] = {}
    owner: dict[int, str] = {}
    for name, value in regions.items():
        if isinstance(value, bool) or not isinstance(value, int | np.integer):
            raise InputError(f"regions[{name!r}] must be a whole number, not {value!r}")
        other = owner.setdefault(int(value), str(name))
        if other != str(name):
            raise InputError(f"regions {other!r} and {str(name)!r} have the same number {value}: join them")
        found[str(name)] = int(value)
    return found


def names_by_number(regions: Mapping[str, int]) -> dict[int, str]:
    """Names by number."""
    return {number: name for name, number in regions.items()}


# ---------------------------------------------------------------------- field data of VTK's files


def add_names(path: Path, regions: Mapping[str, int]) -> None:
    """Put names of regions into a file that meshio has written, as field data "region:<name>"."""
    names = {FIELD + quote(name, safe="()[]{}/:,;=+-*|~!@#$^?'"): number for name, number in regions.items()}
    content = path.read_bytes()
    if suffix_of(path) == ".vtu":
        at = content.index(b"<UnstructuredGrid>") + len(b"<UnstructuredGrid>")
        rows = "".join(
            f'<DataArray type="Int64" Name="{name}" NumberOfTuples="1" format="ascii">{number}</DataArray>\n'
            for name, number in names.items()
        )
        added = f"\n<FieldData>\n{rows}</FieldData>\n".encode()
    elif suffix_of(path) in (".xdmf", ".xmf"):  # as meshio reads them: names in a document inside
        at = content.index(b">", content.index(b"<Grid ")) + 1
        rows = "".join(f'<map key="{name}" dim="0">{number}</map>' for name, number in names.items())
        added = f'<Information Name="regions"><![CDATA[<main>{rows}</main>]]></Information>'.encode()
    else:
        at = content.index(b"DATASET UNSTRUCTURED_GRID\n") + len(b"DATASET UNSTRUCTURED_GRID\n")
        text = b"\nASCII\n" in content[:at]
        fields = b"".join(
            f"{name} 1 1 vtktypeint64\n".encode()
            + (str(number).encode() if text else number.to_bytes(8, "big", signed=True))
            + b"\n"
            for name, number in names.items()
        )
        added = f"FIELD FieldData {len(names)}\n".encode() + fields
    path.write_bytes(content[:at] + added + content[at:])


def found_names(path: Path, other: Any) -> dict[str, int]:
    """The names that `add_names` has put into a file; ``other`` is what meshio has read from it."""
    if suffix_of(path) == ".vtu":
        fields = {
            name: int(np.ravel(rows)[0]) for name, rows in other.field_data.items() if np.size(rows) == 1
        }
    elif suffix_of(path) in (".xdmf", ".xmf"):
        fields = {name: int(row[0]) for name, row in other.field_data.items()}
    else:  # meshio drops field data of the grid
        head = path.read_bytes().partition(b"POINTS ")[0]
        if b"\nASCII\n" in head:
            words = re.findall(rb"\n(\S+) 1 1 vtktypeint64\n(-?\d+)(?=\n)", head)
            fields = {name.decode(): int(number) for name, number in words}
        else:
            rows = re.findall(rb"\n(\S+) 1 1 vtktypeint64\n(.{8})(?=\n)", head, re.DOTALL)
            fields = {name.decode(): int.from_bytes(number, "big", signed=True) for name, number in rows}
    return {unquote(k.removeprefix(FIELD)): number for k, number in fields.items() if k.startswith(FIELD)}
