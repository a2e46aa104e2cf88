"""Meshes of regions in files and back: markers, names, and what a format cannot store."""

from __future__ import annotations

import warnings
from pathlib import Path

import meshio
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from regions import KINDS, random_region

from unstruct import Domain, Mesh, check, constrained_delaunay, refine, swap_diagonals
from unstruct.base.errors import MeshError
from unstruct.examples import regions as example_regions

BOX = [[0, 0], [2, 0], [2, 1], [0, 1], [1, 0], [1, 1]]
SIDES = [[0, 4], [4, 1], [1, 2], [2, 5], [5, 3], [3, 0]]


def halves() -> Domain:
    markers = {"mid wall": [6], "left": [5], "none": []}
    regions = {"a b": [[0.5, 0.5]], "c": [[1.5, 0.5]]}
    return Domain(BOX, SIDES, inner=[[4, 5]], markers=markers, regions=regions)


def keys(rows: np.ndarray) -> set[tuple[int, ...]]:
    return set(map(tuple, np.sort(rows, axis=1).tolist()))


def assert_same(mesh: Mesh, again: Mesh, *, order: bool) -> None:
    assert again.regions == mesh.regions
    for name in ("points", "simplices", "origin", "duplicates"):
        assert np.array_equal(getattr(again, name), getattr(mesh, name)), name
    assert set(again.markers) == set(mesh.markers)
    for name, rows in mesh.markers.items():
        other = again.markers[name]
        assert other.shape == rows.shape and (other.dtype == bool) == (rows.dtype == bool), name
        assert np.array_equal(other, rows) if order or rows.ndim == 1 else keys(other) == keys(rows), name


REGIONS = {
    "halves": halves,
    "rectangle": Domain.rectangle,
    "airfoil": lambda: Domain.naca("2412", closed=False),
    "plate": example_regions.plate,
    "running": example_regions.running_domain,
}


@pytest.mark.parametrize("suffix", ["vtu", "vtk", "msh"])
@pytest.mark.parametrize("name", REGIONS)
def test_regions_come_back_as_they_were(tmp_path: Path, name: str, suffix: str) -> None:
    domain = REGIONS[name]()
    mesh = constrained_delaunay(domain)
    assert check(mesh, domain=domain)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh.write(tmp_path / f"mesh.{suffix}")
    again = Mesh.read(tmp_path / f"mesh.{suffix}")
    assert_same(mesh, again, order=suffix != "msh")
    assert check(again, domain=domain)


@settings(max_examples=15)
@given(st.sampled_from(sorted(KINDS)), st.integers(0, 1000))
def test_random_regions_come_back(tmp_path_factory: pytest.TempPathFactory, kind: str, seed: int) -> None:
    domain = random_region(seed, kind)
    mesh = constrained_delaunay(domain)
    folder = tmp_path_factory.mktemp("files")
    for suffix in ("vtu", "msh"):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            mesh.write(folder / f"mesh.{suffix}")
        again = Mesh.read(folder / f"mesh.{suffix}")
        if not caught:
            assert_same(mesh, again, order=suffix != "msh")
        assert suffix == "msh" or not caught


@pytest.mark.parametrize("suffix", ["vtu", "vtk", "msh"])
@settings(max_examples=25)
@given(
    name=st.text(min_size=1, max_size=8).filter(lambda s: s.isprintable() and s not in ("facets", "inner"))
)
def test_names_of_any_kind(tmp_path_factory: pytest.TempPathFactory, name: str, suffix: str) -> None:
    regions = {name: [0.5, 0.5], f"{name} y": [1.5, 0.5]}  # the second one's name is that of a marker, too
    markers = {f"x{name}": [1, 2], f"{name} y": []}
    mesh = constrained_delaunay(Domain(BOX, SIDES, inner=[[4, 5]], markers=markers, regions=regions))
    path = tmp_path_factory.mktemp("names") / f"mesh.{suffix}"
    mesh.write(path)
    assert_same(mesh, Mesh.read(path), order=False)


