"""The plain adjacency against the compiled one, and walks against exact location."""

from itertools import combinations, pairwise

import numpy as np
import pytest

from unstruct import Mesh, MeshError, check, delaunay
from unstruct.plain.adjacency import face_counts, neighbors, removable, walk


@pytest.mark.parametrize("d", [1, 2, 3, 4])
def test_the_same_as_the_compiled_ones(d):
    mesh = delaunay(np.random.default_rng(d).random((25, d)))
    cells = mesh.simplices.tolist()
    assert neighbors(cells) == mesh.neighbors.tolist()
    assert face_counts(cells) == mesh.face_counts()


def test_a_third_cell_is_an_error():
    with pytest.raises(MeshError, match=r"facet \[0, 1\] has a third cell, 2"):
        neighbors([[0, 1, 2], [1, 0, 3], [0, 1, 4]])


@pytest.mark.parametrize("d", [2, 3])
def test_walks_arrive(d):
    mesh = delaunay(np.random.default_rng(d).random((40, d)))
    cells, adjacent = mesh.simplices.tolist(), mesh.neighbors.tolist()
    for k, q in enumerate(np.random.default_rng(1).random((60, d)) * 1.2 - 0.1):
        path = walk(mesh.points, cells, adjacent, k % mesh.size, q)
        assert path[-1] == mesh.find_simplex(q) and len(set(path)) == len(path)
        for s, t in pairwise(path):
            assert t in adjacent[s]


def test_a_walk_stops_at_a_hole():
    points = [[0, 0], [3, 0], [3, 3], [0, 3], [1, 1], [2, 1], [2, 2], [1, 2]]
    cells = [[0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7]]
    frame = Mesh(points, cells)
    assert walk(points, cells, frame.neighbors.tolist(), 0, [1.5, 2.9])[-1] == -1
    assert frame.find_simplex([1.5, 2.9]) == 4


def test_a_walk_may_go_round():
    """Seven points, nine triangles, all positive, not Delaunay: a pinwheel."""
    points = [[10, 0], [-5, 9], [-5, -9], [-9, 12], [-6, -14], [15, 2], [0, 0]]
    cells = [[6, i, (i + 1) % 3] for i in range(3)]
    for i in range(3):
        cells += [[i, 3 + i, (i + 1) % 3], [(i + 1) % 3, 3 + i, 3 + (i + 1) % 3]]
    pinwheel = Mesh(points, cells)
    assert check(pinwheel) and not check(pinwheel, delaunay=True)
    assert walk(points, cells, pinwheel.neighbors.tolist(), 3, [1, 1]) == [3, 4, 5, 6, 7, 8, 3]
    assert pinwheel.find_simplex([1, 1]) == 0


@pytest.mark.parametrize("d", [2, 3])
def test_removable_cells_leave_a_disk_or_a_ball(d):
    """The rest is valid, and its boundary one closed curve or sphere, exactly if the cell is listed."""
    for seed in range(3):
        mesh = delaunay(np.random.default_rng(seed).random((14, d)))
        listed = removable(mesh.simplices.tolist())
        assert len(listed) >= 2
        for t in range(mesh.size):
            rest = mesh.select(np.setdiff1d(np.arange(mesh.size), [t]))
            faces = [len({frozenset(f) for b in rest.boundary.tolist() for f in combinations(b, k)})
                     for k in range(1, d + 1)]  # fmt: skip
            sphere = faces[0] - faces[1] + (faces[2] if d == 3 else 0) == (2 if d == 3 else 0)
            whole = bool(check(rest)) and rest.euler_characteristic == 1 and sphere
            assert whole == (t in listed)


def test_a_single_cell_stays():
    assert removable([[0, 1, 2]]) == removable([[0, 1, 2, 3]]) == []
    assert removable([[0, 1, 2], [1, 2, 3]]) == [0, 1]
    assert removable([[0, 1, 2], [2, 3, 4]]) == []  # they touch in a point: no disk, and 2 is on the boundary
