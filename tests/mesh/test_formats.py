"""Meshes of several kinds in files: everything comes back, or an error says what the format cannot store."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest
from mixed_cells import GOOD, planar, spatial

from unstruct import InputError, Mesh, MeshError, UnstructError


def marked(mesh: Mesh) -> Mesh:
    named = {
        "wall": mesh.boundary[::2],
        "some edges": mesh.edges[:4],
        "tips": np.array([[2], [0]]),
        "nothing": np.empty((0, 2), dtype=int),
        "region": np.arange(mesh.size) % 3,
        "odd": np.arange(mesh.size) % 2 == 1,
        "value": np.arange(mesh.size) * 0.1,
    }
    return Mesh(mesh.points, cells=mesh.cells, markers=named, origin=np.arange(len(mesh.points))[::-1])


def faces(rows: np.ndarray) -> set[frozenset[int]]:
    return {frozenset(v for v in row if v >= 0) for row in rows.tolist()}


def assert_same_cells(mesh: Mesh, again: Mesh) -> None:
    assert list(again.cells) == list(mesh.cells) and np.array_equal(again.points, mesh.points)
    for kind, block in mesh.cells.items():
        assert [row.tolist() for row in again.cells[kind]] == [row.tolist() for row in block]


@pytest.mark.parametrize("suffix", ["vtu", "vtk"])
@pytest.mark.parametrize("mesh", [planar(5, jitter=0.1, seed=3), spatial(3, jitter=0.1)], ids=repr)
def test_all_comes_back(tmp_path: Path, mesh: Mesh, suffix: str) -> None:
    mesh = marked(mesh)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh.write(tmp_path / f"mesh.{suffix}")
        again = Mesh.read(tmp_path / f"mesh.{suffix}")
    assert_same_cells(mesh, again)
    assert np.array_equal(again.origin, mesh.origin) and set(again.markers) == set(mesh.markers)
    for name, values in mesh.markers.items():
        if values.ndim == 1:
            assert (
                np.array_equal(again.markers[name], values)
                and again.markers[name].dtype.kind == values.dtype.kind
            )
        else:
            assert faces(again.markers[name]) == faces(values)
            assert again.markers[name].shape == values.shape


def test_polygons_of_many_sizes_keep_their_order(tmp_path: Path) -> None:
    sizes = [5, 3, 4, 3, 6, 5]
    ends = np.cumsum(sizes)
    rows = np.split(np.arange(ends[-1]), ends[:-1])
    points = np.random.default_rng(0).random((ends[-1] + 3, 2))
    last = np.arange(ends[-1], ends[-1] + 3)[None]
    for cells in ({"polygon": rows, "triangle": last}, {"triangle": last, "polygon": rows}):
        mesh = Mesh(points, cells=cells, markers={"number": np.arange(7), "corner": [[1]]})
        for suffix in ("vtu", "vtk"):
            mesh.write(tmp_path / f"mesh.{suffix}")
            again = Mesh.read(tmp_path / f"mesh.{suffix}")
            assert_same_cells(mesh, again)
            assert again.markers["number"].tolist() == list(range(7))
            assert again.markers["corner"].tolist() == [[1]] and set(again.markers) == set(mesh.markers)


def test_gmsh_groups_of_triangles_and_quadrilaterals(tmp_path: Path) -> None:
    mesh = spatial(3, jitter=0.1)
    wall = mesh.boundary[mesh.points[mesh.boundary[:, :3]][:, :, 2].max(axis=1) == 0]
    rest = mesh.boundary[mesh.points[mesh.boundary[:, :3]][:, :, 2].max(axis=1) > 0]
    assert len(set((wall < 0).sum(axis=1))) == 2, "both kinds of faces"
    marks = {"floor": wall, "rest": rest, "region": np.arange(mesh.size) % 2, "edge": mesh.edges[:3]}
    mesh = Mesh(mesh.points, cells=mesh.cells, markers=marks)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh.write(tmp_path / "mesh.msh")
    again = Mesh.read(tmp_path / "mesh.msh")
    assert_same_cells(mesh, again)
    assert set(again.markers) == set(mesh.markers)
    assert again.markers["region"].tolist() == mesh.markers["region"].tolist()
    for name in ("floor", "rest", "edge"):
        assert faces(again.markers[name]) == faces(mesh.markers[name])


@pytest.mark.parametrize("suffix", ["su2", "avs", "bdf"])
def test_cells_alone(tmp_path: Path, suffix: str) -> None:
    mesh = marked(spatial(2))
    with pytest.warns(UserWarning, match=r"not written: ('wall', )?'some edges', .*'value'"):
        mesh.write(tmp_path / f"mesh.{suffix}")
    again = Mesh.read(tmp_path / f"mesh.{suffix}")
    assert set(again.cells) == set(mesh.cells)
    for kind, block in mesh.cells.items():
        assert np.array_equal(again.cells[kind], block)
    assert again.volume == pytest.approx(mesh.volume)


@pytest.mark.parametrize("suffix", ["stl", "off", "obj", "ply", "xml", "tec", "inp", "hello"])
def test_solids_that_a_format_cannot_store(tmp_path: Path, suffix: str) -> None:
    with pytest.raises(InputError, match=rf"cannot write this mesh as '\.{suffix}'"):
        spatial(2).write(tmp_path / f"mesh.{suffix}")
    assert not (tmp_path / f"mesh.{suffix}").exists()


@pytest.mark.parametrize("suffix", ["stl", "off", "msh", "mesh", "su2", "f3grid", "xml", "avs", "bdf"])
def test_polygons_that_a_format_cannot_store(tmp_path: Path, suffix: str) -> None:
    with pytest.raises(InputError, match=r"polygon.*; \.vtu stores all"):
        planar(4, seed=1).write(tmp_path / f"mesh.{suffix}")


def test_node_and_ele_are_for_simplices(tmp_path: Path) -> None:
    mesh = planar(4, seed=1)
    for suffix in ("node", "ele"):
        with pytest.raises(MeshError, match=r"\.node and \.ele store simplices of one kind, not .*quad"):
            mesh.write(tmp_path / f"mesh.{suffix}")
    kinds = np.repeat(list(mesh.cells), [len(block) for block in mesh.cells.values()])
    part = mesh.select(kinds == "triangle")
    part.write(tmp_path / "part.node")
    assert np.array_equal(Mesh.read(tmp_path / "part.node").simplices, part.simplices)


def test_hexahedra_in_scikit_fem() -> None:
    skfem = pytest.importorskip("skfem")
    corners = np.array(GOOD["hexahedron"]) + 0.3 * np.random.default_rng(0).normal(size=(8, 3))
    wall = [[0, 1, 5, 4], [4, 5, 6, 7]]
    mesh = Mesh(corners, cells={"hexahedron": [range(8)]}, markers={"wall": wall, "all": [True]})
    theirs = mesh.to_skfem()
    basis = skfem.Basis(theirs, skfem.ElementHex1(), intorder=8)
    volume = skfem.Functional(lambda w: 1 + 0 * w.x[0]).assemble(basis)
    assert volume == pytest.approx(mesh.volume) and theirs.subdomains["all"].tolist() == [0]
    assert faces(theirs.facets[:, theirs.boundaries["wall"]].T) == {frozenset(row) for row in wall}
    quads = Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], cells={"quad": [[0, 1, 2, 3]]}, markers={"low": [[0, 1]]})
    assert len(quads.to_skfem().boundaries["low"]) == 1
    for other in (spatial(2), planar(3, seed=1)):
        with pytest.raises(MeshError, match="scikit-fem has no mesh for cells of kind"):
            other.to_skfem()


def one_of_each(kinds: list[str]) -> Mesh:
    """One good cell of each kind, apart from each other, at coordinates that need all digits."""
    points, cells, n = [], {}, 0
    dimension = max(np.shape(GOOD[kind])[1] for kind in kinds)
    for i, kind in enumerate(kinds):
        corners = np.array(GOOD[kind]) / 7
        points.append(np.pad(corners, ((0, 0), (0, dimension - corners.shape[1]))) + 2 * i)
        cells[kind] = [range(n, n + len(corners))]
        n += len(corners)
    return Mesh(np.vstack(points), cells=cells)


def suffixes() -> list[str]:
    meshio = pytest.importorskip("meshio")
    known = set(meshio._helpers.extension_to_filetypes)
    return sorted(known - {".svg"} | {".lb8.ugrid"})  # .svg is a picture


@pytest.mark.parametrize("suffix", suffixes())
def test_no_format_loses_or_changes_cells(tmp_path: Path, suffix: str) -> None:
    """Each kind alone, and mixtures, come back in every format that meshio knows, or are refused."""
    mixtures = [["quad", "triangle"], ["triangle", "polygon"], ["tetra", "hexahedron", "wedge", "pyramid"]]
    for i, kinds in enumerate([[kind] for kind in GOOD] + mixtures):
        mesh, path = one_of_each(kinds), tmp_path / f"mesh{i}{suffix}"
        try:
            mesh.write(path)
        except UnstructError as error:
            assert not path.exists() and len(str(error)) > 40
            continue
        again = Mesh.read(path)
        assert set(again.cells) == set(mesh.cells), kinds
        for kind, block in mesh.cells.items():
            assert [row.tolist() for row in again.cells[kind]] == [row.tolist() for row in block], kinds
        assert again.points == pytest.approx(mesh.points, abs=1e-6), kinds


@pytest.mark.parametrize("suffix", ["vtu", "vtk", "msh", "inp"])
def test_kinds_without_cells_are_left_out(tmp_path: Path, suffix: str) -> None:
    corners = np.array(GOOD["hexahedron"])
    none = np.empty((0, 6), dtype=int)
    mesh = Mesh(corners, cells={"wedge": none, "hexahedron": [range(8)], "tetra": []})
    assert mesh.size == 1 and mesh.cells["tetra"].shape == (0, 4)
    mesh.write(tmp_path / f"mesh.{suffix}")
    again = Mesh.read(tmp_path / f"mesh.{suffix}")
    assert list(again.cells) == ["hexahedron"] and again.cells["hexahedron"].tolist() == [list(range(8))]


def test_a_mesh_without_cells(tmp_path: Path) -> None:
    """meshio writes files that it cannot read; Triangle's format has a count, which may be zero."""
    for points in (np.array([[0.0, 0.0], [1.0, 1.0]]), np.empty((0, 2))):
        mesh = Mesh(points, np.empty((0, 3), dtype=int))
        for suffix in ("vtu", "msh", "off", "xdmf"):
            with pytest.raises(InputError, match="a mesh without cells cannot be written"):
                mesh.write(tmp_path / f"mesh.{suffix}")
        mesh.write(tmp_path / "mesh.node")
        again = Mesh.read(tmp_path / "mesh.node")
        assert np.array_equal(again.points, points) and again.simplices.shape == (0, 3)


