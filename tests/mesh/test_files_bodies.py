"""Tetrahedra of bodies in files and other libraries: names of pieces, regions and fields come back."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

from unstruct import Domain, Mesh, check, tetrahedralize

NAMES = ("in let", "out", "wall", "interface", "bottom", "top")


@pytest.fixture(scope="module")
def body() -> Mesh:
    """Two regions, a named wall between them, a crack in one of them, and a field."""
    plane = Domain(
        [(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (0, 1), (1.3, 0.5), (1.7, 0.5)],
        [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0)],
        inner=[(1, 4), (6, 7)],
        markers={"in let": [5], "out": [2], "wall": [0, 1, 3, 4], "interface": [6]},
        regions={"left": [(0.5, 0.5)], "right": [(1.5, 0.2)]},
    )
    return tetrahedralize(Domain.extruded(plane, 1, size=0.4), 0.4)


def keys(rows: np.ndarray) -> set[frozenset[int]]:
    return {frozenset(row) for row in rows.tolist()}


def assert_same(mesh: Mesh, again: Mesh) -> None:
    assert np.array_equal(again.points, mesh.points) and np.array_equal(again.simplices, mesh.simplices)
    assert again.regions == mesh.regions and set(again.markers) == set(mesh.markers)
    for name, values in mesh.markers.items():
        if values.ndim == 1:
            assert np.array_equal(again.markers[name], values), name
        else:
            assert keys(again.markers[name]) == keys(values), name


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("a.msh", {"version": "2.2"}),
        ("a.msh", {"version": "4.1"}),
        ("a.msh", {"version": "2.2", "binary": True}),
        ("a.msh", {"version": "4.1", "binary": True}),
        ("a.vtu", {}),
        ("a.vtk", {}),
        ("a.vtk", {"binary": False}),
        ("a.xdmf", {}),
        ("a.xdmf", {"binary": False}),
        ("a.mesh", {}),
    ],
)
def test_names_and_regions_come_back(body: Mesh, tmp_path: Path, name: str, options: dict) -> None:
    assert all(len(body.markers[n]) for n in NAMES) and len(body.markers["inner"]) > len(
        body.markers["interface"]
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        body.write(tmp_path / name, **options)
        again = Mesh.read(tmp_path / name)
    assert_same(body, again)
    assert check(again)


@pytest.mark.parametrize("suffix", ["vtu", "vtk", "xdmf"])
def test_fields_come_back(body: Mesh, tmp_path: Path, suffix: str) -> None:
    fields = {"temperature": body.quality("3r/R"), "hot": body.quality("3r/R") > 0.8, "facets": body.boundary}
    mesh = Mesh(body.points, body.simplices, markers=fields)
    mesh.write(tmp_path / f"a.{suffix}")
    assert_same(mesh, Mesh.read(tmp_path / f"a.{suffix}"))


def test_gmsh_has_the_groups_of_a_body(body: Mesh, tmp_path: Path) -> None:
    gmsh = pytest.importorskip("gmsh")
    for version in ("2.2", "4.1"):
        body.write(tmp_path / "a.msh", version=version)
        gmsh.initialize(interruptible=False)
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            gmsh.open(str(tmp_path / "a.msh"))
            found = {}
            for d, tag in gmsh.model.getPhysicalGroups():
                parts = [
                    rows
                    for e in gmsh.model.getEntitiesForPhysicalGroup(d, tag)
                    for rows in gmsh.model.mesh.getElements(d, e)[1]
                ]
                found[d, gmsh.model.getPhysicalName(d, tag)] = sum(map(len, parts))
        finally:
            gmsh.finalize()
        for name in NAMES:
            assert found[2, name] == len(body.markers[name])
        for name, k in body.regions.items():
            assert found[3, name] == (body.markers["region"] == k).sum()


def test_scikit_fem_has_boundaries_and_regions(body: Mesh) -> None:
    pytest.importorskip("skfem")
    theirs = body.to_skfem()
    for name in NAMES:
        facets = theirs.facets[:, theirs.boundaries[name]].T
        assert keys(facets) == keys(body.markers[name]), name
    for name, k in body.regions.items():
        assert np.array_equal(theirs.subdomains[name], np.flatnonzero(body.markers["region"] == k))


def test_poisson_on_a_ball() -> None:
    """-Δu = 6 with u = 0 on the unit sphere: u = 1 - r². The error goes down as the square of the size."""
    skfem = pytest.importorskip("skfem")
    from skfem.helpers import dot, grad

    @skfem.BilinearForm
    def laplace(u, v, _):
        return dot(grad(u), grad(v))

    @skfem.LinearForm
    def load(v, _):
        return 6.0 * v

    @skfem.Functional
    def square(w):
        return (w["u"] - (1 - (w.x**2).sum(axis=0))) ** 2

    errors = []
    for size in (0.5, 0.25):
        mesh = tetrahedralize(Domain.ball(size=size), size)
        theirs = mesh.to_skfem()
        basis = skfem.Basis(theirs, skfem.ElementTetP1())
        fixed = basis.get_dofs("facets")
        u = skfem.solve(*skfem.condense(laplace.assemble(basis), load.assemble(basis), D=fixed))
        errors.append(square.assemble(basis, u=basis.interpolate(u)) ** 0.5)
    assert errors[1] < 0.05 and errors[1] < errors[0] / 3, errors


def test_pyvista_has_the_cells_and_the_names(body: Mesh, tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    body.write(tmp_path / "a.vtu")
    for theirs in (pyvista.read(tmp_path / "a.vtu"), pyvista.from_meshio(body.to_meshio())):
        solid = theirs.extract_cells(theirs.celltypes == pyvista.CellType.TETRA)
        assert solid.n_cells == body.size and solid.volume == pytest.approx(2)
        assert np.array_equal(solid.cell_data["region"], body.markers["region"])
        wall = theirs.extract_cells(theirs.cell_data["faces:interface"] == 1)
        assert wall.n_cells == len(body.markers["interface"])
