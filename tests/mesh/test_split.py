"""Cells cut into simplices: both cells of a facet cut it in the same way."""

from __future__ import annotations

import numpy as np
import pytest
from mixed_cells import planar, spatial

from unstruct.mesh.split import simplices_of_cells, surface_triangles


@pytest.mark.parametrize("seed", range(4))
def test_solids(seed: int) -> None:
    mesh = spatial(3, seed=seed)
    parts, owner = simplices_of_cells(mesh.cells)
    kinds = np.repeat(list(mesh.cells), [len(block) for block in mesh.cells.values()])
    many = {"tetra": 1, "pyramid": 2, "wedge": 3, "hexahedron": 6}
    assert np.bincount(owner, minlength=mesh.size).tolist() == [many[kind] for kind in kinds]
    e = mesh.points[parts[:, 1:]] - mesh.points[parts[:, :1]]
    volumes = np.einsum("mi,mi->m", e[:, 0], np.cross(e[:, 1], e[:, 2])) / 6
    assert (volumes > 0).all()
    assert np.bincount(owner, volumes) == pytest.approx(mesh.volumes)
    facets = np.count_nonzero(mesh.facets >= 0, axis=1)
    triangles = {
        frozenset(row)
        for kind, block in mesh.cells.items()
        for row in surface_triangles(kind, block).reshape(-1, 3).tolist()
    }
    assert len(triangles) == (facets - 2).sum(), "each quadrilateral once, and not along both diagonals"


def test_surfaces_of_solids_are_closed_and_outward() -> None:
    mesh = spatial(2, seed=2)
    for kind, block in mesh.cells.items():
        for triangles in surface_triangles(kind, block):
            edges = {(a, b) for t in triangles.tolist() for a, b in zip(t, [*t[1:], t[0]])}
            assert len(edges) == 3 * len(triangles) and edges == {(b, a) for a, b in edges}


def test_planar_cells() -> None:
    mesh = planar(5, jitter=0.1)
    parts, owner = simplices_of_cells(mesh.cells)
    e = mesh.points[parts[:, 1:]] - mesh.points[parts[:, :1]]
    areas = (e[:, 0, 0] * e[:, 1, 1] - e[:, 0, 1] * e[:, 1, 0]) / 2
    assert np.bincount(owner, areas) == pytest.approx(mesh.volumes)
    assert (np.diff(owner) >= 0).all()
