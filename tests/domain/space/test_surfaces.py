"""Bodies from meshes: triangles, quadrilaterals, polygons; what is no surface in space is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from unstruct import Domain, DomainError, InputError, Mesh, delaunay

BOX = Domain.box()


def test_points_that_no_cell_has_are_left_out() -> None:
    points = np.vstack([[(9, 9, 9)], BOX.points])
    mesh = Mesh(points, cells={"quad": np.asarray(BOX.facets) + 1})
    body = Domain.surface(mesh, markers={"floor": [4]})
    assert body.volume == 1.0 and len(body.loose) == 0
    assert body.origin.tolist() == [*range(1, 9)] and body.markers["floor"].tolist() == [4]


def test_mixed_cells_and_polygons() -> None:
    rows = np.asarray(BOX.facets)
    mesh = Mesh(BOX.points, cells={"triangle": rows[0][[[0, 1, 2], [0, 2, 3]]], "polygon": list(rows[1:])})
    assert Domain.surface(mesh).volume == 1.0


def test_the_boundary_of_a_solid() -> None:
    solid = delaunay(np.random.default_rng(0).random((40, 3)))
    body = Domain.surface(Mesh(solid.points, solid.boundary))
    assert body.volume == pytest.approx(solid.volume, rel=1e-14)


@pytest.mark.parametrize(
    ("mesh", "told"),
    [
        (delaunay(np.random.default_rng(0).random((9, 3))), "cells have dimension 3.*mesh.boundary"),
        (delaunay(np.random.default_rng(0).random((9, 2))), "it is planar"),
        (Mesh(BOX.points, [[0, 1]]), "triangles, quadrilaterals or polygons are needed"),
        (BOX, "surface takes a Mesh of triangles in space, not a Domain"),
        (None, "not a NoneType"),
    ],
)
def test_what_is_no_surface(mesh: object, told: str) -> None:
    with pytest.raises(InputError, match=told):
        Domain.surface(mesh)


def test_an_open_surface() -> None:
    with pytest.raises(DomainError, match="the boundary is open"):
        Domain.surface(Mesh(BOX.points, [[0, 1, 2]]))


@pytest.mark.parametrize("suffix", [".vtu", ".msh"])
def test_files_of_other_meshes(tmp_path: Path, suffix: str) -> None:
    flat, solid = (delaunay(np.random.default_rng(0).random((9, d))) for d in (2, 3))
    flat.write(tmp_path / f"flat{suffix}")
    solid.write(tmp_path / f"solid{suffix}")
    with pytest.raises(
        InputError, match=rf"flat\{suffix} is a planar mesh, not a region: read it with Mesh.read"
    ):
        Domain.read(tmp_path / f"flat{suffix}")
    with pytest.raises(InputError, match=rf"solid\{suffix} is no surface in space: cells have dimension 3"):
        Domain.read(tmp_path / f"solid{suffix}")
    with pytest.raises(InputError, match=r"there is no file none\.stl"):
        Domain.read(tmp_path / "none.stl")
