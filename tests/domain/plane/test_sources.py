"""Regions from GeoJSON, WKT, Shapefiles and sets of points, by path or text; every fault is named."""

from __future__ import annotations

import json
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

from unstruct import Domain, InputError, Mesh, UnstructError, constrained_delaunay

RING = [[0, 0], [2, 0], [2, 2], [0, 2], [0, 0]]
HOLE = [[0.5, 0.5], [0.5, 1], [1, 1], [1, 0.5], [0.5, 0.5]]
POLYGON = {"type": "Polygon", "coordinates": [RING, HOLE]}
FEATURE = {"type": "Feature", "properties": {"name": "lake"}, "geometry": POLYGON}
WKT = "POLYGON ((0 0, 2 0, 2 2, 0 2, 0 0), (.5 .5, .5 1, 1 1, 1 .5, .5 .5))"


@pytest.mark.parametrize(
    "text", [json.dumps(POLYGON), json.dumps(FEATURE), "\ufeff " + json.dumps(POLYGON), WKT]
)
def test_by_text_and_by_path(tmp_path: Path, text: str) -> None:
    assert Domain.read(text).area == 3.75 and Domain.from_geojson(text).area == 3.75
    names = ["A.WKT", "a.txt"] if "POLYGON" in text else ["a.geojson", "B.GeoJSON", "c.json", "d.txt"]
    for name in names:
        for encoding in ("utf-8-sig", "utf-16"):
            (tmp_path / name).write_text(text.lstrip("\ufeff"), encoding=encoding)
            assert Domain.read(tmp_path / name).area == 3.75
            assert Domain.from_geojson(str(tmp_path / name)).area == 3.75
    with pytest.raises(
        InputError, match=r"no mesh: read it with Domain\.read|cannot be read|meshio cannot read"
    ):
        Mesh.read(tmp_path / names[0])


def test_features_one_in_each_line(tmp_path: Path) -> None:
    other = {"type": "Point", "coordinates": [1.5, 1.5]}
    (tmp_path / "a.geojsonl").write_text(f"{json.dumps(FEATURE)}\n\n\x1e{json.dumps(other)}\n")
    domain = Domain.read(tmp_path / "a.geojsonl")
    assert domain.area == 3.75 and len(domain.loose) == 1


def shapefile(folder: Path) -> Path:
    library = pytest.importorskip("shapefile")
    with library.Writer(str(folder / "Lake.shp")) as writer:
        writer.field("name", "C")
        writer.poly([RING[::-1], HOLE[::-1]])
        writer.record("Großer See")
        writer.null()
        writer.record("nowhere")
    return folder / "Lake.shp"


def test_shapefiles(tmp_path: Path) -> None:
    path = shapefile(tmp_path)
    for name in ("Lake.shp", "Lake.dbf", "Lake.shx"):
        assert Domain.read(tmp_path / name).area == 3.75
    (tmp_path / "Lake.dbf").unlink()
    assert Domain.read(path).area == 3.75
    (tmp_path / "Lake.shx").unlink()
    assert Domain.read(path, markers={"all": [0]}).markers["all"].tolist() == [0]
    path.write_bytes(path.read_bytes()[:150])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises(InputError, match=r"Lake\.shp, shape 0: .* is the Shapefile whole\?"):
            Domain.read(path)
    path.write_bytes(b"hello")
    with pytest.raises(InputError, match=r"Lake\.shp is not a Shapefile"):
        Domain.read(path)


def test_shapefiles_need_a_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = shapefile(tmp_path)
    monkeypatch.setitem(sys.modules, "shapefile", None)
    with pytest.raises(
        UnstructError, match=r"reading Lake\.shp needs pyshp, .* pip install 'unstruct\[io\]'"
    ):
        Domain.read(path)


