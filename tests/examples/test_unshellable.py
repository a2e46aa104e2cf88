"""Rudin's tetrahedron: a valid division, and each of its cells is needed for the rest to be a solid ball."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from unstruct import check
from unstruct.examples import rudin_tetrahedron
from unstruct.plain.adjacency import removable
from unstruct.plain.predicates import determinant, orient


def test_it_divides_the_tetrahedron_of_its_first_four_vertices() -> None:
    mesh = rudin_tetrahedron()
    assert check(mesh) and mesh.face_counts() == (14, 66, 94, 41) and len(mesh.boundary) == 24
    rows = [[int(x) for x in p] for p in mesh.points]
    assert np.array_equal(rows, mesh.points)

    def six_volumes(cell: list[int]) -> int:
        return determinant([[a - b for a, b in zip(rows[v], rows[cell[0]])] for v in cell[1:]])

    whole = abs(six_volumes([0, 1, 2, 3]))
    parts = [six_volumes(cell) for cell in mesh.simplices.tolist()]
    assert min(parts) > 0 and sum(parts) == whole and Fraction(41 * min(parts), whole) > Fraction(6, 25)
    for p in rows[4:]:  # all other vertices lie in a face of it
        assert any(orient([*(rows[v] for v in range(4) if v != k), p]) == 0 for k in range(4))


def test_no_cell_can_be_removed() -> None:
    mesh = rudin_tetrahedron()
    assert removable(mesh.simplices.tolist()) == []
    for t in range(mesh.size):
        assert not check(mesh.select(np.setdiff1d(np.arange(mesh.size), [t])))
