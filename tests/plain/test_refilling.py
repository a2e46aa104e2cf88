"""The plain refilling: counts that are known, and the recovery of edges."""

from __future__ import annotations

from itertools import combinations, product

import pytest

from unstruct.plain.predicates import orient
from unstruct.plain.refilling import faces_of, in_the_way, meets, recover_edge, refills, walls_of

CUBE = list(product((0, 1), repeat=3))


def positive(points: list, *cell: int) -> tuple[int, ...]:
    a, b, c, d = cell
    return (a, b, c, d) if orient([points[v] for v in cell]) > 0 else (a, b, d, c)


def test_two_cells_or_three() -> None:
    """A triangular bipyramid has two triangulations: the flip from two cells to three."""
    points = [(0, 0, 0), (4, 0, 0), (0, 4, 0), (1, 1, 3), (1, 1, -3)]
    cells = {positive(points, 0, 1, 2, 3), positive(points, 0, 1, 2, 4)}
    found = list(refills(points, walls_of(cells)))
    assert sorted(map(len, found)) == [2, 3] and len(set(found)) == 2
    assert all(walls_of(cells) == walls_of(new) for new in found)
    with_edge = recover_edge(points, cells, 3, 4)
    assert with_edge is not None and len(with_edge) == 3 and not in_the_way(points, with_edge, 3, 4)
    assert len(in_the_way(points, cells, 3, 4)) == 2  # one triangle, from both sides


def test_an_edge_that_leaves_the_cells() -> None:
    """Nothing is in the way of 3 4, which passes beside the common face; yet it cannot be had."""
    points = [(0, 0, 0), (4, 0, 0), (0, 4, 0), (3, 3, 3), (3, 3, -3)]
    cells = {positive(points, 0, 1, 2, 3), positive(points, 0, 1, 2, 4)}
    assert not in_the_way(points, cells, 3, 4) and recover_edge(points, cells, 3, 4) is None
    assert recover_edge(points, cells, 0, 3) == cells


def test_forced_faces() -> None:
    """A face that is open in both orientations is in every refill."""
    points = [(0, 0, 0), (4, 0, 0), (0, 4, 0), (1, 1, 3), (1, 1, -3)]
    cells = {positive(points, 0, 1, 2, 3), positive(points, 0, 1, 2, 4)}
    (shared,) = [f for cell in cells for f in faces_of(cell) if set(f) == {0, 1, 2}][:1]
    both = {shared, (shared[0], shared[2], shared[1])}
    assert list(refills(points, walls_of(cells) | both)) == [frozenset(cells)]


def test_triangulations_of_a_cube() -> None:
    """With the diagonals of the five-cell triangulation: that one, and six cells around a long diagonal."""
    even = [v for v in range(8) if sum(CUBE[v]) % 2 == 0]
    middle = positive(CUBE, *even)
    corners = [
        positive(CUBE, v, *(w for w in even if sum(map(abs, map(int.__sub__, CUBE[v], CUBE[w]))) == 1))
        for v in range(8)
        if v not in even
    ]
    found = list(refills(CUBE, walls_of([middle, *corners])))
    assert sorted(map(len, found)) == [5, 6, 6, 6, 6] and len(set(found)) == 5


def test_no_tetrahedra() -> None:
    """The polyhedron of row C12.2.8-09 has no refill on its six vertices."""
    points = [(6, 0, 0), (-3, 5, 0), (-3, -5, 0), (5, 3, 8), (-5, 3, 8), (0, -6, 8)]
    outside = {(0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (0, 3, 2), (2, 3, 5)}
    inward = frozenset((a, c, b) for a, b, c in outside)
    found = [list(refills(points, frozenset(map(least_first, f)))) for f in (outside, inward)]
    assert found == [[], []]


def least_first(face: tuple[int, int, int]) -> tuple[int, int, int]:
    k = face.index(min(face))
    return face[k], face[(k + 1) % 3], face[(k + 2) % 3]


@pytest.mark.parametrize(
    ("ends", "expected"),
    [
        (((1, 1, -1), (1, 1, 1)), True),  # through the interior
        (((2, 0, -1), (2, 0, 1)), True),  # through an edge
        (((0, 0, -1), (0, 0, 1)), True),  # through a vertex
        (((5, 5, -1), (5, 5, 1)), False),
        (((1, 1, 1), (1, 1, 2)), False),
        (((1, 1, 0), (1, 1, 2)), False),  # an open segment that begins on the triangle
        (((-1, 1, 0), (5, 1, 0)), True),  # in its plane, across
        (((1, 1, 0), (2, 1, 0)), True),  # in its plane, within
        (((-2, 0, 0), (-1, 0, 0)), False),  # in its plane, on the line of an edge
        (((-1, 0, 0), (6, 0, 0)), True),  # along an edge
    ],
)
def test_segments_and_triangles(ends: tuple, expected: bool) -> None:
    points = [(0, 0, 0), (4, 0, 0), (0, 4, 0), *ends]
    for face in [(0, 1, 2), (1, 2, 0), (0, 2, 1)]:
        assert meets(points, 3, 4, face) is expected and meets(points, 4, 3, face) is expected


def test_edges_of_a_face_are_not_in_its_way() -> None:
    points = [(0, 0, 0), (4, 0, 0), (0, 4, 0), (4, 4, 0)]
    assert not any(meets(points, a, b, (0, 1, 2)) for a, b in combinations(range(3), 2))
    assert meets(points, 0, 3, (0, 1, 2)) and not meets(points, 1, 3, (0, 1, 2))
