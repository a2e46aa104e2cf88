"""STL: texts and binary files, several solids, equal corners, and files that are not as they should be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from unstruct import Domain, DomainError, InputError

TETRAHEDRON = Domain(
    [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
)


def text_of(domain: Domain, tmp_path: Path) -> str:
    domain.write(tmp_path / "source.stl")
    return (tmp_path / "source.stl").read_text()


def test_text_round_trip(tmp_path: Path) -> None:
    """Doubles with all digits, names of solids, and the order of triangles."""
    ball = Domain.ball((0.1, 1 / 3, 1e-9), size=0.6, markers={"north pole": [0, 3], "rest": range(4, 80)})
    ball.write(tmp_path / "a.stl")
    again = Domain.read(tmp_path / "a.stl")
    assert {name: len(rows) for name, rows in again.markers.items()} == {"north pole": 2, "rest": 76}
    assert again.volume == ball.volume and set(map(tuple, again.points)) == set(map(tuple, ball.points))
    assert len(again.facets) == 80 and again.repairs[0].text.startswith(
        "merged 240 corners of 80 triangles into 42"
    )
    again.write(tmp_path / "b.stl")
    assert (tmp_path / "b.stl").read_bytes() == (tmp_path / "a.stl").read_bytes()


def test_binary_round_trip(tmp_path: Path) -> None:
    box = Domain.box((0, 0, 0), (1, 2, 0.5))
    with pytest.warns(UserWarning, match="not written: markers"):
        box.write(tmp_path / "A.STL", binary=True)
    data = (tmp_path / "A.STL").read_bytes()
    assert len(data) == 84 + 12 * 50
    again = Domain.read(tmp_path / "A.STL")
    assert again.volume == 1.0 and len(again.points) == 8 and len(again.facets) == 12
    again.write(tmp_path / "b.stl", binary=True)
    assert (tmp_path / "b.stl").read_bytes() == data
    # a head that says "solid", and another file behind
    (tmp_path / "c.stl").write_bytes(
        b"solid".ljust(80) + data[80:] + b"two".ljust(80) + data[80:84] + moved(data)
    )
    both = Domain.read(tmp_path / "c.stl")
    assert both.volume == 2.0 and {name: len(rows) for name, rows in both.markers.items()} == {
        "solid 1": 12,
        "two": 12,
    }


def moved(data: bytes) -> bytes:
    rows = np.frombuffer(data, [("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")], offset=84).copy()
    rows["v"] += 5
    return rows.tobytes()


def test_corners_are_merged_with_an_account(tmp_path: Path) -> None:
    (tmp_path / "a.stl").write_text(
        text_of(TETRAHEDRON, tmp_path).replace("vertex 0.0 0.0 0.0", "vertex -0.0 0 0.0", 1)
    )
    found = Domain.read(tmp_path / "a.stl")
    assert found.volume == 1 / 6 and len(found.points) == 4
    (repair,) = found.repairs
    assert repair.kind == "duplicate points" and "merged 12 corners of 4 triangles into 4 points" in str(
        repair
    )
    assert found.origin.tolist() == [0, 1, 2, 5] and found.piece_origin.tolist() == [0, 1, 2, 3]


def test_forms_of_a_text(tmp_path: Path) -> None:
    text = text_of(TETRAHEDRON, tmp_path)
    forms = {
        "windows": text.replace("\n", "\r\n").encode(),
        "mark": b"\xef\xbb\xbf" + text.encode(),
        "capitals": text.upper().encode(),
        "one line each": b"solid a\n" + b" ".join(text.encode().split()[1:-1]) + b"\nendsolid",
        "spaces": ("\n\n  " + text.replace("\n", "\n\n\t")).encode(),
        "bytes": text.replace("solid", "solid caf\xe9", 1).encode("latin-1"),
    }
    for name, data in forms.items():
        (tmp_path / "a.Stl").write_bytes(data)
        assert Domain.read(tmp_path / "a.Stl").volume == 1 / 6, name


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda t: "", r"a\.stl is empty"),
        (lambda t: "  \n", r"a\.stl is empty"),
        (lambda t: "solid\nendsolid\n", r"a\.stl has no triangles"),
        (lambda t: t[:200], r"a\.stl, line \d+: "),
        (lambda t: t.replace("endsolid\n", ""), "ends without 'endsolid': it is truncated"),
        (
            lambda t: t.replace("vertex 1.0 0.0 0.0", "vertex 1.0 nan 0.0", 1),
            r"line \d+: 'nan' among coordinates",
        ),
        (
            lambda t: t.replace("vertex 1.0 0.0 0.0", "vertex 1.0 1e999 0", 1),
            "'1e999' among coordinates is not finite",
        ),
        (lambda t: t.replace("vertex 1.0 0.0 0.0", "vertex 1.0 o 0.0", 1), r"line \d+: 'o' is no number"),
        (lambda t: t.replace("vertex 1.0 0.0 0.0", "vertex 1.0 0.0", 1), "a vertex needs 3 coordinates"),
        (lambda t: t.replace("endloop\n", "", 1), r"line 7: 'endloop' is expected, not 'endfacet'"),
        (lambda t: t + "more", "after the last 'endsolid'"),
        (lambda t: t + "endsolid\n", "'endsolid' is not expected here"),
        (lambda t: "solid\n" + t, "'solid' is not expected here"),
        (lambda t: "hello", "neither a text that begins with 'solid', nor the head of a binary STL file"),
        (lambda t: "x" * 200, r"announces 2021161080 triangles.* it is truncated, or not an STL file"),
    ],
)
def test_wrong_texts_are_refused(tmp_path: Path, change: object, told: str) -> None:
    (tmp_path / "a.stl").write_text(change(text_of(TETRAHEDRON, tmp_path)))
    with pytest.raises(InputError, match=told):
        Domain.read(tmp_path / "a.stl")


def test_wrong_binary_files_are_refused(tmp_path: Path) -> None:
    TETRAHEDRON.write(tmp_path / "a.stl", binary=True)
    data = (tmp_path / "a.stl").read_bytes()
    wrong = np.frombuffer(data, dtype=np.uint8).copy()
    wrong[84 + 50 + 12 : 84 + 50 + 16] = 255
    for changed, told in (
        (data[:-1], "announces 4 triangles, which take 284 bytes, but has 283"),
        (data[:50], "its 50 bytes are neither a text"),
        (data[:80] + bytes(4) + data[84:], "announces 0 triangles, but has 200 bytes .* as of 4 triangles"),
        (data + b"abc", "3 bytes after the last triangle"),
        (wrong.tobytes(), "triangle 1 has coordinates .*nan"),
        (data[:80] + bytes(4), "has no triangles"),
    ):
        (tmp_path / "b.stl").write_bytes(changed)
        with pytest.raises(InputError, match=told):
            Domain.read(tmp_path / "b.stl")


def test_an_open_surface_is_a_fault(tmp_path: Path) -> None:
    text = text_of(TETRAHEDRON, tmp_path)
    (tmp_path / "a.stl").write_text("solid\n" + text[text.index("facet", text.index("endfacet") + 9) :])
    with pytest.raises(DomainError, match="the boundary is open"):
        Domain.read(tmp_path / "a.stl")
