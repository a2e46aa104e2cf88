"""OFF and OBJ: polygons, names, numbers that count back, and files that are not as they should be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from unstruct import Domain, InputError

CUBE = """OFF
8 6 12
0 0 0
0 0 1
0 1 0
0 1 1
1 0 0
1 0 1
1 1 0
1 1 1
4 0 1 3 2
4 4 6 7 5
4 0 4 5 1
4 2 3 7 6
4 0 2 6 4
4 1 5 7 3
"""


def obj_cube() -> str:
    lines = CUBE.splitlines()
    rows = [f"v {line}" for line in lines[2:10]]
    names = "left right front back bottom top".split()
    for name, line in zip(names, lines[10:]):
        rows += [f"g {name}", "f " + " ".join(str(int(v) + 1) for v in line.split()[1:])]
    return "\n".join(rows) + "\n"


@pytest.mark.parametrize("suffix", [".off", ".obj"])
def test_round_trip(tmp_path: Path, suffix: str) -> None:
    """Points, polygons and their order, bit for bit."""
    bodies = [
        Domain.box((0.1, 0, 1e-300), (1 / 3, 1, 5)),
        Domain.revolved(Domain.polygon([(1, 0), (2, 0.2), (1.5, 1)]), count=7),
    ]
    for body in bodies:
        bare = Domain(body.points, body.facets)
        bare.write(tmp_path / f"a{suffix}")
        again = Domain.read(tmp_path / f"a{suffix}")
        assert np.array_equal(again.points, bare.points)
        assert [row.tolist() for row in again.facets] == [row.tolist() for row in bare.facets]
        again.write(tmp_path / f"b{suffix}")
        assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


@pytest.mark.parametrize(
    "change",
    [
        lambda t: t,
        lambda t: t.replace("OFF\n", "OFF "),
        lambda t: t.replace("OFF\n", ""),
        lambda t: t.replace("OFF\n", "COFF # colors\n\n# more\n").replace("0 0 0\n", "0 0 0 255 0 0 1\n"),
        lambda t: t.replace("8 6 12", "8 6"),
        lambda t: t.replace("4 0 1 3 2", "4 0 1 3 2 255 0 0"),
        lambda t: t.replace("\n", "\r\n"),
        lambda t: "\ufeff" + t,
    ],
)
def test_forms_of_off(tmp_path: Path, change: object) -> None:
    (tmp_path / "A.OFF").write_text(change(CUBE), encoding="utf-8")
    assert Domain.read(tmp_path / "A.OFF").volume == 1.0


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda t: "", "a.off is empty"),
        (lambda t: "OFF\n0 0 0\n", "a.off has no vertices"),
        (lambda t: "OFF\n", "ends where the numbers of vertices and faces are expected"),
        (lambda t: t.replace("8 6 12", "8 x 12"), "line 2: the numbers of vertices, faces and edges"),
        (lambda t: t.replace("8 6 12", "8 -6 12"), "line 2: the numbers"),
        (lambda t: t.replace("8 6 12", "9 6 12"), "announces 9 vertices and 6 faces, but has 14"),
        (lambda t: t.replace("8 6 12", "8 5 12"), "line 16: '4 1 5 7 3' follows the last of 5 faces"),
        (lambda t: t.replace("0 1 1", "0 nan 1", 1), "line 6: 'nan' among coordinates is not finite"),
        (lambda t: t.replace("0 1 1", "0 1", 1), "line 6: a vertex needs 3 coordinates"),
        (lambda t: t.replace("0 1 1", "0 a 1", 1), "line 6: 'a' among coordinates is no number"),
        (lambda t: t.replace("4 4 6 7 5", "4 4 6 7 8"), "line 12: there is no vertex 8; the file has 0 to 7"),
        (lambda t: t.replace("4 4 6 7 5", "4 4 6 7 -1"), "line 12: there is no vertex -1"),
        (lambda t: t.replace("4 4 6 7 5", f"4 4 6 7 {10**30}"), "line 12: there is no vertex 1000"),
        (lambda t: t.replace("4 4 6 7 5", "5 4 6 7 5"), "line 12: a face of 5 vertices has 4"),
        (lambda t: t.replace("4 4 6 7 5", "2 4 6"), "line 12: a facet has 2 vertices, but needs 3"),
        (lambda t: t.replace("4 4 6 7 5", "q 4 6 7 5"), "line 12: a face is the number of its vertices"),
        (lambda t: t.replace("OFF", "4OFF"), "points of 4 or n coordinates"),
        (lambda t: t.replace("OFF", "OFF BINARY"), "a binary OFF file"),
        (lambda t: t[:60], "announces 8 vertices and 6 faces"),
    ],
)
def test_wrong_off_is_refused(tmp_path: Path, change: object, told: str) -> None:
    (tmp_path / "a.off").write_text(change(CUBE))
    with pytest.raises(InputError, match=told):
        Domain.read(tmp_path / "a.off")


def test_points_alone(tmp_path: Path) -> None:
    (tmp_path / "a.off").write_text("OFF\n2 0 0\n0 0 0\n1 1 1\n")
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 1 1\n")
    (tmp_path / "a.node").write_text("2 3 0 0\n1 0 0 0\n2 1 1 1\n")
    for name in ("a.off", "a.obj", "a.node"):
        found = Domain.read(tmp_path / name)
        assert found.dimension == 3 and found.loose.tolist() == [0, 1] and len(found.facets) == 0


def test_names_of_obj(tmp_path: Path) -> None:
    text = obj_cube().replace("g top", "o the lid\ng top cover")
    (tmp_path / "a.obj").write_text(text)
    found = Domain.read(tmp_path / "a.obj")
    assert found.volume == 1.0
    assert {name: rows.tolist() for name, rows in found.markers.items()} == {
        "left": [0], "right": [1], "front": [2], "back": [3], "bottom": [4], "top": [5],
        "cover": [5], "the lid": [5],
    }  # fmt: skip
    with pytest.warns(UserWarning, match="the_lid"):
        found.write(tmp_path / "b.obj")
    again = Domain.read(tmp_path / "b.obj")
    assert again.markers["cover"].tolist() == again.markers["the_lid"].tolist() == [5]
    (tmp_path / "c.obj").write_text(text.replace("g left", "g region"))
    assert "region (file)" in Domain.read(tmp_path / "c.obj").markers


@pytest.mark.parametrize(
    "change",
    [
        lambda t: (
            "# made by hand\nmtllib a.mtl\n" + t.replace("f 1 2 4 3", "vt 0 0\nvn 0 0 1\nf 1/1/1 2//1 4/1 3")
        ),
        lambda t: t.replace("f 1 2 4 3", "f -8 -7 -5 -6"),
        lambda t: t.replace("f 1 2 4 3", "f 1 2 \\\n4 3"),
        lambda t: t.replace("f 1 2 4 3", "f 1 2 \\\r\n 4 \\\r\n3"),
        lambda t: t.replace("\n", "\r\n"),
        lambda t: "\ufeff" + t,
        lambda t: t.replace("v 0 0 0\n", "v 0 0 0 1.0\n").replace("v 0 0 1\n", "v 0 0 1 0.5 0.5 0.5\n"),
        lambda t: t + "l 1 8\n",
    ],
)
def test_forms_of_obj(tmp_path: Path, change: object) -> None:
    (tmp_path / "A.OBJ").write_text(change(obj_cube()), encoding="utf-8", newline="")
    found = Domain.read(tmp_path / "A.OBJ")
    assert found.volume == 1.0 and len(found.inner) in (0, 1)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda t: "", "a.obj has no vertices"),
        (lambda t: "hello", "line 1: 'hello' is no line of an OBJ file"),
        (lambda t: t.replace("f 1 2 4 3", "f 1 2 4 9"), "line 10: there is no vertex 9; the file has 1 to 8"),
        (
            lambda t: t.replace("f 1 2 4 3", "f 1 2 4 0"),
            "line 10: there is no vertex 0; they are counted from 1",
        ),
        (lambda t: t.replace("f 1 2 4 3", "f 1 2 4 -9"), "line 10: there is no vertex -9"),
        (lambda t: t.replace("f 1 2 4 3", "f 1 2 4 x"), "line 10: 'x' is no number of a vertex"),
        (lambda t: t.replace("f 1 2 4 3", "f 1 2"), "line 10: a facet has 2 vertices"),
        (lambda t: t.replace("v 0 0 1", "v 0 inf 1"), "line 2: 'inf' among coordinates is not finite"),
        (lambda t: t.replace("v 0 0 1", "v 0 1"), "line 2: a vertex needs 3 coordinates"),
        (lambda t: t + "cstype bezier\n", "belongs to curves and curved surfaces"),
    ],
)
def test_wrong_obj_is_refused(tmp_path: Path, change: object, told: str) -> None:
    (tmp_path / "a.obj").write_text(change(obj_cube()))
    with pytest.raises(InputError, match=told):
        Domain.read(tmp_path / "a.obj")
