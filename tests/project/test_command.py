"""The command: what it prints, what it writes, and its exit codes."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from unstruct import Domain, Mesh, check, constrained_delaunay
from unstruct.command import MESHERS, main

SQUARE = {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]]}


@pytest.fixture
def square(tmp_path: Path) -> Path:
    (tmp_path / "square.geojson").write_text(json.dumps(SQUARE))
    return tmp_path / "square.geojson"


def run(*words: object) -> Result:
    return CliRunner().invoke(main, list(map(str, words)), catch_exceptions=False)


@pytest.mark.parametrize("method", [name for name in MESHERS if name != "tetrahedralize"])
def test_every_method_meshes(square: Path, method: str) -> None:
    target = square.with_name("out.msh")
    size = [] if method == "constrained-delaunay" else ["--size", 0.3]
    result = run("mesh", square, *size, "--method", method, "-o", target)
    assert result.exit_code == 0, result.output
    mesh = Mesh.read(target)
    assert check(mesh, domain=Domain.read(square))
    assert f"out.msh: {len(mesh.points)} points, {mesh.size} triangles, minimum angle" in result.output
    assert run("mesh", square, *size, "--method", method, "-o", target, "-q").output == ""


def test_options_reach_the_method_and_the_file(square: Path) -> None:
    target = square.with_name("out.msh")
    words = [
        "mesh",
        square,
        "--max-area",
        0.01,
        "--min-angle",
        28,
        "-o",
        target,
        "--gmsh-version",
        "4.1",
        "--binary",
    ]
    assert run(*words).exit_code == 0
    mesh = Mesh.read(target)
    assert mesh.volumes.max() <= 0.01 and mesh.quality("min_angle").min() >= 28
    assert target.read_bytes().startswith(b"$MeshFormat\n4.1 1 8\n")
    again = square.with_name("again.msh")
    assert run("mesh", target, "--max-area", 0.005, "-o", again).exit_code == 0
    assert Mesh.read(again).volumes.max() <= 0.005


def test_what_is_not_reached_is_told(tmp_path: Path) -> None:
    needle = tmp_path / "needle.wkt"
    needle.write_text("POLYGON ((0 0, 1 0, 1 0.01, 0 0))")
    result = run("mesh", needle, "--min-angle", 20, "-o", tmp_path / "a.msh")
    assert result.exit_code == 1 and "Not complete: " in result.stderr
    assert (tmp_path / "a.msh").exists()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["mesh", "none.shp", "-o", "a.msh"], "there is no file none.shp"),
        (["mesh", "SQUARE", "-o", "a.hello"], "no format has this suffix"),
        (["mesh", "SQUARE", "-o", "none/a.msh"], "there is no folder none"),
        (["mesh", "SQUARE"], "Missing option '-o'"),
        (["mesh", "SQUARE", "--size", "0", "-o", "a.msh"], "size"),
        (["mesh", "SQUARE", "--method", "voronoi-segment", "-o", "a.msh"], "needs --size"),
        (
            ["mesh", "SQUARE", "--method", "voronoi-segment", "--min-angle", "9", "-o", "a.msh"],
            "it is for refine",
        ),
        (["mesh", "SQUARE", "--hull", "-o", "a.msh"], "--hull; it is for constrained-delaunay"),
        (["mesh", "SQUARE", "--thickness", "1", "-o", "a.msh"], "has no option 'thickness'"),
        (["convert", "SQUARE", "a.msh"], "is a region, which is written as .poly"),
        (["check", "SQUARE", "--delaunay"], "is no mesh"),
        (["mesh", "SQUARE", "--max-volume", "1", "-o", "a.msh"], "max_volume is for space"),
        (["hello"], "No such command"),
    ],
)
def test_wrong_use(square: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], told: str) -> None:
    monkeypatch.chdir(square.parent)
    result = run(*[word.replace("SQUARE", square.name) for word in words])
    assert result.exit_code == 2 and told in result.stderr and "Traceback" not in result.output
    assert sorted(path.name for path in square.parent.iterdir()) == [square.name]


def test_check(square: Path, tmp_path: Path) -> None:
    good, bad = tmp_path / "good.msh", tmp_path / "bad.node"
    points = [[0, 0], [1, 0], [1, 1], [0, 1]]
    constrained_delaunay(Domain.read(square)).write(good)
    Mesh(points, [[0, 1, 2], [0, 3, 2]]).write(bad)
    assert run("check", good, "--domain", square, "--delaunay").output.startswith("valid")
    assert run("check", good, "-q").output == ""
    result = run("check", bad, "-q")
    assert result.exit_code == 1 and result.output.startswith("not valid")


def test_info_and_convert(square: Path, tmp_path: Path) -> None:
    result = run("info", square)
    assert result.exit_code == 0 and "area 1, from [0.0, 0.0] to [1.0, 1.0]" in result.output
    poly, mesh, other = (tmp_path / name for name in ("a.poly", "a.su2", "a.MSH"))
    assert run("convert", square, poly).exit_code == 0
    assert Domain.read(poly).area == 1
    run("mesh", poly, "--method", "constrained-delaunay", "-o", mesh)
    result = run("convert", mesh, other)
    assert result.exit_code == 0 and "Mesh: 4 points, 2 triangles" in result.output
    result = run("info", other)
    assert "2 triangles" in result.output and "marker 'facets': 4 faces" in result.output


def test_in_a_shell(square: Path) -> None:
    """The module ``unstruct.__main__``."""
    words = [sys.executable, "-m", "unstruct", "info", str(square)]
    result = subprocess.run(words, capture_output=True, text=True)
    assert result.returncode == 0 and "a region" in result.stdout
    result = subprocess.run([*words[:3], "info", "none.msh"], capture_output=True, text=True)
    assert result.returncode == 2 and result.stderr.startswith("Error: there is no file none.msh")


def test_bodies_in_space(tmp_path: Path) -> None:
    good, other, bad, broken = (tmp_path / name for name in ("a.stl", "a.smesh", "open.off", "cut.ply"))
    Domain.box(markers={"sides": [0, 1]}).write(good)
    result = run("info", good)
    assert result.exit_code == 0 and "a body in space\npoints 8, facets 12, inner pieces 0" in result.output
    assert "closed, volume 1\n" in result.output and "marker 'sides': 4 pieces" in result.output
    assert "repaired: merged 36 corners of 12 triangles into 8 points" in result.output
    assert run("check", good).output == "sound: closed, volume 1\n" and run("check", good, "-q").output == ""
    assert run("convert", good, other).exit_code == 0 and Domain.read(other).volume == 1
    assert run("convert", other, tmp_path / "b.stl", "--binary").exit_code == 0
    assert "closed, volume 1" in run("info", other).output
    bad.write_text("OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 1 2 3\n")
    for command in ("info", "check"):
        result = run(command, bad)
        assert result.exit_code == 1 and "open boundary, 3 times: the boundary is open" in result.output
    broken.write_text("ply\nformat ascii 1.0\n")
    result = run("info", broken)
    assert result.exit_code == 2 and "ends before 'end_header'" in result.stderr
    result = run("mesh", other, "--size", 1, "-o", tmp_path / "c.msh")
    assert result.exit_code == 0 and "6 tetrahedra, minimum dihedral angle" in result.output
    assert Mesh.read(tmp_path / "c.msh").volume == pytest.approx(1)
    result = run("mesh", other, "--size", 1, "--method", "advancing-front", "-o", tmp_path / "c.msh")
    assert result.exit_code == 0 and Mesh.read(tmp_path / "c.msh").volume == pytest.approx(1)


@pytest.mark.parametrize("name", ["a.stl", "a.off", "a.ply", "a.obj", "a.smesh", "a.poly"])
def test_every_surface_is_a_body(tmp_path: Path, name: str) -> None:
    source, target = tmp_path / name, tmp_path / "out.msh"
    Domain.box().write(source)
    words = ["mesh", source, "-o", target, "--size", 0.6]
    result = run(*words, "--split-boundary")
    assert result.exit_code == 0 and "tetrahedra, minimum dihedral angle" in result.output, result.output
    assert Mesh.read(target).volume == pytest.approx(1) and Mesh.read(target).dimension == 3
    result = run("check", target, "--domain", source)
    assert result.exit_code == 0, result.output
    assert run("mesh", source, "-o", target, "--max-volume", 0.1).exit_code == 0, "refine has this option"
    assert Mesh.read(target).volumes.max() <= 0.1
    other = tmp_path / "other.obj"
    assert run("convert", source, other).exit_code == 0 and Domain.read(other).volume == pytest.approx(1)


def test_surfaces_that_are_no_bodies(tmp_path: Path) -> None:
    flat, opened = tmp_path / "flat.stl", tmp_path / "open.off"
    Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]]).write(flat)
    assert run("mesh", flat, "--size", 0.4, "-o", tmp_path / "a.msh").exit_code == 0
    assert Mesh.read(tmp_path / "a.msh").volume == pytest.approx(1)
    opened.write_text("OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 1 2 3\n")
    assert run("convert", opened, tmp_path / "open.ply").exit_code == 0
    result = run("mesh", opened, "-o", tmp_path / "a.msh")
    assert result.exit_code == 2 and "the boundary is open" in result.stderr


def test_options_have_the_names_of_the_command(tmp_path: Path, square: Path) -> None:
    box, bow = tmp_path / "box.stl", tmp_path / "bow.wkt"
    Domain.box().write(box)
    result = run("mesh", box, "--size", 0.3, "-o", tmp_path / "a.msh")
    assert result.exit_code == 1 and "larger than the size; --split-boundary divides it" in result.stderr
    bow.write_text("POLYGON ((0 0, 1 1, 1 0, 0 1, 0 0))")
    assert "or let --resolve split" in run("info", bow).stderr
    assert run("check", square).output == "sound: closed, area 1\n"
    assert run("check", bow).exit_code == 1
