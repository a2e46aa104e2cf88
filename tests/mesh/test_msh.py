"""Gmsh's format in both versions and forms, beside Gmsh itself; files of Gmsh's own; faults by name."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest
from mixed_cells import planar, spatial

from unstruct import InputError, Mesh, MeshError
from unstruct.base import decimals

FORMS = [(version, binary) for version in ("2.2", "4.1") for binary in (False, True)]
TINY = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
3
1 0 0 0
2 1 0 0
3 0 1 0
$EndNodes
$Elements
1
1 2 2 0 1 1 2 3
$EndElements
"""


def flat(n: int) -> Mesh:
    mesh = planar(n, jitter=0.1, seed=3)
    kinds = np.repeat(list(mesh.cells), [len(block) for block in mesh.cells.values()])
    return mesh.select(kinds != "polygon")


def named(mesh: Mesh) -> Mesh:
    edges = mesh.boundary
    marks = {"left wall": edges[:3], "rest": edges[3:], "tip": [[2], [0]], "none": np.empty((0, 2), int)}
    return Mesh(mesh.points, cells=mesh.cells, markers=marks | {"region": np.arange(mesh.size) % 3})


def keys(rows: np.ndarray) -> set[frozenset[int]]:
    return {frozenset(v for v in row if v >= 0) for row in rows.tolist()}


@pytest.mark.parametrize(("version", "binary"), FORMS)
@pytest.mark.parametrize("mesh", [flat(5), spatial(3, jitter=0.1)], ids=repr)
def test_everything_comes_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mesh: Mesh, version: str, binary: bool
) -> None:
    monkeypatch.setattr(decimals, "FEW_ROWS", 10)
    mesh = named(mesh)
    path = tmp_path / "Mesh.MSH"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh.write(path, version=version, binary=binary)
        again = Mesh.read(path)
    assert path.read_bytes().startswith(f"$MeshFormat\n{version} {int(binary)} 8\n".encode())
    assert np.array_equal(again.points, mesh.points) and list(again.cells) == list(mesh.cells)
    for kind, block in mesh.cells.items():
        assert np.array_equal(again.cells[kind], block)
    assert set(again.markers) == set(mesh.markers)
    for name, rows in mesh.markers.items():
        found = again.markers[name]
        assert np.array_equal(found, rows) if rows.ndim == 1 else keys(found) == keys(rows), name


