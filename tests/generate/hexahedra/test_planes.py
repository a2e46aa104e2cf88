"""Faces of leaves that facets cover, as counted in small cubes; planes of the lattice and others."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.generate.hexahedra.test_dominant import SIDES, UNIT, halves
from tests.helpers.voxels import voxels
from unstruct import Domain, octree
from unstruct.generate.hexahedra.planes import NO_AXIS, faces_in_planes, pieces_at, planes_of

WHOLE = [[0, 0, 0], [4, 4, 4]]


@settings(max_examples=25, deadline=None)
@given(
    st.sets(st.tuples(*[st.integers(0, 3)] * 3), min_size=1, max_size=14),
    st.integers(0, 2),
    st.integers(0, 99),
)
def test_as_counted_in_small_cubes(cells: set, level: int, seed: int) -> None:
    body = Domain(*voxels(cells)).simplified()
    tree = octree(body, 4.0 / 2**level, box=WHOLE)
    if seed % 3 == 0:
        tree = tree.refined([seed % len(tree)])
    solid = np.zeros((18, 18, 18), dtype=bool)  # in cubes of half the side, with empty ones around
    for cell in cells:
        i, j, k = (2 * np.array(cell) + 1).tolist()
        solid[i : i + 2, j : j + 2, k : k + 2] = True
    chosen = np.ones(len(tree), dtype=bool)
    planes = planes_of(tree, True, False)
    bits, partly = faces_in_planes(tree, body, planes, chosen)
    low, high = (np.round(2 * end).astype(int) + 1 for end in tree.corners)
    for leaf in range(len(tree)):
        covered = []
        for axis in range(3):
            for upper in (0, 1):
                box = [slice(a, b) for a, b in zip(low[leaf], high[leaf], strict=True)]
                at = high[leaf, axis] if upper else low[leaf, axis]
                sheets = []
                for layer in (at - 1, at):
                    box[axis] = slice(layer, layer + 1)
                    sheets.append(solid[tuple(box)])
                change = sheets[0] != sheets[1]
                covered.append(change.mean())
        inside = solid[tuple(slice(a, b) for a, b in zip(low[leaf], high[leaf], strict=True))].all()
        if any(0 < share < 1 for share in covered):
            assert partly[leaf]
        if inside and not partly[leaf]:
            assert bits[leaf] == sum(1 << k for k, share in enumerate(covered) if share == 1)


def test_which_planes() -> None:
    body = Domain(UNIT, SIDES)
    inside = octree(body, 0.25, box=[[0, 0, 0], [1, 1, 1]])
    assert sorted(planes_of(inside, None, False).axis.tolist()) == [0, 0, 1, 1, 2, 2]
    assert (planes_of(inside, False, False).axis == NO_AXIS).all()
    between = octree(body, 0.25)  # a root with a margin
    assert (planes_of(between, None, False).axis == NO_AXIS).all()
    some = octree(body, 0.25, box=[[0, 0, -0.1], [2, 2, 1.9]])
    assert sorted(planes_of(some, None, False).axis.tolist()) == [-1, -1, 0, 0, 1, 1]
    triangles = Domain(UNIT, body.triangulated.bounding)
    tree = octree(triangles, 0.25, box=[[0, 0, 0], [1, 1, 1]])
    assert (planes_of(tree, None, False).axis == NO_AXIS).all()  # they are kept
    assert (planes_of(tree, True, False).axis != NO_AXIS).all()
    wall = octree(halves(0.5), 0.25, box=[[0, 0, 0], [1, 1, 1]])
    assert planes_of(wall, None, False).axis[10] == NO_AXIS
    assert planes_of(wall, None, True).axis[10] == 0


@pytest.mark.parametrize("unit", [1e-200, 1.0, 1e200])
def test_passed_and_found(unit: float) -> None:
    body = Domain(UNIT * unit, SIDES)
    tree = octree(body, 0.25 * unit, box=np.array([[0, 0, 0], [1, 1, 1]]) * unit)
    planes = planes_of(tree, None, False)
    low, high = np.array([[0.5, 0.5, 0.7], [0.5, 0.5, 0.8]]) * unit, np.array([[0.75] * 3, [0.75] * 3]) * unit
    high[:, 2] = np.array([1.0, 0.95]) * unit
    assert planes.passed(np.array([1, 1]), low, high).tolist() == [True, False]
    x = np.array([[0, 0, 1], [0.25, 0, 1], [0.25, 0.25, 1], [0, 0.25, 1], [0, 0, 0.5]]) * unit
    rows = np.array([[0, 1, 2, 3], [0, 1, 2, -1], [0, 1, 4, -1], [1, 2, 4, -1]])
    assert pieces_at(body, planes, x, rows).tolist() == [1, 1, 2, -1]
