"""Well-known text: every kind of geometry, and where it is wrong."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from unstruct import InputError
from unstruct.domain.plane.well_known import is_wkt, wkt_geometries

RINGS = [[[0, 0], [4, 0], [4, 4], [0, 0]], [[1, 1], [2, 1], [2, 2], [1, 1]]]
CASES = [
    ("POINT (1 2)", "Point", [1, 2]),
    ("point(1 -2e0)", "Point", [1, -2]),
    ("POINT Z (1 2 3)", "Point", [1, 2, 3]),
    ("POINTZM(1 2 3 4)", "Point", [1, 2, 3, 4]),
    ("POINT EMPTY", "Point", []),
    ("SRID=4326; POINT (1 2)", "Point", [1, 2]),
    ("LINESTRING (0 0, 1 1\n, 2 0)", "LineString", [[0, 0], [1, 1], [2, 0]]),
    ("LINEARRING (0 0, 1 1, 2 0, 0 0)", "LinearRing", [[0, 0], [1, 1], [2, 0], [0, 0]]),
    ("POLYGON ((0 0, 4 0, 4 4, 0 0), (1 1, 2 1, 2 2, 1 1))", "Polygon", RINGS),
    ("TRIANGLE ((0 0, 4 0, 4 4, 0 0))", "Polygon", RINGS[:1]),
    ("POLYGON M EMPTY", "Polygon", []),
    ("MULTIPOINT ((0 0), EMPTY, (1 2))", "MultiPoint", [[0, 0], [1, 2]]),
    ("MULTIPOINT (0 0, 1 2)", "MultiPoint", [[0, 0], [1, 2]]),
    ("MULTILINESTRING ((0 0, 1 1), EMPTY)", "MultiLineString", [[[0, 0], [1, 1]], []]),
    ("MULTIPOLYGON (((0 0, 4 0, 4 4, 0 0)), EMPTY)", "MultiPolygon", [RINGS[:1], []]),
    ("TIN (((0 0, 4 0, 4 4, 0 0)))", "MultiPolygon", [RINGS[:1]]),
]


@pytest.mark.parametrize(("text", "kind", "coordinates"), CASES)
def test_every_kind(text: str, kind: str, coordinates: list) -> None:
    assert is_wkt(text)
    assert wkt_geometries(text, "it") == [{"type": kind, "coordinates": coordinates}]


def test_collections_and_several() -> None:
    inner = ", ".join(text for text, _, _ in CASES if "SRID" not in text)
    (found,) = wkt_geometries(f"GEOMETRYCOLLECTION Z ({inner}, GEOMETRYCOLLECTION EMPTY)", "it")
    assert len(found["geometries"]) == len(CASES)
    assert [part["type"] for part in found["geometries"][:2]] == ["Point", "Point"]
    text = ";\n".join(text for text, _, _ in CASES if "SRID" not in text)
    assert len(wkt_geometries(text, "it")) == len(CASES) - 1


@given(st.lists(st.tuples(*[st.floats(allow_nan=False, allow_infinity=False)] * 2), min_size=1, max_size=9))
def test_every_digit_counts(points: list[tuple[float, float]]) -> None:
    text = ", ".join(f"{x!r} {y!r}" for x, y in points)
    (found,) = wkt_geometries(f"LINESTRING ({text})", "it")
    assert json.dumps(found["coordinates"]) == json.dumps(points)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("CIRCULARSTRING (0 0, 1 1, 2 0)", "CIRCULARSTRING is not understood; convert curves to straight"),
        ("HEXAGON (0 0)", r"it, line 1, at 'HEXAGON .*: HEXAGON is not understood; known are POINT"),
        ("POINT (1 2, 3 4)", "a POINT has one position"),
        ("POINT 1 2", r"'\(' or EMPTY is expected after POINT"),
        ("POLYGON (0 0, 1 1)", r"it, line 1, at '0 0, 1 1\)': '\(' or EMPTY is expected"),
        ("LINESTRING (0 0,\n\n1 x)", r"it, line 3, at '1 x\)'|it, line \d, at .*: '1 x' is no position"),
        ("LINESTRING (0 0, 1)", "'1' is no position"),
        ("LINESTRING (0 0, 1 1 1)", "positions have different numbers of coordinates"),
        ("POLYGON ((0 0, 1 1, 2 0, 0 0)", r"',' or '\)' is expected"),
        ("POLYGON ((0 0, 1 1", r"there is no '\)' for a '\('"),
        ("MULTIPOLYGON (((0 0, 1 1, 2 0, 0 0)) POINT", r"',' or '\)' is expected"),
        ("POINT (1 2) and more", "AND is not understood|is expected"),
        ("", "it contains no geometry"),
    ],
)
def test_faults_are_named_by_their_line(text: str, told: str) -> None:
    with pytest.raises(InputError, match=told):
        wkt_geometries(text, "it")


def test_paths_are_no_geometries() -> None:
    for path in ("point.dat", "polygon", "POLYGON 1.shp", "tin/a.poly", "triangle.poly", ""):
        assert not is_wkt(path)
