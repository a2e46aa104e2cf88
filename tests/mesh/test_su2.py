"""SU2's format: markers of the boundary come back by name; what it cannot hold is told; faults by line."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest
from mixed_cells import planar, spatial

from unstruct import Domain, InputError, Mesh, check, constrained_delaunay

TINY = """% a comment
NDIME= 2
NELEM= 2 % two
5 0 1 2 0
5 0 2 3 1
NPOIN= 4
0 0 0
1 0 1
1 1 2
0 1 3
NMARK= 2
MARKER_TAG= wall
MARKER_ELEMS= 2
3 0 1
3 1 2
MARKER_TAG= far field
MARKER_ELEMS= 2
SEND_RECV= 0
3 2 3
3 3 0
"""


def faces(rows: np.ndarray) -> set[frozenset[int]]:
    return {frozenset(v for v in row if v >= 0) for row in rows.tolist()}


def without_polygons(mesh: Mesh) -> Mesh:
    kinds = np.repeat(list(mesh.cells), [len(block) for block in mesh.cells.values()])
    return mesh.select(kinds != "polygon")


@pytest.mark.parametrize("mesh", [without_polygons(planar(5, seed=3)), spatial(3)], ids=repr)
def test_markers_come_back(tmp_path: Path, mesh: Mesh) -> None:
    border = mesh.boundary
    mesh = Mesh(mesh.points, cells=mesh.cells, markers={"upper": border[:5], "lower": border[5:9]})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh.write(tmp_path / "a.SU2")
        again = Mesh.read(tmp_path / "a.SU2")
    assert np.array_equal(again.points, mesh.points) and set(again.cells) == set(mesh.cells)
    for kind, block in mesh.cells.items():
        assert np.array_equal(again.cells[kind], block)
    assert set(again.markers) == {"upper", "lower", "facets"}
    assert faces(again.markers["upper"]) == faces(border[:5])
    assert faces(again.markers["facets"]) == faces(border[9:])


def test_each_facet_has_one_marker_and_the_rest_is_told(tmp_path: Path) -> None:
    domain = Domain.rectangle(inner=[[0, 2]], markers={"all sides": [0, 1, 2, 3], "cut": [4], "none": []})
    mesh = constrained_delaunay(domain)
    with pytest.warns(UserWarning, match="not written: .*stores for each facet") as told:
        mesh.write(tmp_path / "a.su2")
    text = str(told[0].message)
    assert all(repr(name) in text for name in ("all sides", "cut", "none")) and "'bottom'" not in text
    again = Mesh.read(tmp_path / "a.su2")
    assert {"bottom", "right", "top", "left"} <= set(again.markers)
    assert sum(len(rows) for rows in again.markers.values()) == 4


def test_names_are_such_as_configurations_can_use(tmp_path: Path) -> None:
    names = ["a b", "a,b", "(a)b", "%"]
    mesh = Mesh(
        [[0, 0], [1, 0], [1, 1], [0, 1]],
        [[0, 1, 2], [0, 2, 3]],
        markers={name: [[i, (i + 1) % 4]] for i, name in enumerate(names)},
    )
    mesh.write(tmp_path / "a.su2")
    again = Mesh.read(tmp_path / "a.su2")
    assert set(again.markers) == {"a_b", "a_b_2", "_a_b", "_"}


def test_files_from_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "a.su2").write_text("\ufeff" + TINY.replace("\n", "\r\n"))
    mesh = Mesh.read(tmp_path / "a.su2")
    assert mesh.volume == 1 and check(mesh)
    assert {name: rows.tolist() for name, rows in mesh.markers.items()} == {
        "wall": [[0, 1], [1, 2]],
        "far field": [[2, 3], [3, 0]],
    }


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("NDIME= 2", "", r"a\.su2 is not in SU2's format: there is no line 'NDIME= 2'"),
        ("NDIME= 2", "NDIME= 4", r"a\.su2, line 2: the dimension is 4"),
        ("NDIME= 2", "NDIME= two", r"a\.su2, line 2: 'two' is no count"),
        ("NELEM= 2 ", "NELEM= 3 ", r"a\.su2, line 3: cells number 3 of 3 is|a\.su2, line 3: 3 cells"),
        ("NELEM= 2 ", "NELEM= 1 ", r"a\.su2, line 3: 1 cells are announced, but more numbers follow"),
        ("5 0 2 3 1", "5 0 2 three 1", r"a\.su2, line 5: '5 0 2 three 1' is not a row of whole numbers"),
        ("5 0 2 3 1", "4 0 2 3 1", r"a\.su2, line 3: cells of type 4 are not known"),
        ("5 0 2 3 1", "5 0 2 9 1", r"a\.su2: 'triangle' has the vertex 9, but NPOIN says 4"),
        ("NPOIN= 4", "NPOIN= 5", r"a\.su2, line 6: 5 points of 2 coordinates are announced"),
        ("1 1 2\n", "1 one 2\n", r"a\.su2, line 9: '1 one 2' is not a row of numbers"),
        ("NPOIN= 4\n0 0 0\n1 0 1\n1 1 2\n0 1 3\n", "", r"a\.su2 has no NPOIN"),
        ("NDIME= 2", "NZONE= 2\nNDIME= 2", r"a\.su2, line 2: there are 2 zones"),
    ],
)
def test_faults_are_named_by_their_line(tmp_path: Path, old: str, new: str, told: str) -> None:
    assert old in TINY
    (tmp_path / "a.su2").write_text(TINY.replace(old, new))
    with pytest.raises(InputError, match=told):
        Mesh.read(tmp_path / "a.su2")


def test_surfaces_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="SU2 has meshes of the plane and of space"):
        Mesh(np.eye(3), [[0, 1, 2]]).write(tmp_path / "a.su2")
    assert not list(tmp_path.iterdir())