def test_attributes_of_triangles_in_space_are_no_corners(tmp_path: Path) -> None:
    (tmp_path / "mesh.node").write_text("3 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n")
    (tmp_path / "mesh.ele").write_text("1 3 1\n1 1 2 3 7\n")
    mesh = Mesh.read(tmp_path / "mesh.ele")
    assert mesh.simplices.tolist() == [[0, 1, 2]] and mesh.markers["attribute"].tolist() == [7]


@pytest.mark.parametrize("suffix", ["vtu", "vtk"])
def test_real_values_that_are_whole_stay_real(tmp_path: Path, suffix: str) -> None:
    mesh = Mesh(GOOD["triangle"], [[0, 1, 2]], markers={"value": [2.0], "number": [2], "flag": [True]})
    mesh.write(tmp_path / f"mesh.{suffix}")
    again = Mesh.read(tmp_path / f"mesh.{suffix}").markers
    assert [again[name].dtype.kind for name in ("value", "number", "flag")] == ["f", "i", "b"]


@pytest.mark.parametrize("suffix", [".bdf", ".fem", ".nas"])
def test_numbers_of_nastran(tmp_path: Path, suffix: str) -> None:
    """They have 16 characters; meshio fails without a text at longer ones, as most negative ones are."""
    values = [
        -1 / 3,
        1 / 3,
        -1e-17 / 3,
        1e-17 / 3,
        -1e100 / 3,
        -1e-100 / 3,
        1e300 / 3,
        -0.0,
        0.0,
        -9.9999999999999e-10,
    ]
    points = np.array([[x, 1.0, 0.0] for x in values])
    Mesh(points, [[0, 1, k] for k in range(2, len(points))]).write(tmp_path / f"a{suffix}")
    again = Mesh.read(tmp_path / f"a{suffix}")
    np.testing.assert_allclose(again.points[:, 0], values, rtol=1e-8)
    body = spatial(2, jitter=0.3, seed=1)
    Mesh(body.points - 1, cells=body.cells).write(tmp_path / f"b{suffix}")
    np.testing.assert_allclose(
        Mesh.read(tmp_path / f"b{suffix}").points, body.points - 1, rtol=1e-9, atol=1e-12
    )


def test_exponents_in_wkt(tmp_path: Path) -> None:
    points = np.array([[1e-7, 0.0], [1e22, -1e-300], [0.5, 1e-5]])
    Mesh(points, [[0, 1, 2]]).write(tmp_path / "a.wkt")
    again = Mesh.read(tmp_path / "a.wkt")
    assert sorted(again.points.tolist()) == sorted(points.tolist())


def test_meshio_is_quiet_and_errors_have_a_text(
    tmp_path: Path, capfd: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    meshio = pytest.importorskip("meshio")
    one_of_each(["triangle"]).write(tmp_path / "a.xml")
    assert capfd.readouterr() == ("", "")

    def failing(*_: object, **__: object) -> None:
        raise AssertionError

    monkeypatch.setattr(meshio.Mesh, "write", failing)
    with pytest.raises(InputError, match=r"cannot write this mesh as '\.vtu' \(AssertionError\)"):
        one_of_each(["triangle"]).write(tmp_path / "a.vtu")
