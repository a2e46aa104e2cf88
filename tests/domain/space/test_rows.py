"""Facets and inner pieces as arguments: arrays, lists, nested lists, polygons themselves."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from unstruct import Domain, InputError
from unstruct.domain.space.rows import as_polygons
from unstruct.geometry.polygons import Polygons

ROWS = [[0, 1, 2, 3], [4, 5, 6, 7]]


@pytest.mark.parametrize(
    "rows",
    [
        ROWS,
        tuple(map(tuple, ROWS)),
        np.array(ROWS),
        np.array(ROWS, dtype=np.uint8),
        [np.array(row, dtype=np.int64) for row in ROWS],
        [[row] for row in ROWS],
        [ROWS[0], [ROWS[1]]],
        Polygons.of_rings([[row] for row in ROWS]),
    ],
)
def test_the_same_polygons(rows: object) -> None:
    found = as_polygons(rows, "facets", 3)
    assert found == Polygons.of_rings([[row] for row in ROWS]) and found.vertices.dtype == np.int32


def test_mixed_rows_and_holes() -> None:
    found = as_polygons([[0, 1, 2], [[0, 1, 2, 3], (4, 5, 6), np.array([7, 8, 9])], (1, 2)], "inner", 2)
    assert found.corners.tolist() == [3, 10, 2] and len(found.rings(1)) == 3
    assert len(as_polygons([], "inner", 2)) == len(as_polygons(np.empty((0, 3)), "facets", 3)) == 0


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([[0, 1]], r"facets\[0\] has 2 vertices; a facet needs three"),
        ([[0, 1, 2], [[0, 1, 2], [3, 4]]], r"facets\[1\] has 5 vertices; a facet needs three"),
        ([[0, 1, 2], 5], r"facets\[1\] must be a row of vertices, not 5"),
        ([[0, 1, 2], "abc"], r"facets\[1\] must be a row of vertices, not 'abc'"),
        ([[0, 1, 2], [True, False, True, 0.5]], r"facets\[1\] must be integers"),
        ([[0, 1, 2], [[[0, 1, 2]]]], r"facets\[1\]"),
        (np.zeros((2, 2, 3), dtype=int), "must have shape"),
        (np.ma.masked_equal(np.array([[0, 1, 2]]), 1), "masked"),
        ({"a": 1}, "must be rows of vertices, not dict"),
        (7, "must be rows of vertices, not int"),
        ([[0, 1, 2**31]], "beyond 32 bits"),
    ],
)
def test_bad_rows_are_named(rows: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        as_polygons(rows, "facets", 3)


def test_triangles_stay_an_array() -> None:
    points = np.array(list(product((0.0, 1.0), repeat=3)))[[0, 1, 2, 4]]
    rows = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]
    domain = Domain(points, [[row] for row in rows])
    assert isinstance(domain.facets, np.ndarray) and domain.facets.tolist() == rows
    with pytest.raises(ValueError, match="read-only"):
        domain.facets[0, 0] = 3
