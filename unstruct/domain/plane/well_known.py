"""Well-known text (WKT) of geometries, as GeoJSON mappings.

Understood are POINT, LINESTRING, LINEARRING, POLYGON, TRIANGLE, their MULTI forms, TIN, POLYHEDRALSURFACE
and GEOMETRYCOLLECTION, with or without Z, M, ZM, EMPTY, and "SRID=...;" before them; several may follow each
other. Source: OGC 06-103r4, Simple feature access, part 1.
"""

from __future__ import annotations

import re
from typing import Any

from ...base.decimals import numbers_of
from ...base.errors import InputError

__all__ = ["is_wkt", "wkt_geometries"]

WKT_KINDS = {  # name -> (type of GeoJSON, brackets within its own)
    "POINT": ("Point", 0),
    "LINESTRING": ("LineString", 0),
    "LINEARRING": ("LinearRing", 0),
    "POLYGON": ("Polygon", 1),
    "TRIANGLE": ("Polygon", 1),
    "MULTIPOINT": ("MultiPoint", 0),
    "MULTILINESTRING": ("MultiLineString", 1),
    "MULTIPOLYGON": ("MultiPolygon", 2),
    "TIN": ("MultiPolygon", 2),
    "POLYHEDRALSURFACE": ("MultiPolygon", 2),
}
CURVED = "CIRCULARSTRING|COMPOUNDCURVE|CURVEPOLYGON|MULTICURVE|MULTISURFACE|CURVE|SURFACE"
WKT_START = re.compile(
    rf"\s*(SRID\s*=\s*\d+\s*;\s*)?({'|'.join(WKT_KINDS)}|GEOMETRYCOLLECTION|{CURVED})(ZM|Z|M)?\b", re.I
)
WKT_NEXT = re.compile(r"\s*(SRID\s*=\s*\d+\s*;\s*)?([A-Za-z]+)(?:\s*(ZM|Z|M)\b)?\s*(EMPTY\b|\()?", re.I)


def is_wkt(text: str) -> bool:
    """Whether a text begins as WKT does: with the name of a geometry, and what may follow it."""
    match = WKT_START.match(text)
    return (
        match is not None
        and re.match(r"\s*((ZM|Z|M)\b)?\s*(EMPTY\b|\()", text[match.end() :], re.I) is not None
    )


def wkt_geometries(text: str, source: str) -> list[dict[str, Any]]:
    """The geometries of a text as GeoJSON mappings; ``source`` is named in errors.

    Raises
    ------
    InputError
        For text that is not WKT, and for curves; the message names the line.

    Notes
    -----
    O(length of the text).
    """
    reader = _Reader(text, source)
    found = []
    while reader.text[reader.at :].strip(" \t\r\n;"):
        while reader.text[reader.at] in " \t\r\n;":
            reader.at += 1
        found.append(reader.geometry())
    if not found:
        raise InputError(f"{source} contains no geometry")
    return found


class _Reader:
    """A text and how far it has been read."""

    def __init__(self, text: str, source: str):
        self.text, self.source, self.at = text, source, 0

    def error(self, what: str) -> InputError:
        line = self.text.count("\n", 0, self.at) + 1
        here = self.text[self.at : self.at + 30].split("\n")[0]
        return InputError(f"{self.source}, line {line}, at {here!r}: {what}")

    def geometry(self) -> dict[str, Any]:
        match = WKT_NEXT.match(self.text, self.at)
        if match is None:
            raise self.error("the name of a geometry is expected, such as POLYGON")
        name = match[2].upper()
        short = re.sub(r"(ZM|Z|M)$", "", name)  # POLYGONZ, without a space
        name = name if name in WKT_KINDS or short not in {*WKT_KINDS, "GEOMETRYCOLLECTION"} else short
        if name not in WKT_KINDS and name != "GEOMETRYCOLLECTION":
            curved = re.fullmatch(CURVED, name)
            hint = (
                "convert curves to straight segments first" if curved else f"known are {', '.join(WKT_KINDS)}"
            )
            raise self.error(f"{name} is not understood; {hint}")
        if not match[4]:
            raise self.error(f"'(' or EMPTY is expected after {name}")
        self.at = match.end()
        empty = match[4] != "("
        if name == "GEOMETRYCOLLECTION":
            parts = []
            while not empty:
                parts.append(self.geometry())
                if self._separator() == ")":
                    break
            return {"type": "GeometryCollection", "geometries": parts}
        kind, depth = WKT_KINDS[name]
        coordinates = [] if empty else self._group(depth, points=name == "MULTIPOINT")
        if kind == "Point" and not empty:
            if len(coordinates) != 1:
                raise self.error("a POINT has one position")
            coordinates = coordinates[0]
        return {"type": kind, "coordinates": coordinates}

    def _separator(self) -> str:
        match = re.compile(r"\s*([,)])").match(self.text, self.at)
        if match is None:
            raise self.error("',' or ')' is expected")
        self.at = match.end()
        return match[1]

    def _open(self) -> bool:
        """Read '(' or EMPTY; return whether it was '('."""
        match = re.compile(r"\s*(\(|EMPTY\b)", re.I).match(self.text, self.at)
        if match is None:
            raise self.error("'(' or EMPTY is expected")
        self.at = match.end()
        return match[1] == "("

    def _group(self, depth: int, *, points: bool = False) -> Any:
        """What is within brackets, of which the first is read: positions, or lists of them."""
        if depth == 0:
            return self._positions(points)
        found = []
        while True:
            found.append(self._group(depth - 1) if self._open() else [])
            if self._separator() == ")":
                return found

    def _positions(self, points: bool) -> list[list[float]]:
        if points and "(" in (ahead := self.text[self.at : self.at + 200]) and ahead.lstrip()[0] in "(eE":
            found: list[list[float]] = []  # MULTIPOINT ((1 2), (3 4))
            while True:
                found += self._positions(False) if self._open() else []
                if self._separator() == ")":
                    return found
        end = self.text.find(")", self.at)
        if end < 0:
            raise self.error("there is no ')' for a '('")
        body = self.text[self.at : end]
        many = body.count(",") + 1
        numbers = numbers_of(body.replace(",", " "))
        if numbers is None or len(numbers) % many or not 2 <= len(numbers) // many <= 4:
            for position in body.split(","):
                values = numbers_of(position)
                if values is None or not 2 <= len(values) <= 4:
                    self.at += body.find(position)
                    raise self.error(f"{position.strip()[:40]!r} is no position 'x y'")
            raise self.error("positions have different numbers of coordinates")
        self.at = end + 1
        return numbers.reshape(many, -1).tolist()
