"""Medit's format .mesh: references with names, read again here, by Gmsh and by meshio alone."""

from __future__ import annotations

import warnings
from pathlib import Path

import meshio
import numpy as np
import pytest
from mixed_cells import planar, spatial

from unstruct import Domain, Mesh, constrained_delaunay, tetrahedralize


def keys(rows: np.ndarray) -> set[frozenset[int]]:
    return {frozenset(v for v in row if v >= 0) for row in rows.tolist()}


def body() -> Mesh:
    """A box with names of any kind."""
    plane = Domain.polygon([(0, 0), (2, 0), (2, 1), (0, 1)], markers={'a "wall"': [0, 2]})
    return tetrahedralize(Domain.extruded(plane, 1, size=0.5), 0.5)


def assert_same(mesh: Mesh, again: Mesh) -> None:
    assert list(again.cells) == list(mesh.cells) and np.array_equal(again.points, mesh.points)
    for kind, block in mesh.cells.items():
        assert np.array_equal(again.cells[kind], block)
    assert again.regions == mesh.regions and set(again.markers) == set(mesh.markers)
    for name, values in mesh.markers.items():
        if values.ndim == 1:
            assert np.array_equal(again.markers[name], values), name
        else:
            assert keys(again.markers[name]) == keys(values), name


def test_a_body_comes_back_with_its_names(tmp_path: Path) -> None:
    mesh = body()
    region = (mesh.points[mesh.simplices].mean(axis=1)[:, 0] > 1).astype(int)
    mesh = Mesh(
        mesh.points,
        mesh.simplices,
        markers={**{k: v for k, v in mesh.markers.items() if v.ndim == 2}, "region": region},
        regions={"left half": 0, "ä \n": 1},
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh.write(tmp_path / "a.mesh")
    assert_same(mesh, Mesh.read(tmp_path / "a.mesh"))
    theirs = meshio.read(tmp_path / "a.mesh")
    assert [block.type for block in theirs.cells] == ["tetra", "triangle"], "each kind once"
    assert set(theirs.cell_data["medit:ref"][0].tolist()) == {1, 2}
    gmsh = pytest.importorskip("gmsh")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(tmp_path / "a.mesh"))
        entities = gmsh.model.getEntities(3)
        counts = [len(gmsh.model.mesh.getElements(d, e)[1][0]) for d, e in entities]
    finally:
        gmsh.finalize()
    assert counts == np.bincount(region).tolist()


@pytest.mark.parametrize("mesh", [spatial(3, jitter=0.1), constrained_delaunay(Domain.rectangle())], ids=repr)
def test_other_cells(tmp_path: Path, mesh: Mesh) -> None:
    named = {"first": mesh.boundary[:2], "rest": mesh.boundary[2:], "odd": np.arange(mesh.size) % 2 == 1}
    mesh = Mesh(mesh.points, cells=mesh.cells, markers=named)
    mesh.write(tmp_path / "a.mesh")
    again = Mesh.read(tmp_path / "a.mesh")
    assert np.array_equal(again.points, mesh.points) and list(again.cells) == list(mesh.cells)
    assert keys(again.markers["first"]) == keys(named["first"])
    assert keys(again.markers["rest"]) == keys(named["rest"])
    assert np.array_equal(again.markers["region"] == again.regions["odd"], named["odd"])


def test_what_is_lost_is_named(tmp_path: Path) -> None:
    mesh = body()
    values = {"temperature": np.linspace(0, 1, mesh.size), "tips": [[0], [1]]}
    mesh = Mesh(mesh.points, mesh.simplices, markers=values)
    with pytest.warns(UserWarning, match="not written: 'temperature', 'tips'; .mesh has one number"):
        mesh.write(tmp_path / "a.mesh")
    assert set(Mesh.read(tmp_path / "a.mesh").markers) == set()


def test_files_of_others_are_read_as_before(tmp_path: Path) -> None:
    mesh = body()
    cells = [("tetra", mesh.simplices)]
    other = meshio.Mesh(mesh.points, cells, cell_data={"medit:ref": [np.arange(mesh.size) % 2]})
    other.write(tmp_path / "b.mesh")
    again = Mesh.read(tmp_path / "b.mesh")
    assert np.array_equal(again.markers["medit:ref"], np.arange(mesh.size) % 2)
    with pytest.raises(ValueError, match="polygon"):
        planar(3, seed=1).write(tmp_path / "c.mesh")
