"""Adjacency against dictionaries of sets."""

import os
import subprocess
import sys
from collections import defaultdict
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from unstruct import InputError, MeshError
from unstruct.mesh import topology


def random_complex(n, d, seed):
    return Delaunay(np.random.default_rng(seed).random((n, d))).simplices


def slow_neighbors(simplices):
    owners = defaultdict(list)
    for t, row in enumerate(simplices.tolist()):
        for i in range(len(row)):
            owners[frozenset(row) - {row[i]}].append((t, i))
    result = np.full(simplices.shape, -1)
    for group in owners.values():
        if len(group) == 2:
            (t, i), (s, j) = group
            result[t, i], result[s, j] = s, t
    return result


COMPLEXES = [random_complex(40, d, seed) for d in (2, 3, 4) for seed in range(3)]
COMPLEXES.append(np.column_stack([np.arange(6), np.arange(1, 7)]))


@pytest.mark.parametrize("simplices", COMPLEXES, ids=lambda s: f"{len(s)}x{s.shape[1]}")
def test_everything_against_sets(simplices):
    n, width = int(simplices.max()) + 3, simplices.shape[1]
    rows = simplices.tolist()
    neighbors = topology.neighbors(simplices)
    assert neighbors.dtype == np.int32
    assert (neighbors == slow_neighbors(simplices)).all()
    for j in range(width):
        wanted = sorted({tuple(sorted(face)) for row in rows for face in combinations(row, j + 1)})
        assert [tuple(face) for face in topology.faces(simplices, j).tolist()] == wanted
        assert topology.face_counts(simplices)[j] == len(wanted)
    joined = defaultdict(set)
    for row in rows:
        for a in row:
            joined[a] |= set(row) - {a}
    indptr, indices = topology.vertex_neighbors(simplices, n)
    star, cells = topology.stars(simplices, n)
    for v in range(n):
        assert indices[indptr[v] : indptr[v + 1]].tolist() == sorted(joined[v])
        assert cells[star[v] : star[v + 1]].tolist() == [t for t, row in enumerate(rows) if v in row]
    twin, facet = topology.twins(neighbors), {}
    for t, row in enumerate(rows):
        for i in range(width):
            facet.setdefault(frozenset(row) - {row[i]}, []).append(t * width + i)
    for numbers in facet.values():
        assert [twin[e] for e in numbers] == ([-1] if len(numbers) == 1 else numbers[::-1])
    assert topology.euler(simplices) == 1
    assert topology.components(neighbors)[0] == 1


@given(st.lists(st.lists(st.integers(0, 9), min_size=2, max_size=2), min_size=1, max_size=60))
@settings(deadline=None)
def test_rows_are_grouped_as_python_would(rows):
    group, first = topology.group_rows(np.array(rows))
    seen = {}
    for r, row in enumerate(rows):
        assert group[r] == seen.setdefault(tuple(row), len(seen))
    assert [tuple(rows[f]) for f in first] == list(seen)


def test_a_bad_hash_would_still_be_right():
    """With many rows in few buckets, chains are followed."""
    rows = np.array([[i, 0] for i in range(1000)] * 2)
    group, first = topology.group_rows(rows)
    assert (group == np.tile(np.arange(1000), 2)).all() and (first == np.arange(1000)).all()


def test_boundary_of_a_positive_mesh_is_outward():
    square = np.array([[0, 1, 2], [0, 2, 3]])
    edges = topology.boundary(square, topology.neighbors(square))
    following = {a: b for a, b in edges.tolist()}
    walk = [0]
    while following[walk[-1]] != 0:
        walk.append(following[walk[-1]])
    assert walk == [0, 1, 2, 3]
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    for a, b, c in topology.boundary(np.array([[0, 1, 2, 3]]), np.full((1, 4), -1)):
        normal = np.cross(points[b] - points[a], points[c] - points[a])
        assert normal @ (points[a] - points.mean(axis=0)) > 0


def test_components_are_numbered_in_order():
    three = np.array([[0, 1, 2], [5, 6, 7], [2, 1, 3], [8, 9, 10], [7, 6, 11]])
    count, label = topology.components(topology.neighbors(three))
    assert count == 3 and label.tolist() == [0, 1, 0, 2, 1]


def test_euler_of_known_surfaces():
    tetrahedron = np.array([[1, 2, 3], [2, 0, 3], [0, 1, 3], [1, 0, 2]])
    assert topology.face_counts(tetrahedron) == (4, 6, 4) and topology.euler(tetrahedron) == 2
    i, j = (x.ravel() for x in np.meshgrid(np.arange(5), np.arange(4), indexing="ij"))

    def v(a, b):
        return (a % 5) * 4 + b % 4

    corners = (v(i, j), v(i + 1, j), v(i + 1, j + 1), v(i, j + 1))
    torus = np.concatenate([np.column_stack(corners[:3]), np.column_stack([corners[0], *corners[2:]])])
    assert topology.euler(torus) == 0 and len(topology.boundary(torus, topology.neighbors(torus))) == 0


def test_a_facet_with_three_cells_is_named():
    fan = np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]])
    with pytest.raises(MeshError, match=r"facet \[0, 1\].*3 cells, \[0, 1, 2\]"):
        topology.neighbors(fan)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ([[0, 1, 5]], r"simplices\[0\] = \[0, 1, 5\].*0\.\.3"),
        ([[0, 1, 2], [1, 2, -1]], r"simplices\[1\]"),
        ([[0, 1, 2], [1, 1, 3]], r"simplices\[1\] = \[1, 1, 3\] repeats"),
        ([[0.0, 1.0, 2.0]], "integers"),
        ([0, 1, 2], "shape"),
        (
            np.ma.masked_array([[0, 1, 2], [1, 2, 3]], mask=[[0, 0, 0], [0, 1, 0]]),
            r"simplices\[1\] has masked",
        ),
    ],
)
def test_wrong_rows_are_named(rows, words):
    with pytest.raises(InputError, match=words):
        topology.as_simplices(rows, vertices=4)


def test_no_faces_of_too_high_dimension():
    with pytest.raises(InputError, match="no faces of dimension 3"):
        topology.faces(np.array([[0, 1, 2]]), 3)


def test_an_empty_complex():
    empty = np.empty((0, 3), dtype=int)
    assert topology.neighbors(empty).shape == (0, 3) and topology.edges(empty).shape == (0, 2)
    assert topology.face_counts(empty) == (0, 0, 0) and topology.components(empty)[0] == 0


def test_as_plain_python():
    """The kernels give the same with numba switched off."""
    code = (
        "import numpy as np; from unstruct import topology as t; "
        "s = np.array([[0,1,2],[2,1,3],[2,3,4]]); print(t.neighbors(s).tolist(), t.face_counts(s))"
    )
    run = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert run.stdout.strip() == "[[1, -1, -1], [-1, 2, 0], [-1, -1, 1]] (5, 7, 3)"