def test_a_face_of_several_markers_is_in_one_group_of_gmsh(tmp_path: Path) -> None:
    domain = Domain(BOX, SIDES, markers={"wall": [0, 1], "hot": [1, 2], "cold": [0]})
    mesh = refine(domain, 0.5)
    with pytest.warns(UserWarning, match=r"not written: 'hot', 'cold'; \.msh stores each face in one group"):
        mesh.write(tmp_path / "mesh.msh")
    again = Mesh.read(tmp_path / "mesh.msh").markers
    assert keys(again["wall"]) == keys(mesh.markers["wall"]) and "cold" not in again
    assert keys(again["hot"]) == keys(mesh.markers["hot"]) - keys(mesh.markers["wall"])
    assert keys(again["facets"]) == keys(mesh.markers["facets"])


def test_gmsh_sees_the_groups(tmp_path: Path) -> None:
    gmsh = pytest.importorskip("gmsh")
    mesh = refine(halves(), 0.3)
    mesh.write(tmp_path / "mesh.msh")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(tmp_path / "mesh.msh"))
        found = {}
        for d, tag in gmsh.model.getPhysicalGroups():
            entities = gmsh.model.getEntitiesForPhysicalGroup(d, tag)
            many = sum(len(gmsh.model.mesh.getElements(d, e)[1][0]) for e in entities)
            found[d, gmsh.model.getPhysicalName(d, tag)] = many
        gmsh.write(str(tmp_path / "other.msh"))  # in Gmsh's own version, 4.1
    finally:
        gmsh.finalize()
    regions = {(2, name): int((mesh.markers["region"] == k).sum()) for name, k in mesh.regions.items()}
    named = {(1, name): len(mesh.markers[name]) for name in ("mid wall", "left")}
    rest = len(mesh.markers["facets"]) - named[1, "left"]
    assert found == regions | named | {(1, "facets"): rest}
    again = Mesh.read(tmp_path / "other.msh")
    assert np.bincount(again.markers["region"]).tolist() == list(regions.values())
    assert len(again.markers["mid wall"]) == len(mesh.markers["mid wall"])
    assert again.regions == {"a b": 0, "c": 1}
    finer = refine(again, max_area={"a b": 0.01})
    areas = [finer.volumes[finer.markers["region"] == k].max() for k in (0, 1)]
    assert areas[0] <= 0.01 < areas[1] and finer.regions == mesh.regions


def test_groups_of_cells_by_name(tmp_path: Path) -> None:
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    other = meshio.Mesh(
        points,
        [("triangle", [[0, 1, 2], [0, 2, 3]]), ("line", [[0, 1]])],
        cell_data={
            "gmsh:physical": [np.array([4, 9]), np.array([2])],
            "gmsh:geometrical": [np.array([4, 9]), np.array([2])],
        },
        field_data={"fluid": np.array([4, 2]), "solid": np.array([9, 2]), "inlet": np.array([2, 1])},
    )
    meshio.write(tmp_path / "a.msh", other, file_format="gmsh22")
    mesh = Mesh.read(tmp_path / "a.msh")
    assert mesh.regions == {"fluid": 0, "solid": 1} and mesh.markers["region"].tolist() == [0, 1]
    assert mesh.markers["inlet"].tolist() == [[0, 1]]
    flags = Mesh(mesh.points, mesh.simplices, markers={"fluid": [True, False], "solid": [False, True]})
    for k, one in enumerate((mesh, flags)):
        one.write(tmp_path / f"b{k}.msh")
        again = Mesh.read(tmp_path / f"b{k}.msh")
        assert again.regions == {"fluid": 0, "solid": 1} and again.markers["region"].tolist() == [0, 1]


