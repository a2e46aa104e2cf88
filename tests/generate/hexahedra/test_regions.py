"""The region of each leaf: also where a wall lies in the faces of leaves."""

from __future__ import annotations

import numpy as np
import pytest

from tests.generate.hexahedra.test_dominant import SIDES, UNIT, halves
from unstruct import Domain, octree
from unstruct.generate.hexahedra.meeting import meetings
from unstruct.generate.hexahedra.regions import regions_of_leaves


@pytest.mark.parametrize("at", [0.45, 0.5, 0.625, 0.75])
@pytest.mark.parametrize("fine", [False, True])
def test_a_wall_between_or_in_planes_of_the_lattice(at: float, fine: bool) -> None:
    body = halves(at)
    size = (lambda x: 0.06 + 0.4 * np.abs(x[:, 0] - at)) if fine else 1 / 8
    tree = octree(body, size, box=[[0, 0, 0], [1, 1, 1]])
    shell = body.triangulated
    chosen = np.asarray(tree.states) == 1
    chosen[meetings(tree, chosen, shell.points, shell.triangles)[0]] = False
    region = regions_of_leaves(tree, chosen)
    low, high = tree.corners
    right = np.where(low[:, 0] >= at, 0, np.where(high[:, 0] <= at, 1, -1))  # "b" is the first name
    assert np.array_equal(region, np.where(chosen, right, -1))
    mesh = tree.mesh("hexahedra")
    side = mesh.points[mesh.cells["hexahedron"]][..., 0].mean(axis=1)
    own = mesh.markers["region"][: len(side)]
    assert np.array_equal(own, np.where(side > at, 0, 1))


def test_parts_without_names_and_shells_in_shells() -> None:
    body = Domain(
        np.concatenate([UNIT, 0.25 + 0.5 * UNIT]),
        SIDES,
        inner=SIDES + 8,
        regions={"within": [(0.5, 0.5, 0.5)]},
    )
    tree = octree(body, 1 / 8, box=[[0, 0, 0], [1, 1, 1]])
    region = regions_of_leaves(tree, np.ones(len(tree), dtype=bool))
    within = (np.abs(tree.centers - 0.5) < 0.25).all(axis=1)
    assert np.array_equal(region, np.where(within, 0, 1))
    assert (regions_of_leaves(tree, np.zeros(len(tree), dtype=bool)) == -1).all()