def test_points_alone(tmp_path: Path) -> None:
    (tmp_path / "a.node").write_text("4 2 0 0\n1 0 0\n2 1 0\n3 1 1\n4 0 1\n")
    domain = Domain.read(tmp_path / "a.node")
    assert len(domain.loose) == 4 and constrained_delaunay(domain, hull=True).volume == 1
    assert Domain.read(tmp_path / "a.node", inner=[[0, 2]]).inner.tolist() == [[0, 2]]
    (tmp_path / "b.node").write_text("1 4 0 0\n1 0 0 0 0\n")
    with pytest.raises(InputError, match=r"b\.node has points in 4 dimensions"):
        Domain.read(tmp_path / "b.node")


def test_poly_in_capitals_with_its_points_beside(tmp_path: Path) -> None:
    (tmp_path / "A.NODE").write_text("\ufeff3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n")
    (tmp_path / "A.POLY").write_text("0 2 0 0\n3 0\n1 1 2\n2 2 3\n3 3 1\n0\n")
    domain = Domain.read(tmp_path / "A.POLY")
    assert domain.area == 0.5
    domain.write(tmp_path / "B.Poly")
    assert np.array_equal(Domain.read(tmp_path / "B.Poly").points, domain.points)
    before = (tmp_path / "B.Poly").read_bytes()
    with pytest.raises(InputError, match="change the file's name"):
        domain.write(tmp_path / "B.msh")
    with pytest.raises(InputError, match="there is no folder"):
        domain.write(tmp_path / "none" / "B.poly")
    assert (tmp_path / "B.Poly").read_bytes() == before


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("a.geojson", '{"type":\n "Poly" "x"}', r"a\.geojson, line 2: this is not JSON"),
        ("a.geojson", "", r"a\.geojson, line 1: this is not JSON"),
        ("a.json", "[1, 2]", r"a\.json is JSON, but not GeoJSON"),
        ("a.json", '{"type": "Topology"}', r"a\.json is TopoJSON"),
        ("a.json", '{"type": "Circle"}', r"the type 'Circle' of a geometry is unknown"),
        ("a.wkt", "POLYGON ((0 0,\n1 0, 1 1, a 0))", r"a\.wkt, line 2, at .*: 'a 0' is no position"),
        ("a.wkt", "", r"a\.wkt contains no geometry"),
        ("a.txt", "hello", r"a\.txt cannot be read: its suffix '\.txt' is none of \.poly, \.node, \.geojson"),
        ("a.msh", "hello", r"a\.msh is not a file of Gmsh|a\.msh"),
        ("a.poly", "3 2 0 0\n1 0 0\n2 1 zz\n", r"a\.poly, line 3: 'zz' among vertices is no number"),
        ("a.poly", "1 2 0 0\n1 0 0\n1 0\n1 1 2.5\n", r"a\.poly, line 4: '2\.5' among segments is no whole"),
        ("a.poly", "1 4 0 0\n1 0 0 0 0\n", r"a\.poly, line 1: the file is in 4 dimensions"),
        ("a.poly", "3 2 0 0\n1 0 0\n", r"a\.poly ends where a vertex is expected"),
        ("a.poly", "0 2 0 0\n", r"there is no file a\.node; there is a\.poly"),
    ],
)
def test_faults_name_the_file(tmp_path: Path, name: str, text: str, told: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=told):
        Domain.read(tmp_path / name)


@pytest.mark.parametrize(
    ("source", "told"),
    [
        ("none.shp", r"there is no file none\.shp; looked in"),
        ("hello\nworld", r"the text 'hello\\nworld'\.\.\. is neither GeoJSON"),
        ("{}", "the text is JSON, but not GeoJSON"),
        ("POLYGON((0 0, 1 0", r"the text, line 1, at .*: there is no '\)'"),
        (3, "a path must be a string or a Path, not int"),
        (".", "is a folder, not a file"),
    ],
)
def test_what_is_neither_a_file_nor_a_text(source: object, told: str) -> None:
    with pytest.raises(InputError, match=told):
        Domain.read(source)
