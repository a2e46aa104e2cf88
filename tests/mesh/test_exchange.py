"""Names that a format must change: a warning lists them, in all formats alike, and no two become one."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np
import pytest

from unstruct import Domain, Mesh, constrained_delaunay, second_order
from unstruct.mesh.exchange import plain_names
from unstruct.mesh.gmsh import brief, coded

LONG = "x" * 300
NAMES = ["inlet 1", "inlet_1", "1st", "-a", 'q"uote', "50%", "ä", LONG, LONG + "y", "frontAndBack", "a\nb"]


def ring(names: list[str]) -> Mesh:
    """A polygon in the plane, a side for each name, in two regions."""
    n = len(names)
    t = 2 * np.pi * np.arange(n) / n
    points = np.round(np.column_stack([np.cos(t), np.sin(t)]), 6)
    cells = [[0, i, i + 1] for i in range(1, n - 1)]
    marks = {name: [[i, (i + 1) % n]] for i, name in enumerate(names)}
    return Mesh(
        points, cells, markers={**marks, "region": [0] + [1] * (n - 3)}, regions={"my steel": 0, "2nd": 1}
    )


def told(caught: list[warnings.WarningMessage]) -> str:
    return "\n".join(str(one.message) for one in caught if str(one.message).startswith("renamed"))


@pytest.mark.parametrize("target", ["a.su2", "polyMesh", "a.msh", "a.vtu", "a.vtk", "a.xdmf", "a.mesh"])
def test_every_name_is_kept_or_told(tmp_path: Path, target: str) -> None:
    mesh = ring(NAMES)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        mesh.write(tmp_path / target)
    assert all(Path(one.filename) == Path(__file__) for one in caught), "the line of the caller"
    text = told(caught)
    if target == "polyMesh":
        boundary = (tmp_path / target / "boundary").read_text()
        found = re.findall(r"^    (\S+)$", boundary.partition("(\n")[2], re.MULTILINE)
        found = [word for word in found if word not in "{}"]
        assert len(found) == len(NAMES) + 1 and len(set(found)) == len(found)
        assert all(name[0].isalpha() or name[0] == "_" for name in found) and found[-1] == "frontAndBack"
        for word in ("'inlet 1' as 'inlet_1_2'", "'1st' as '_1st'", "'frontAndBack' as 'frontAndBack_2'"):
            assert word in text
        assert "'my steel' as 'my_steel'" in text and "'2nd' as '_2nd'" in text
        return
    again = Mesh.read(tmp_path / target)
    rows = {
        name: sorted(map(tuple, np.sort(again.markers[name]).tolist()))
        for name in again.markers
        if name != "region"
    }
    expected = {name: [tuple(sorted(mesh.markers[name][0].tolist()))] for name in NAMES}
    if target == "a.su2":
        words = plain_names(NAMES)
        assert "'inlet 1' as 'inlet_1_2'" in text
    elif target == "a.msh":
        words = brief(NAMES)
        assert words[LONG] == "x" * 127 and words[LONG + "y"] == "x" * 125 + "_2"
        assert "have at most 127 bytes" in text and "'q\"uote' as 'q%22uote'" in text
    else:
        words = {name: name for name in NAMES}
        assert ("renamed" in text) == (target in ("a.vtu", "a.xdmf"))  # VTK has such codes
    assert rows == {words[name]: expected[name] for name in NAMES}
    if target != "a.su2":
        assert again.regions == mesh.regions


def test_names_that_are_kept_are_not_told(tmp_path: Path) -> None:
    mesh = ring(["inlet", "outlet_2", "wall-3", "a.b+c"])
    mesh.markers["region"] = [7, 8]
    mesh.regions.clear()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for target in ("polyMesh", "a.msh", "a.vtu", "a.vtk", "a.xdmf", "a.mesh"):
            mesh.write(tmp_path / target)


def test_plain_names() -> None:
    words = plain_names(["-a", "_-a", "9", "x" * 300, "x" * 301, "a"], taken=["a"], words=True, most=20)
    assert words["-a"] == "_-a_2" and words["_-a"] == "_-a" and words["9"] == "_9" and words["a"] == "a_2"
    assert words["x" * 300] == "x" * 20 and words["x" * 301] == "x" * 18 + "_2"


def test_brief_names() -> None:
    names = ["%" * 60, "ä" * 100, "x" * 127, "x" * 128, "x" * 129, ""]
    words = brief(names)
    assert len(set(words.values())) == len(names) and words["x" * 127] == "x" * 127
    assert all(len(coded(word).encode()) <= 127 for word in words.values())


def test_a_region_that_is_called_like_a_marker(tmp_path: Path) -> None:
    """Groups of equal names would be one; a code in the place of the first character keeps them apart."""
    mesh = Mesh(
        [[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], markers={"wall": [[0, 1]], "region": [0]}, regions={"wall": 0}
    )
    with pytest.warns(UserWarning, match="'wall' as '%77all'"):
        mesh.write(tmp_path / "a.msh")
    again = Mesh.read(tmp_path / "a.msh")
    assert again.regions == {"wall": 0} and again.markers["wall"].tolist() == [[0, 1]]


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".smesh", ".poly"])
def test_names_of_bodies(tmp_path: Path, suffix: str) -> None:
    names = {"a b": [0], "a_b": [1], "a  b": [2], " ": [3], "c": [4, 5]}
    box = Domain.box()
    body = Domain(box.points, box.facets, markers=names)
    with pytest.warns(UserWarning, match="renamed: 'a"):
        body.write(tmp_path / f"a{suffix}")
    again = Domain.read(tmp_path / f"a{suffix}")
    assert len(again.markers) == len(names)
    assert sorted(map(len, again.markers.values())) == [1, 1, 1, 1, 2] or suffix == ".stl"
    wide = Domain(box.points, box.facets, markers={"one": [0, 1], "two": [1, 2]})
    if suffix != ".obj":
        with pytest.warns(UserWarning, match="not written completely: 'one'; .* its last marker"):
            wide.write(tmp_path / f"b{suffix}")


def test_names_of_planar_regions(tmp_path: Path) -> None:
    square = Domain.rectangle(regions={"steel": (0.5, 0.5)})
    with pytest.warns(UserWarning) as caught:
        square.write(tmp_path / "a.poly")
    text = told(caught.list)
    assert "'bottom' as '1'" in text and "markers are numbers" in text and "'steel' as '1'" in text


def test_names_of_curved_meshes(tmp_path: Path) -> None:
    disc = Domain.disc(markers={'q"': [0]})
    curved = second_order(constrained_delaunay(disc), disc)
    with pytest.warns(UserWarning, match="renamed: 'q\"' as 'q%22'"):
        curved.write(tmp_path / "a.msh")
    with pytest.warns(UserWarning, match="second or higher order"):
        assert 'q"' in Mesh.read(tmp_path / "a.msh").markers
