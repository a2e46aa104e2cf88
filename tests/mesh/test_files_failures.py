"""Writing that fails leaves what was there; options; packages that are missing; files that are not meshes."""

from __future__ import annotations

import os
import sys
import warnings
from pathlib import Path

import meshio
import numpy as np
import pytest

from unstruct import InputError, Mesh, UnstructError, delaunay
from unstruct.mesh import files

SQUARE = Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]])
OWN = ["msh", "su2", "node", "ele", "polyMesh"]
THEIRS = (
    "avs bdf f3grid h5m inp med mdpa mesh meshb nas obj off ply stl tec lb8.ugrid vtk vtu xdmf xml".split()
)


def place(folder: Path, suffix: str) -> Path:
    return folder / suffix if suffix == "polyMesh" else folder / f"a.{suffix}"


def state(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def quiet_write(mesh: Mesh, path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        mesh.write(path)


@pytest.mark.parametrize("suffix", OWN + THEIRS)
def test_a_failure_half_way_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
) -> None:
    """The disk is full: every write fails, once something has been written."""
    mesh = SQUARE
    if suffix in ("f3grid",):
        mesh = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]])
    path = place(tmp_path, suffix)
    quiet_write(mesh, path)
    before = state(tmp_path)
    assert before and all(before.values())

    def full(*args: object, **options: object) -> None:
        folder = next(Path(str(p)) for p in args if isinstance(p, str | Path))
        folder = folder if folder.is_dir() else folder.parent
        (folder / path.name).write_bytes(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(meshio.Mesh, "write", lambda self, path, **options: full(path))
    for name in ("write_msh", "write_su2", "write_node_ele", "write_foam", "write_medit"):
        real = getattr(files, name)
        monkeypatch.setattr(files, name, lambda mesh, path, *rest, real=real: full(path))
    with pytest.raises(InputError, match=r"cannot write .*: No space left on device"):
        quiet_write(mesh, path)
    assert state(tmp_path) == before and not [p for p in tmp_path.rglob(".*")]


@pytest.mark.parametrize("suffix", ["msh", "su2", "vtu", "stl", "node", "xdmf"])
def test_an_interruption_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
) -> None:
    path = place(tmp_path, suffix)
    quiet_write(SQUARE, path)
    before = state(tmp_path)

    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", stopped)
    with pytest.raises(KeyboardInterrupt):
        quiet_write(SQUARE, path)
    assert state(tmp_path) == before and not [p for p in tmp_path.rglob(".*")]


def test_meshes_that_a_format_refuses_leave_the_old_file(tmp_path: Path) -> None:
    polygon = Mesh([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0.5]], cells={"polygon": [[0, 1, 2, 3, 4]]})
    for suffix in ("su2", "msh", "node", "stl", "mesh"):
        path = place(tmp_path, suffix)
        quiet_write(SQUARE, path)
    before = state(tmp_path)
    for suffix in ("su2", "msh", "node", "stl", "mesh"):
        with pytest.raises(UnstructError):
            polygon.write(place(tmp_path, suffix))
    assert state(tmp_path) == before


@pytest.mark.parametrize("suffix", ["vtu", "vtk", "stl", "ply", "xdmf"])
def test_text_and_binary(tmp_path: Path, suffix: str) -> None:
    sizes = []
    for binary in (False, True):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            SQUARE.write(tmp_path / f"a.{suffix}", binary=binary)
        again = Mesh.read(tmp_path / f"a.{suffix}")
        assert again.size == 2 and np.abs(again.volumes).sum() == pytest.approx(1)
        sizes.append(sum(len(data) for data in state(tmp_path).values()))
    assert sizes[0] != sizes[1]


@pytest.mark.parametrize(
    ("name", "options", "told"),
    [
        ("a.vtu", {"version": "4.1"}, r"\.vtu has no option 'version'; it is for \.msh"),
        ("a.msh", {"version": "3.0"}, r"version '3\.0' of Gmsh's format is not written: '2\.2' or '4\.1' is"),
        ("a.off", {"binary": True}, r"\.off has no option 'binary'; it is for \.msh, \.vtk"),
        ("a.node", {"binary": True}, r"\.node has no option 'binary'"),
        ("a.msh", {"thickness": 1.0}, r"\.msh has no option 'thickness'; it is for a folder named polyMesh"),
        ("polyMesh", {"binary": True}, r"polyMesh has no option 'binary'"),
        ("a", {}, "no format has this suffix; there are polyMesh"),
    ],
)
def test_options_of_other_formats_are_refused(tmp_path: Path, name: str, options: dict, told: str) -> None:
    with pytest.raises(InputError, match=told):
        SQUARE.write(tmp_path / name, **options)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", ["VTU", "Msh", "SU2", "Ply", "OFF", "XDMF", "Node"])
def test_suffixes_in_any_case(tmp_path: Path, suffix: str) -> None:
    quiet_write(SQUARE, tmp_path / f"A.{suffix}")
    again = Mesh.read(tmp_path / f"A.{suffix}")
    assert again.size == 2 and np.array_equal(again.points[:, :2], SQUARE.points)


@pytest.mark.parametrize("suffix", ["obj", "off", "su2", "msh", "inp", "vtu", "node"])
def test_byte_order_marks(tmp_path: Path, suffix: str) -> None:
    path = place(tmp_path, suffix)
    quiet_write(SQUARE, path)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert Mesh.read(path).size == 2


