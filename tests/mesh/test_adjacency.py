"""Facets, stars and selection of cells of any kinds, against dictionaries of sets."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mixed_cells import GOOD, planar, spatial

from unstruct import InputError, Mesh, MeshError, delaunay

FACETS = {
    "tetra": [(1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2)],
    "pyramid": [(0, 1, 2, 3), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    "wedge": [(0, 1, 2), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
    "hexahedron": [
        *((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    ],
}


def every_cell(mesh: Mesh) -> list[tuple[str, list[int]]]:
    return [(kind, [int(v) for v in row]) for kind, block in mesh.cells.items() for row in block]


def by_sets(mesh: Mesh) -> dict[frozenset[int], list[int]]:
    """Each facet, as a set of vertices, and its cells."""
    found = defaultdict(list)
    for t, (kind, row) in enumerate(every_cell(mesh)):
        if mesh.dimension == 2:
            sides = [{a, b} for a, b in zip(row, [*row[1:], row[0]])]
        else:
            sides = [{row[v] for v in facet} for facet in FACETS[kind]]
        for side in sides:
            found[frozenset(side)].append(t)
    return found


def meshes() -> list[Mesh]:
    flat = delaunay(np.random.default_rng(0).random((40, 2)))
    solid = delaunay(np.random.default_rng(0).random((40, 3)))
    one_kind = Mesh(GOOD["wedge"], cells={"wedge": [range(6)]})
    return [
        flat,
        solid,
        one_kind,
        *(planar(5, seed=s) for s in range(3)),
        *(spatial(3, seed=s) for s in range(3)),
    ]


@pytest.mark.parametrize("mesh", meshes(), ids=repr)
def test_facets_and_their_two_cells(mesh: Mesh) -> None:
    wanted = by_sets(mesh)
    assert mesh.facet_cells.dtype == np.int32 and mesh.facet_cells.shape == (len(mesh.facets), 2)
    rows = [tuple(v for v in row if v >= 0) for row in mesh.facets.tolist()]
    assert len(rows) == len(set(rows)) == len(wanted)
    for row, padded, (first, second) in zip(rows, mesh.facets.tolist(), mesh.facet_cells.tolist()):
        assert list(row) == sorted(row) and padded[: len(row)] == list(row), "padding stands at the end"
        cells = sorted(wanted[frozenset(row)])
        assert [first, second] == [*cells, -1][:2]
    assert mesh.facets.tolist() == sorted(mesh.facets.tolist()), "lexicographic"
    outer = {frozenset(v for v in row if v >= 0) for row in mesh.boundary.tolist()}
    assert outer == {facet for facet, cells in wanted.items() if len(cells) == 1}


@pytest.mark.parametrize("mesh", meshes(), ids=repr)
def test_stars(mesh: Mesh) -> None:
    wanted = defaultdict(set)
    for t, (_, row) in enumerate(every_cell(mesh)):
        for v in row:
            wanted[v].add(t)
    indptr, cells = mesh.stars
    assert indptr.dtype == cells.dtype == np.int32 and len(indptr) == len(mesh.points) + 1
    for v in range(len(mesh.points)):
        assert cells[indptr[v] : indptr[v + 1]].tolist() == sorted(wanted[v])


def test_facet_cells_agree_with_neighbors() -> None:
    mesh = delaunay(np.random.default_rng(1).random((60, 3)))
    pairs = {(t, int(s)) for t, row in enumerate(mesh.neighbors) for s in row if s > t}
    inner = mesh.facet_cells[mesh.facet_cells[:, 1] >= 0]
    assert pairs == set(map(tuple, inner.tolist()))
    segments = Mesh([[0.0], [1.0], [2.0], [5.0]], [[1, 2], [1, 0]])
    assert segments.facet_cells.tolist() == [[1, -1], [0, 1], [0, -1]]


def test_more_than_two_cells_are_named() -> None:
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1], [0.5, 0.5, -1], [0.5, 0.5, 2]]
    book = Mesh(points, cells={"pyramid": [[0, 1, 2, 3, 4], [0, 3, 2, 1, 5], [0, 1, 2, 3, 6]]})
    with pytest.raises(
        MeshError, match=r"facet \[0, 1, 2, 3\] is shared by 3 cells, \[0, 1, 2\].*facet_cells"
    ):
        _ = book.facet_cells
    fan = Mesh([[0, 0], [1, 0], [0, 1], [0, -1], [1, 1]], [[0, 1, 2], [1, 0, 3], [0, 1, 4]])
    with pytest.raises(MeshError, match=r"facet \[0, 1\] is shared by 3 cells, \[0, 1, 2\]"):
        _ = fan.facet_cells
    two = Mesh(
        np.vstack([fan.points, [[2, 2], [3, 2], [3, 3], [2, 3]]]),
        cells={"triangle": fan.simplices, "quad": [[5, 6, 7, 8], [8, 7, 6, 5]], "polygon": [[6, 5, 1]]},
    )
    with pytest.raises(MeshError, match=r"facet \[0, 1\] .*; so are \[5, 6\]"):
        _ = two.facet_cells


def test_neighbors_stay_with_simplices() -> None:
    with pytest.raises(MeshError, match=r"use \.facet_cells"):
        _ = planar().neighbors


# ---------------------------------------------------------------------- selection


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 5), st.booleans(), st.data())
def test_selection(seed: int, solid: bool, data: st.DataObject) -> None:
    mesh = spatial(2, seed=seed) if solid else planar(4, seed=seed)
    faces = {"wall": mesh.boundary, "edges": mesh.edges, "all": mesh.facets, "tips": np.arange(5)[:, None]}
    mesh = Mesh(
        mesh.points,
        cells=mesh.cells,
        origin=np.arange(len(mesh.points)) + 7,
        markers={**faces, "number": np.arange(mesh.size)},
    )
    chosen = np.array(data.draw(st.lists(st.integers(0, mesh.size - 1), max_size=12, unique=True)), dtype=int)
    part = mesh.select(chosen)
    kinds = [kind for kind, block in mesh.cells.items() for _ in block]
    order = [t for kind in mesh.cells for t in chosen.tolist() if kinds[t] == kind]
    assert part.markers["number"].tolist() == order
    old = every_cell(mesh)
    back = part.origin - 7
    assert [(kind, back[row].tolist()) for kind, row in every_cell(part)] == [old[t] for t in order]
    assert (mesh.points[back] == part.points).all() and len(part.points) == len(
        {v for t in order for v in old[t][1]}
    )
    if len(chosen) == 0:
        assert list(part.cells) == list(mesh.cells) and part.size == 0
        return
    assert set(part.cells) == {kinds[t] for t in order}
    own = set(by_sets(part))
    sets = {
        name: {frozenset(v for v in row if v >= 0) for row in part.markers[name].tolist()} for name in faces
    }
    assert sets["all"] == own
    outer = {frozenset(back[list(facet)].tolist()) for facet in own}
    wall = {frozenset(v for v in row if v >= 0) for row in mesh.boundary.tolist()}
    assert {frozenset(back[list(facet)].tolist()) for facet in sets["wall"]} == wall & outer
    assert sets["edges"] == {frozenset(e) for e in part.edges.tolist()}
    again = mesh.select(np.isin(np.arange(mesh.size), chosen))
    assert again.markers["number"].tolist() == sorted(order)


def test_triangles_of_a_mixed_mesh_are_simplices() -> None:
    mesh = planar(4, seed=1)
    kinds = np.repeat(list(mesh.cells), [len(block) for block in mesh.cells.values()])
    part = mesh.select(kinds == "triangle")
    assert part.is_simplicial and part.neighbors.shape == part.simplices.shape


def test_markers_may_be_padded_beside_solids_only() -> None:
    mesh = spatial(2)
    assert Mesh(mesh.points, cells=mesh.cells, markers={"a": [[0, 1, -1, -1]]}).markers["a"].tolist() == [
        [0, 1, -1, -1]
    ]
    for wrong in ([[0, -1, 1, 2]], [[-1, 0, 1, 2]], [[0, 1, -2, -1]], [[0, 1, 2, 10**6]], [[-1]]):
        with pytest.raises(InputError, match=r"markers\['a'\]\[0\] = .* missing vertices"):
            Mesh(mesh.points, cells=mesh.cells, markers={"a": wrong})
    with pytest.raises(InputError, match="missing vertices"):
        Mesh([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], markers={"a": [[0, 1, -1]]})
