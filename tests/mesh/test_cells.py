"""Kinds of cells: polygons as compressed rows, corners by kind, counts in words."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from mixed_cells import planar, spatial

from unstruct import InputError, Mesh
from unstruct.mesh.cells import CELL_TYPES, cell_rows, counted, equal_rows

HOUSE = [[0, 0], [2, 0], [2, 2], [1, 3], [0, 2]]


def test_polygons_are_read_only_and_lose_nothing() -> None:
    mesh = Mesh(HOUSE, cells={"polygon": [[0, 1, 2, 4], (2, 3, 4)]})
    assert [row.tolist() for row in mesh.cells["polygon"]] == [[0, 1, 2, 4], [2, 3, 4]]
    for row in mesh.cells["polygon"]:
        assert row.dtype == np.int32
        with pytest.raises(ValueError, match="read-only"):
            row[0] = 1
    assert Mesh(HOUSE, cells={"polygon": []}).size == 0


@pytest.mark.parametrize(
    ("polygons", "words"),
    [
        ([[0, 1, 2], [2, 3]], r"polygon 1 must be at least three integers"),
        ([[0, 1, 2], [2, 3, 4.5]], r"polygon 1 must be at least three integers"),
        ([[0, 1, 2], [2, 3, 5]], r"polygon 1 = \[2, 3, 5\] refers to vertices outside 0\.\.4"),
        ([[0, 1, 2], [2, -1, 4]], r"polygon 1 .* outside"),
        ([[0, 1, 2], [2, 3, 4, 2]], r"polygon 1 = \[2, 3, 4, 2\] repeats a vertex"),
    ],
)
def test_wrong_polygons_are_named(polygons: list, words: str) -> None:
    with pytest.raises(InputError, match=words):
        Mesh(HOUSE, cells={"polygon": polygons})


@pytest.mark.parametrize("mesh", [planar(4), spatial(2)], ids=repr)
def test_compressed_rows_and_corners(mesh: Mesh) -> None:
    indptr, corners = cell_rows(mesh.cells)
    rows = [row.tolist() for block in mesh.cells.values() for row in block]
    assert [corners[a:b].tolist() for a, b in pairwise(indptr.tolist())] == rows
    assert list(mesh.corners) == list(mesh.cells)
    for kind, block in mesh.cells.items():
        found = mesh.corners[kind]
        assert len(found) == len(block) and (kind == "polygon" or found.shape[1] == CELL_TYPES[kind][1])
        for row, places in zip(block, found):
            assert (mesh.points[row] == places).all()


def test_rows_of_equal_length() -> None:
    rows = [[0, 1, 2], [3, 4, 5, 6], [7, 8, 9]]
    found = {block.shape[1]: (which.tolist(), block.tolist()) for which, block in equal_rows(rows)}
    assert found == {3: ([0, 2], [rows[0], rows[2]]), 4: ([1], [rows[1]])}
    assert list(equal_rows(np.empty((0, 4), dtype=int))) == []


def test_words() -> None:
    assert counted(2, "hexahedron") == "2 hexahedra" and counted(1, "tetra") == "1 tetrahedron"
    assert counted(3, "wedge") == "3 wedges" and counted(3, "simplex4") == "3 4-simplices"


def test_arrays_of_the_caller_stay_writable() -> None:
    rows = np.array([[0, 1, 2, 3]], dtype=np.int32)
    for kind in ("quad", "polygon"):
        mesh = Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], cells={kind: rows})
        assert rows.flags.writeable and not mesh.cells[kind][0].flags.writeable


@pytest.mark.parametrize(
    ("cells", "message"),
    [
        ([("quad", [[0, 1, 2, 3]])], "cells must be a dictionary"),
        ({"polygon": 5}, "list of rows, not 5"),
        ({"polygon": [np.ma.array([0, 1, 2, 3], mask=[0, 0, 0, 1])]}, "polygon 0 has masked entries"),
        ({"quad": np.ma.array([[0, 1, 2, 3]], mask=[[0, 0, 0, 1]])}, "masked entries"),
    ],
)
def test_what_cells_cannot_be(cells: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], cells=cells)  # type: ignore[arg-type]
