"""PLY: texts and binary files of any properties, and files that are not as they should be."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from unstruct import Domain, InputError

TEXT = """ply
format ascii 1.0
comment made by hand
element vertex 4
property float x
property float y
property float z
property uchar red
element face 4
property uchar quality
property list uchar int vertex_indices
element edge 1
property int vertex1
property int vertex2
end_header
0 0 0 255
1 0 0 255
0 1 0 255
0 0 1 255
9 3 0 2 1
9 3 0 1 3
9 3 1 2 3
9 3 0 3 2
0 1
"""


def binary(order: str, sizes: tuple[int, ...] = (3, 3, 3, 3)) -> bytes:
    """The same body, with another order of properties."""
    kind = {"<": "little", ">": "big"}[order]
    head = (
        f"ply\nformat binary_{kind}_endian 1.0\nelement vertex 4\nproperty double z\nproperty float y\n"
        "property double x\nelement face 4\nproperty list uint8 uint32 vertex_index\n"
        "property int8 a\nend_header\n"
    )
    rows = [(0, 0, 0), (0, 0, 1), (0, 1, 0), (1, 0, 0)]
    faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
    body = b"".join(struct.pack(f"{order}dfd", *row) for row in rows)
    body += b"".join(struct.pack(f"{order}B3Ib", 3, *row, 7) for row in faces)
    return head.encode() + body


def test_other_elements_are_accounted_for(tmp_path: Path) -> None:
    (tmp_path / "a.ply").write_text(TEXT)
    body = Domain.read(tmp_path / "a.ply")
    assert [repair.text for repair in body.repairs] == ["the file also has 1 of 'edge', which were left out"]
    (tmp_path / "b.ply").write_bytes(binary("<"))
    assert Domain.read(tmp_path / "b.ply").repairs == []


@pytest.mark.parametrize("as_binary", [False, True])
def test_round_trip(tmp_path: Path, as_binary: bool) -> None:
    """Points, polygons and their order, bit for bit; triangles alone are read all at once."""
    mixed = Domain.revolved(Domain.rectangle((0, 0), (1 / 3, 1)), count=30 if as_binary else 7)
    for body in (mixed, Domain.ball(size=0.6), Domain.box((0.1, 0, 0), (1, 1, 1e9))):
        bare = Domain(body.points, body.facets)
        bare.write(tmp_path / "A.Ply", binary=as_binary)
        again = Domain.read(tmp_path / "A.Ply")
        assert np.array_equal(again.points, bare.points)
        assert [row.tolist() for row in again.facets] == [row.tolist() for row in bare.facets]


def test_long_lists(tmp_path: Path) -> None:
    """More than 255 vertices need a longer type for the number of them."""
    turn = 2 * np.pi * np.arange(300) / 300
    body = Domain.extruded(Domain.polygon(np.column_stack([np.cos(turn), np.sin(turn)])), 1)
    bare = Domain(body.points, body.facets)
    for as_binary in (False, True):
        bare.write(tmp_path / "a.ply", binary=as_binary)
        assert Domain.read(tmp_path / "a.ply").volume == body.volume


@pytest.mark.parametrize(
    "data",
    [
        TEXT.encode(),
        TEXT.replace("\n", "\r\n").encode(),
        b"\xef\xbb\xbf" + TEXT.encode(),
        binary("<"),
        binary(">"),
        binary("<").replace(b"\n", b"\r\n", 9),
    ],
)
def test_forms(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "a.ply").write_bytes(data)
    assert Domain.read(tmp_path / "a.ply").volume == 1 / 6


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda t: "", "a.ply is not a PLY file"),
        (lambda t: t.replace("vertex 4", "vertex 0"), "a.ply has no vertices"),
        (lambda t: t[:100], "ends before 'end_header'"),
        (lambda t: t.replace("format ascii 1.0\n", ""), "the header has no 'format'"),
        (lambda t: t.replace("ascii", "binary"), "line 2: 'format binary 1.0' is no line of the header"),
        (lambda t: t.replace("vertex 4", "vertex x"), "line 4: 'element vertex x' is no line of the header"),
        (lambda t: t.replace("vertex 4", "vertex -4"), "line 4: "),
        (lambda t: t.replace("property float z\n", ""), "vertices need the properties x, y, z"),
        (lambda t: t.replace("vertex_indices", "corners"), "faces need the list 'vertex_indices'"),
        (lambda t: t.replace("element vertex", "element point"), "has no element 'vertex'"),
        (
            lambda t: t.replace("face 4", "face 6"),
            "announces 1 of 'edge', but ends after 0|announces 6 of 'face'",
        ),
        (lambda t: t.replace("face 4", "face 3"), "'0 1' follows the last element"),
        (lambda t: t.replace("0 1 0 255", "0 nan 0 255"), "line 18: 'nan' among coordinates is not finite"),
        (lambda t: t.replace("0 1 0 255", "0 1 0"), "line 18: a vertex has 4 properties, not 3"),
        (lambda t: t.replace("9 3 0 1 3", "9 3 0 1 4"), "line 21: there is no vertex 4; the file has 0 to 3"),
        (lambda t: t.replace("9 3 0 1 3", "9 3 0 1"), "line 21: a face is the number of its vertices"),
        (lambda t: t.replace("9 3 0 1 3", "9 2 0 1"), "line 21: a facet has 2 vertices"),
        (lambda t: t.replace("element face", "element tristrips"), "strips of triangles"),
    ],
)
def test_wrong_texts_are_refused(tmp_path: Path, change: object, told: str) -> None:
    (tmp_path / "a.ply").write_text(change(TEXT))
    with pytest.raises(InputError, match=told):
        Domain.read(tmp_path / "a.ply")


def test_wrong_binary_files_are_refused(tmp_path: Path) -> None:
    data = binary("<")
    at = data.index(b"end_header\n") + 11
    nan = data[:at] + struct.pack("<d", float("nan")) + data[at + 8 :]
    faces = at + 4 * 20
    for changed, told in (
        (data[:-1], "announces 4 of 'face', but ends before they do: it is truncated"),
        (data[: at + 30], "announces 4 of 'vertex', but ends before"),
        (data + b"x", "1 bytes follow the last element"),
        (nan, "vertex 0 has coordinates .*nan"),
        (
            data[: faces + 1] + struct.pack("<I", 9) + data[faces + 5 :],
            "face 0 has the vertex 9; the file has 4",
        ),
        (data[:faces] + b"\x02" + data[faces + 1 :], "face 0 has 2 vertices|truncated|follow"),
    ):
        (tmp_path / "a.ply").write_bytes(changed)
        with pytest.raises(InputError, match=told):
            Domain.read(tmp_path / "a.ply")
