"""Sides among given edges, compared with sets, and found without sorting the unmarked sides."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from unstruct.connect.insertion.delaunay import delaunay
from unstruct.mesh.marked import marked_facets, marked_sides

POINTS = np.random.default_rng(3).random((40, 2))
MESH = delaunay(POINTS)
PAIRS = st.lists(st.tuples(st.integers(0, 39), st.integers(0, 39)), max_size=60)


@given(PAIRS, st.booleans())
def test_as_sets_say(pairs: list[tuple[int, int]], known: bool) -> None:
    edges = np.array(pairs, dtype=np.int32).reshape(-1, 2)
    if known:  # most pairs are no edges: let some be
        edges = np.concatenate([edges, MESH.edges[edges.sum(axis=1) % len(MESH.edges)]])
    wanted = {frozenset(row) for row in edges.tolist()}
    sides, found = marked_sides(MESH.simplices, edges, len(POINTS))
    every = {frozenset(row) for row in MESH.edges.tolist()}
    assert found.tolist() == [frozenset(row) in every for row in edges.tolist()]
    for i in range(3):
        facets = np.delete(MESH.simplices, i, axis=1)
        expected = [frozenset(row) in wanted for row in facets.tolist()]
        assert sides[:, i].tolist() == expected
        assert marked_facets(facets, edges, len(POINTS)).tolist() == expected


def test_faces_of_tetrahedra() -> None:
    mesh = delaunay(np.random.default_rng(4).random((30, 3)))
    named = mesh.boundary[::3, ::-1]
    result = marked_facets(mesh.facets, named, 30)
    wanted = {frozenset(row) for row in named.tolist()}
    assert result.tolist() == [frozenset(row) in wanted for row in mesh.facets.tolist()] and result.any()


def test_no_cells_no_edges() -> None:
    none = np.empty((0, 2), dtype=np.int32)
    assert not marked_sides(MESH.simplices, none, 40)[0].any()
    sides, found = marked_sides(np.empty((0, 3), dtype=np.int32), np.array([[0, 1], [1, 0]]), 2)
    assert sides.shape == (0, 3) and found.tolist() == [False, False]
    assert marked_facets(none, none, 0).shape == (0,)
