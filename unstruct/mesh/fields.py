"""Fields that are written beside a mesh: values of a solution at its points and in its cells."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ..base.checked import by_name
from ..base.errors import InputError
from .complex import CellComplex
from .exchange import Exchange

__all__ = ["WITH_FIELDS", "Fields", "add_fields", "as_fields", "padded_fields"]

WITH_FIELDS = (".vtu", ".vtk", ".xdmf", ".xmf", ".msh")  # formats that have data at points and of cells
GMSH_WIDTHS = (1, 3, 9)  # numbers that Gmsh has at a node: a number, a vector, a tensor
OWN_FIELDS = ("origin", "kept", "polygon:number")  # what `Mesh.write` itself stores under these names
OWN_BEGINNINGS = ("faces:", "gmsh:", "medit:")


class Fields(NamedTuple):
    """Values by name.

    Attributes
    ----------
    points : dict of str to ndarray, shape (n,) or (n, k)
    cells : dict of str to ndarray, shape (m,) or (m, k)
    """

    points: dict[str, np.ndarray]
    cells: dict[str, np.ndarray]

    def renamed(self, called: Callable[[str], str]) -> Fields:
        """The same fields under other names."""
        return Fields(*({called(name): values for name, values in part.items()} for part in self))


def as_fields(mesh: CellComplex, point_data: Any, cell_data: Any) -> Fields:
    """Fields, checked: one row of real numbers for each point, or for each cell.

    Raises
    ------
    InputError
        The message names the field and what is wrong with it.
    """
    n, m = len(mesh.points), mesh.size
    points = partial(_as_field, what="point_data", many=n, other=m, taken=())
    cells = partial(_as_field, what="cell_data", many=m, other=n, taken=tuple(mesh.markers))
    return Fields(
        {} if point_data is None else by_name(point_data, "point_data", points),
        {} if cell_data is None else by_name(cell_data, "cell_data", cells),
    )


def _as_field(
    name: str,
    values: Any,
    _: Mapping[str, np.ndarray],
    what: str,
    many: int,
    other: int,
    taken: tuple[str, ...],
) -> np.ndarray:
    called, each = f"{what}[{name!r}]", "point" if what == "point_data" else "cell"
    if name in OWN_FIELDS or name.startswith(OWN_BEGINNINGS):
        raise InputError(f"{called}: files of meshes use this name themselves; take another name")
    if name in taken:
        raise InputError(
            f"{called}: the mesh has a marker of this name, which is written, too; take another name"
        )
    try:
        array = np.asanyarray(values)
    except ValueError:  # ragged lists
        raise InputError(f"{called} must have shape ({many},) or ({many}, k), and no gaps") from None
    if np.ma.isMaskedArray(array) and np.ma.getmaskarray(array).any():
        row = int(np.argwhere(np.ma.getmaskarray(array))[0][0])
        raise InputError(f"{called}[{row}] is masked; give it a value, such as nan")
    array = np.asarray(array)
    if array.ndim not in (1, 2) or len(array) != many or array.shape[1:] == (0,):
        hint = f"; there are {other} {'cells: cell_data' if each == 'point' else 'points: point_data'}?"
        wrong = array.ndim not in (1, 2) or len(array) != other or other == many
        more = "; write a matrix as one row" if array.ndim == 3 and len(array) == many else ""
        raise InputError(
            f"{called} must have shape ({many},) or ({many}, k), a row for each {each}, not {array.shape}"
            + ("" if wrong else hint) + more
        )  # fmt: skip
    if array.dtype.kind not in "biuf":
        more = "; write .real and .imag" if array.dtype.kind == "c" else ""
        raise InputError(f"{called} must be real numbers, not {array.dtype}{more}")
    if array.dtype.kind == "b":
        return array.astype(np.int8)
    if array.dtype.kind == "f" and array.dtype.itemsize not in (4, 8):
        return array.astype(np.float64)
    return array.astype(array.dtype.newbyteorder("="), copy=False)


def padded_fields(fields: Fields) -> Fields:
    """Real numbers in rows of the lengths that Gmsh has: 1, 3 or 9, the rest zero.

    Raises
    ------
    InputError
        For longer rows.
    """
    parts = (("point_data", fields.points), ("cell_data", fields.cells))
    return Fields(*({k: _padded(v, f"{what}[{k!r}]") for k, v in part.items()} for what, part in parts))


def _padded(values: np.ndarray, called: str) -> np.ndarray:
    if values.ndim == 1:
        return values.astype(np.float64)
    width = values.shape[1]
    wide = next((w for w in GMSH_WIDTHS if w >= width), None)
    if wide is None:
        raise InputError(
            f"{called} has rows of {width} numbers, and .msh has at most {GMSH_WIDTHS[-1]}: divide it, or "
            "write .vtu"
        )
    return np.pad(values.astype(np.float64), ((0, 0), (0, wide - width)))


def add_fields(other: Exchange, fields: Fields, rows: list[np.ndarray]) -> None:
    """Put fields into what is written; blocks beyond those of the cells, named faces, have nan or 0.

    Parameters
    ----------
    other : Exchange
    fields : Fields
    rows : list of ndarray
        The cells of each of the first blocks.
    """
    other.point_data |= fields.points
    for name, values in fields.cells.items():
        none = np.nan if values.dtype.kind == "f" else 0
        more = [
            np.full((len(b.data), *values.shape[1:]), none, values.dtype) for b in other.cells[len(rows) :]
        ]
        other.cell_data[name] = [values[r] for r in rows] + more
