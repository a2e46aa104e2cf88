"""The background over graded trees: conforming, and with the angles that it has by construction."""

from __future__ import annotations

import numpy as np
import pytest

from tests.helpers.value_tables import dihedral_range
from unstruct import DomainMesh, check, octree
from unstruct.generate.stuffing.background import background_tetrahedra
from unstruct.generate.stuffing.filling import lattice_vertices


@pytest.mark.parametrize("seed", range(3))
def test_random_trees(seed: int) -> None:
    rng = np.random.default_rng(seed)
    tree = octree([(0,) * 3, (1,) * 3], points=rng.random((5, 3)), max_level=5, balance="edges")
    points, place, vertices = lattice_vertices(tree.grid)
    inner = ((place > 0) & (place < 2 << tree.depth)).all(axis=1)
    touching = ((vertices.coordinates[vertices.corners] % (1 << tree.depth)) == 0).any(axis=(1, 2))
    sign = np.where(inner, 1, -1).astype(np.int8)
    sign[len(vertices.points) :][touching] = -1
    sign[np.unique(vertices.corners[touching])] = -1
    cells = background_tetrahedra(tree.grid, vertices.corners, sign)
    if not len(cells):
        return
    whole = (sign[cells] > 0).all(axis=1)
    used, number = np.unique(cells, return_inverse=True)
    mesh = DomainMesh(points[used], number.reshape(-1, 4))
    report = check(mesh)
    assert {problem.kind for problem in report.problems} <= {"pinched vertex", "pinched edge", "vertex link"}
    least, most = dihedral_range(mesh)
    assert least > 44.99
    assert most < 120.01
    assert whole.any()


def test_the_cells_of_one_level() -> None:
    tree = octree([(0,) * 3, (1,) * 3], min_level=3, max_level=3)
    points, _, vertices = lattice_vertices(tree.grid)
    sign = np.where(np.abs(points - 0.5).max(axis=1) < 0.3, 1, -1).astype(np.int8)
    cells = background_tetrahedra(tree.grid, vertices.corners, sign)
    edges = np.sqrt(((points[cells[:, [0, 2]]] - points[cells[:, [1, 3]]]) ** 2).sum(axis=2))
    assert np.allclose(edges, 1 / 8)
    used, number = np.unique(cells, return_inverse=True)
    assert dihedral_range(DomainMesh(points[used], number.reshape(-1, 4))) == pytest.approx((60, 90))
