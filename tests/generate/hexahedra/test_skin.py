"""The skin of cubes covers what it should, once; what it leaves of facets ends in closed outlines."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.generate.hexahedra.test_dominant import SIDES, UNIT
from tests.helpers.voxels import voxels
from unstruct import Domain, octree
from unstruct.generate.hexahedra.choosing import clear_leaves, with_hexahedra
from unstruct.generate.hexahedra.pattern import cubes_as_cells
from unstruct.generate.hexahedra.planes import faces_in_planes, planes_of
from unstruct.generate.hexahedra.skin import cover_of, places_of_vertices, skin_of
from unstruct.generate.tree.vertices import numbered


@settings(max_examples=20, deadline=None)
@given(
    st.sets(st.tuples(*[st.integers(0, 2)] * 3), min_size=1, max_size=9),
    st.floats(0.5, 1.0),
    st.integers(0, 10**6),
)
def test_some_leaves_of_voxels(cells: set, share: float, seed: int) -> None:
    body = Domain(*voxels(cells)).simplified()
    tree = octree(body, 0.5, box=[[0, 0, 0], [4, 4, 4]])
    planes = planes_of(tree, True, False)
    chosen = clear_leaves(tree, body, 0.0, planes)
    assert np.array_equal(chosen, tree.states == 1)
    bare, partly = faces_in_planes(tree, body, planes, chosen)
    chosen &= ~partly & (np.random.default_rng(seed).random(len(tree)) < share)
    vertices = numbered(tree.grid)
    kinds = with_hexahedra(tree, vertices, chosen, bare=bare)
    if not (kinds.kind > 0).any():
        return
    cubes = cubes_as_cells(tree.grid, vertices, kinds.kind, bare=bare)
    skin = skin_of(cubes, body, planes)
    kept = np.flatnonzero(kinds.kind > 0)
    faces = sum(bin(int(bits)).count("1") for bits in bare[kept])
    four = skin.faces[:, 3] >= 0
    assert four.sum() + (~four).sum() / 2 == faces  # a square, or two triangles of one
    x = cubes.points[np.where(skin.faces >= 0, skin.faces, skin.faces[:, :1])]
    assert (np.ptp(x, axis=1) == 0).any(axis=1).all()
    cover, place = cover_of(body, planes, cubes, skin)
    points = np.concatenate([body.points, cover.points])
    at = np.flatnonzero(place >= 0)
    assert np.array_equal(points[place[at]], cubes.points[at])
    assert len(np.unique(points, axis=0)) == len(points)
    for piece in np.unique(cover.piece):
        ends = cover.edges[cover.piece == piece]
        assert (np.bincount(ends.ravel()) % 2 == 0).all()
    for (a, b), v in zip(cover.side.tolist(), cover.vertex.tolist(), strict=True):
        assert a < b
        along, away = points[b] - points[a], points[v] - points[a]
        assert np.array_equal(np.cross(along, away), [0, 0, 0])
        assert 0 < (along * away).sum() < (along * along).sum()
    away = np.abs(points[cover.vertex] - points[cover.side[:, 0]]).max(axis=1)
    same = (cover.side[1:] == cover.side[:-1]).all(axis=1)
    assert (np.diff(away)[same] > 0).all()


def test_same_places() -> None:
    body = Domain(UNIT, SIDES)
    x = np.array([[0.0, -0.0, 1.0], [0.5, 0, 0], [1, 1, 1]])
    assert places_of_vertices(body, x).tolist() == [4, -1, 6]


@pytest.mark.parametrize("size", [1.0, 0.25])
def test_all_of_a_cube(size: float) -> None:
    body = Domain(UNIT, SIDES)
    tree = octree(body, size, box=[[0, 0, 0], [1, 1, 1]])
    planes = planes_of(tree, None, False)
    every = np.ones(len(tree), dtype=bool)
    bare, partly = faces_in_planes(tree, body, planes, every)
    assert not partly.any()
    vertices = numbered(tree.grid)
    kinds = with_hexahedra(tree, vertices, every, bare=bare)
    cubes = cubes_as_cells(tree.grid, vertices, kinds.kind, bare=bare)
    skin = skin_of(cubes, body, planes)
    n = round(1 / size)
    assert len(cubes.hexahedra) == n**3
    assert np.bincount(skin.piece).tolist() == [n * n] * 6
    cover, _ = cover_of(body, planes, cubes, skin)
    assert np.bincount(cover.piece).tolist() == [4 * n] * 6
    assert len(cover.vertex) == 12 * (n - 1)