@pytest.mark.parametrize(("version", "binary"), FORMS)
def test_gmsh_reads_it(tmp_path: Path, version: str, binary: bool) -> None:
    gmsh = pytest.importorskip("gmsh")
    mesh = named(flat(4))
    mesh.write(tmp_path / "a.msh", version=version, binary=binary)
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(tmp_path / "a.msh"))
        _, x, _ = gmsh.model.mesh.getNodes()
        assert np.array_equal(np.sort(x.reshape(-1, 3)[:, :2], axis=0), np.sort(mesh.points, axis=0))
        found = {}
        for d, tag in gmsh.model.getPhysicalGroups():
            entities = gmsh.model.getEntitiesForPhysicalGroup(d, tag)
            parts = [gmsh.model.mesh.getElements(d, e)[1] for e in entities]
            found[gmsh.model.getPhysicalName(d, tag)] = sum(len(tags) for part in parts for tags in part)
    finally:
        gmsh.finalize()
    assert found["left wall"] == 3 and found["tip"] == 2
    assert found["region 1"] == (mesh.markers["region"] == 1).sum()


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("every", [0, 1])
@pytest.mark.parametrize(("version", "binary"), FORMS)
def test_files_of_gmsh_itself(tmp_path: Path, version: str, binary: bool, every: int, order: int) -> None:
    """A square of two materials, one of them in two groups; with and without SaveAll; of higher order."""
    gmsh = pytest.importorskip("gmsh")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        geo = gmsh.model.geo
        corners = [geo.addPoint(x, y, 0, 0.4) for x, y in [(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (0, 1)]]
        lines = [geo.addLine(corners[i], corners[(i + 1) % 6]) for i in range(6)]
        middle = geo.addLine(corners[1], corners[4])
        left = geo.addPlaneSurface([geo.addCurveLoop([lines[0], middle, lines[4], lines[5]])])
        right = geo.addPlaneSurface([geo.addCurveLoop([lines[1], lines[2], lines[3], -middle])])
        geo.synchronize()
        gmsh.model.addPhysicalGroup(1, [lines[5]], 3, "inlet")
        gmsh.model.addPhysicalGroup(1, [lines[5], lines[0]], 9, "wet")
        gmsh.model.addPhysicalGroup(2, [left], 5, "steel")
        gmsh.model.addPhysicalGroup(2, [left, right], 6, "all")
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(order)
        for name, value in [("SaveAll", every), ("Binary", int(binary)), ("MshFileVersion", float(version))]:
            gmsh.option.setNumber(f"Mesh.{name}", value)
        gmsh.write(str(tmp_path / "a.msh"))
        triangles = sum(len(gmsh.model.mesh.getElements(2, s)[1][0]) for s in (left, right))
    finally:
        gmsh.finalize()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        mesh = Mesh.read(tmp_path / "a.msh")
    assert any("second or higher order" in str(w.message) for w in caught) == (order > 1)
    assert mesh.size == triangles and mesh.points.shape[1] == 2
    assert mesh.volume == pytest.approx(2, abs=1e-12)
    assert len(np.unique(mesh.simplices)) == len(mesh.points)
    if every and version == "2.2":  # Gmsh writes no groups then
        return
    assert mesh.volumes[mesh.markers["steel"]].sum() == pytest.approx(1)
    assert mesh.markers["all"].all()
    length = {n: np.ptp(mesh.points[mesh.markers[n]], axis=1).sum() for n in ("inlet", "wet")}
    assert length["inlet"] == pytest.approx(1) and length["wet"] == pytest.approx(2)


def test_data_of_cells_and_points(tmp_path: Path) -> None:
    mesh = Mesh([[0, 0], [1, 0], [0, 1], [0, 1]], [[0, 1, 2]], duplicates=[[3, 2]], markers={"heat": [1.5]})
    for version, binary in FORMS:
        mesh.write(tmp_path / "a.msh", version=version, binary=binary)
        again = Mesh.read(tmp_path / "a.msh")
        assert again.duplicates.tolist() == [[3, 2]] and again.markers["heat"].tolist() == [1.5]


def test_line_ends_marks_and_gaps_in_numbers(tmp_path: Path) -> None:
    text = TINY.replace("\n3 0 1 0", "\n30 0 1 0").replace("1 2 3\n", "1 2 30\n").replace("\n", "\r\n")
    (tmp_path / "a.msh").write_bytes(b"\xef\xbb\xbf" + text.encode())
    assert Mesh.read(tmp_path / "a.msh").simplices.tolist() == [[0, 1, 2]]


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("MeshFormat", "Hello", r"a\.msh is not in Gmsh's format"),
        ("2.2 0 8", "3.7 0 8", r"version 3\.7 of Gmsh's format is not read; save it as 4\.1 or 2\.2"),
        ("2.2 0 8", "2.2 0", r"'2\.2 0' is not a version, 0 or 1, and a size"),
        ("$EndElements\n", "", r"a\.msh ends within the section \$Elements"),
        ("2 1 0 0", "2 1 zero 0", r"section \$Nodes: 'zero' is no number"),
        ("2 1 0 0", "3 1 0 0", r"section \$Nodes: node 3 occurs twice"),
        ("1 2 2 0 1 1 2 3", "1 2 2 0 1 1 2 4", r"section \$Elements: there is no node 4"),
        ("1 2 2 0 1 1 2 3", "1 99 2 0 1 1 2 3", r"section \$Elements: cells of type 99 are not known"),
        ("1 2 2 0 1 1 2 3", "1 2 2 0 1 1 2", r"section \$Elements: cells number 1 of 1 is incomplete"),
        ("1 2 2 0 1 1 2 3", "1 2 2 0 1 1 2 3 4", r"section \$Elements: 1 cells are announced, but more"),
        ("$Nodes\n3", "$Nodes\n5", r"section \$Nodes: it ends too early"),
        ("1 2 2 0 1 1 2 3", "1 15 2 0 1 1", r"a\.msh contains no cells"),
    ],
)
def test_faults_are_named_by_their_section(tmp_path: Path, old: str, new: str, told: str) -> None:
    assert old in TINY
    (tmp_path / "a.msh").write_text(TINY.replace(old, new))
    with pytest.raises(InputError, match=told):
        Mesh.read(tmp_path / "a.msh")


@pytest.mark.parametrize(("version", "binary"), FORMS)
def test_files_cut_short(tmp_path: Path, version: str, binary: bool) -> None:
    """Whatever is missing at the end, it is an error of the library's own, or the mesh is whole."""
    mesh = named(flat(3))
    mesh.write(tmp_path / "a.msh", version=version, binary=binary)
    data = (tmp_path / "a.msh").read_bytes()
    for end in range(0, len(data), 97):
        (tmp_path / "a.msh").write_bytes(data[:end])
        try:
            assert np.array_equal(Mesh.read(tmp_path / "a.msh").points, mesh.points)
        except (InputError, MeshError) as error:
            assert "a.msh" in str(error)
