"""The plain criteria on what can be checked by hand."""

from fractions import Fraction

from unstruct.plain.surface_delaunay import (
    circumcenter,
    empty_interval,
    extrinsic,
    intrinsic,
    is_surface_delaunay,
    restricted,
)

TETRA = [(0, 0, 0), (4, 0, 0), (0, 4, 0), (1, 1, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]


def test_the_surface_without_a_delaunay_triangulation():
    assert circumcenter(*TETRA[:3]) == [2, 2, 0]
    assert is_surface_delaunay(TETRA, FACES) == [[3], [], [], []]
    assert not any(restricted(TETRA, FACES))


def test_circumcenter():
    assert circumcenter((0, 0, 0), (2, 0, 0), (0, 0, 2)) == [1, 0, 1]
    assert circumcenter((0, 0, 0), (1, 0, 0), (0, 1, 5)) == [Fraction(1, 2), Fraction(1, 2), Fraction(5, 2)]


def test_a_regular_tetrahedron_is_delaunay_in_every_sense():
    points = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
    rows = [(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)]
    assert is_surface_delaunay(points, rows) == [[], [], [], []]
    assert all(intrinsic(points, rows).values()) and all(extrinsic(points, rows).values())
    assert all(restricted(points, rows))
    low, high = empty_interval(points, (0, 1, 2), range(4))
    assert (low is None) != (high is None)  # on one side spheres may grow forever


def test_a_square_is_a_tie():
    points, rows = [(0, 0, 7), (1, 0, 7), (1, 1, 7), (0, 1, 7)], [(0, 1, 2), (0, 2, 3)]
    assert intrinsic(points, rows) == {(0, 2): True} and extrinsic(points, rows) == {(0, 2): True}
    assert is_surface_delaunay(points, rows) == [[], []] and restricted(points, rows) == [True, True]


def test_folding_changes_the_chapters_criterion_alone():
    """The angles at a folded edge remain, the distance of the far corner from the center does not."""
    flat = [(-1, 0, 0), (1, 0, 0), (0, 2, 0), (0, -1, 0)]
    rows = [(0, 1, 2), (1, 0, 3)]
    assert extrinsic(flat, rows)[0, 1] == intrinsic(flat, rows)[0, 1]
    folded = [*flat[:3], (0, 0, 1)]
    assert intrinsic(folded, rows) == intrinsic(flat, rows) == {(0, 1): True}
    assert extrinsic(flat, rows)[0, 1]
    assert not extrinsic([*flat[:3], (0, 1, 0.1)], [(0, 1, 2), (1, 0, 3)])[0, 1]