def test_markers_in_xdmf(tmp_path: Path) -> None:
    mesh = Mesh(SQUARE.points, SQUARE.simplices, markers={"region": [4, 7], "wall": [[0, 1]]})
    for binary in (False, True):
        mesh.write(tmp_path / "a.xdmf", binary=binary)
        again = Mesh.read(tmp_path / "a.xdmf")
        assert again.markers["region"].tolist() == [4, 7] and again.markers["wall"].tolist() == [[0, 1]]


@pytest.mark.parametrize("suffix", ["xdmf", "xmf"])
def test_single_vertices_are_left_out_of_xdmf(tmp_path: Path, suffix: str) -> None:
    """meshio wrote them, and raised KeyError when it read the file; `.vtu` keeps them."""
    markers = {"region": [4, 7], "hanging": [[0], [3]], "none": np.empty((0, 1), dtype=int), "wall": [[0, 1]]}
    mesh = Mesh(SQUARE.points, SQUARE.simplices, markers=markers)
    path = tmp_path / f"a.{suffix}"
    for binary in (False, True):
        with pytest.warns(UserWarning, match="not written: 'hanging'; meshio cannot read single vertices"):
            mesh.write(path, binary=binary)
        again = Mesh.read(path)
        assert again.markers.keys() == {"region", "none", "wall"} and "hanging" in mesh.markers
        assert again.markers["none"].shape == (0, 1) and again.markers["region"].tolist() == [4, 7]
    mesh.write(tmp_path / "a.vtu")
    assert Mesh.read(tmp_path / "a.vtu").markers["hanging"].tolist() == [[0], [3]]


def test_xdmf_of_others_with_single_vertices_says_why_it_is_not_read(tmp_path: Path) -> None:
    theirs = meshio.Mesh(np.eye(3), [("triangle", [[0, 1, 2]]), ("vertex", [[0], [2]])])
    meshio.write(tmp_path / "a.xdmf", theirs, data_format="XML")
    with pytest.raises(InputError, match="meshio reads none with single vertices beside other cells"):
        Mesh.read(tmp_path / "a.xdmf")


def test_second_order_of_other_formats(tmp_path: Path) -> None:
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.5, 0, 0], [0.5, 0.5, 0], [0, 0.5, 0]]
    meshio.Mesh(points, {"triangle6": [[0, 1, 2, 3, 4, 5]]}).write(tmp_path / "a.vtu")
    with pytest.warns(UserWarning, match=r"a\.vtu has cells of second"):
        mesh = Mesh.read(tmp_path / "a.vtu")
    assert mesh.simplices.tolist() == [[0, 1, 2]] and len(mesh.points) == 3


@pytest.mark.parametrize(
    ("name", "data", "told"),
    [
        ("a.vtu", b"hello", r"meshio cannot read a\.vtu \("),
        ("a.stl", b"", r"a\.stl contains no cells"),
        ("a.off", b"OFF\n3 1 0\n0 0\n", r"meshio cannot read a\.off \("),
        ("a.xyz", b"1 2 3", r"a\.xyz cannot be read: no format has the suffix '\.xyz'"),
        ("a.poly", b"", r"a\.poly is no mesh: read it with Domain\.read"),
        ("a.geo", b"", r"a\.geo is no mesh: Gmsh makes meshes of such files"),
        ("a.dat", b"NACA 0012\n1 0\n", r"The coordinates of an airfoil are read by Domain\.read"),
    ],
)
def test_files_that_are_no_meshes(
    tmp_path: Path, capsys: pytest.CaptureFixture, name: str, data: bytes, told: str
) -> None:
    (tmp_path / name).write_bytes(data)
    with pytest.raises(InputError, match=told):
        Mesh.read(tmp_path / name)
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize("name", ["a.vtu", "a.stl", "a.med"])
def test_missing_packages_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    (tmp_path / name).write_text("x")
    missing = "h5py" if name == "a.med" else "meshio"
    monkeypatch.setitem(sys.modules, missing, None)
    for what in (lambda: Mesh.read(tmp_path / name), lambda: SQUARE.write(tmp_path / name)):
        with pytest.raises(UnstructError, match=rf"needs {missing}, and {missing} is not installed: pip"):
            what()
    assert (tmp_path / name).read_text() == "x"
    assert len(list(tmp_path.iterdir())) == 1


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("a.vtk", {"binary": False}),
        ("A.VTK", {"binary": True}),
        ("A.VTU", {"binary": False}),
        ("a.msh", {"version": "4.1", "binary": True}),
        ("a.msh", {}),
    ],
)
def test_names_of_regions(tmp_path: Path, name: str, options: dict) -> None:
    names = {"steel plate": 3, "ölig": 0}
    mesh = Mesh(SQUARE.points, SQUARE.simplices, markers={"region": [3, 0]}, regions=names)
    mesh.write(tmp_path / name, **options)
    again = Mesh.read(tmp_path / name)
    assert again.regions == names and again.markers["region"].tolist() == [3, 0]


@pytest.mark.parametrize("suffix", [".dat", ".tec"])
def test_files_of_tecplot_that_end_too_early(tmp_path: Path, suffix: str) -> None:
    """The reader of meshio waits for lines that never come."""
    path = tmp_path / f"a{suffix}"
    mesh = delaunay(np.random.default_rng(2).random((20, 2)))
    mesh.write(path)
    assert (Mesh.read(path).simplices == mesh.simplices).all()
    text = path.read_text()
    for part in (text[: len(text) // 2], text.replace("20", "2000")):
        path.write_text(part)
        with pytest.raises(InputError, match=r"cannot read a\..*: is it whole"):
            Mesh.read(path)
