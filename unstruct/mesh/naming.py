"""Names of regions: what the numbers in the marker "region" are called."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote

import numpy as np

from ..base.arrays import frozen, within
from ..base.checked import by_name
from ..base.errors import InputError
from ..base.files import suffix_of

__all__ = [
    "WITH_NAMES",
    "add_names",
    "as_marker",
    "as_region_names",
    "as_region_number",
    "found_names",
    "names_by_number",
]

WITH_NAMES = (".vtu", ".vtk", ".xdmf", ".xmf")  # formats whose names have no place in meshio's files
MOST_REGION = 2**63 - 1
FIELD = "region:"  # before the name of a region among field data


def as_marker(
    name: str, values: Any, _: Mapping[str, np.ndarray], size: int, vertices: int, padded: bool
) -> np.ndarray:
    """A marker, checked: one number per cell, or rows of vertices; read-only.

    Parameters
    ----------
    name : str
    values : array_like
    size, vertices : int
        The numbers of cells and of vertices.
    padded : bool
        Whether rows may end in -1.

    Raises
    ------
    InputError
        The message names the first entry that is wrong.
    """
    try:
        array = np.asanyarray(values)
    except ValueError:  # ragged lists
        array = np.empty(0, dtype=object)
    if np.ma.isMaskedArray(array) and np.ma.getmaskarray(array).any():
        row = int(np.argwhere(np.ma.getmaskarray(array))[0][0])
        raise InputError(f"markers[{name!r}][{row}] is masked; give it a value first, such as 0 or nan")
    array = np.asarray(array)
    if array.ndim == 1 and len(array) == size and (array.dtype.kind in "biuf" or size == 0):
        return frozen(_native(name, array))
    if array.ndim != 2 or (array.size and array.dtype.kind not in "iu"):
        what = "lists of different lengths" if array.dtype == object and not array.size else array.dtype
        raise InputError(
            f"markers[{name!r}] must be one number per cell, shape ({size},), or faces as rows of vertices, "
            f"integers (c, j), not {what} of shape {array.shape}; names of cells go into regions"
        )
    if len(array) and array.shape[1] == 0:
        raise InputError(f"markers[{name!r}] has {len(array)} faces without vertices: drop them")
    if within(array, vertices):
        return frozen(array.astype(np.int32))
    wrong = (array < 0) | (array >= vertices)
    if padded and array.shape[1]:  # rows of fewer vertices end in -1, as in `boundary`
        padding = np.cumprod(array[:, :0:-1] == -1, axis=1)[:, ::-1].astype(bool)
        wrong[:, 1:] &= ~padding
    if wrong.any():
        row = int(np.argmax(wrong.any(axis=1)))
        raise InputError(
            f"markers[{name!r}][{row}] = {array[row].tolist()} refers to missing vertices; there are 0 to "
            f"{vertices - 1}"
        )
    return frozen(array.astype(np.int32))


def _native(name: str, values: np.ndarray) -> np.ndarray:
    """Numbers of cells in a type that files have: this machine's bytes, and reals of 32 or 64 bits."""
    if name == "region" and values.dtype == np.uint64 and len(values) and values.max() > MOST_REGION:
        row = int(np.argmax(values > MOST_REGION))
        raise InputError(f"markers['region'][{row}] = {values[row]} is beyond 64 bits with a sign: renumber")
    if values.dtype.kind == "f" and values.dtype.itemsize not in (4, 8):
        return values.astype(np.float64)
    if values.dtype.kind not in "biuf":  # of no cells
        return values.astype(np.float64)
    return values.astype(values.dtype.newbyteorder("="), copy=False)


def as_region_names(regions: Any, markers: Mapping[str, np.ndarray]) -> dict[str, int]:
    """Numbers by name, checked: whole numbers, all different, for cells that have the marker "region".

    Raises
    ------
    InputError
        The message names the first name that is wrong.
    """
    number = markers.get("region")
    if number is None or number.ndim != 1:
        raise InputError("regions names values of the marker 'region', which this mesh does not have")
    found = by_name(regions, "regions", _whole)
    if len(set(found.values())) < len(found):
        owner: dict[int, str] = {}
        for name, value in found.items():
            _refuse_equal(owner.setdefault(value, name), name, value)
    return found


def as_region_number(name: str, value: Any, others: Mapping[str, int]) -> int:
    """The number of one more region, checked: a whole number that no other name has. O(r)."""
    number = _whole(name, value, others)
    _refuse_equal(next((other for other, old in others.items() if old == number), name), name, number)
    return number


def _whole(name: str, value: Any, _: Mapping[str, int]) -> int:
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or abs(int(value)) > MOST_REGION:
        raise InputError(f"regions[{name!r}] must be a whole number, not {value!r}; it may have 64 bits")
    return int(value)


def _refuse_equal(one: str, two: str, number: int) -> None:
    if one != two:
        raise InputError(f"regions {one!r} and {two!r} have the same number {number}: join them")


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
