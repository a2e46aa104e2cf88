"""Triangle's and TetGen's files: every number comes back, every fault is named by its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from unstruct import InputError, Mesh
from unstruct.base import decimals

SQUARE = "4 2 0 0\n{} 0 0\n{} 1 0\n{} 1 1\n{} 0 1\n"


def grid(n: int) -> Mesh:
    x = np.linspace(0, np.pi, n)
    points = np.stack(np.meshgrid(x, x / 3), axis=-1).reshape(-1, 2)
    i = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    lower, upper = np.column_stack([i, i + 1, i + n + 1]), np.column_stack([i, i + n + 1, i + n])
    return Mesh(points, np.concatenate([lower, upper]))


@pytest.mark.parametrize("suffix", ["node", "ele", "NODE"])
def test_large_files_come_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str) -> None:
    monkeypatch.setattr(decimals, "FEW_ROWS", 100)
    mesh = grid(40)
    mesh.write(tmp_path / f"a.{suffix}")
    again = Mesh.read(tmp_path / f"a.{suffix}")
    assert np.array_equal(again.points, mesh.points) and np.array_equal(again.simplices, mesh.simplices)
    names = {path.name for path in tmp_path.iterdir()}
    assert names == ({"a.NODE", "a.ELE"} if suffix.isupper() else {"a.node", "a.ele"})


@pytest.mark.parametrize("first", [0, 1, 7])
def test_numbers_begin_where_the_first_says(tmp_path: Path, first: int) -> None:
    number = [first + i for i in range(4)]
    (tmp_path / "a.node").write_text("\ufeff# box\n\n" + SQUARE.format(*number) + "# made by hand\n")
    (tmp_path / "a.ele").write_text(
        f"2 3 0\r\n{first} {first} {first + 1} {first + 2} # one\r\n"
        f"{first + 1} {first} {first + 2} {first + 3}"
    )
    mesh = Mesh.read(tmp_path / "a.ele")
    assert mesh.volume == 1 and mesh.simplices.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_attributes_marks_and_more_entries_than_announced(tmp_path: Path) -> None:
    (tmp_path / "a.node").write_text("3 2 1 1\n1 0 0 0.5 4\n2 1 0 1.5 4\n3 0 1 2.5 0\n")
    (tmp_path / "a.ele").write_text("1 3 2\n1 1 2 3 -1.5 8 99\n")
    mesh = Mesh.read(tmp_path / "a.node")
    assert mesh.markers["vertices 4"].tolist() == [[0], [1]]
    assert mesh.markers["attribute"].tolist() == [-1.5] and mesh.markers["attribute1"].tolist() == [8]


def test_points_alone_are_a_set_of_points(tmp_path: Path) -> None:
    (tmp_path / "a.node").write_text(SQUARE.format(1, 2, 3, 4))
    mesh = Mesh.read(tmp_path / "a.node")
    assert mesh.size == 0 and mesh.points.tolist() == [[0, 0], [1, 0], [1, 1], [0, 1]]
    with pytest.raises(InputError, match=r"no file a\.ele; there is a\.node"):
        Mesh.read(tmp_path / "a.ele")
    (tmp_path / "b.node").write_text("0 3 0 0\n")
    assert Mesh.read(tmp_path / "b.node").points.shape == (0, 3)


def test_second_order_is_read_by_its_corners(tmp_path: Path) -> None:
    (tmp_path / "a.node").write_text("6 2 0 1\n1 0 0 1\n2 1 0 0\n3 0 1 0\n4 .5 .5 2\n5 0 .5 0\n6 .5 0 0\n")
    (tmp_path / "a.ele").write_text("1 6 0\n1 1 2 3 4 5 6\n")
    with pytest.warns(UserWarning, match=r"a\.ele has cells of second .*corners, and 3 nodes"):
        mesh = Mesh.read(tmp_path / "a.node")
    assert mesh.simplices.tolist() == [[0, 1, 2]] and mesh.origin.tolist() == [0, 1, 2]
    assert mesh.markers["vertices 1"].tolist() == [[0]] and mesh.markers["vertices 2"].shape == (0, 1)


@pytest.mark.parametrize(
    ("node", "ele", "told"),
    [
        ("", "", r"a\.node is empty: a header is expected"),
        ("4 2\n1 0 0\n2 1 0\n3 1 1\n", "", r"a\.node announces 4 rows but contains 3"),
        ("2 2\n1 0 0\n2 1 0\n3 1 1\n", "", r"a\.node, line 4: '3 1 1' follows the last vertex"),
        ("2 2\n1 0 0\n\n2 1\n", "", r"a\.node, line 4: a vertex needs 3 entries, not '2 1'"),
        ("2 2\n1 0 0\n2 1 x # y\n", "", r"a\.node, line 3: 'x' among the entries of a vertex is no number"),
        ("2 2\n1 0 0\n2 1 nan\n", "", r"a\.node, line 3: 'nan' among .* is not finite"),
        ("2 2\n1 0 0\n3 1 1\n", "", r"line 3: the vertex number 3 follows number 1"),
        ("2\n1 0 0\n3 1 1\n", "", r"the header must be the number of vertices, the dimension"),
        ("-2 2\n", "", r"is -2, but must not be negative"),
        ("3 2\n1 0 0\n2 1 0 3\n3 1\n", "", r"line 4: a vertex needs 3 entries"),  # the sum is right
        (SQUARE, "1 3 0\n1 1 2 5\n", r"a\.ele, line 2: cell \[1, 2, 5\] has a vertex .* it has 1 to 4"),
        (SQUARE, "1 3 0\n1 0 2 3\n", r"a\.ele, line 2: cell \[0, 2, 3\] has a vertex"),
        (SQUARE, "1 5 0\n1 1 2 3 4 1\n", r"cells have 5 nodes, but simplices in 2 dimensions have 3, or 6"),
        (SQUARE, "1 2.5 0\n", r"a\.ele, line 1: '2\.5' among .* is no whole number"),
    ],
)
def test_faults_are_named_by_their_line(tmp_path: Path, node: str, ele: str, told: str) -> None:
    (tmp_path / "a.node").write_text(node.format(1, 2, 3, 4))
    if ele:
        (tmp_path / "a.ele").write_text(ele)
    with pytest.raises(InputError, match=told):
        Mesh.read(tmp_path / "a.node")