def test_some_groups_of_cells_without_a_name(tmp_path: Path) -> None:
    """Groups 3 and 7 have names, 5 has none, and cells of group 0 are in no group."""
    cells = np.arange(12).reshape(4, 3)
    points = np.pad(np.random.default_rng(0).random((12, 2)), ((0, 0), (0, 1)))
    tags = [np.array([7, 5, 0, 3])]
    other = meshio.Mesh(
        points,
        [("triangle", cells)],
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={"air": np.array([3, 2]), "oil": np.array([7, 2])},
    )
    meshio.write(tmp_path / "a.msh", other, file_format="gmsh22")
    mesh = Mesh.read(tmp_path / "a.msh")
    assert mesh.regions == {"air": 0, "oil": 2} and mesh.markers["region"].tolist() == [2, 1, 3, 0]
    assert mesh.markers["gmsh:physical"].tolist() == [7, 5, 0, 3]


def test_what_scikit_fem_cannot_find_is_reported() -> None:
    skfem = pytest.importorskip("skfem")
    mesh = refine(halves(), 0.3)
    theirs = mesh.to_skfem()
    assert list(theirs.subdomains) == ["a b", "c"]
    assert isinstance(theirs, skfem.MeshTri) and len(theirs.boundaries["none"]) == 0
    for name in ("facets", "mid wall", "left"):
        found = theirs.facets[:, theirs.boundaries[name]].T
        assert (found == np.sort(mesh.markers[name], axis=1)).all()
    wrong = Mesh(mesh.points, mesh.simplices, markers={"left": [[0, 2]]})
    with pytest.raises(MeshError, match=r"\[0, 2\] has a marker, but is not a facet"):
        wrong.to_skfem()


def test_what_other_libraries_cannot_have_is_told() -> None:
    side = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float)
    domain = Domain(side, [(0, 1), (1, 2), (2, 3), (3, 0)], markers={"a": [0], "c": [2]})
    mesh = refine(domain.matched("a", "c"), 0.4)
    for convert in (mesh.to_meshio, mesh.to_skfem):
        with pytest.warns(UserWarning, match="periodic"):
            convert()


def test_many_names() -> None:
    """Each of them was looked for among all edges: `select` took minutes, `.msh` hours."""
    n = 2000
    t = np.arange(n) * (2 * np.pi / n)
    ring = np.column_stack([np.cos(t), np.sin(t)])
    facets = np.column_stack([np.arange(n), (np.arange(n) + 1) % n])
    mesh = constrained_delaunay(Domain(ring, facets, markers={f"m{i}": [i] for i in range(n)}))
    half = mesh.select(np.arange(mesh.size // 2))
    kept = sum(len(half.markers[f"m{i}"]) for i in range(n))
    assert kept == len(half.markers["facets"])
    for other in (refine(mesh, min_angle=0), swap_diagonals(mesh)):
        assert all(np.array_equal(other.markers[f"m{i}"], mesh.markers[f"m{i}"]) for i in range(0, n, 97))


@pytest.mark.parametrize("suffix", ["msh", "mesh"])
def test_facets_of_triangles_and_quadrilaterals_are_read_again(suffix: str, tmp_path: Path) -> None:
    """A wedge below a tetrahedron: "facets" had lost the faces of markers with both shapes."""
    points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1), (0.2, 0.2, 2)]
    bare = Mesh(points, cells={"wedge": [[0, 1, 2, 3, 4, 5]], "tetra": [[3, 4, 5, 6]]})
    rows = np.asarray(bare.boundary)
    many = (rows >= 0).sum(axis=1)
    mixed = np.array([np.flatnonzero(many == 3)[0], *np.flatnonzero(many == 4)])
    markers = {"facets": rows, "mixed": rows[mixed], "others": np.delete(rows, mixed, axis=0)[:, :3]}
    mesh = Mesh(points, cells=bare.cells, markers=markers)
    mesh.write(tmp_path / f"a.{suffix}")
    read = Mesh.read(tmp_path / f"a.{suffix}").markers
    for name, wanted in mesh.markers.items():
        assert sorted(np.sort(read[name], axis=1).tolist()) == sorted(np.sort(wanted, axis=1).tolist()), name
