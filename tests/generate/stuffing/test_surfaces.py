"""Stuffing of domains in space: exact signs, names, what is missing."""

from __future__ import annotations

import numpy as np
import pytest

from tests.helpers.value_tables import assert_sound, dihedral_range
from unstruct import Domain, IncompleteWarning, InputError, Mesh, check, isosurface_stuffing

TURN = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]


def test_a_box_on_the_lattice_is_exact() -> None:
    mesh = isosurface_stuffing(Domain.box(), 0.25)
    assert mesh.complete
    assert check(mesh)
    assert mesh.volume == 1.0
    assert mesh.figures["cells missed"] < 1e-12
    assert dihedral_range(mesh)[0] > 44
    assert set(mesh.markers) == {"left", "right", "front", "back", "bottom", "top"}
    for name, axis, value in (("left", 0, 0.0), ("right", 0, 1.0), ("bottom", 2, 0.0), ("top", 2, 1.0)):
        assert (mesh.points[mesh.markers[name]][:, :, axis] == value).all()
    assert sum(map(len, mesh.markers.values())) == len(mesh.boundary)


@pytest.mark.parametrize("size", [0.3, 0.17, 0.08])
def test_a_turned_box(size: float) -> None:
    box = Domain.box()
    body = Domain(box.points @ TURN, box.facets)
    mesh = isosurface_stuffing(body, size)
    assert mesh.complete
    assert check(mesh)
    least, most = dihedral_range(mesh)
    assert least >= 10.7
    assert most <= 164.8
    local = mesh.points[np.unique(mesh.boundary)] @ TURN.T
    assert np.abs(np.abs(local - 0.5).max(axis=1) - 0.5).max() < 1e-12
    assert mesh.figures["cells missed"] < 0.8


@pytest.mark.parametrize("body", [Domain.ball(size=0.2), Domain.torus(size=0.25)], ids=["ball", "torus"])
def test_smooth_surfaces(body: Domain) -> None:
    mesh = isosurface_stuffing(body, 0.15)
    assert mesh.complete
    assert_sound(mesh)
    assert check(mesh)
    assert dihedral_range(mesh)[0] >= 15
    assert 0.97 * body.volume < mesh.volume < body.volume
    graded = isosurface_stuffing(body, lambda x: 0.06 + 0.1 * np.abs(x[:, 0]), graded=True)
    assert check(graded)
    assert dihedral_range(graded)[0] >= 8


def test_a_mesh_of_triangles() -> None:
    body = Domain.ball(size=0.4)
    mesh = isosurface_stuffing(Mesh(body.points, np.array(list(body.facets))), 0.2)
    assert mesh.size == isosurface_stuffing(body, 0.2).size


def test_thin_parts_are_told_by_place() -> None:
    plate = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    fin = [(1, 0.4, 0.51), (1, 0.6, 0.51), (1, 0.6, 0.53), (1, 0.4, 0.53)]
    points = np.array([*plate, *fin, *[(x + 1, y, z) for x, y, z in fin]], dtype=float)
    facets = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [2, 3, 7, 6], [3, 0, 4, 7]]
    # the side with the fin, cut into two polygons along its lower edge
    facets += (
        [[1, 2, 6, 11, 10, 9, 8, 11, 6, 5]]
        if False
        else [[1, 2, 9, 8], [2, 6, 10, 9], [6, 5, 11, 10], [5, 1, 8, 11]]
    )
    facets += [[8, 9, 13, 12], [9, 10, 14, 13], [10, 11, 15, 14], [11, 8, 12, 15], [12, 13, 14, 15]]
    body = Domain(points, facets)
    with pytest.warns(IncompleteWarning, match="thinner than a cell"):
        mesh = isosurface_stuffing(body, 0.13)
    assert not mesh.complete
    assert any("(2, " in reason for reason in mesh.reasons)
    assert mesh.figures["cells missed"] > 6


def test_regions() -> None:
    boxes = [Domain.box((0, 0, 0), (1, 1, 1)), Domain.box((2, 0, 0), (3, 1, 1))]
    points = np.concatenate([b.points for b in boxes])
    facets = [list(row) for row in boxes[0].facets] + [[i + 8 for i in row] for row in boxes[1].facets]
    body = Domain(points, facets, regions={"one": (0.5, 0.5, 0.5), "two": (2.5, 0.5, 0.5)})
    mesh = isosurface_stuffing(body, 0.3)
    centers = mesh.points[mesh.simplices].mean(axis=1)
    assert np.array_equal(mesh.markers["region"], np.where(centers[:, 0] < 1.5, 0, 1))
    assert mesh.regions == {"one": 0, "two": 1}


def test_refusals() -> None:
    with pytest.raises(InputError, match="budget"):
        isosurface_stuffing(Domain.box(), 0.01, budget=1000)
    with pytest.raises(InputError, match="thinner than a cell"):
        isosurface_stuffing(Domain.box(), 7.0)
